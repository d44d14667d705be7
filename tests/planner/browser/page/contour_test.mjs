// SPDX-License-Identifier: AGPL-3.0-or-later
// The contour workbench on the head phantom, or on the scan OCTOTOMY_CONTOUR_SCAN: contours are drawn, corrected, dragged,
// smoothed, erased, found around a pixel, taken from an object and copied. Each is one edit, and the object is certified.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-contour-'));
const plan_path = path.join(folder, 'contour.plan.json');
const pictures = process.env.OCTOTOMY_PICTURES;
const scan = process.env.OCTOTOMY_CONTOUR_SCAN;
const axial = 2; // of the layout "Views and slices"
let server;
let one;
const plan = () => one.plan(plan_path);
const ours = () => plan().steps.find((each) => each.do === 'tile');
const at = (position) => ours()?.contours.find((slice) => Math.abs(slice.position_mm - position) < 0.02);
const picture = async (name) => {
  if (pictures) await one.page.screenshot({ path: path.join(pictures, `contour_${name}.png`) });
};
const choose = (label) => one.click(one.page.locator(`[data-key="contour-${label}"]`));
const height = async () => Math.round((await one.look()).cross_mm[2] * 100) / 100;
const area = (line) => Math.abs(line.reduce((sum, a, i) => {
  const b = line[(i + 1) % line.length];
  return sum + (a[0] * b[1] - a[1] * b[0]) / 2;
}, 0));
/// Drags around points of the axial slice, in the pane's millimetres.
const draw = async (points) => {
  const way = [];
  for (const uv of points) way.push(await one.position(axial, uv));
  await one.page.mouse.move(way[0].x, way[0].y);
  await one.page.mouse.down();
  for (const { x, y } of way.slice(1)) await one.page.mouse.move(x, y, { steps: 3 });
  await one.page.mouse.up();
};
const circle = (u, v, radius, count = 24) => Array.from({ length: count + 1 }, (_, i) => [u + radius * Math.cos((2 * Math.PI * i) / count), v + radius * Math.sin((2 * Math.PI * i) / count)]);

before(async () => {
  if (scan) fs.symlinkSync(scan, path.join(folder, 'head_phantom.nrrd'));
  else lay_phantom(folder, 2);
  fs.writeFileSync(plan_path, JSON.stringify({
    octotomy_plan: 1, name: 'contour', scans: { ct: { path: 'head_phantom.nrrd' } }, universe: { voxel_mm: 2 },
    steps: [{ id: 'skull', do: 'window', scan: 'ct', low: 300 }],
  }));
  server = await start_server(folder, [plan_path]);
  one = await PlannerWindow.open(server.url);
  await one.click('Continue');
  await one.command('Views and slices');
  await one.at_rest();
  await one.click('Contours (E)');
});
after(async () => {
  if (pictures && one) await picture('last');
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

let z;
test('a drag around a region of a slice is a contour, and begins an object', async () => {
  z = await height();
  await draw(circle(0, 0, 20));
  await one.until(() => ours(), 'the contour as a step');
  assert.equal(ours().view, 'inferior');
  assert.equal(at(z).polygons_mm.length, 1);
  assert.ok(ours().end_mm > 0);
  const drawn = area(at(z).polygons_mm[0]);
  assert.ok(Math.abs(drawn - Math.PI * 400) < 40, `the area of the circle: ${drawn}`);
  await one.at_rest();
  await picture('drawn');
});

test('it is copied to the next slices on either side, which are shown then', async () => {
  await choose('on');
  await one.until(() => ours().contours.length === 2, 'copied on');
  const above = await height();
  assert.ok(above > z && at(above), `the slice at ${above} is shown and has the contour`);
  assert.deepEqual(at(above).polygons_mm, at(z).polygons_mm);
  await one.page.locator('.pane canvas').nth(axial).focus();
  await one.press('.');
  await one.until(() => ours().contours.length === 3, 'copied on by its key');
  await choose('back');
  await one.page.locator('.notice', { hasText: 'erase them first' }).first().waitFor();
  assert.equal(ours().contours.length, 3);
});

test('a contour is dragged with what is near it, and undone by itself', async () => {
  const top = await height();
  const as_it_was = JSON.stringify(at(top).polygons_mm);
  await choose('Drag');
  await one.type('contour-reach', 10);
  await draw([[20, 0], [23, 0], [26, 0]]);
  await one.until(() => JSON.stringify(at(top).polygons_mm) !== as_it_was, 'the dragged contour');
  const most = Math.max(...at(top).polygons_mm[0].map((p) => Math.abs(p[0])));
  assert.ok(Math.abs(most - 26) < 1, `the place follows the hand: ${most}`);
  await picture('dragged');
  await one.press('Control+z');
  await one.until(() => JSON.stringify(at(top).polygons_mm) === as_it_was, 'undone');
  await one.press('Control+y');
  await one.until(() => JSON.stringify(at(top).polygons_mm) !== as_it_was, 'done again');
});

test('smoothing takes the bulge down, and keeps the area of the rest', async () => {
  const top = await height();
  const rough = at(top).polygons_mm[0];
  await choose('Smooth');
  await draw([[24, -6], [26, 0], [24, 6], [25, 0], [24, -6], [26, 0], [24, 6]]);
  await one.until(() => JSON.stringify(at(top).polygons_mm[0]) !== JSON.stringify(rough), 'smoothed');
  const smooth = at(top).polygons_mm[0];
  assert.ok(Math.abs(area(smooth) - area(rough)) < 0.1 * area(rough));
});

test('a stroke from the contour to the contour draws a stretch of it anew', async () => {
  const top = await height();
  const before = area(at(top).polygons_mm[0]);
  await choose('Draw');
  await draw([[0, 20], [-5, 27], [-10, 28], [-15, 24], [-17.3, 10]]);
  await one.until(() => area(at(top).polygons_mm[0]) > before + 20, 'the longer contour');
  assert.equal(at(top).polygons_mm.length, 1);
});

test('clicks set corners, Enter closes; a line that crosses a contour is refused in a line', async () => {
  const top = await height();
  for (const uv of [[-50, -10], [-40, -10], [-40, 5], [-50, 5]]) await one.click_at(axial, uv);
  await one.press('Enter');
  await one.until(() => at(top).polygons_mm.length === 2, 'the second contour');
  assert.ok(Math.abs(area(at(top).polygons_mm[1]) - 150) < 10);
  await draw(circle(-40, 0, 8));
  await one.page.locator('.notice', { hasText: 'crosses itself or another contour' }).first().waitFor();
  assert.equal(at(top).polygons_mm.length, 2);
});

test('a click erases the contour around it', async () => {
  const top = await height();
  await choose('Erase');
  await one.click_at(axial, [-45, 0]);
  await one.until(() => at(top).polygons_mm.length === 1, 'erased');
});

test('an object of contours is tiled by both kernels, which agree', async () => {
  await one.press('Escape');
  await one.command('Certify');
  await one.tab('Numbers');
  const badges = one.page.locator('.inspector .badge');
  await one.until(async () => (await badges.count()) >= 2 && (await one.page.locator('.inspector .badge.none').count()) === 0, 'certificates');
  const verdicts = await badges.evaluateAll((all) => all.map((each) => each.classList[1]));
  assert.ok(!verdicts.includes('fail'), `${verdicts}`);
  await picture('certified');
});

test('a seed finds the region around a pixel, and the outline of an object is taken over', async () => {
  await one.click('Contours (E)');
  await one.select(ours().id);
  await one.at_rest();
  await one.page.locator('.pane canvas').nth(axial).hover();
  await choose('Seed');
  await one.type('contour-tolerance', 60);
  const top = await height();
  await one.click_at(axial, [0, -30]);
  await one.until(() => Math.max(...at(top).polygons_mm.map(area)) > 2000, 'the brain behind the middle');
  await picture('seed');
  const found = JSON.stringify(at(top).polygons_mm);
  await one.page.locator('[data-key="contour-object"]').click();
  await one.until(() => JSON.stringify(at(top).polygons_mm) !== found, 'the outline of the skull');
  await picture('outline');
  assert.deepEqual(one.problems, []);
});

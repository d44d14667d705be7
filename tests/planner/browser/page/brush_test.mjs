// SPDX-License-Identifier: AGPL-3.0-or-later
// The brush on the head phantom: strokes in slices and in views, by mouse and by keys, ball and slab, erased and painted. Each
// stroke is one edit, and further ones of the same mode are added to the same step.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-brush-'));
const plan_path = path.join(folder, 'brush.plan.json');
const pictures = process.env.OCTOTOMY_PICTURES;
const theme = process.env.OCTOTOMY_THEME ?? 'dark';
const view = 0, axial = 2; // of the layout "Views and slices"
let server;
let one;
const plan = () => one.plan(plan_path);
const step = (name) => plan().steps.find((each) => each.id === name);
const picture = async (name) => {
  if (pictures) await one.page.screenshot({ path: path.join(pictures, `brush_${name}_${theme}.png`) });
};
const newest = (pane) => one.frames.filter(({ header }) => header.pane === pane).pop();
const choose = (label) => one.click(one.page.locator(`[data-key="brush-${label}"]`));
const across = (p, axis) => p.map((q) => q[axis]);

before(async () => {
  lay_phantom(folder, 2);
  fs.writeFileSync(plan_path, JSON.stringify({
    octotomy_plan: 1, name: 'brush', scans: { ct: { path: 'head_phantom.nrrd' } }, universe: { voxel_mm: 2 },
    steps: [{ id: 'skull', do: 'window', scan: 'ct', low: 300 }],
  }));
  server = await start_server(folder, [plan_path]);
  one = await PlannerWindow.open(server.url, { theme });
  await one.click('Continue');
  await one.command('Views and slices');
  await one.at_rest();
  await one.select('skull');
});
after(async () => {
  if (pictures && one) await picture('last');
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('a drag in a slice erases along it, in the plane of the slice, as one step', async () => {
  await one.click('Brush');
  await one.type('brush-radius', 6);
  await one.at_rest();
  const as_it_was = newest(axial).picture;
  const { cross_mm } = await one.look();
  await one.drag(axial, [-30, 75], [30, 75]);
  await one.until(() => step('skull_erased'), 'the stroke as a step');
  const { strokes, mode, object } = step('skull_erased');
  assert.equal(object, 'skull');
  assert.equal(mode, undefined, 'to erase is the default');
  assert.equal(strokes.length, 1);
  assert.equal(strokes[0].radius_mm, 6);
  assert.equal(strokes[0].shape, undefined);
  const points = strokes[0].points_mm;
  assert.ok(points.length >= 2 && points.length < 6, `a straight drag has few points: ${points.length}`);
  for (const z of across(points, 2)) assert.ok(Math.abs(z - cross_mm[2]) < 0.011, `${z} in the slice at ${cross_mm[2]}`);
  for (const y of across(points, 1)) assert.ok(Math.abs(y + 75) < 1, `${y}`);
  assert.ok(Math.abs(points[0][0] + points.at(-1)[0]) < 2 && Math.abs(points[0][0] - points.at(-1)[0]) > 55, `${points}`);
  await one.until(() => !newest(axial).picture.equals(as_it_was), 'the slice without the bone');
  await one.at_rest();
  await picture('slice');
});

test('a second stroke is added to the step, and each is undone by itself', async () => {
  await one.drag(axial, [-30, 60], [-30, 40]);
  await one.until(() => step('skull_erased').strokes.length === 2, 'two strokes');
  assert.equal(plan().steps.length, 2);
  await one.press('Control+z');
  await one.until(() => step('skull_erased').strokes.length === 1, 'the second undone');
  await one.press('Control+z');
  await one.until(() => !step('skull_erased'), 'the first undone');
  await one.press('Control+y');
  await one.until(() => step('skull_erased'), 'the first again');
});

test('a stroke in a view lies on the surface, and a slab faces it', async () => {
  await one.select('skull_erased');
  await one.click(one.page.locator('[data-key="brush-Slab"]'));
  await one.type('brush-thickness', 8);
  await one.at_rest();
  const { x, y } = await one.position(view, [0, 40]);
  await one.page.mouse.move(x, y);
  await one.page.waitForTimeout(100);
  await picture('outline');
  await one.drag(view, [-15, 40], [15, 48]);
  await one.until(() => step('skull_erased').strokes.length === 2, 'the slab');
  const slab = step('skull_erased').strokes[1];
  assert.equal(slab.shape, 'slab');
  assert.equal(slab.thickness_mm, 8);
  assert.deepEqual(slab.normal.map((n) => Math.round(n) + 0), [0, 1, 0]);
  for (const depth of across(slab.points_mm, 1)) assert.ok(depth < -60 && depth > -110, `on the forehead: ${depth}`);
  await one.at_rest();
  await picture('view');
});

test('what is painted is a step of its own, whose findings state that it is not measured', async () => {
  await choose('Ball');
  await choose('Paint');
  await one.page.getByText('No scan shows the painted material').waitFor();
  await one.drag(view, [-20, 55], [20, 55]);
  await one.until(() => step('skull_erased_painted'), 'paint as a step');
  assert.equal(step('skull_erased_painted').mode, 'paint');
  assert.equal(step('skull_erased_painted').object, 'skull_erased');
  await one.at_rest();
  await picture('painted');
});

test('keys alone draw a stroke: arrows carry it, Enter begins and ends it, brackets change the radius', async () => {
  const before = step('skull_erased_painted').strokes.length;
  await one.page.locator('.pane canvas').nth(axial).focus();
  await one.press('ArrowRight');
  await one.press('Enter');
  for (let i = 0; i < 4; ++i) await one.press('ArrowRight');
  await one.press(']');
  await picture('keys');
  await one.press('Enter');
  await one.until(() => step('skull_erased_painted').strokes.length === before + 1, 'a stroke by keys');
  assert.equal(step('skull_erased_painted').strokes.at(-1).radius_mm, 6.5);
  await one.press(' ');
  await one.until(() => step('skull_erased_painted').strokes.length === before + 2, 'a dab by Space');
  assert.equal(step('skull_erased_painted').strokes.at(-1).points_mm.length, 1);
  await one.press('Enter');
  await one.press('ArrowLeft');
  await one.press('Escape');
  assert.equal(await one.page.getByRole('button', { name: /^Brush/ }).first().getAttribute('aria-pressed'), 'true', 'Escape let go of the stroke alone');
  assert.equal(step('skull_erased_painted').strokes.length, before + 2);
});

test('beside all surfaces of a view nothing is drawn, and the person is told', async () => {
  const count = plan().steps.map((each) => each.strokes?.length ?? 0).reduce((a, b) => a + b);
  await one.at_rest();
  await one.drag(view, [-95, -100], [-90, -95]);
  await one.page.locator('.notice', { hasText: 'No surface lies there' }).first().waitFor();
  assert.equal(plan().steps.map((each) => each.strokes?.length ?? 0).reduce((a, b) => a + b), count);
});

test('both kernels agree on what was drawn, and no error was on the console', async () => {
  await one.press('Escape');
  await one.command('Certify');
  await one.tab('Numbers');
  const badges = one.page.locator('.inspector .badge');
  await one.until(async () => (await badges.count()) >= 3 && (await one.page.locator('.inspector .badge.none').count()) === 0, 'certificates');
  assert.deepEqual(await badges.evaluateAll((all) => all.map((each) => each.classList[1])), ['pass', 'pass', 'pass']);
  await picture('certified');
  assert.deepEqual(one.problems, []);
});

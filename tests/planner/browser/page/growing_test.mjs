// SPDX-License-Identifier: AGPL-3.0-or-later
// Region growing by click and drag on the head phantom, and offset and shell by a slider: what is tried is shown before it is a
// step, is one edit once it is accepted, and is refused in words.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-growing-'));
const plan_path = path.join(folder, 'growing.plan.json'), other_path = path.join(folder, 'other.plan.json');
const pictures = process.env.OCTOTOMY_PICTURES;
const view = 0, axial = 2; // of the layout "Views and slices"
const plan_of = (name) => ({
  octotomy_plan: 1, name, scans: { ct: { path: 'head_phantom.nrrd' } }, universe: { voxel_mm: 2 },
  steps: [{ id: 'skull', do: 'window', scan: 'ct', low: 300 }],
});
let server;
let one;
const plan = () => one.plan(plan_path);
const step = (name) => plan().steps.find((each) => each.id === name);
const newest = (pane) => one.frames.filter(({ header }) => header.pane === pane).pop()?.header;
const tried = () => one.page.locator('[data-key="tried"]');
const tried_voxels = async () => {
  const words = await tried().innerText().catch(() => '');
  return Number(words.match(/([\d\u202f]+) voxels/)?.[1].replace(/\u202f/g, '') ?? 0);
};
const notice = (words) => one.page.locator('.notice', { hasText: words }).first();
const picture = async (name) => {
  if (pictures) await one.page.screenshot({ path: path.join(pictures, `growing_${name}.png`) });
};

before(async () => {
  lay_phantom(folder, 2);
  fs.writeFileSync(plan_path, JSON.stringify(plan_of('growing')));
  fs.writeFileSync(other_path, JSON.stringify(plan_of('other')));
  server = await start_server(folder, [plan_path]);
  one = await PlannerWindow.open(server.url);
  await one.click('Continue');
  await one.command('Views and slices');
  await one.at_rest();
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('a click shows what grows from it, in slices and views, and the plan stays as it is', async () => {
  await one.click('Grow a region');
  await one.click_at(axial, [0, 75]);
  await one.until(async () => (await tried_voxels()) > 100, 'a region');
  await one.until(() => newest(axial)?.preview?.voxels > 100 && newest(view)?.preview?.voxels > 100, 'the region in slice and view');
  assert.equal(newest(axial).preview.voxels, newest(view).preview.voxels);
  assert.equal(plan().steps.length, 1);
  await one.at_rest();
  await picture('seed');
});

test('a drag from the seed sets the tolerance, and the region follows', async () => {
  const before = await tried_voxels();
  await one.drag(axial, [0, 75], [60, 75]);
  await one.until(async () => (await tried_voxels()) > before, 'a larger region');
  const larger = Number(await one.page.locator('[data-key="grow-tolerance"]').inputValue());
  assert.ok(larger > 60, `${larger}`);
  assert.equal(plan().steps.length, 1);
  await one.at_rest();
});

test('the region is one step, as large as it was shown, and undone at once', async () => {
  const shown = await tried_voxels();
  await one.click(one.page.locator('[data-key="grow-accept"]'));
  await one.until(() => step('region'), 'the step');
  const { do: word, scan, seeds_mm, tolerance } = step('region');
  assert.deepEqual([word, scan, seeds_mm.length], ['segment', 'ct', 1]);
  assert.ok(tolerance > 60);
  await one.until(() => newest(view)?.objects?.includes('region'), 'the region drawn');
  const words = await one.until(async () => (await one.page.locator('.inspector .reading').innerText().catch(() => '')).match(/^[\d\u202f]+/)?.[0], 'its volume');
  assert.equal(Number(words.replace(/\u202f/g, '')), shown * 8, 'voxels of 2 mm');
  assert.equal(await tried().count(), 0, 'nothing is tried any more');
  await one.press('Control+z');
  await one.until(() => !step('region'), 'undone by one step');
});

test('the running mean is another region, of the same operation', async () => {
  await one.click_at(axial, [0, 75]);
  await one.until(async () => (await tried_voxels()) > 0, 'a region');
  await one.click(one.page.locator('[data-key="grow-mean"]'));
  await one.page.locator('.pane canvas').nth(axial).focus();
  await one.press('Enter');
  await one.until(() => step('region')?.running_mean === true, 'the step by running mean');
  await one.press('Control+z');
  await one.until(() => !step('region'), 'undone');
  await one.click(one.page.locator('[data-key="grow-seed"]'));
});

test('a seed outside of the scan, beside all surfaces, or from which nothing grows is refused in words', async () => {
  await one.page.keyboard.press('Escape');
  if (await one.page.locator('[data-key="grow-accept"]').count() === 0) await one.click('Grow a region');
  await one.at_rest();
  const { bounds } = await one.page.evaluate(() => ({ bounds: [...document.querySelectorAll('.pane canvas')].map((each) => each.getBoundingClientRect().toJSON()) }));
  const box = bounds[axial];
  await one.page.mouse.click(box.x + 30, box.y + box.height - 30);
  await notice('The seed lies outside of the scan').waitFor();
  await one.click_at(view, [-95, -100]);
  await notice('No surface lies there').waitFor();
  assert.equal(await tried().count(), 0);
  await one.type('grow-tolerance', 0);
  await one.click_at(axial, [3, 62]);
  await one.until(async () => (await tried().count()) > 0, 'a seed');
  const alone = await one.until(tried_voxels, 'voxels');
  await one.click(one.page.locator('[data-key="grow-accept"]'));
  if (alone === 1) {
    await notice('Nothing grows from there').waitFor();
    assert.equal(plan().steps.length, 1);
  } else {
    await one.until(() => step('region'), 'more than the seed grew');
    await one.press('Control+z');
    await one.until(() => !step('region'), 'undone');
  }
});

test('keys alone grow a region', async () => {
  await one.page.locator('.pane canvas').nth(axial).focus();
  await one.press('ArrowRight');
  await one.press(' ');
  await one.until(async () => (await tried().count()) > 0, 'a seed by Space');
  const before = Number(await one.page.locator('[data-key="grow-tolerance"]').inputValue());
  await one.press(']');
  await one.until(async () => Number(await one.page.locator('[data-key="grow-tolerance"]').inputValue()) === before + 10, 'a larger tolerance');
  await one.press('Escape');
  await one.until(async () => (await tried().count()) === 0, 'let go');
  assert.equal(await one.page.getByRole('button', { name: /^Grow a region/ }).first().getAttribute('aria-pressed'), 'true');
});

for (const [operation, field, value] of [['offset', 'by_mm', 3], ['shell', 'thickness_mm', 4]])
  test(`${operation}: a slider shows the surface before it is a step`, async () => {
    await one.press('Escape');
    await one.select('skull');
    await one.command(`Add step: ${operation}`);
    await one.until(tried_voxels, 'the surface');
    const first = await tried_voxels();
    const slider = one.page.locator(`[data-key="live-${operation}"]`);
    await slider.fill(String(value));
    await one.until(async () => (await tried_voxels()) && (await tried_voxels()) !== first, 'another surface');
    await one.until(() => newest(view)?.preview && newest(axial)?.preview?.voxels === newest(view).preview.voxels, 'in slice and view');
    await one.at_rest();
    const shown = await tried_voxels();
    await picture(operation);
    assert.equal(plan().steps.length, 1);
    await one.click('Add step');
    await one.until(() => step(operation)?.[field] === value, 'the step');
    await one.until(() => newest(view)?.objects?.includes(operation), 'it is drawn');
    const volume = await one.until(async () => (await one.page.locator('.inspector .reading').innerText().catch(() => '')).match(/^[\d\u202f]+/)?.[0], 'its volume');
    assert.equal(Number(volume.replace(/\u202f/g, '')), shown * 8);
    // A step that is there is changed the same way.
    const handle = one.page.locator(`[data-key="live-${operation}"]`);
    await handle.fill(String(value - 1));
    await one.until(() => step(operation)[field] === value - 1, 'the changed step');
    await one.press('Control+z');
    await one.press('Control+z');
    await one.until(() => !step(operation), 'undone');
  });

test('a length that is refused says so where it is set, and nothing is in the plan', async () => {
  await one.select('skull');
  await one.command('Add step: offset');
  await one.page.locator('[data-key="live-offset"]').fill('0');
  await one.until(async () => /0 moves nothing/.test(await tried().innerText()), 'the refusal');
  assert.equal(plan().steps.length, 1);
  await one.click('Cancel');
  await one.until(async () => (await tried().count()) === 0, 'nothing is tried');
});

test('nothing that is tried, and no tolerance, goes into another plan', async () => {
  await one.click('Grow a region');
  await one.type('grow-tolerance', 33);
  await one.click_at(axial, [0, 75]);
  await one.until(tried_voxels, 'a region');
  await one.click(one.page.locator('.brand'));
  await one.click('Scan or plan');
  await one.click(one.page.locator('.file', { hasText: 'other.plan.json' }));
  await one.until(async () => (await one.page.locator('.plan-name').innerText()) === 'other', 'the other plan');
  const go_on = one.page.getByRole('button', { name: 'Continue' });
  if (await go_on.isVisible()) await one.click(go_on);
  await one.until(() => newest(view)?.objects?.includes('skull'), 'its skull');
  await one.at_rest();
  assert.equal(newest(view).preview, undefined);
  await one.click('Grow a region');
  assert.equal(await one.page.locator('[data-key="grow-tolerance"]').inputValue(), '60');
});

test('no error was on the console', () => assert.deepEqual(one.problems, []));

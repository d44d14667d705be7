// SPDX-License-Identifier: AGPL-3.0-or-later
// The planner in a browser on the UNC head: a Le Fort I drawn by hand, from opening the scan to a certified report, and what
// a person does beside it. OCTOTOMY_SHARED_DATA names the folder of the reference scans.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, program, start_server } from './planner_window.mjs';

const most_actions = 60;
const scan = path.join(process.env.OCTOTOMY_SHARED_DATA ?? '.', 'ct_unc_cthead.nrrd');
const skip = fs.existsSync(scan) ? false : `there is no ${scan}`;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-real-head-'));
const plan_path = path.join(folder, 'head.plan.json');
let server;
let one;
const began = Date.now();
const step = (name) => one.plan(plan_path).steps.find((each) => each.id === name);
const names = () => one.plan(plan_path).steps.map((each) => each.id);
const has = (name) => one.until(() => names().includes(name), `step ${name}`);

// The upper jaw's alveolar process and teeth, in the views' millimetres.
const jaw_from_front = [[-62, 71], [32, 71], [32, 95], [-62, 95]];
const jaw_from_left = [[-112, 71], [-48, 71], [-48, 95], [-112, 95]];

if (skip) console.log(`Skipped: ${skip}`);

before(async () => {
  if (skip) return;
  fs.copyFileSync(scan, path.join(folder, 'head.nrrd'));
  server = await start_server(folder);
  one = await PlannerWindow.open(server.url, { theme: 'light' });
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('the scan is chosen from the opened folder, and its audit is read', { skip }, async () => {
  await one.click('Scan or plan');
  await one.click(one.page.locator('.file', { hasText: 'head.nrrd' }));
  await one.page.locator('.audit li').first().waitFor();
  assert.match(await one.page.locator('.facts').innerText(), /256 × 256 × 113/);
  await one.click('Continue');
  await one.at_rest();
});

test('bone is set, and the picture at rest is what the command line renders, byte for byte', { skip }, async () => {
  await one.click('bone', { exact: true });
  await one.click('Set bone');
  await one.until(() => one.page.evaluate(() => !document.querySelector('.tool-card')), 'the tool put away');
  const frame = await one.until(() => one.frames.filter(({ header }) => header.command).pop(), 'a picture that names its command');
  const out = path.join(folder, 'rest.png');
  const words = frame.header.command.match(/'[^']*'|\S+/g).map((word) => word.replace(/^'|'$/g, '')).slice(1);
  words[words.indexOf('-o') + 1] = out;
  execFileSync(program, words, { cwd: folder, stdio: 'ignore' });
  assert.ok(fs.readFileSync(out).equals(frame.picture), frame.header.command);
});

test('a region in anterior, refined in left, cuts the upper jaw', { skip }, async () => {
  await one.press('r');
  for (const corner of jaw_from_front) await one.click_at(0, corner);
  await one.press('Enter');
  await has('cut');
  for (const corner of jaw_from_left) await one.click_at(1, corner);
  await one.press('Enter');
  await one.until(() => step('cut').regions.length === 2, 'the second region');
  assert.deepEqual(step('cut').regions.map((region) => region.view), ['anterior', 'left']);
  await one.press('x');
  await has('piece');
  await one.shows(1, 'piece');
});

test('the piece is dragged 6 mm forward with its overlap, and turned by typing', { skip }, async () => {
  await one.press('g');
  await one.page.locator('[data-key="move-forward_mm"]').waitFor();
  await one.drag(1, [-80, 83], [-86, 83]);
  await has('piece_moved');
  const { by } = step('piece_moved');
  assert.ok(Math.abs(by.forward_mm - 6) < 0.5, JSON.stringify(by));
  assert.equal(step('overlap').expression, 'rest & piece_moved');
  await one.type('move-pitch_deg', 3);
  await one.until(() => step('piece_moved').turn?.pitch_deg === 3, 'the turn');
  await one.press('Control+z');
  await one.until(() => step('piece_moved').turn === undefined, 'undone');
  await one.press('Control+y');
  await one.until(() => step('piece_moved').turn?.pitch_deg === 3, 'done again');
  await one.click('New branch beside main');
  await one.page.locator('dialog input').fill('more_up');
  await one.press('Enter');
  await one.until(() => one.page.locator('.bar', { hasText: 'more_up' }).count(), 'the branch');
});

test('a distance between two landmarks is the command line\'s', { skip }, async () => {
  await one.press('Escape');
  await one.press('l');
  for (const [name, at] of [['glabella', [-18, 155]], ['menton', [-18, 42]]]) {
    await one.page.locator('[data-key="landmark-name"]').fill(name);
    await one.at_rest();
    await one.click_at(0, at);
    await one.until(() => one.plan(plan_path).steps.some((each) => each.do === 'landmarks' && each.points.some((point) => point.name === name)), name);
  }
  await one.press('Escape');
  await one.press('d');
  const marks = one.plan(plan_path).steps.find((each) => each.do === 'landmarks').points;
  for (const mark of marks) await one.click_at(0, [mark.point_mm[0], mark.point_mm[2]]);
  await has('distance');
  assert.deepEqual(step('distance').points_mm, ['glabella', 'menton']);
  const row = one.page.locator('.numbers tr', { hasText: 'distance' });
  await row.getByText(/mm/).waitFor();
  const shown = Number((await row.locator('td').first().innerText()).match(/[\d.]+/)[0]);
  // The plan's landmarks and the distance alone: the command line needs no bone for them.
  const alone = path.join(folder, 'distance.plan.json');
  const whole = one.plan(plan_path);
  fs.writeFileSync(alone, JSON.stringify({ ...whole, steps: whole.steps.filter((each) => ['landmarks', 'measure'].includes(each.do)) }));
  const told = JSON.parse(execFileSync(program, ['run', alone, '-o', path.join(folder, 'replayed'), '--no-certificates', '--json'], { maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'ignore'] }));
  const found = told.measurements.find((each) => each.id === 'distance' || each.name === 'distance').distance_mm;
  assert.ok(Math.abs(found - shown) <= 0.01, `${found} and ${shown}`);
});

test('every object is certified, and the report is written', { skip }, async () => {
  await one.press('Escape');
  await one.press('Control+Enter');
  await one.until(async () => (await one.page.locator('.numbers .badge:not(.none)').count()) >= 5, 'badges', 300000);
  console.log(`badges: ${(await one.page.locator('.numbers .badge:not(.none)').allInnerTexts()).join(' ')}`);
  assert.equal(await one.page.locator('.numbers .badge.fail').count(), 0);
  await one.click(one.page.locator('.bar').getByRole('button', { name: 'Report' }));
  await one.page.locator('dialog.report iframe').waitFor({ timeout: 300000 });
  await one.press('Escape');
  console.log(`actions: ${one.actions}, ${((Date.now() - began) / 1000).toFixed(0)} s`);
  assert.ok(one.actions <= most_actions, `${one.actions} actions`);
});

test('STL and a deck are exported', { skip }, async () => {
  for (const kind of ['stl', 'inp']) {
    await one.press('Control+e');
    await one.page.locator('select[name="object"]').selectOption('piece_moved');
    await one.click(one.page.locator(`[data-kind="${kind}"]`));
    const download = one.page.waitForEvent('download', { timeout: 300000 });
    await one.click('Write the file', { exact: false });
    const file = await (await download).path();
    assert.ok(fs.statSync(file).size > 10000, kind);
    await one.press('Escape');
  }
});

test('the page is loaded again and everything is there', { skip }, async () => {
  const before_names = names();
  await one.page.reload();
  await one.at_rest();
  await one.tab('Steps');
  const listed = await one.page.locator('.lists .name').allInnerTexts();
  assert.deepEqual(listed.map((name) => name.replace(/ /g, '_')), before_names);
  assert.match(await one.page.locator('.bar').innerText(), /more_up/);
  assert.deepEqual(one.problems, []);
});

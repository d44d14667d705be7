// SPDX-License-Identifier: AGPL-3.0-or-later
// The planner in a browser, as a person uses it: a Le Fort I from opening the scan to a certified report.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { PlannerWindow, lay_phantom, program, start_proxy, start_server } from './planner_window.mjs';

const most_actions = 60;
const most_bundle_bytes = 300 * 1024;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-browser-'));
const plan_path = path.join(folder, 'head_phantom.plan.json');
let server;
let one;
const step = (name) => one.plan(plan_path).steps.find((each) => each.id === name);
const names = () => one.plan(plan_path).steps.map((each) => each.id);
const has = (name) => one.until(() => names().includes(name), `step ${name}`);

before(async () => {
  lay_phantom(folder);
  server = await start_server(folder);
  one = await PlannerWindow.open(server.url);
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('the scan is opened and its audit comes before anything else', async () => {
  await one.click('Head phantom A CT');
  await one.page.getByRole('heading', { name: 'The scan is in order' }).waitFor();
  assert.match(await one.page.locator('.facts').innerText(), /200 × 248 × 252/);
  await one.click('Continue');
  await one.at_rest();
});

test('bone is set', async () => {
  await one.click('cortical bone', { exact: false });
  await one.at_rest();
  await one.click('bone', { exact: true });
  await one.click('Set bone');
  await one.until(() => one.page.evaluate(() => !document.querySelector('.tool-card')), 'the tool put away');
  assert.equal(one.plan(plan_path).steps[0].do, 'window');
});

test('a region is drawn in anterior, and refined in left', async () => {
  await one.press('r');
  for (const corner of [[-40, -60], [40, -60], [40, -25], [-40, -25]]) await one.click_at(0, corner);
  await one.press('Enter');
  await has('cut');
  for (const corner of [[-110, -60], [-20, -60], [-20, -25], [-110, -25]]) await one.click_at(1, corner);
  await one.press('Enter');
  await one.until(() => step('cut').regions.length === 2, 'the second region');
  await one.drag(1, [-110, -60], [-112, -58]);
  await one.until(() => step('cut').regions[1].polygons_mm[0][0][1] > -59, 'the moved corner');
  assert.deepEqual(step('cut').regions.map((region) => region.view), ['anterior', 'left']);
});

test('the cut makes a piece and the rest', async () => {
  await one.press('x');
  await has('piece');
  assert.equal(step('piece').expression, 'bone & cut');
  assert.equal(step('rest').expression, 'bone - cut');
  await one.at_rest();
});

test('the piece is dragged 6 mm forward, and its overlap is read while it moves', async () => {
  await one.press('g');
  const pivot = await one.until(() => one.page.evaluate(() => document.querySelector('[data-key="move-forward_mm"]') !== null), 'the handles');
  assert.ok(pivot);
  await one.shows(1, 'piece');
  // In the left view the patient looks to the left; teeth lie at y -95 to -60, z -55 to -30.
  await one.drag(1, [-75, -45], [-81, -45]);
  await has('piece_moved');
  const by = step('piece_moved').by;
  assert.ok(Math.abs(by.forward_mm - 6) < 0.5, JSON.stringify(by));
  await one.type('move-up_mm', 2);
  await one.type('move-forward_mm', 6);
  await one.until(() => step('piece_moved').by.up_mm === 2 && step('piece_moved').by.forward_mm === 6, 'typed numbers');
  assert.match(await one.page.locator('.inspector .reading').first().innerText(), /6.0 mm forward, 2.0 mm up/);
});

test('it is turned by typing; undo, redo and a branch go through the history', async () => {
  await one.type('move-pitch_deg', 3);
  await one.until(() => step('piece_moved').turn?.pitch_deg === 3, 'the turn');
  await one.click('Undo');
  await one.until(() => step('piece_moved').turn === undefined, 'undone');
  await one.click('Redo');
  await one.until(() => step('piece_moved').turn?.pitch_deg === 3, 'done again');
  await one.click('New branch beside main');
  await one.page.locator('dialog input').fill('more_up');
  await one.press('Enter');
  await one.until(() => one.page.locator('.bar', { hasText: 'more_up' }).count(), 'the branch');
});

test('two landmarks and a distance that the command line finds, too', async () => {
  await one.press('Escape');
  await one.press('l');
  await one.page.locator('[data-key="landmark-name"]').fill('upper');
  // On teeth, above 662 HU; beside them nothing has a depth, and nothing is placed.
  await one.at_rest();
  await one.click_at(0, [0, 30]);
  await one.page.locator('.notice', { hasText: 'no depth' }).waitFor();
  // The second name is typed while the first landmark is on its way.
  await one.page.evaluate(() => addEventListener('pointerup', () => {
    const field = document.querySelector('[data-key="landmark-name"]');
    field.focus();
    field.value = 'lower';
    field.dispatchEvent(new Event('input'));
  }, { once: true }));
  for (const [name, at] of [['upper', [-5, -38]], ['lower', [-18, -67]]]) {
    await one.click_at(0, at);
    await one.until(() => one.plan(plan_path).steps.some((each) => each.do === 'landmarks' && each.points.some((point) => point.name === name)), name);
    await one.page.locator('.lists .words', { hasText: 'landmarks' }).waitFor();
    await one.at_rest();
  }
  await one.press('Escape');
  await one.press('d');
  const marks = one.plan(plan_path).steps.find((each) => each.do === 'landmarks').points;
  for (const mark of marks) await one.click_at(0, [mark.point_mm[0], mark.point_mm[2]]);
  await has('distance');
  assert.deepEqual(step('distance').points_mm, ['upper', 'lower']);
  const row = one.page.locator('.numbers', { hasText: 'Measurements' }).locator('tr', { hasText: 'distance' });
  await row.getByText(/mm/).waitFor();
  const shown = Number((await row.locator('td').first().innerText()).match(/[\d.]+/)[0]);
  const told = JSON.parse(execFileSync(program, ['run', plan_path, '-o', path.join(folder, 'replayed'), '--no-certificates', '--json'], { maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'ignore'] }));
  const found = told.measurements.find((each) => each.id === 'distance' || each.name === 'distance');
  assert.ok(Math.abs(found.distance_mm - shown) <= 0.0101, `${found.distance_mm} and ${shown}`);
});

test('every object is certified', async () => {
  await one.press('Escape');
  await one.press('Control+Enter');
  await one.until(async () => (await one.page.locator('.numbers .badge.pass').count()) >= 3, 'green badges');
  assert.equal(await one.page.locator('.numbers .badge.fail').count(), 0);
});

test('STL and a deck are exported', async () => {
  for (const [kind, least] of [['stl', 10000], ['inp', 10000]]) {
    await one.press('Control+e');
    await one.page.locator('select[name="object"]').selectOption('piece_moved');
    await one.click(one.page.locator(`[data-kind="${kind}"]`));
    const download = one.page.waitForEvent('download');
    await one.click('Write the file', { exact: false });
    const file = await (await download).path();
    assert.ok(fs.statSync(file).size > least, kind);
    await one.press('Escape');
  }
});

test('the report is written', async () => {
  await one.click(one.page.locator('.bar').getByRole('button', { name: 'Report' }));
  const report = one.page.frameLocator('dialog.report iframe');
  await report.getByRole('heading', { name: 'Certificates' }).waitFor();
  assert.ok(await report.locator('svg image').count() >= 8);
  await report.locator('body').press('Escape');
  await one.page.locator('dialog.report').waitFor({ state: 'detached' });
});

test(`a Le Fort I takes at most ${most_actions} actions`, (context) => {
  context.diagnostic(`${one.actions} actions`);
  console.log(`actions: ${one.actions}`);
  assert.ok(one.actions <= most_actions, `${one.actions} actions`);
});

test('the page is loaded again and everything is there', async () => {
  const before_names = names();
  const setting = await one.setting(0);
  await one.page.reload();
  await one.at_rest();
  await one.tab('Steps');
  const listed = await one.page.locator('.lists .name').allInnerTexts();
  assert.deepEqual(listed.map((name) => name.replace(/ /g, '_')), before_names);
  assert.deepEqual(await one.setting(0), setting);
  assert.match(await one.page.locator('.bar').innerText(), /more_up/);
});

test('the picture at rest is what the command line renders, byte for byte', async () => {
  const bare = path.join(folder, 'bare');
  fs.mkdirSync(bare);
  fs.copyFileSync(path.join(folder, 'head_phantom.nrrd'), path.join(bare, 'head_phantom.nrrd'));
  const other = await start_server(bare, ['head_phantom.nrrd']);
  const light = await PlannerWindow.open(other.url, { theme: 'light' });
  try {
    await light.click('Continue');
    await light.press('Escape');
    await light.at_rest();
    const frame = light.frames.filter(({ header }) => header.command).pop();
    assert.ok(frame, 'a picture names its command');
    const out = path.join(bare, 'rest.png');
    const words = frame.header.command.match(/'[^']*'|\S+/g).map((word) => word.replace(/^'|'$/g, '')).slice(1);
    const at = words.findIndex((word) => word === '-o' || word === '--out');
    if (at >= 0) words[at + 1] = out;
    else words.push('-o', out);
    execFileSync(program, words, { cwd: bare, stdio: 'ignore' });
    assert.ok(fs.readFileSync(out).equals(frame.picture), frame.header.command);
  } finally {
    await light.close();
    other.stop();
  }
});

test('the first paint waits for the page, its style and its script alone, and for no connection', async () => {
  const proxy = await start_proxy({ late_ms: 600000 });
  const early = await PlannerWindow.open(server.url, { proxy: proxy.url });
  try {
    await early.page.locator('.offer').first().waitFor();
    await early.until(() => early.first_paint_ms(), 'a paint');
    const fetched = await early.page.evaluate(() => performance.getEntriesByType('resource').map((one) => new URL(one.name).pathname));
    assert.deepEqual(fetched.filter((name) => !['/app.css', '/app.js', '/icon.svg'].includes(name)), []);
    assert.equal(early.answers, 0);
  } finally {
    await early.close();
    proxy.stop();
  }
});

test('no console error, no WebGL context, a small bundle', async (context) => {
  assert.deepEqual(one.problems, []);
  const asked = await one.page.evaluate(() => window.asked_contexts);
  assert.deepEqual(Object.keys(asked), ['2d']);
  let bytes = 0;
  for (const name of ['app.js', 'app.css', 'icon.svg']) bytes += gzipSync(Buffer.from(await (await fetch(new URL(name, server.url))).arrayBuffer())).length;
  context.diagnostic(`bundle ${bytes} bytes gzipped`);
  console.log(`bundle: ${(bytes / 1024).toFixed(1)} KB gzipped`);
  assert.ok(bytes < most_bundle_bytes);
});

test('a server that stands still, as behind a network that stalls or a tab asleep, is waited for', async () => {
  const listed = names();
  server.process.kill('SIGSTOP');
  for (let i = 0; i < 8; ++i) await one.page.keyboard.press('ArrowLeft');
  await one.page.waitForTimeout(3000);
  server.process.kill('SIGCONT');
  await one.at_rest();
  assert.deepEqual(names(), listed);
  assert.equal(await one.page.locator('section.lost').isVisible(), false);
});

test('the server is killed: the page says so, and goes on with everything when it is back', async () => {
  const url = new URL(server.url);
  const listed = await one.page.locator('.lists .name').allInnerTexts();
  // In mid-drag, so that pictures are under way.
  const at = await one.position(0, [0, 0]);
  await one.page.mouse.move(at.x, at.y);
  await one.page.mouse.down();
  await one.page.mouse.move(at.x + 15, at.y);
  server.stop();
  for (let i = 0; i < 5; ++i) await one.page.mouse.move(at.x + 20 + i, at.y);
  await one.page.mouse.up();
  await one.page.locator('section.lost').waitFor({ state: 'visible' });
  const token = path.join(folder, 'token');
  fs.writeFileSync(token, url.searchParams.get('token'), { mode: 0o600 });
  server = await start_server(folder, ['--port', url.port, '--token-file', token, plan_path]);
  await one.page.locator('section.lost').waitFor({ state: 'hidden' });
  await one.until(async () => JSON.stringify(await one.page.locator('.lists .name').allInnerTexts()) === JSON.stringify(listed), 'the same steps');
});

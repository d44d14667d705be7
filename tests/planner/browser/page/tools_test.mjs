// SPDX-License-Identifier: AGPL-3.0-or-later
// On the head phantom: the guided tour to its last step, a step as a command that makes it again, an oblique slice that is
// tilted, a piece moved by marks in two views, the contacts of two objects, a later scan, and networks that are cut or slow.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, program, start_proxy, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-tools-'));
const plan_path = path.join(folder, 'head_phantom.plan.json');
const pictures = process.env.OCTOTOMY_PICTURES;
let server;
let one;
const plan = () => one.plan(plan_path);
const step = (name) => plan().steps.find((each) => each.id === name);
const picture = async (name) => {
  if (pictures) await one.page.screenshot({ path: path.join(pictures, `${name}.png`) });
};
const newest = (pane) => one.frames.filter(({ header }) => header.pane === pane).pop()?.header;

before(async () => {
  lay_phantom(folder);
  server = await start_server(folder);
  one = await PlannerWindow.open(server.url);
});
after(async () => {
  if (pictures && one) await picture('last_tools');
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('the guided tour goes to its last step, and ends with a report', async () => {
  await one.click('Guided tour');
  const card = one.page.locator('.tour-card');
  for (let stop = 1; stop <= 7; ++stop) {
    await card.getByText(`${stop} of 7`).waitFor();
    await one.click(card.getByRole('button', { name: 'Do it for me' }));
  }
  await card.getByRole('button', { name: 'Write the report' }).waitFor({ timeout: 400000 });
  await one.click(card.getByRole('button', { name: 'Write the report' }));
  await one.page.locator('dialog.report iframe').waitFor({ timeout: 400000 });
  await one.press('Escape');
  await one.click(card.getByRole('button', { name: 'End the tour' }));
  await card.waitFor({ state: 'hidden' });
  assert.equal(step('piece_moved').by.forward_mm, 6);
  assert.ok((await one.page.locator('.numbers .badge.pass').count()) >= 3);
});

test('a step as a command makes that step again', async () => {
  await one.tab('Steps');
  const row = one.page.locator('.lists .step', { hasText: 'piece moved' }).first();
  await one.click(row.getByRole('button', { name: 'More for piece_moved' }));
  await one.click(row.getByRole('menuitem', { name: 'Copy as command' }));
  const command = await one.until(async () => (await one.page.evaluate(() => navigator.clipboard.readText())) || null, 'the command');
  assert.match(command, /octotomy run 'piece_moved.step.plan.json'/);
  execFileSync('bash', ['-c', command], { env: { ...process.env, PATH: `${path.dirname(path.resolve(program))}:${process.env.PATH}` }, stdio: 'ignore' });
  const made = JSON.parse(fs.readFileSync(path.join(folder, 'piece_moved result', 'result.json'), 'utf8'));
  const object = made.objects.find((each) => each.id === 'piece_moved');
  assert.deepEqual(made.objects.map((each) => each.id).includes('rest'), false);
  await one.select('piece_moved');
  const shown = await one.page.locator('.inspector .reading b').filter({ hasText: 'mm³' }).first().innerText();
  const volume = object.measures?.volume?.value ?? object.volume?.value ?? object.voxel?.volume_mm3;
  assert.ok(volume > 0, JSON.stringify(object).slice(0, 400));
  assert.ok(Math.abs(Number(shown.split('±')[0].replace(/[^\d.]/g, '')) / volume - 1) < 0.02, `${shown} and ${volume}`);
});

test('steps are put into another order by their menu, and no step before what it uses', async () => {
  const order = () => plan().steps.map((each) => each.id);
  const menu = async (name, what) => {
    await one.click(one.page.getByRole('button', { name: `More for ${name}`, exact: true }));
    await one.click(one.page.locator('.menu:not([hidden])').getByRole('menuitem', { name: what }));
  };
  await one.tab('Steps');
  const before_order = order();
  const uses = (later, earlier) => JSON.stringify(plan().steps.find((each) => each.id === later)).match(/\w+/g).includes(earlier);
  const place = before_order.findIndex((id, i) => i > 0 && !uses(id, before_order[i - 1]));
  await menu(before_order[place], 'Put earlier');
  await one.until(() => order()[place - 1] === before_order[place], 'one place earlier');
  await menu(before_order[place], 'Put later');
  await one.until(() => order().join() === before_order.join(), 'where it was');
  const bound = before_order.findIndex((id, i) => i > 0 && uses(id, before_order[i - 1]));
  await menu(before_order[bound], 'Put earlier');
  await one.page.locator('.notice.error', { hasText: before_order[bound - 1] }).first().waitFor();
  assert.deepEqual(order(), before_order);
  await one.click(one.page.locator('.notice.error').getByRole('button', { name: 'Close' }).first());
});

test('an oblique slice is tilted by a handle in another pane', async () => {
  await one.press('Shift+2');
  await one.page.getByLabel('What pane 4 shows').selectOption('oblique');
  await one.at_rest();
  const before_tilt = (await one.setting(3)).tilt;
  const box = await one.page.locator('.pane canvas').nth(2).boundingBox();
  const { cross_mm } = await one.look();
  const at = await one.position(2, [cross_mm[0], -cross_mm[1]]);
  // The trace of the plane in the axial slice: along the plane's right.
  const turn = (azimuth) => [Math.cos((azimuth * Math.PI) / 180), Math.sin((azimuth * Math.PI) / 180)];
  const reach = 0.36 * Math.min(box.width, box.height);
  const end = (azimuth) => ({ x: at.x + reach * turn(azimuth)[0], y: at.y + reach * turn(azimuth)[1] });
  const [from, to] = [end(before_tilt.azimuth), end(before_tilt.azimuth - 20)];
  await one.page.mouse.move(from.x, from.y);
  await one.page.mouse.down();
  for (let i = 1; i <= 8; ++i) await one.page.mouse.move(from.x + ((to.x - from.x) * i) / 8, from.y + ((to.y - from.y) * i) / 8);
  await one.page.mouse.up();
  await one.at_rest();
  const { tilt } = await one.setting(3);
  assert.ok(Math.abs(tilt.azimuth - (before_tilt.azimuth - 20)) < 1, `${before_tilt.azimuth} -> ${tilt.azimuth}`);
  assert.equal(tilt.elevation, 0);
  const { look } = newest(3).view_frame;
  const wanted = [-turn(tilt.azimuth)[1], turn(tilt.azimuth)[0], 0];
  assert.ok(Math.hypot(...look.map((x, i) => x - wanted[i])) < 0.01, `${look} and ${wanted}`);
  // The plane goes through the cross-hair.
  const { centre_mm } = newest(3).view_frame;
  assert.ok(Math.abs(cross_mm.reduce((sum, x, i) => sum + (x - centre_mm[i]) * look[i], 0)) < 0.01);
  assert.equal(newest(3).step.do, 'slice');
  await picture('oblique');
});

test('a piece is moved by a mark and its target, set in one view and refined in another', async () => {
  await one.press('Shift+1');
  await one.select('piece_moved');
  await one.at_rest();
  await one.press('j');
  await one.page.locator('.tool-card', { hasText: 'Move by marks' }).waitFor();
  await one.until(async () => newest(1)?.step === undefined, 'the piece in its own place');
  await one.at_rest();
  await one.click_at(1, [-75, -45]);
  await one.click_at(1, [-80, -44]);
  await one.page.locator('.tool-card li', { hasText: 'Mark 1' }).waitFor();
  const { cross_mm } = await one.look();
  await one.at_rest();
  await one.drag(0, [cross_mm[0], -44], [cross_mm[0] + 3, -44]);
  await one.at_rest();
  await picture('marks');
  await one.page.locator('.pane canvas').nth(0).focus();
  await one.press('Enter');
  await one.until(() => step('piece_moved').points, 'the marks in the plan');
  const moved = step('piece_moved');
  assert.equal(moved.by, undefined);
  const [{ at, to }] = moved.points;
  for (const [axis, mm] of [3, -5, 1].entries()) assert.ok(Math.abs(to[axis] - at[axis] - mm) < 0.8, `${at} to ${to}`);
  await one.until(() => one.page.locator('.lists .words', { hasText: 'by one mark' }).count(), 'said in words');
});

test('two objects are coloured by their distance to each other', async () => {
  await one.select('piece_moved');
  await one.at_rest();
  await one.press('t');
  await one.until(() => newest(2)?.legend && newest(2).objects.length === 1 && newest(3)?.objects.length === 1, 'each jaw alone');
  await one.at_rest();
  assert.equal(newest(0).legend.high_mm, 2);
  assert.match(newest(0).legend.definition, /and the reverse/);
  assert.notDeepEqual(newest(2).objects, newest(3).objects);
  await picture('contacts');
  await one.click('Measure the gap');
  await one.until(() => plan().steps.some((each) => each.do === 'measure' && each.to), 'the gap as a step');
  await one.press('t');
  await one.at_rest();
  assert.equal(newest(0).legend, undefined);
  assert.ok(newest(2).objects.length > 1);
});

test('the plan is held against a later scan, here one on which nothing was done', async () => {
  await one.command('Outcome of the operation');
  await one.click(one.page.locator('.file', { hasText: 'head_phantom.nrrd' }));
  await one.page.locator('.outcome-table').waitFor({ timeout: 300000 });
  const row = await one.page.locator('.outcome-table tr', { hasText: 'forward' }).first().innerText();
  const [planned, achieved, half_width] = row.slice(row.indexOf('forward')).replace(/−/g, '-').match(/-?\d+\.\d+/g).map(Number);
  assert.ok(Math.abs(planned - 5) < 0.8, row);
  assert.ok(Math.abs(achieved) < 0.3 && half_width < 0.5, row);
  assert.ok(await one.page.locator('.outcome-table tr.missed').count());
  await picture('outcome');
  await one.press('Escape');
});

test('Ctrl K opens the palette at any instant, and a dialog keeps its keys to itself', async () => {
  const field = one.page.locator('.palette-field');
  const opens = async (when) => {
    await one.page.keyboard.press('Control+k');
    await field.waitFor().catch(() => assert.fail(`no palette ${when}`));
    await one.page.keyboard.press('Escape');
    await field.waitFor({ state: 'detached' });
  };
  await one.press('Shift+1');
  await one.at_rest();
  const rounds = 8;
  for (let round = 0; round < rounds; ++round) {
    const box = await one.page.locator('.pane canvas').nth(3).boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await one.page.mouse.move(x, y);
    await one.page.mouse.down();
    await one.page.mouse.move(x + 10 + 5 * round, y, { steps: 3 });
    await one.page.waitForTimeout((37 * round) % 200);
    await opens(`in mid-drag, round ${round}`);
    await one.page.mouse.up();
    // The drag has ended: a pointer without a button turns nothing.
    const { view } = await one.setting(3);
    await one.page.mouse.move(x - 40, y, { steps: 3 });
    await one.page.waitForTimeout(60);
    assert.deepEqual((await one.setting(3)).view, view);
    for (const key of ['Control+z', 'Control+y']) {
      await one.page.keyboard.press(key);
      await one.page.waitForTimeout((61 * round) % 150);
      await opens(`after ${key}, round ${round}`);
    }
  }
  await one.press('Control+e');
  await one.page.locator('dialog.export').waitFor();
  await one.page.keyboard.press('Control+k');
  assert.equal(await field.count(), 0);
  await one.press('Escape');
  await opens('after a dialog');
});

test('what is pressed stays, though the plan changes meanwhile', async () => {
  const tab = one.page.getByRole('tab', { name: 'Movement' });
  await one.page.mouse.move(...(await one.middle(tab)));
  await one.page.mouse.down();
  await one.page.keyboard.press('Control+z');
  await one.at_rest();
  await one.page.mouse.up();
  await one.until(async () => (await tab.getAttribute('aria-selected')) === 'true', 'the pressed tab');
  await one.press('Control+y');
  // A slider is drawn through many pictures.
  await one.tab('Objects');
  const slider = one.page.getByLabel('Opacity of rest');
  const box = await one.until(() => slider.boundingBox(), 'the slider');
  await one.page.mouse.move(box.x + box.width - 6, box.y + box.height / 2);
  await one.page.mouse.down();
  for (let i = 1; i <= 8; ++i) {
    await one.page.mouse.move(box.x + box.width - 6 - ((box.width - 12) * i) / 16, box.y + box.height / 2);
    await one.page.waitForTimeout(30);
  }
  await one.page.mouse.up();
  const opacity = await one.until(async () => (await one.look()).looks.rest?.opacity, 'the opacity');
  assert.ok(Math.abs(opacity - 0.5) < 0.1, `${opacity}`);
  await one.tab('Steps');
  // A menu stays open.
  const row = one.page.locator('.lists .step', { hasText: 'piece moved' }).first();
  await one.click(row.getByRole('button', { name: 'More for piece_moved' }));
  for (const key of ['Control+z', 'Control+y']) {
    const saved = JSON.stringify(plan());
    await one.press(key);
    await one.until(() => JSON.stringify(plan()) !== saved, key);
    assert.ok(await row.getByRole('menuitem', { name: 'Copy as command' }).isVisible(), `no menu after ${key}`);
  }
  await one.tab('Inspector');
  await one.at_rest();
});

test('a network that is cut in mid-drag is noticed, and nothing is lost', async () => {
  const proxy = await start_proxy();
  const far = await PlannerWindow.open(server.url, { proxy: proxy.url, size: { width: 1200, height: 900 } });
  try {
    await far.at_rest();
    // Back to a motion that is dragged.
    await far.select('piece_moved');
    while (step('piece_moved').points) {
      const before_undo = JSON.stringify(plan());
      await far.press('Control+z');
      await far.until(() => JSON.stringify(plan()) !== before_undo, 'one step undone');
    }
    await far.at_rest();
    await far.press('g');
    await far.page.locator('[data-key="move-forward_mm"]').waitFor();
    const { forward_mm } = step('piece_moved').by;
    const [from, to] = [await far.position(1, [-80, -45]), await far.position(1, [-84, -45])];
    await far.page.mouse.move(from.x, from.y);
    await far.page.mouse.down();
    await far.page.mouse.move((from.x + to.x) / 2, from.y, { steps: 4 });
    proxy.cut();
    await far.page.mouse.move(to.x, to.y, { steps: 4 });
    await far.page.mouse.up();
    await far.page.locator('section.lost').waitFor({ state: 'visible' });
    assert.equal(step('piece_moved').by.forward_mm, forward_mm);
    proxy.mend();
    await far.page.locator('section.lost').waitFor({ state: 'hidden' });
    await far.until(() => Math.abs(step('piece_moved').by.forward_mm - forward_mm - 4) < 0.5, 'the motion of the drag');
    await far.at_rest();
    proxy.cut();
    await far.press('Control+z');
    await far.page.locator('section.lost').waitFor({ state: 'visible' });
    proxy.mend();
    await far.until(() => step('piece_moved').by.forward_mm === forward_mm, 'the drag undone, once');
    await far.at_rest();
    assert.equal(step('piece_moved').by.forward_mm, forward_mm);
    assert.deepEqual(far.problems.filter((problem) => !/WebSocket|ERR_/.test(problem)), []);
  } finally {
    await far.close();
    proxy.stop();
  }
});

for (const names of [['Head phantom A CT'], ['Scan or plan', 'head_phantom.nrrd']])
  test(`${names[0]}, asked for before the page has its connection, comes once it has`, async () => {
    const bare = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-late-'));
    lay_phantom(bare);
    const late = await start_server(bare), proxy = await start_proxy({ late_ms: 3000 });
    const early = await PlannerWindow.open(late.url, { proxy: proxy.url });
    try {
      for (const name of names) await early.click(name);
      await early.page.getByRole('heading', { name: 'The scan is in order' }).waitFor();
      assert.deepEqual(early.problems, []);
    } finally {
      await early.close();
      proxy.stop();
      late.stop();
      fs.rmSync(bare, { recursive: true, force: true });
    }
  });

test('no console error, no WebGL context', async () => {
  assert.deepEqual(one.problems, []);
  assert.deepEqual(Object.keys(await one.page.evaluate(() => window.asked_contexts)), ['2d']);
});

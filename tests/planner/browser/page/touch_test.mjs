// SPDX-License-Identifier: AGPL-3.0-or-later
// Fingers and a pen in the panes of the head phantom, and a tab that sleeps while another window works on.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-touch-'));
const plan_path = path.join(folder, 'head_phantom.plan.json');
let server;
let one;
let devtools;
const step = (name) => one.plan(plan_path).steps.find((each) => each.id === name);

before(async () => {
  lay_phantom(folder, 2);
  server = await start_server(folder);
  one = await PlannerWindow.open(server.url);
  devtools = await one.context.newCDPSession(one.page);
  await devtools.send('Emulation.setTouchEmulationEnabled', { enabled: true, maxTouchPoints: 5 });
  await one.click('Head phantom A CT');
  await one.page.getByRole('heading', { name: 'The scan is in order' }).waitFor();
  await one.click('Continue');
  await one.at_rest();
  await one.click('bone', { exact: true });
  await one.click('Set bone');
  await one.until(() => fs.existsSync(plan_path) && one.plan(plan_path).steps.length === 1, 'bone');
  await one.at_rest();
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

const middle_of = async (pane) => {
  const box = await one.page.locator('.pane canvas').nth(pane).boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
};
const touch = (type, points) => devtools.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });

/// Fingers go from `from` to `to` in ten steps, and are lifted.
async function fingers(from, to) {
  for (let count = 1; count <= from.length; ++count) await touch('touchStart', from.slice(0, count));
  for (let i = 1; i <= 10; ++i) await touch('touchMove', from.map(([x, y], finger) => [x + ((to[finger][0] - x) * i) / 10, y + ((to[finger][1] - y) * i) / 10]));
  await touch('touchEnd', []);
  await one.at_rest();
}

test('one finger turns a view', async () => {
  const [x, y] = await middle_of(3);
  const before_turn = (await one.look()).panes[3].view;
  await fingers([[x, y]], [[x + 60, y]]);
  const turned = (await one.setting(3)).view;
  assert.notDeepEqual(turned, before_turn);
});

test('two fingers zoom by their spread about their middle, and pan by it', async () => {
  const [x, y] = await middle_of(0);
  const before_pinch = await one.setting(0);
  await fingers([[x - 40, y], [x + 40, y]], [[x - 80, y], [x + 80, y]]);
  const zoomed = await one.setting(0);
  assert.ok(Math.abs(zoomed.pixel_mm / before_pinch.pixel_mm - 0.5) < 0.01, `${before_pinch.pixel_mm} to ${zoomed.pixel_mm}`);
  const shift = (from, to) => Math.hypot(...to.centre_mm.map((value, axis) => value - from.centre_mm[axis])) / to.pixel_mm;
  assert.ok(shift(before_pinch, zoomed) < 3, `the middle moved by ${shift(before_pinch, zoomed)} pixels`);
  await fingers([[x - 40, y], [x + 40, y]], [[x - 10, y], [x + 70, y]]);
  const panned = await one.setting(0);
  assert.ok(Math.abs(panned.pixel_mm / zoomed.pixel_mm - 1) < 0.01);
  assert.ok(Math.abs(shift(zoomed, panned) - 30) < 3, `${shift(zoomed, panned)} pixels`);
  assert.deepEqual(panned.view, before_pinch.view);
  await one.command('Fit');
});

test('fingers draw the corners of a region, and a pinch between them adds none', async () => {
  await one.press('r');
  await one.at_rest();
  const corners = [[-40, -60], [40, -60], [40, -25], [-40, -25]];
  for (const [number, corner] of corners.entries()) {
    const { x, y } = await one.position(0, corner);
    await touch('touchStart', [[x, y]]);
    await touch('touchEnd', []);
    if (number === 1) await fingers([[x - 40, y], [x + 40, y]], [[x - 42, y], [x + 42, y]]);
  }
  await one.press('Enter');
  const cut = await one.until(() => step('cut'), 'the mask');
  assert.equal(cut.regions[0].polygons_mm[0].length, corners.length);
});

test('a pen drags a corner', async () => {
  await one.at_rest();
  const [corner] = step('cut').regions[0].polygons_mm[0];
  const [from, to] = [await one.position(0, corner), await one.position(0, [corner[0] - 6, corner[1]])];
  const pen = (type, { x, y }, buttons) => devtools.send('Input.dispatchMouseEvent', { type, x, y, buttons, button: 'left', clickCount: 1, pointerType: 'pen', force: buttons ? 0.5 : 0 });
  await pen('mousePressed', from, 1);
  for (let i = 1; i <= 8; ++i) await pen('mouseMoved', { x: from.x + ((to.x - from.x) * i) / 8, y: from.y }, 1);
  await pen('mouseReleased', to, 0);
  await one.until(() => Math.abs(step('cut').regions[0].polygons_mm[0][0][0] - corner[0] + 6) < 0.6, 'the dragged corner');
});

test('a tab that slept shows what another window did meanwhile', async () => {
  const far = await PlannerWindow.open(server.url, { size: { width: 1024, height: 768 } });
  try {
    await far.at_rest();
    await devtools.send('Page.setWebLifecycleState', { state: 'frozen' });
    await far.press('Control+z');
    await far.press('Control+z');
    await far.until(() => !step('cut'), 'undone');
    // Longer than the silence after which a line is taken for cut.
    await far.page.waitForTimeout(10000);
    await devtools.send('Page.setWebLifecycleState', { state: 'active' });
    await one.until(async () => (await one.page.locator('.lists .name', { hasText: /^cut$/ }).count()) === 0, 'the plan as it is now');
    await one.page.locator('section.lost').waitFor({ state: 'hidden' });
    await one.press('Control+y');
    await one.until(() => step('cut'), 'redone by the tab that slept');
    assert.deepEqual(far.problems, []);
  } finally {
    await far.close();
  }
  assert.deepEqual(one.problems, []);
});

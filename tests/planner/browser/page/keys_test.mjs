// SPDX-License-Identifier: AGPL-3.0-or-later
// An operation from the start page to its report by keys alone: what has the focus is seen, and the mouse is never moved.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, start_server } from './planner_window.mjs';

const most_tabs = 120;
const pictures = process.env.OCTOTOMY_PICTURES;
const coarse_px = 12; // of an arrow key; with Shift 1
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-keys-'));
let server;
let one;
const plan_path = () => fs.readdirSync(folder).filter((name) => name.endsWith('.plan.json')).map((name) => path.join(folder, name))[0];
const step = (name) => plan_path() && one.plan(plan_path()).steps.find((each) => each.id === name);

before(async () => {
  server = await start_server(folder);
  one = await PlannerWindow.open(server.url);
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

/// Goes from one control to the next until one has the focus, and holds that it is seen.
async function reach(control) {
  await control.first().waitFor();
  let seen;
  for (let i = 0; i < most_tabs && !seen?.has_focus; ++i) {
    if (seen) await one.press('Tab');
    seen = await control.first().evaluate((element) => {
      const style = element.matches('.pane canvas') ? getComputedStyle(element.closest('.pane'), '::after') : null;
      const width = style ? style.borderTopWidth : getComputedStyle(element).outlineStyle !== 'none' ? getComputedStyle(element).outlineWidth : '0';
      return { has_focus: element === document.activeElement, width: parseFloat(width), words: element.outerHTML.slice(0, 120) };
    });
  }
  assert.ok(seen.has_focus, `not reached within ${most_tabs} keys: ${seen.words}`);
  assert.ok(seen.width >= 2, `focus is not seen on ${seen.words}`);
}
const button = (name, exact = false) => one.page.getByRole('button', { name, exact });
async function push(control) {
  await reach(control);
  await one.press('Enter');
}

/// Where the arrows have carried the place of a pane; it begins in the middle.
let carried;
/// Carries it to a point of the view, and takes it.
async function take(pane, uv) {
  const to = await one.position(pane, uv);
  for (const [axis, keys] of [['x', ['ArrowLeft', 'ArrowRight']], ['y', ['ArrowUp', 'ArrowDown']]]) {
    const by = Math.round(to[axis] - carried[axis]);
    const key = keys[by > 0 ? 1 : 0];
    for (let i = 0; i < Math.floor(Math.abs(by) / coarse_px); ++i) await one.press(key);
    for (let i = 0; i < Math.abs(by) % coarse_px; ++i) await one.press(`Shift+${key}`);
    carried[axis] += by;
  }
  await one.press(' ');
}
async function enter(pane) {
  await reach(one.page.locator('.pane canvas').nth(pane));
  const box = await one.page.locator('.pane canvas').nth(pane).boundingBox();
  carried ??= { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}

test('the phantom is opened, and bone is set', async () => {
  await push(button(/^Head phantom/));
  await one.page.getByRole('heading', { name: 'The scan is in order' }).waitFor();
  await push(button('Continue'));
  await one.at_rest();
  await push(button('bone', true));
  await push(button('Set bone'));
  await one.until(() => step('bone'), 'bone');
  await one.at_rest();
});

test('a region is drawn where the arrows carry its corners', async () => {
  await one.press('Control+k');
  await one.page.keyboard.type('draw a region');
  await one.press('Enter');
  await enter(0);
  const corners = [[-40, -60], [40, -60], [40, -25], [-40, -25]];
  for (const corner of corners) await take(0, corner);
  await one.press('Enter');
  const cut = await one.until(() => step('cut'), 'the mask');
  const [drawn] = cut.regions[0].polygons_mm;
  assert.equal(drawn.length, corners.length);
  // A place stands on whole pixels.
  const pixel_mm = (await one.setting(0)).pixel_mm;
  for (const [i, corner] of corners.entries()) for (const axis of [0, 1]) assert.ok(Math.abs(drawn[i][axis] - corner[axis]) <= pixel_mm, `${drawn[i]} for ${corner}`);
});

test('it is cut, moved by a typed number, undone and done again', async () => {
  await one.page.locator('.lists .name', { hasText: /^cut$/ }).waitFor();
  await one.press('x');
  await one.until(() => step('piece'), 'the piece');
  await one.at_rest();
  await one.press('g');
  await reach(one.page.locator('[data-key="move-forward_mm"]'));
  await one.press('Control+a');
  await one.page.keyboard.type('6');
  await one.press('Enter');
  await one.until(() => step('piece_moved')?.by.forward_mm === 6, 'the motion');
  // The focus stays where it is, though the list around it is filled anew.
  const tab = one.page.getByRole('tab', { name: 'Objects' });
  await reach(tab);
  await one.press('Control+z');
  await one.until(() => !step('piece_moved'), 'undone');
  await one.press('Control+y');
  await one.until(() => step('piece_moved')?.by.forward_mm === 6, 'done again');
  await one.at_rest();
  assert.ok(await tab.evaluate((element) => element === document.activeElement), 'the focus is lost');
});

test('certificates are asked for, one is opened, and the report is read', async () => {
  await one.press('Control+Enter');
  await one.until(async () => (await one.page.locator('.numbers .badge.pass').count()) >= 3, 'green badges');
  await push(one.page.locator('.numbers .badge.pass'));
  await one.press('Control+k');
  await one.page.locator('.palette-field').waitFor();
  await one.page.keyboard.type('report');
  await one.press('Enter');
  await one.page.locator('dialog.report iframe').waitFor();
  await one.press('Escape');
  await one.page.locator('dialog.report').waitFor({ state: 'detached' });
});

test('landmarks are guessed: one is kept, one is put elsewhere, one is passed over', async () => {
  const placed = () => one.plan(plan_path()).steps.filter((each) => each.do === 'landmarks').flatMap((each) => each.points);
  const asked = async () => (await one.page.locator('.tool-card').innerText()).match(/(\d+) to look at: ([\w ]+), within/);
  await one.press('Control+k');
  await one.page.keyboard.type('first guess');
  await one.press('Enter');
  const keep = one.page.locator('[data-key="keep-guess"]');
  await keep.waitFor();
  const [, count, first] = await asked();
  assert.ok(Number(count) >= 15, count);
  assert.deepEqual(placed(), [], 'a guess alone places nothing');
  if (pictures) await one.at_rest().then(() => one.page.screenshot({ path: path.join(pictures, 'guesses.png') }));
  await push(keep);
  await one.until(() => placed().length === 1, 'the kept guess');
  assert.equal(placed()[0].name, first.replace(/ /g, '_'));
  const [, , second] = await one.until(async () => { const found = await asked(); return found?.[2] === first ? null : found; }, 'the next guess');
  // The panes show it close up, about the cross-hair; the whole head comes back by a key.
  const { panes, cross_mm } = await one.look();
  for (const pane of panes) assert.ok(pane.pixel_mm <= 0.35 && pane.centre_mm.join() === cross_mm.join(), JSON.stringify(pane));
  await one.press('0');
  await one.until(async () => (await one.setting(0)).pixel_mm > 0.35, 'the whole head');
  // The next is clicked where the arrows carry it.
  await enter(0);
  await take(0, [0, 40]);
  await one.until(() => placed().length === 2, 'the corrected guess');
  assert.equal(placed()[1].name, second.replace(/ /g, '_'));
  assert.ok(Math.abs(placed()[1].point_mm[2] - 40) < 3, `${placed()[1].point_mm}`);
  await one.until(async () => (await asked())?.[1] === String(count - 2), 'two fewer');
  await push(one.page.locator('[data-key="pass-guess"]'));
  await one.until(async () => (await asked())?.[1] === String(count - 3), 'three fewer');
  assert.equal(placed().length, 2);
  assert.deepEqual(one.problems, []);
});

// SPDX-License-Identifier: AGPL-3.0-or-later
// On the head phantom with a board behind it, a loose ball beside it and a metal bar in it: a window's object proposes what
// cleans it, each proposal is drawn before it is made, and parts are taken by clicks.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import zlib from 'node:zlib';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-cleaning-'));
const plan_path = path.join(folder, 'head_phantom.plan.json');
const pictures = process.env.OCTOTOMY_PICTURES;
const theme = process.env.OCTOTOMY_THEME ?? 'dark';
const ball_mm = [-80, -60, 60];
let server;
let one;
const plan = () => one.plan(plan_path);
const step = (name) => plan().steps.find((each) => each.id === name);
const picture = async (name) => {
  if (pictures) await one.page.screenshot({ path: path.join(pictures, `${name}_${theme}.png`) });
};
const newest = (pane) => one.frames.filter(({ header }) => header.pane === pane).pop();
const group = (name) => one.page.getByRole('group', { name, exact: true });

/// Puts a board, a ball and a bar with a dark streak into the phantom's samples, which are 2 mm apart.
function add_dirt(scan) {
  const file = fs.readFileSync(scan);
  const end = file.indexOf('\n\n') + 2;
  const header = file.subarray(0, end).toString();
  const [nx, ny, nz] = header.match(/sizes: (\d+) (\d+) (\d+)/).slice(1).map(Number);
  const origin = header.match(/space origin: \((.*)\)/)[1].split(',').map(Number);
  const bytes = zlib.gunzipSync(file.subarray(end));
  const samples = new Int16Array(bytes.buffer, bytes.byteOffset, nx * ny * nz);
  for (let k = 0; k < nz; ++k)
    for (let j = 0; j < ny; ++j)
      for (let i = 0; i < nx; ++i) {
        const p = [origin[0] + 2 * i, origin[1] + 2 * j, origin[2] + 2 * k];
        const at = i + nx * (j + ny * k);
        if (j >= ny - 5 && j < ny - 2 && i > 8 && i < nx - 8) samples[at] = 500;
        if (Math.hypot(...p.map((x, axis) => x - ball_mm[axis])) < 7) samples[at] = 700;
        if (Math.abs(p[0]) < 20 && Math.abs(p[1] + 60) < 3 && Math.abs(p[2] + 40) < 3) samples[at] = p[0] < 0 ? 3071 : -1024;
      }
  fs.writeFileSync(scan, Buffer.concat([file.subarray(0, end), zlib.gzipSync(bytes)]));
}

before(async () => {
  lay_phantom(folder, 2);
  add_dirt(path.join(folder, 'head_phantom.nrrd'));
  server = await start_server(folder);
  one = await PlannerWindow.open(server.url, { theme });
  await one.click('Scan or plan');
  await one.click(one.page.locator('.file', { hasText: 'head_phantom.nrrd' }));
  await one.click('Continue');
  await one.at_rest();
});
after(async () => {
  if (pictures && one) await picture('last_cleaning');
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('a window that becomes a step proposes what cleans it, and nothing is done by itself', async () => {
  await one.type('low', 300);
  await one.click(one.page.locator('[data-key="apply-window"]'));
  await group('Keep the largest part').waitFor();
  await group('Remove the headrest').waitFor();
  await group('Clamp metal streaks').waitFor();
  await one.page.getByText('Nothing is done before you choose one').waitFor();
  const words = await group('Keep the largest part').innerText();
  assert.match(words, /The other .* ha(s|ve) \d[\d.,\s]* cm³/);
  assert.match(await group('Remove the headrest').innerText(), /loses [\d.]+ cm³/);
  assert.match(await group('Clamp metal streaks').innerText(), /Near them, [1-9]\d* samples below −1000 HU/);
  assert.deepEqual(plan().steps.map((each) => each.do), ['window']);
  await picture('proposals');
});

test('a proposal is drawn before it is made, and what is drawn ends with its panel', async () => {
  await one.at_rest();
  const as_it_is = newest(0).picture;
  const largest = group('Keep the largest part');
  await one.click(largest.getByRole('button', { name: 'After' }));
  await one.until(() => !newest(0).picture.equals(as_it_is), 'the picture after');
  await one.at_rest();
  await picture('after_largest');
  assert.equal(newest(0).header.step, undefined);
  await one.click(largest.getByRole('button', { name: 'Before' }));
  await one.until(() => newest(0).picture.equals(as_it_is), 'the picture before');
  const headrest = group('Remove the headrest');
  await one.click(headrest.getByRole('button', { name: 'After' }));
  await one.until(() => !newest(0).picture.equals(as_it_is), 'the picture without the board');
  await one.at_rest();
  await picture('after_headrest');
  await one.tab('Numbers');
  await one.until(() => newest(0).picture.equals(as_it_is), 'the object as it is');
  await one.tab('Inspector');
  assert.equal(await headrest.getByRole('button', { name: 'Before' }).getAttribute('aria-pressed'), 'true');
  assert.deepEqual(plan().steps.map((each) => each.do), ['window']);
});

test('one click makes a proposal an ordinary step, which undo takes back', async () => {
  await one.click(group('Clamp metal streaks').getByRole('button', { name: 'Dismiss' }));
  await group('Clamp metal streaks').waitFor({ state: 'detached' });
  await one.click(group('Remove the headrest').locator('[data-key="headrest-do"]'));
  await one.until(() => plan().steps.length === 2, 'the headrest as a step');
  assert.deepEqual(plan().steps.map((each) => each.do), ['remove_headrest', 'window']);
  assert.equal(plan().steps[1].scan, plan().steps[0].id);
  await group('Keep the largest part').waitFor();
  await one.page.getByText('Nothing is done before you choose one').waitFor();
  assert.equal(await group('Remove the headrest').count(), 0);
  assert.equal(await group('Clamp metal streaks').count(), 0, 'dismissed');
  await one.click(group('Keep the largest part').locator('[data-key="largest-do"]'));
  await one.until(() => plan().steps.length === 3, 'the largest part as a step');
  assert.deepEqual(plan().steps[2], { id: 'bone_largest', do: 'parts', object: 'bone', largest: 1 });
  await one.press('Control+z');
  await one.press('Control+z');
  await one.until(() => plan().steps.length === 1, 'both undone');
  assert.equal(plan().steps[0].scan, 'ct');
});

test('a click on an island removes it, or keeps it alone', async () => {
  await one.select('bone');
  await one.at_rest();
  await one.click('Islands');
  await one.at_rest();
  await one.click_at(0, [ball_mm[0], ball_mm[2]]);
  await one.until(() => step('bone_rest'), 'the rest as a step');
  assert.equal(step('bone_rest').expression, 'bone - bone_islands');
  const [at] = step('bone_islands').at_mm;
  assert.ok(Math.hypot(...at.map((x, axis) => x - ball_mm[axis])) < 8, `${at}`);
  const said = await one.page.locator('.notice', { hasText: 'Removed a part' }).innerText();
  const mm3 = Number(said.match(/of ([\d.\s\u202f]+) mm³/)[1].replace(/[^\d.]/g, ''));
  assert.ok(Math.abs(mm3 / ((4 / 3) * Math.PI * 7 ** 3) - 1) < 0.25, said);
  await one.at_rest();
  await picture('island_removed');
  await one.press('Control+z');
  await one.until(() => !step('bone_rest'), 'the island back');
  await one.select('bone');
  await one.click(one.page.locator('[data-key="islands-Keep"]'));
  await one.at_rest();
  await one.click_at(0, [ball_mm[0], ball_mm[2]]);
  await one.until(() => step('bone_kept'), 'the island as a step');
  assert.equal(step('bone_kept').at_mm.length, 1);
});

test('no console error, and nothing of the proposals survives another plan', async () => {
  await one.press('Escape');
  await one.select('bone');
  await one.click(one.page.locator('[data-key="clean"]'));
  await group('Remove the headrest').waitFor();
  await one.click(group('Remove the headrest').getByRole('button', { name: 'After' }));
  await one.command('Open');
  await one.click(one.page.locator('.file', { hasText: 'head_phantom.nrrd' }));
  await one.page.locator('.page-audit, .audit, .start-host').first().waitFor({ state: 'attached' });
  await one.until(async () => (await group('Remove the headrest').count()) === 0, 'no proposal');
  assert.deepEqual(one.problems, []);
});

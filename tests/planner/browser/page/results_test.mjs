// SPDX-License-Identifier: AGPL-3.0-or-later
// The result of each measuring step in the page: its number, its table and its plot, and no JSON. On the head phantom.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-results-'));
const plan_path = path.join(folder, 'results.plan.json');
const pictures = process.env.OCTOTOMY_PICTURES;
const region = (view, [x, y, to_x, to_y]) => ({ view, polygons_mm: [[[x, y], [to_x, y], [to_x, to_y], [x, to_y]]] });
const steps = [
  { id: 'bone', do: 'window', scan: 'ct', low: 300 },
  { id: 'cut', do: 'mask', regions: [region('anterior', [-40, -60, 40, -25]), region('left', [-90, -60, -20, -25])] },
  { id: 'piece', do: 'combine', expression: 'bone & cut' }, { id: 'rest', do: 'combine', expression: 'bone - cut' },
  { id: 'moved', do: 'move', object: 'piece', by: { forward_mm: 4 } },
  { id: 'column', do: 'mask', regions: [region('anterior', [-8, -40, 8, 40]), region('left', [-8, -40, 8, 40])] },
  { id: 'tube', do: 'combine', expression: 'column' },
  { id: 'wide', do: 'measure', points_mm: [[-12, 0, 0], [12, 0, 0]] },
  { id: 'size', do: 'measure', object: 'piece' },
  { id: 'narrow', do: 'airway', object: 'tube', begin: [0, 0, -35], end: [0, 0, 35], step_mm: 4 },
  { id: 'bite', do: 'contacts', object: 'moved', against: 'rest', within_mm: 3 },
  { id: 'differ', do: 'compare', a: 'piece', b: 'moved' },
  { id: 'doubt', do: 'trials', trials: 100 },
  { id: 'guess', do: 'find_landmarks', object: 'bone' },
];
let server;
let one;
const newest = (pane) => one.frames.filter(({ header }) => header.pane === pane).pop()?.header;
const result = () => one.page.locator('.inspector .result');
async function shown(name) {
  await one.tab('Inspector');
  await one.select(name);
  await one.page.locator('.inspector h3', { hasText: name }).first().waitFor();
  await result().waitFor();
  if (pictures) await one.page.screenshot({ path: path.join(pictures, `result_${name}.png`) });
  return result().innerText();
}
const plots = () => result().locator('svg.plot').count();

before(async () => {
  lay_phantom(folder, 2);
  fs.writeFileSync(plan_path, JSON.stringify({
    octotomy_plan: 1, name: 'results', scans: { ct: { path: 'head_phantom.nrrd' } }, universe: { voxel_mm: 2 }, steps,
  }));
  server = await start_server(folder, [plan_path]);
  one = await PlannerWindow.open(server.url);
  if (await one.page.getByRole('button', { name: 'Continue' }).isVisible()) await one.click('Continue');
  await one.until(() => newest(0)?.objects?.length, 'the first picture');
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('an airway has its number, both volumes and a plot, before any certificate', async () => {
  const words = await shown('narrow');
  assert.match(words, /narrowest section, mm²/);
  assert.equal(await plots(), 1);
  assert.match(await one.page.locator('.inspector .reading').first().innerText(), /mm² Narrowest section of tube/);
  await one.click(one.page.locator('[data-key="result-place"]'));
  await one.page.locator('.status', { hasText: 'narrowest section of tube' }).waitFor();
});

test('contacts have a table of their places, and the panes colour both objects', async () => {
  assert.match(await shown('bite'), /places? of moved within 3.00 mm of rest/);
  assert.ok((await result().locator('tbody tr').count()) > 1);
  await one.click(one.page.locator('[data-key="result-colours"]'));
  await one.until(() => newest(0)?.legend, 'the colours');
  assert.match(newest(0).legend.definition, /and the reverse/);
  await one.click(one.page.locator('[data-key="result-colours"]'));
  await one.until(() => !newest(0)?.legend, 'without colours');
});

test('trials have a row and a bar for each number', async () => {
  assert.match(await shown('doubt'), /Values under random errors/);
  assert.equal(await plots(), 1);
  assert.ok((await result().locator('tbody tr').count()) > 3);
});

test('guesses of landmarks have their places', async () => {
  assert.match(await shown('guess'), /Nobody has confirmed them/);
});

test('a comparison waits for the meshes and says so; certified, it has distances and their histogram', async () => {
  assert.match(await shown('differ'), /meshes, which are not there yet/);
  await one.command('Certify');
  await one.until(async () => {
    await one.tab('Inspector');
    await one.select('differ');
    return /Hausdorff 95/.test(await result().innerText());
  }, 'the comparison');
  assert.equal(await plots(), 1);
  await one.click(one.page.locator('[data-key="result-enlarge"]'));
  const dialog = one.page.locator('dialog.result-dialog');
  assert.match(await dialog.innerText(), /95th percentile/);
  if (pictures) await one.page.screenshot({ path: path.join(pictures, 'result_enlarged.png') });
  await one.press('Escape');
});

test('sizes have both kernels, and every measuring step stands among the numbers', async () => {
  assert.match(await shown('size'), /voxel kernel/);
  await one.tab('Numbers');
  const list = await one.page.locator('.inspector .numbers').last().innerText();
  for (const { id, do: word } of steps)
    if (['measure', 'airway', 'contacts', 'compare', 'trials', 'find_landmarks'].includes(word))
      assert.ok(list.includes(id), `${id} in ${list}`);
  assert.ok(!/[{}]|\[object/.test(list), list);
});

test('the console stayed empty', () => assert.deepEqual(one.problems, []));

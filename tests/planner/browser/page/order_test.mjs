// SPDX-License-Identifier: AGPL-3.0-or-later
// Steps are dragged to another place of the plan. A place before what a step uses is refused, and nothing changes.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';
import { violations } from './screen_checks.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-order-'));
const plan_path = path.join(folder, 'order.plan.json');
const first = ['skull', 'soft', 'dense', 'both'];
let server;
let one;
before(async () => {
  lay_phantom(folder, 2);
  fs.writeFileSync(plan_path, JSON.stringify({
    octotomy_plan: 1, name: 'order', scans: { ct: { path: 'head_phantom.nrrd' } },
    steps: [
      { id: 'skull', do: 'window', scan: 'ct', low: 300 },
      { id: 'soft', do: 'window', scan: 'ct', low: 0 },
      { id: 'dense', do: 'window', scan: 'ct', low: 700 },
      { id: 'both', do: 'combine', expression: 'skull | dense' },
    ],
  }));
  server = await start_server(folder, ['order.plan.json']);
  one = await PlannerWindow.open(server.url);
  await one.at_rest();
  await one.tab('Steps');
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

const order = () => one.plan(plan_path).steps.map((step) => step.id);
const row = (id) => one.page.locator('.item.step', { has: one.page.locator('.name', { hasText: new RegExp(`^${id}$`) }) });
/// Drags a row to the upper or lower half of another one.
async function drag(id, to, half) {
  await one.until(() => one.waiting.size === 0, 'answers');
  const box = await one.until(() => row(to).boundingBox(), `${to} in sight`);
  await row(id).locator('.words').dragTo(row(to), { targetPosition: { x: box.width / 2, y: half === 'before' ? 4 : box.height - 4 } });
}

test('a step is dragged to each place, once', async () => {
  for (const [id, to, half, wanted] of [
    ['dense', 'skull', 'before', ['dense', 'skull', 'soft', 'both']],
    ['dense', 'both', 'before', ['skull', 'soft', 'dense', 'both']],
    ['skull', 'soft', 'behind', ['soft', 'skull', 'dense', 'both']],
    ['soft', 'both', 'behind', ['skull', 'dense', 'both', 'soft']],
  ]) {
    await drag(id, to, half);
    await one.until(() => order().join() === wanted.join(), `${id} ${half} ${to}: ${wanted}, not ${order()}`, 20000);
    await one.until(async () => (await one.page.locator('.lists .step .name').allInnerTexts()).join() === wanted.join(), 'the list', 20000);
  }
  // One edit each, which undo takes back.
  for (let i = 0; i < 4; ++i) await one.press('Control+z');
  await one.until(() => order().join() === first.join(), 'undone');
});

test('a place before what a step uses is refused, and where a step stands is no edit', async () => {
  const { length } = (await one.plan(plan_path)).steps;
  const before_it = fs.readFileSync(plan_path, 'utf8');
  await drag('both', 'skull', 'before');
  await one.page.locator('.notice.error', { hasText: 'skull' }).waitFor();
  await drag('soft', 'skull', 'behind');
  await drag('soft', 'dense', 'before');
  await one.page.waitForTimeout(400);
  assert.equal(fs.readFileSync(plan_path, 'utf8'), before_it);
  assert.equal(length, first.length);
  assert.equal(await one.page.locator('body.dropping').count(), 0);
  assert.deepEqual(await violations(one, 'order'), []);
  assert.deepEqual(one.problems, []);
});

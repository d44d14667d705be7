// SPDX-License-Identifier: AGPL-3.0-or-later
// A working day in short, to see whether memory stays flat: views turned, a region drawn, cut, dragged, undone, branched,
// certified, reported, slices walked through, the page loaded again, and all of it once more until the time is over.
//   OCTOTOMY_PROGRAM=build/release/octotomy node session.mjs SCAN MINUTES [TABLE.tsv]
// Prints after every round the server's resident memory, the page's heap after a collection, and the page's nodes; at the
// end the growth of each by a straight line through what came after the first ten minutes.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { PlannerWindow, start_server } from './planner_window.mjs';

const warm_up_min = 10;
const scan = path.resolve(process.argv[2] ?? 'head.nrrd');
const minutes = Number(process.argv[3] ?? 60);
const table = process.argv[4];
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-session-'));
const plan_path = path.join(folder, 'head.plan.json');
fs.copyFileSync(scan, path.join(folder, 'head.nrrd'));

const rows = [];
const say = (line) => {
  console.log(line);
  if (table) fs.appendFileSync(table, line + '\n');
};

/// Kilobytes that a process has in memory, by a line of its status.
const kept_kb = (pid, line) => Number(fs.readFileSync(`/proc/${pid}/status`, 'utf8').match(new RegExp(`${line}:\\s+(\\d+)`))[1]);

async function measure(one, devtools, server, round, began) {
  await devtools.send('HeapProfiler.collectGarbage');
  const { metrics } = await devtools.send('Performance.getMetrics');
  const page = (name) => metrics.find((metric) => metric.name === name).value;
  const row = {
    minute: (Date.now() - began) / 60000, server_mb: kept_kb(server.process.pid, 'VmRSS') / 1024,
    heap_mb: page('JSHeapUsedSize') / 2 ** 20, nodes: page('Nodes'),
  };
  rows.push(row);
  say([round, row.minute.toFixed(1), row.server_mb.toFixed(0), row.heap_mb.toFixed(2), row.nodes].join('\t'));
}

/// The slope of a straight line through the rows that came after the first minutes, an hour.
function growth_per_hour(name) {
  const used = rows.filter((row) => row.minute >= Math.min(warm_up_min, minutes / 3));
  const mean = (of) => used.reduce((sum, row) => sum + of(row), 0) / used.length;
  const [minute, value] = [mean((row) => row.minute), mean((row) => row[name])];
  const spread = used.reduce((sum, row) => sum + (row.minute - minute) ** 2, 0);
  return { per_hour: (60 * used.reduce((sum, row) => sum + (row.minute - minute) * (row[name] - value), 0)) / (spread || 1), mean: value };
}

async function work(one, round) {
  const { page } = one;
  const step = (name) => one.plan(plan_path).steps.find((each) => each.id === name);
  const drag_canvas = async (pane, from, to) => {
    const box = await page.locator('.pane canvas').nth(pane).boundingBox();
    const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
    await page.mouse.move(...at(from));
    await page.mouse.down();
    await page.mouse.move(...at(to), { steps: 25 });
    await page.mouse.up();
  };
  // Views turned, and slices walked through.
  for (const pane of [3, 3, 3]) await drag_canvas(pane, [0.3, 0.5], [0.8, 0.4 + 0.01 * (round % 20)]);
  await one.command('Views and slices');
  for (const pane of [1, 2, 3]) await drag_canvas(pane, [0.4, 0.4], [0.6, 0.6]);
  await page.mouse.wheel(0, 400);
  await one.at_rest();
  await one.command('Four views');
  await one.at_rest();
  // A region, the cut and a moved piece, a little different in every round.
  const shift = (round % 17) * 0.5;
  await one.press('r');
  for (const corner of [[-62, 71], [32, 71], [32, 95 + shift], [-62, 95 + shift]]) await one.click_at(0, corner);
  await one.press('Enter');
  await one.until(() => step('cut'), 'the cut');
  for (const corner of [[-112, 71], [-48, 71], [-48, 95 + shift], [-112, 95 + shift]]) await one.click_at(1, corner);
  await one.press('Enter');
  await one.until(() => step('cut')?.regions.length === 2, 'the second region');
  await one.press('x');
  await one.until(() => step('piece'), 'the piece');
  await one.shows(1, 'piece');
  await one.press('g');
  await page.locator('[data-key="move-forward_mm"]').waitFor();
  await one.drag(1, [-80, 83], [-86 - shift / 4, 83]);
  await one.until(() => step('piece_moved'), 'the moved piece');
  for (let i = 0; i < 6; ++i) await one.drag(1, [-86, 83], [-86 + (i % 2 ? 2 : -2), 83 + (i % 3)]);
  for (let i = 0; i < 4; ++i) await one.press('Control+z');
  for (let i = 0; i < 2; ++i) await one.press('Control+y');
  await one.at_rest();
  await one.click('New branch beside main', {});
  await page.locator('dialog input').fill(`round_${round}`);
  await one.press('Enter');
  await one.until(() => page.locator('.bar', { hasText: `round_${round}` }).count(), 'the branch');
  await one.press('Escape');
  if (round % 3 === 0) {
    await one.press('Control+Enter');
    await one.until(async () => (await page.locator('.numbers .badge:not(.none)').count()) >= 5, 'badges', 600000);
  }
  if (round % 6 === 0) {
    await one.click(page.locator('.bar').getByRole('button', { name: 'Report' }));
    await page.locator('dialog.report iframe').waitFor({ timeout: 600000 });
    await one.press('Escape');
  }
  await one.command('Compare in colours');
  await one.at_rest();
  await one.command('Compare in colours');
  if (round % 4 === 0) {
    await page.reload();
    await one.at_rest();
  }
  // Back to the scan with its window alone, on the first branch.
  await one.tab('History');
  await page.locator('[data-key="branch"]').selectOption('main');
  await one.until(() => page.locator('.bar', { hasText: 'New branch beside main' }).count().then(() => page.getByRole('button', { name: 'New branch beside main' }).count()), 'main');
  for (let left = () => one.plan(plan_path).steps.length, presses = 0; left() > 1; ++presses) {
    assert.ok(presses < 60, `undo leaves ${left()} steps`);
    await one.press('Control+z');
    await page.waitForTimeout(150);
  }
  await one.tab('Steps');
  await one.at_rest();
}

const server = await start_server(folder, ['head.nrrd']);
const one = await PlannerWindow.open(server.url, { size: { width: 1200, height: 900 } });
try {
  const devtools = await one.context.newCDPSession(one.page);
  await devtools.send('Performance.enable');
  await one.click('Continue');
  await one.press('Escape');
  await one.at_rest();
  say(['round', 'minute', 'server_mb', 'heap_mb', 'nodes'].join('\t'));
  const began = Date.now();
  for (let round = 0; Date.now() - began < minutes * 60000; ++round) {
    await measure(one, devtools, server, round, began);
    await work(one, round);
  }
  await measure(one, devtools, server, 'end', began);
  for (const name of ['server_mb', 'heap_mb', 'nodes']) {
    const { per_hour, mean } = growth_per_hour(name);
    say(`${name}: mean ${mean.toFixed(1)}, ${per_hour >= 0 ? '+' : ''}${per_hour.toFixed(1)} an hour, ${rows.length} measurements, ${one.actions} actions`);
  }
} catch (error) {
  await one.page.screenshot({ path: path.resolve('session_failed.png') });
  say(`failed: ${error.message}; the last picture is session_failed.png`);
  process.exitCode = 1;
} finally {
  if (one.problems.length) say(`problems: ${one.problems.slice(0, 5).join(' | ')}`);
  await one.close();
  server.stop();
  fs.rmSync(folder, { recursive: true, force: true });
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// Merging with a plan that somebody else has changed, and signatures: what the page reports is the command line's.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, program, start_server } from './planner_window.mjs';
import { violations } from './screen_checks.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-signing-'));
const mine = path.join(folder, 'mine.plan.json'), theirs = path.join(folder, 'theirs.plan.json');
const octotomy = (...typed) => JSON.parse(execFileSync(program, [...typed, '--json'], { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }));
let server;
let one;

const base = {
  octotomy_plan: 1, name: 'mine', scans: { ct: { path: 'head_phantom.nrrd' } },
  steps: [{ id: 'skull', do: 'window', scan: 'ct', low: 300 }, { id: 'inner', do: 'offset', object: 'skull', by_mm: -2 }],
};
const with_low = (low, more = []) => ({ ...base, steps: [{ ...base.steps[0], low }, base.steps[1], ...more] });
const write = (file, plan) => fs.writeFileSync(file, JSON.stringify(plan));
const picture = async (name) => {
  if (process.env.OCTOTOMY_PICTURES) await one.page.screenshot({ path: path.join(process.env.OCTOTOMY_PICTURES, `${name}.png`) });
};

before(async () => {
  lay_phantom(folder, 2);
  write(mine, base);
  write(theirs, with_low(400));
  server = await start_server(folder, ['mine.plan.json']);
  one = await PlannerWindow.open(server.url);
  await one.at_rest();
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

async function open_merge(file) {
  await one.command('Merge with another plan');
  await one.click(one.page.locator('.picker .file', { hasText: file }));
  await one.page.locator('dialog.merge').waitFor();
}

test('a merge shows what it changes, and is one edit that undo takes back', async () => {
  await one.tab('Steps');
  await one.select('skull');
  await one.command('Mirror the selected object');
  await one.until(() => one.plan(mine).steps.length === 3, 'a step of our own');
  await open_merge('theirs.plan.json');
  const dialog = one.page.locator('dialog.merge');
  assert.match(await dialog.innerText(), /guess/);
  assert.match(await dialog.locator('.diff').innerText(), /skull.*low.*300.*400/);
  assert.equal(await dialog.locator('select').inputValue(), '1');
  assert.deepEqual(await violations(one, 'merge'), []);
  await picture('merge');
  await one.click(dialog.getByRole('button', { name: 'Merge', exact: true }));
  await one.until(() => one.plan(mine).steps[0].low === 400, 'the other plan\'s change');
  assert.equal(one.plan(mine).steps.length, 3);
  // As the command line merges the same three files.
  write(path.join(folder, 'base.plan.json'), base);
  fs.writeFileSync(path.join(folder, 'ours.plan.json'), JSON.stringify({ ...one.plan(mine), steps: one.plan(mine).steps.map((step, i) => (i ? step : { ...step, low: 300 })) }));
  octotomy('plan', 'merge', 'base.plan.json', 'ours.plan.json', 'theirs.plan.json', '-o', 'merged.plan.json');
  assert.deepEqual(JSON.parse(fs.readFileSync(path.join(folder, 'merged.plan.json'), 'utf8')).steps, one.plan(mine).steps);
  await one.press('Control+z');
  await one.until(() => one.plan(mine).steps[0].low === 300, 'undone');
  await one.press('Control+y');
  await one.until(() => one.plan(mine).steps[0].low === 400, 'done again');
});

test('what both plans changed differently is shown side by side, and nothing is merged', async () => {
  write(theirs, with_low(500));
  const before_it = fs.readFileSync(mine, 'utf8');
  await open_merge('theirs.plan.json');
  const dialog = one.page.locator('dialog.merge');
  await dialog.locator('select').selectOption('1');
  await one.until(async () => /same values/.test(await one.page.locator('dialog.merge').innerText()), 'a conflict');
  const rows = await one.page.locator('dialog.merge tbody tr').allInnerTexts();
  assert.match(rows.join('\n'), /skull, low\s+300\s+400\s+500/);
  assert.ok(await one.page.locator('dialog.merge').getByRole('button', { name: 'Merge', exact: true }).isDisabled());
  assert.deepEqual(await violations(one, 'conflict'), []);
  await picture('conflict');
  await one.press('Escape');
  assert.equal(fs.readFileSync(mine, 'utf8'), before_it);
});

test('a signature holds, for the command line too, until the plan is changed', async () => {
  await one.command('Signatures');
  const dialog = one.page.locator('dialog.sign');
  await dialog.getByText('Nobody has signed').waitFor();
  await dialog.locator('input[name="by"]').fill('A. Reader');
  await dialog.locator('input[name="as"]').fill('second reader');
  await dialog.locator('input[name="note"]').fill('read on paper');
  await one.click(dialog.getByRole('button', { name: 'Sign', exact: true }));
  await dialog.locator('.badge.pass').waitFor();
  assert.match(await dialog.innerText(), /A\. Reader, second reader.*holds/s);
  assert.deepEqual(await violations(one, 'sign'), []);
  await picture('sign');
  const [signature] = octotomy('plan', 'sign', 'mine.plan.json').signatures;
  assert.deepEqual([signature.by, signature.as, signature.note, signature.changed_since], ['A. Reader', 'second reader', 'read on paper', []]);
  await one.press('Escape');
  await one.select('skull');
  await one.command('Mirror the selected object');
  await one.until(() => one.plan(mine).steps.length === 4, 'a later step');
  await one.command('Signatures');
  await one.page.locator('dialog.sign .badge.warn').waitFor();
  assert.match(await one.page.locator('dialog.sign').innerText(), /the plan changed since/);
  // No name, no signature.
  await one.click(one.page.locator('dialog.sign').getByRole('button', { name: 'Sign', exact: true }));
  await one.page.locator('.notice.error', { hasText: 'needs a name' }).waitFor();
  assert.equal(one.plan(mine).signatures.length, 1);
  await one.press('Escape');
  assert.deepEqual(one.problems, []);
});

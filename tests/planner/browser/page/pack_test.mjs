// SPDX-License-Identifier: AGPL-3.0-or-later
// The checker of packs as a page, opened as a file: on a good pack, on forged ones and on files that are none, it says line by
// line what check_pack.py says, and asks no network for anything. OCTOTOMY_FORGERIES: how many forged packs.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { browser_path } from './planner_window.mjs';

const sources = process.env.OCTOTOMY_SOURCES;
const forgeries = process.env.OCTOTOMY_FORGERIES ?? '29';
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-pack-page-'));
const asked = [], problems = [];
let browser, page, packs;

before(async () => {
  execFileSync(process.env.OCTOTOMY_PYTHON ?? '/usr/bin/python3',
               [path.join(sources, 'tests/planner/result/pack/pack_forgery.py'), folder, forgeries], { stdio: 'inherit' });
  packs = fs.readdirSync(folder).filter((name) => name.endsWith('.zip')).sort();
  browser = await chromium.launch({ executablePath: browser_path, args: ['--disable-gpu', '--no-sandbox'] });
  page = await browser.newPage();
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) asked.push(request.url()); });
  page.on('console', (message) => { if (message.type() === 'error') problems.push(message.text()); });
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.goto(pathToFileURL(path.join(sources, 'planner/result/pack/check_pack.html')).href);
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
});

const shown = () => page.waitForFunction(() => ['good', 'bad', 'refused'].includes(document.getElementById('summary').className), null, { timeout: 120000 });
async function checked(name) {
  await page.setInputFiles('#file', path.join(folder, name));
  await shown();
  const lines = await page.locator('#lines tr').evaluateAll((rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
  return { state: await page.locator('#summary').getAttribute('class'), summary: await page.locator('#summary').innerText(), lines };
}
/// A claim with its numbers to six figures, without quotation marks, and without the words of an error.
const plain = (text) => text.replace(/cannot be read:.*/s, 'cannot be read')
  .replace(/-?\d+(?:\.\d+)?(?:e[-+]?\d+)?/g, (number) => String(Number(Number(number).toPrecision(6)))).replaceAll(/['"]/g, '').replace(/None|null|undefined/g, 'none');

test('says of every pack, line by line, what check_pack.py says', async () => {
  const states = { good: 0, bad: 0, refused: 0 };
  for (const name of packs) {
    const expected = JSON.parse(fs.readFileSync(path.join(folder, `${name}.json`)));
    const found = await checked(name);
    ++states[found.state];
    if (expected.refused) {
      assert.equal(found.state, 'refused', `${name}: check_pack.py says ${expected.refused}, the page ${found.summary}`);
      continue;
    }
    const values = found.lines.filter((line) => line[2] !== ''), claims = found.lines.filter((line) => line[2] === '');
    assert.deepEqual(values.map(([state, what, value]) => [state, what, Number(value)]), expected.values, name);
    assert.deepEqual(claims.map(([state, text]) => [state, plain(text)]), expected.claims.map(([state, text]) => [state, plain(text)]), name);
    const contradicted = [...expected.values, ...expected.claims].some(([state]) => state === 'contradicted');
    assert.equal(contradicted, name !== 'good.zip', name);
    assert.equal(found.state, contradicted ? 'bad' : 'good', `${name}: ${found.summary}`);
  }
  assert.deepEqual(states, { good: 1, bad: Number(forgeries), refused: 4 });
});

test('takes a pack that is dropped, and shows only the chosen lines', async () => {
  const bytes = fs.readFileSync(path.join(folder, packs.find((name) => name.endsWith('change_a_verdict.zip')))).toString('base64');
  const dropped = await page.evaluateHandle(async (text) => {
    const data = new DataTransfer();
    data.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], 'dropped.zip'));
    return data;
  }, bytes);
  await page.dispatchEvent('#drop', 'drop', { dataTransfer: dropped });
  await page.waitForFunction(() => document.getElementById('summary').textContent.startsWith('dropped.zip: ')
    && document.getElementById('summary').className === 'bad', null, { timeout: 120000 });
  await page.selectOption('#show', 'contradicted');
  const visible = await page.locator('#lines tr:visible').evaluateAll((rows) => rows.map((row) => row.dataset.state));
  assert.ok(visible.length > 0);
  assert.deepEqual([...new Set(visible)], ['contradicted']);
});

test('asks no network for anything, and reports no error', () => {
  assert.deepEqual(asked, []);
  assert.deepEqual(problems, []);
});

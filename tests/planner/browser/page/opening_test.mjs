// SPDX-License-Identifier: AGPL-3.0-or-later
// Opening as people expect: a DICOM folder that is chosen or dropped with the folders in which it lies, what is too large or
// no scan, and a recent plan.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, program, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-opening-'));
const series = path.join(folder, 'elsewhere', 'ST0001');
const work = path.join(folder, 'work');
let server;
let one;
const uploads = () => fs.readdirSync(path.join(work, 'uploads'));

before(async () => {
  fs.mkdirSync(work, { recursive: true });
  fs.mkdirSync(series, { recursive: true });
  execFileSync(program, ['phantom', 'head', '--voxel', '4', '--dicom', '-o', path.join(series, 'SE0001')], { stdio: 'ignore' });
  fs.writeFileSync(path.join(series, 'DICOMDIR'), 'an index of other paths');
  server = await start_server(work);
  one = await PlannerWindow.open(server.url);
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

const audited = () => one.page.getByRole('button', { name: 'Continue' }).waitFor();
async function start_page() {
  await one.page.locator('.brand').click();
  await one.page.locator('.start .drop').waitFor();
}

test('the start page says how much it takes', async () => {
  assert.match(await one.page.locator('.drop').innerText(), /up to 4 GB/);
  assert.equal(await one.page.locator('.recent').count(), 0);
});

test('a folder is chosen with all that lies below it', async () => {
  const choosing = one.page.waitForEvent('filechooser');
  await one.click('Choose a folder');
  await (await choosing).setFiles(series);
  await audited();
  const [sent] = uploads();
  assert.match(sent, /^ST0001-\d{8}-\d{6}$/);
  const slices = fs.readdirSync(path.join(series, 'SE0001'));
  assert.deepEqual(fs.readdirSync(path.join(work, 'uploads', sent)).sort(), slices.sort());
  assert.match(await one.page.locator('.facts').innerText(), new RegExp(`× ${slices.length}`));
  await one.click('Continue');
});

test('the plan of it is a recent one, and opens by a click', async () => {
  await start_page();
  const row = one.page.locator('.recent .file');
  await row.first().waitFor();
  assert.match(await row.first().innerText(), /ST0001/);
  await row.first().click();
  await one.until(async () => (await one.page.locator('.plan-name').count()) && (await one.page.locator('.plan-name').innerText()).startsWith('ST0001'), 'the recent plan');
});

/// Drops files on the page, as a browser does for files that lie in no folder.
const drop = (files) => one.page.evaluate((given) => {
  const transfer = new DataTransfer();
  for (const [name, bytes] of given) transfer.items.add(new File([new Uint8Array(bytes)], name));
  document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
}, files);

test('many images that are dropped are one series', async () => {
  await start_page();
  const names = fs.readdirSync(path.join(series, 'SE0001')).sort();
  const known = new Set(uploads());
  await drop(names.map((name) => [name, [...fs.readFileSync(path.join(series, 'SE0001', name))]]));
  await audited();
  const sent = uploads().find((name) => !known.has(name));
  assert.equal(fs.readdirSync(path.join(work, 'uploads', sent)).length, names.length);
  await one.click('Continue');
});

test('a folder of images is opened from within, too', async () => {
  await start_page();
  await one.click('Scan or plan');
  const whole = one.page.getByRole('button', { name: 'Open this folder as scan' });
  await one.click(one.page.locator('dialog .file', { hasText: 'uploads' }));
  await one.click(one.page.locator('dialog .file', { hasText: 'ST0001' }).first());
  await one.page.locator('dialog .file', { hasText: '..' }).waitFor();
  await one.click(whole);
  await one.until(async () => (await one.page.locator('.plan-name').innerText()).startsWith('ST0001'), 'the folder as a scan');
});

test('files that are no scan are refused with the reason', async () => {
  await start_page();
  await drop([['notes.txt', [65, 66]], ['more.txt', [67]]]);
  await one.page.locator('.notice.error').waitFor();
  await drop([['.hidden', [1]]]);
  await one.page.locator('.notice', { hasText: 'no file' }).waitFor();
});

test('more than may be sent is refused before anything is sent', async () => {
  const known = uploads().length;
  await one.page.evaluate(() => {
    const transfer = new DataTransfer();
    const large = new File([new Uint8Array(1)], 'large.nrrd');
    transfer.items.add(large);
    Object.defineProperty(File.prototype, 'size', { value: 5 * 2 ** 30, configurable: true });
    document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
  });
  await one.page.locator('.notice.error', { hasText: 'at most 4 GB can be sent' }).waitFor();
  assert.equal(uploads().length, known);
});

test('the console holds nothing but the refusal', () => assert.deepEqual(one.problems, []));

// SPDX-License-Identifier: AGPL-3.0-or-later
// page_test.mjs PAGE: the page opened as a file in headless Chromium; its numbers are the program's. Started by
// tests/planner/browser/page/run, in the folder that has playwright-core.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const page_file = process.argv[2];
if (!page_file || !existsSync(page_file)) {
  console.log('Skipped: this build has no WebAssembly, hence no such page');
  process.exit(77);
}
const { chromium } = createRequire(`${process.cwd()}/`)('playwright-core');
const program = process.env.OCTOTOMY_PROGRAM;
const octotomy = (...words) => execFileSync(program, words, { encoding: 'utf8' });
const folder = mkdtempSync(path.join(tmpdir(), 'one_kernel'));
const browser = await chromium.launch({ executablePath: process.env.OCTOTOMY_CHROMIUM, args: ['--disable-gpu', '--no-sandbox'] });
try {
  const page = await browser.newPage({ viewport: { width: 1000, height: 800 } });
  const problems = [], asked = [];
  page.on('console', (message) => { if (message.type() === 'error') problems.push(message.text()); });
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) asked.push(request.url()); });
  await page.goto(pathToFileURL(page_file).href);
  assert.equal(await page.locator('.badge').innerText(), 'one kernel');

  const open = async (file) => {
    const name = path.basename(file);
    await page.setInputFiles('#file', file);
    await page.waitForFunction((text) => document.getElementById('said').textContent.startsWith(text)
      || document.getElementById('said').className === 'refusal', `${name}: `);
  };
  const shown = async () => (await page.locator('#numbers tr').evaluateAll((rows) => rows.map((row) => Number(row.dataset.exact)))).slice(0, 2);
  /// How many pixels show the object, how bright they are, and how far to the right of the middle they lie.
  const picture = () => page.evaluate(() => {
    const canvas = document.getElementById('picture');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let lit = 0, right = 0, up = 0;
    for (let i = 0; i < data.length; i += 4)
      if (data[i] + data[i + 1] + data[i + 2] > 150) {
        ++lit;
        right += (i / 4) % canvas.width - canvas.width / 2;
        up += canvas.height / 2 - Math.floor(i / 4 / canvas.width);
      }
    return { lit, right: right / lit, up: up / lit };
  });

  // The head in both formats: the program's own count, to the voxel.
  const head = path.join(folder, 'head.nrrd');
  if (process.env.OCTOTOMY_PHANTOMS) copyFileSync(path.join(process.env.OCTOTOMY_PHANTOMS, 'head_phantom_1.nrrd'), head);
  else octotomy('phantom', 'head', '-o', head);
  const truth = JSON.parse(octotomy('measure', head, '--window', '300:', '--json'));
  const nifti = path.join(folder, 'head.nii.gz');
  octotomy('convert', head, '-o', nifti);
  for (const file of [head, nifti]) {
    await open(file);
    assert.deepEqual(await shown(), [truth.voxels, truth.volume_mm3], file);
    assert.ok((await picture()).lit > 20000, 'nothing is drawn');
  }
  const centroid = await page.locator('#numbers tr').nth(3).innerText();
  assert.match(centroid, new RegExp(truth.centroid_mm.map((value) => value.toFixed(1)).join(', ')));
  await page.fill('#low', '-300');
  await page.press('#low', 'Enter');
  const skin = JSON.parse(octotomy('measure', head, '--window=-300:', '--json'));
  await page.waitForFunction((count) => document.querySelector('#numbers tr').dataset.exact === `${count}`, skin.voxels);
  if (process.env.OCTOTOMY_SCREENSHOT) await page.screenshot({ path: process.env.OCTOTOMY_SCREENSHOT });

  // A frame that is flipped would put this corner elsewhere: a block at the patient's left, back and top.
  const bytes = Buffer.alloc(40 * 40 * 40 * 2);
  for (let z = 0; z < 40; ++z)
    for (let y = 0; y < 40; ++y)
      for (let x = 0; x < 40; ++x) {
        const is_frame = [x, y, z].filter((at) => at < 2 || at > 37).length >= 2;
        bytes.writeInt16LE(is_frame || (x > 25 && y > 25 && z > 25) ? 1000 : 0, 2 * (x + 40 * (y + 40 * z)));
      }
  const header = ['NRRD0004', 'type: short', 'dimension: 3', 'sizes: 40 40 40', 'encoding: raw', 'endian: little'];
  const write = (name, more) => {
    const file = path.join(folder, name);
    writeFileSync(file, Buffer.concat([Buffer.from([...header, ...more, '', ''].join('\n')), bytes]));
    return file;
  };
  const seen_from = async (name) => { await page.getByRole('button', { name }).click(); return picture(); };
  // The same lattice by two names of its axes, one of them reversed: from the front, the patient's left is at the right.
  for (const [name, space, directions] of [['lps.nrrd', 'left-posterior-superior', '(1,0,0) (0,1,0) (0,0,1)'],
    ['ras.nrrd', 'right-anterior-superior', '(-1,0,0) (0,-1,0) (0,0,1)']]) {
    await open(write(name, [`space: ${space}`, `space directions: ${directions}`, 'space origin: (0,0,0)']));
    assert.equal(await page.locator('#said').getAttribute('class'), '', await page.locator('#said').innerText());
    const front = await seen_from('Front'), back = await seen_from('Back'), left = await seen_from('Left');
    assert.ok(front.right > 20 && front.up > 20, `${name}: from the front at ${JSON.stringify(front)}`);
    assert.ok(back.right < -20 && back.up > 20, `${name}: from the back at ${JSON.stringify(back)}`);
    assert.ok(left.up > 20 && Math.abs(left.right) > 20, `${name}: from the left at ${JSON.stringify(left)}`);
  }

  // What cannot be read is refused in words, and the page goes on.
  const refused = async (name, content, words) => {
    const file = path.join(folder, name);
    writeFileSync(file, content);
    await open(file);
    assert.equal(await page.locator('#said').getAttribute('class'), 'refusal');
    assert.match(await page.locator('#said').innerText(), words);
  };
  await refused('cut.nrrd', readFileSync(head).subarray(0, 50000), /cut short/);
  await refused('none.nii', Buffer.alloc(400), /NIfTI-1/);
  await refused('words.nrrd', 'not a scan', /cut short/);
  await refused('flat.nrrd', Buffer.concat([Buffer.from([...header, 'space: left-posterior-superior',
    'space directions: (1,0,0) (1,0,0) (0,0,1)', 'space origin: (0,0,0)', '', ''].join('\n')), bytes]), /singular|lattice|axes/);
  await open(head);
  assert.deepEqual(await shown(), [truth.voxels, truth.volume_mm3]);
  assert.deepEqual([problems, asked], [[], []]);
  console.log(`the page counts ${truth.voxels} voxels of bone as the program does; nothing was fetched`);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// The audit shows where a scan is doubtful: a gap, metal and a headrest that were put into a made scan, at their places, and
// nothing of the kind where there is none.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, program, start_server } from './planner_window.mjs';
import { beside, violations } from './screen_checks.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-audit-'));
const side = 96, spacing = 2, gone = [60, 61, 62];
const centre = (side - 1) / 2; // in voxels, as of the head
const metal = [66, 40, 30]; // the corner of a cube of 4 voxels
const mm = (voxel) => (voxel - centre) * spacing;

/// A ball of tissue in a shell of bone, in Hounsfield units; `doubtful`: on a board, with a cube of metal.
function made_scan(file, doubtful) {
  const samples = new Int16Array(side ** 3);
  for (let z = 0, i = 0; z < side; ++z)
    for (let y = 0; y < side; ++y)
      for (let x = 0; x < side; ++x, ++i) {
        const r = Math.hypot(x - centre, y - centre, z - centre);
        samples[i] = r < 32 ? 40 : r < 35 ? 1100 : r < 38 ? 30 : doubtful && y >= 87 && y < 91 && x > 20 && x < 76 ? 150 : -1000;
        if (doubtful && [x, y, z].every((at, axis) => at >= metal[axis] && at < metal[axis] + 4)) samples[i] = 3050;
      }
  const header = `NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: ${side} ${side} ${side}\nspace directions: (${spacing},0,0) (0,${spacing},0) (0,0,${spacing})\n` +
    `kinds: domain domain domain\nendian: little\nencoding: raw\nspace units: "mm" "mm" "mm"\nspace origin: (${[0, 1, 2].map(() => -centre * spacing).join()})\n\n`;
  fs.writeFileSync(file, Buffer.concat([Buffer.from(header), Buffer.from(samples.buffer)]));
}

let server;
before(async () => {
  made_scan(path.join(folder, 'made.nrrd'), true);
  made_scan(path.join(folder, 'sound.nrrd'), false);
  execFileSync(program, ['convert', 'made.nrrd', '-o', 'series', '--dicom'], { cwd: folder, stdio: 'ignore' });
  // Images of the lost slices, by their heights.
  const images = fs.readdirSync(path.join(folder, 'series')).filter((name) => name.endsWith('.dcm')).sort();
  assert.equal(images.length, side);
  for (const z of gone) fs.rmSync(path.join(folder, 'series', images[z]));
  server = await start_server(folder);
});
after(() => {
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

async function open_found(one, name, as_folder) {
  await one.page.locator('.start .offers').waitFor();
  await one.click('Scan or plan');
  const row = one.page.locator('.picker .file', { hasText: name });
  await one.click(row);
  if (as_folder) await one.click('Open this folder as scan');
  await one.page.locator('.audit-page .places').waitFor();
}

for (const [width, height] of [[390, 844], [820, 1180], [1024, 768], [1600, 900]])
  for (const theme of ['light', 'dark'])
    test(`gap, metal and headrest are shown at their places, ${width} pixels, ${theme}`, async () => {
      const fresh = width === 390 && theme === 'light' ? server : await start_server(folder);
      const one = await PlannerWindow.open(fresh.url, { size: { width, height }, theme });
      try {
        await one.page.locator('.start .offers').waitFor();
        // The plan that an earlier window made would skip the audit.
        for (const name of fs.readdirSync(folder)) if (name.startsWith('series.plan')) fs.rmSync(path.join(folder, name));
        await open_found(one, 'series', true);
        await one.page.locator('.place').nth(2).waitFor();
        if (process.env.OCTOTOMY_PICTURES) await one.page.screenshot({ path: path.join(process.env.OCTOTOMY_PICTURES, `audit_${width}_${theme}.png`), fullPage: true });
        const texts = await one.page.locator('.place figcaption').allInnerTexts();
        assert.match(texts[0], /gap: no image measured a slab of 8\.00 mm/);
        assert.match(texts[1], /metal: 512 mm³ in 4 slices/);
        assert.match(texts[2], /headrest: .* cm³ behind the patient/);
        // Each picture has orange in it, and not everywhere.
        for (const shares of await one.page.evaluate(() => Promise.all([...document.querySelectorAll('.place img')].map(async (image) => {
          await image.decode();
          const canvas = new OffscreenCanvas(image.naturalWidth, image.naturalHeight), context = canvas.getContext('2d');
          context.drawImage(image, 0, 0);
          const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
          let orange = 0;
          for (let i = 0; i < data.length; i += 4) orange += data[i] > data[i + 2] + 60 ? 1 : 0;
          return orange / (data.length / 4);
        })))) assert.ok(shares > 1e-4 && shares < 0.3, `share of orange ${shares}`);
        assert.deepEqual(await violations(one, 'audit'), []);
        assert.deepEqual(await one.page.evaluate(beside, 'audit'), []);
        // The metal's place, in the panes.
        await one.click(one.page.locator('[data-key="place-metal"]'));
        await one.at_rest();
        const { cross_mm } = await one.look();
        for (const axis of [0, 1, 2]) assert.ok(Math.abs(cross_mm[axis] - mm(metal[axis] + 1.5)) <= 4, `the metal at ${cross_mm}`);
        assert.match(await one.page.locator('.status .hint').innerText(), /metal/);
        // From the plan, in a dialog: the gap.
        await one.command("Show the scan's audit");
        await one.click(one.page.locator('dialog [data-key="place-gap"]'));
        await one.page.waitForTimeout(200);
        assert.equal(await one.page.locator('dialog[open]').count(), 0);
        assert.ok(Math.abs((await one.look()).cross_mm[2] - mm(61)) < 0.1);
        assert.deepEqual(one.problems, []);
      } finally {
        await one.close();
        if (fresh !== server) fresh.stop();
      }
    });

test('a scan without them has no picture', async () => {
  const fresh = await start_server(folder);
  const one = await PlannerWindow.open(fresh.url);
  try {
    await open_found(one, 'sound.nrrd', false);
    await one.page.locator('.places .says', { hasText: 'No gap, metal or headrest' }).waitFor();
    assert.equal(await one.page.locator('.place').count(), 0);
    assert.deepEqual(one.problems, []);
  } finally {
    await one.close();
    fresh.stop();
  }
});

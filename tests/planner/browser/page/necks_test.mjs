// SPDX-License-Identifier: AGPL-3.0-or-later
// Two balls joined by a rod that one kernel alone connects: the step that keeps the largest part lists the neck, and a click
// keeps the part beyond it or cuts the neck.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-necks-'));
const plan_path = path.join(folder, 'joined.plan.json');
const pictures = process.env.OCTOTOMY_PICTURES;
let server;
let one;
const step = () => one.plan(plan_path).steps.find(({ id }) => id === 'part');
const section = () => one.page.getByRole('region', { name: 'Thin necks' });
const cubic_mm = (radius) => 4 / 3 * Math.PI * radius ** 3;

/// The balls have radii of 8 and 10 mm; the rod between them is 1.6 mm thick, less than a voxel of the plan.
function lay_joined_balls(file) {
  const n = 64, samples = new Int16Array(n ** 3);
  const filled = (depth) => 2000 * Math.min(0.5, Math.max(-0.5, depth));
  for (let k = 0, at = 0; k < n; ++k)
    for (let j = 0; j < n; ++j)
      for (let i = 0; i < n; ++i, ++at) {
        const [x, y, z] = [i, j, k].map((index) => index - 0.5 * (n - 1));
        const ball = (centre, radius) => filled(radius - Math.hypot(x - centre, y, z));
        const rod = Math.abs(x) < 14 ? filled(0.8 - Math.hypot(y - 0.3, z - 0.5)) : -1000;
        samples[at] = Math.round(Math.max(ball(-14, 8), ball(13, 10), rod));
      }
  const first = -0.5 * (n - 1);
  fs.writeFileSync(file, Buffer.concat([
    Buffer.from(`NRRD0005\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: ${n} ${n} ${n}\n` +
      `space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (${first},${first},${first})\nencoding: raw\nendian: little\n\n`),
    Buffer.from(samples.buffer),
  ]));
}

/// Certifies the plan, answers what the part's badge says, and goes back to the inspector, which lists the necks.
const certified = async () => {
  await one.command('Certify');
  const badge = one.page.getByRole('tabpanel').getByRole('button', { name: /^part: / });
  await badge.first().waitFor();
  const says = await badge.first().getAttribute('aria-label');
  await one.tab('Inspector');
  await one.at_rest();
  return says;
};

before(async () => {
  lay_joined_balls(path.join(folder, 'joined.nrrd'));
  fs.writeFileSync(plan_path, JSON.stringify({
    octotomy_plan: 1, name: 'joined', scans: { ct: { path: 'joined.nrrd' } }, universe: { voxel_mm: 2 },
    steps: [{ id: 'all', do: 'window', scan: 'ct', low: 0 }, { id: 'part', do: 'parts', object: 'all', largest: 1 }],
  }));
  server = await start_server(folder, [plan_path]);
  one = await PlannerWindow.open(server.url);
  await one.select('part');
  await one.at_rest();
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('a certified step lists its thin neck, with the volume beyond it, and a click shows the place', async () => {
  assert.equal(await section().count(), 0, 'nothing is listed before both kernels were compared');
  assert.match(await certified(), /with a warning/);
  const words = await section().innerText();
  const mm3 = Number(words.match(/([\d\s\u202f]+) mm³ near/)[1].replace(/\D/g, ''));
  assert.ok(Math.abs(mm3 - cubic_mm(8)) < 0.15 * cubic_mm(8), `${words}: the smaller ball`);
  await one.click(section().getByRole('button', { name: /near/ }).first());
  const { cross_mm } = await one.look();
  assert.ok(cross_mm[0] > -9 && cross_mm[0] < 5 && Math.hypot(cross_mm[1], cross_mm[2]) < 4, `${cross_mm} on the rod`);
  if (pictures) await one.page.screenshot({ path: path.join(pictures, 'necks.png') });
});

test('a neck that is kept stands in the plan, and leaves no doubt', async () => {
  await one.click(section().getByRole('button', { name: 'Keep', exact: true }));
  await one.until(() => step().keep_bridges_mm, 'the decision in the plan');
  assert.equal(step().keep_bridges_mm.length, 1);
  assert.match(await certified(), /both kernels agree/);
  assert.equal(await section().count(), 0);
});

test('a neck that is cut leaves the larger ball alone', async () => {
  await one.command('Undo');
  await one.until(() => !step().keep_bridges_mm, 'the plan as it was');
  await certified();
  await one.click(section().getByRole('button', { name: 'Cut', exact: true }));
  await one.until(() => step().cut_bridges_mm, 'the decision in the plan');
  assert.match(await certified(), /both kernels agree/);
  const words = await one.page.locator('.card .reading').first().innerText();
  const mm3 = Number(words.match(/^([\d\s\u202f.,]+)/)[1].replace(/[^\d.]/g, ''));
  assert.ok(Math.abs(mm3 - cubic_mm(10)) < 0.08 * cubic_mm(10), words);
});

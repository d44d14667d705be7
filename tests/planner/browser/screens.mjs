// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures of the page to look at: six screens in two sizes, light and dark. The first report certifies the plan.
//   OCTOTOMY_PROGRAM=build/release/octotomy node screens.mjs FOLDER
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { execFileSync } from 'node:child_process';
import { PlannerWindow, program, start_server } from './planner_window.mjs';

const out = path.resolve(process.argv[2] ?? 'screens');
fs.mkdirSync(out, { recursive: true });
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-screens-'));
execFileSync(program, ['phantom', 'head', '-o', path.join(folder, 'head.nrrd')]);
const points = { sella: [0, -12, 8], nasion: [0, -84, 10], ans: [0, -86, -30], a_point: [0, -82, -38], b_point: [0, -83, -78], pogonion: [0, -87, -93], menton: [0, -82, -101] };
const jaw = [{ view: 'anterior', polygons_mm: [[[-40, -60], [40, -60], [40, -25], [-40, -25]]] }, { view: 'left', polygons_mm: [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]] }];
const plan = path.join(folder, 'le_fort_i.plan.json');
fs.writeFileSync(plan, JSON.stringify({
  octotomy_plan: 1, name: 'Le Fort I', scans: { ct: { path: 'head.nrrd' } },
  steps: [
    { id: 'landmarks', do: 'landmarks', points: Object.entries(points).map(([name, point_mm]) => ({ name, point_mm })) },
    { id: 'skull', do: 'window', scan: 'ct', low: 300 },
    { id: 'cut', do: 'mask', regions: jaw },
    { id: 'rest', do: 'combine', expression: 'skull - cut' },
    { id: 'maxilla', do: 'combine', expression: 'skull & cut' },
    { id: 'maxilla_moved', do: 'move', object: 'maxilla', by: { forward_mm: 6, up_mm: 2 }, turn: { pitch_deg: 3, about_mm: [0, -60, -42] } },
    { id: 'overlap', do: 'combine', expression: 'rest & maxilla_moved' },
    { id: 'planned', do: 'combine', expression: 'rest | maxilla_moved' },
    { id: 'face_height', do: 'measure', points_mm: ['nasion', 'menton'] },
    { id: 'convexity', do: 'measure', points_mm: ['nasion', 'a_point', 'pogonion'] },
  ],
}));
const empty = await start_server(folder);
const server = await start_server(folder, [plan]);
try {
  for (const theme of ['dark', 'light'])
    for (const size of [{ width: 1440, height: 900 }, { width: 1024, height: 768 }]) {
      const save = (one, name) => one.page.screenshot({ path: path.join(out, `${name}_${size.width}_${theme}.png`) });
      const start = await PlannerWindow.open(empty.url, { size, theme });
      await start.page.locator('.offer').nth(1).waitFor();
      await save(start, 'start');
      await start.close();
      const one = await PlannerWindow.open(server.url, { size, theme });
      await one.page.locator('.lists .name').first().waitFor();
      if (await one.page.getByRole('button', { name: 'Continue' }).isVisible()) await one.click('Continue');
      await one.at_rest();
      await one.select('maxilla_moved');
      await one.press('g');
      await one.at_rest();
      await save(one, 'planning');
      await one.press('Escape');
      await one.command('Views and slices');
      await one.at_rest();
      await save(one, 'slices');
      await one.command('Four views');
      await one.select('maxilla_moved');
      await one.command('Compare in colours');
      await one.at_rest();
      await save(one, 'compare');
      await one.command('Compare in colours');
      await one.command('Radiograph and landmarks');
      await one.at_rest();
      await save(one, 'cephalometry');
      await one.press('Escape');
      await one.command('Four views');
      await one.click(one.page.locator('.bar').getByRole('button', { name: 'Report' }));
      await one.page.locator('dialog.report iframe').waitFor({ timeout: 600000 });
      await one.page.waitForTimeout(1500);
      await save(one, 'report');
      if (one.problems.length) console.log(one.problems);
      await one.close();
    }
} finally {
  empty.stop();
  server.stop();
  fs.rmSync(folder, { recursive: true, force: true });
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// The face's measures in the page: before and after, each with its norm, the norm's source and whom it describes, and the
// tracing; numbers and picture are the command line's.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, program, start_server } from './planner_window.mjs';
import { beside, violations } from './screen_checks.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-cephalometry-'));
const points = { sella: [0, -12, 8], nasion: [0, -84, 10], ans: [0, -86, -30], pns: [0, -40, -32], a_point: [0, -82, -38], b_point: [0, -83, -78], pogonion: [0, -87, -93], menton: [0, -82, -101] };
const jaw = [{ view: 'anterior', polygons_mm: [[[-40, -60], [40, -60], [40, -25], [-40, -25]]] }, { view: 'left', polygons_mm: [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]] }];
let server;
before(async () => {
  lay_phantom(folder, 2);
  fs.writeFileSync(path.join(folder, 'face.plan.json'), JSON.stringify({
    octotomy_plan: 1, name: 'face', scans: { ct: { path: 'head_phantom.nrrd' } },
    steps: [
      { id: 'landmarks', do: 'landmarks', points: Object.entries(points).map(([name, point_mm]) => ({ name, point_mm })) },
      { id: 'skull', do: 'window', scan: 'ct', low: 300 },
      { id: 'cut', do: 'mask', regions: jaw },
      { id: 'rest', do: 'combine', expression: 'skull - cut' },
      { id: 'maxilla', do: 'combine', expression: 'skull & cut' },
      { id: 'moved', do: 'move', object: 'maxilla', by: { forward_mm: 6 } },
    ],
  }));
  server = await start_server(folder, ['face.plan.json']);
});
after(() => {
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

const shown = (value) => value.toFixed(1).replace('-', '−');

for (const [width, height] of [[390, 844], [820, 1180], [1024, 768], [1600, 900]])
  for (const theme of ['light', 'dark'])
    test(`measures, norms and tracing in a window of ${width} pixels, ${theme}`, async () => {
      const one = await PlannerWindow.open(server.url, { size: { width, height }, theme });
      try {
        await one.at_rest();
        await one.tab('Movement');
        await one.click(one.page.locator('[data-key="cephalometry"]'));
        const dialog = one.page.locator('dialog.cephalometry');
        await dialog.locator('img').waitFor();
        if (process.env.OCTOTOMY_PICTURES) await one.page.screenshot({ path: path.join(process.env.OCTOTOMY_PICTURES, `cephalometry_${width}_${theme}.png`) });
        const tracing = path.join(folder, 'tracing.png');
        const said = JSON.parse(execFileSync(program, ['cephalometry', path.join(folder, 'face.plan.json'), '-o', tracing, '--json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }));
        const text = (await dialog.innerText()).replace(/\u202f/g, ' ');
        assert.ok(said.measures.length > 5);
        for (const row of said.measures) {
          const line = (await dialog.locator('tbody tr', { hasText: `${row.name},` }).first().innerText()).replace(/\u202f/g, ' ');
          for (const value of [row.before, row.after]) assert.ok(line.includes(`${shown(value.value)} ± ${shown(value.half_width)}`), `${line} for ${JSON.stringify(row)}`);
          if (row.norm === null) continue;
          assert.ok(line.includes(`${shown(row.norm)} ± ${shown(row.deviation)}`) && line.includes(row.source), line);
          assert.ok(row.norm_of.length > 20 && text.includes(`${row.source}: ${row.norm_of}`), text);
        }
        const source = await dialog.locator('img').getAttribute('src');
        assert.ok(Buffer.from(source.split(',')[1], 'base64').equals(fs.readFileSync(tracing)), 'the tracing is the command line\'s');
        assert.deepEqual(await violations(one, 'cephalometry'), []);
        assert.deepEqual(await one.page.evaluate(beside, 'cephalometry'), []);
        assert.deepEqual(one.problems, []);
      } finally {
        await one.close();
      }
    });

// SPDX-License-Identifier: AGPL-3.0-or-later
// axe-core finds no violation on any screen, in light and dark: names, roles, order of headings, landmarks of the page, and a
// contrast of at least 4.5 of all text. Nothing reaches out of windows of four widths.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';
import { beside, violations } from './screen_checks.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-accessibility-'));
const jaw = [{ view: 'anterior', polygons_mm: [[[-40, -60], [40, -60], [40, -25], [-40, -25]]] }, { view: 'left', polygons_mm: [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]] }];

before(() => {
  lay_phantom(folder, 2);
  fs.writeFileSync(path.join(folder, 'jaw.plan.json'), JSON.stringify({
    octotomy_plan: 1, name: 'jaw', scans: { ct: { path: 'head_phantom.nrrd' } },
    steps: [
      { id: 'landmarks', do: 'landmarks', points: [{ name: 'nasion', point_mm: [0, -84, 10] }, { name: 'menton', point_mm: [0, -82, -101] }] },
      { id: 'skull', do: 'window', scan: 'ct', low: 300 },
      { id: 'cut', do: 'mask', regions: jaw },
      { id: 'rest', do: 'combine', expression: 'skull - cut' },
      { id: 'piece', do: 'combine', expression: 'skull & cut' },
      { id: 'moved', do: 'move', object: 'piece', by: { forward_mm: 6 } },
      { id: 'overlap', do: 'combine', expression: 'rest & moved' },
      { id: 'height', do: 'measure', points_mm: ['nasion', 'menton'] },
    ],
  }));
});
after(() => fs.rmSync(folder, { recursive: true, force: true }));

/// Names of screens, and what brings each from the planner at rest.
const screens = {
  steps: (one) => one.tab('Steps'),
  objects: (one) => one.tab('Objects'),
  history: (one) => one.tab('History'),
  inspector: async (one) => {
    await one.tab('Steps');
    await one.select('moved');
    await one.tab('Inspector');
  },
  numbers: (one) => one.tab('Numbers'),
  movement: (one) => one.tab('Movement'),
  ...Object.fromEntries([['window', 'w'], ['region', 'r'], ['move', 'g'], ['marks', 'j'], ['landmark', 'l'], ['distance', 'd'], ['segment', 'p'], ['cut plane', 'k'], ['compare', 'c'], ['palette', 'Control+k'], ['help', '?'], ['open', 'Control+o'], ['export', 'Control+e']]
    .map(([name, key]) => [name, (one) => one.press(key)])),
  ...Object.fromEntries(['Procedure from landmarks', "Show the scan's audit", 'Outcome of the operation', 'New branch', 'Add step: measure', 'Tool: Dental arch', 'Tool: Brush', 'Views and slices', 'Radiograph and landmarks']
    .map((name) => [name, (one) => one.command(name)])),
};

for (const [width, height] of [[390, 844], [820, 1180], [1024, 768], [1440, 900]])
  test(`nothing reaches out of a window of ${width} pixels`, async () => {
    const server = await start_server(folder);
    const one = await PlannerWindow.open(server.url, { size: { width, height } });
    try {
      const found = [];
      await one.page.locator('.start .offers').waitFor();
      found.push(...(await one.page.evaluate(beside, 'start')));
      await one.page.locator('.offer').nth(2).click();
      await one.page.locator('.picker .file', { hasText: 'jaw.plan.json' }).click();
      await one.page.locator('.plan-name', { hasText: 'jaw' }).waitFor({ state: 'attached' });
      await one.page.waitForTimeout(300);
      const go_on = one.page.getByRole('button', { name: 'Continue' });
      if (await go_on.isVisible()) await go_on.click();
      await one.press('Escape');
      await one.at_rest();
      // Scanners state numbers of 64 letters.
      await one.page.locator('.bar .patient .words').evaluate((words) => { words.textContent = `head_neck_ex1 · ${'1.3.6.1.4.1.9590'.repeat(4)}`; });
      found.push(...(await one.page.evaluate(beside, 'a long patient')));
      for (const name of ['steps', 'window', 'numbers', 'Procedure from landmarks', 'help', 'export']) {
        await screens[name](one);
        await one.page.waitForTimeout(200);
        found.push(...(await one.page.evaluate(beside, name)));
        for (let i = 0; i < 2; ++i) await one.press('Escape');
      }
      assert.deepEqual(found, []);
    } finally {
      await one.close();
      server.stop();
    }
  });

for (const theme of ['light', 'dark'])
  test(`no screen has a violation, ${theme}`, async () => {
    // A new server begins with the start page.
    const server = await start_server(folder);
    const one = await PlannerWindow.open(server.url, { theme });
    try {
      const found = [];
      await one.page.locator('.start .offers').waitFor();
      if (await one.page.locator('.recent').count() === 0) await one.page.waitForTimeout(300);
      found.push(...(await violations(one, 'start')));
      await one.click('Scan or plan');
      await one.page.locator('.picker .file').first().waitFor();
      found.push(...(await violations(one, 'picker')));
      await one.click(one.page.locator('.picker .file', { hasText: 'jaw.plan.json' }));
      await one.page.locator('.plan-name', { hasText: 'jaw' }).waitFor({ state: 'attached' });
      const go_on = one.page.getByRole('button', { name: 'Continue' });
      await one.page.waitForTimeout(300);
      if (await go_on.isVisible()) {
        found.push(...(await violations(one, 'audit')));
        await one.click(go_on);
      }
      await one.press('Escape');
      await one.at_rest();
      for (const [name, bring] of Object.entries(screens)) {
        await bring(one);
        await one.page.waitForTimeout(200);
        found.push(...(await violations(one, name)));
        for (let i = 0; i < 2; ++i) await one.press('Escape');
        if (name === 'cut plane') await one.press('k');
        if (name === 'compare') await one.press('c');
        const cancel = one.page.locator('.inspector').getByRole('button', { name: 'Cancel', exact: true });
        if (await cancel.count()) await cancel.first().click();
      }
      assert.deepEqual([...new Set(found)], []);
      assert.deepEqual(one.problems, []);
    } finally {
      await one.close();
      server.stop();
    }
  });

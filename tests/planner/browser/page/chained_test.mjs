// SPDX-License-Identifier: AGPL-3.0-or-later
// The three planned operations of the thesis's chapter 8 on the head phantom, each with a genioplasty after it: procedures
// chosen by name, values typed into their forms. The page's plan is the command line's, and so are its outcomes.
//   OCTOTOMY_CASES=kufner,mandible,two_jaw node --test chained_test.mjs
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, program, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-chained-'));
const marks = {
  piriform_left: [12, -84, -25], piriform_right: [-12, -84, -25], buttress_left: [30, -68, -28], buttress_right: [-30, -68, -28],
  pterygoid_left: [20, -39, -30], pterygoid_right: [-20, -39, -30], incisor: [0, -85, -57.5], molar_left: [27, -52, -57.5], molar_right: [-27, -52, -57.5],
  orbital_rim_left: [25, -75, -7], orbital_rim_right: [-25, -75, -7], lateral_rim_left: [51, -66, 13], lateral_rim_right: [-51, -66, 13],
  zygoma_left: [60, -42, -13], zygoma_right: [-60, -42, -13],
  split_front_left: [39, -46, -80], split_front_right: [-39, -46, -80], split_back_left: [46.5, -25, -45], split_back_right: [-46.5, -25, -45],
  lower_incisor: [0, -84, -61], lower_molar_left: [27, -54, -61], lower_molar_right: [-27, -54, -61], menton: [0, -82, -101],
  condyle_left: [50, -6, -13], condyle_right: [-50, -6, -13], notch_left: [47, -20, -30], notch_right: [-47, -20, -30],
  coronoid_left: [47, -37, -22], coronoid_right: [-47, -37, -22],
  foramen_left: [22, -74, -82], foramen_right: [-22, -74, -82], border_left: [33, -55, -91], border_right: [-33, -55, -91], pogonion: [0, -87, -93],
};
// `outcome`: landmarks of a moved piece and the displacements that were typed for them, forward, left and up.
const cases = [
  { name: 'kufner', button: /^Kufner/, values: { forward_mm: 15, up_mm: -1 }, chin: { forward_mm: 4 }, outcome: { midface_moved: { molar_left: [15, 0, -1] } } },
  {
    name: 'mandible', button: /^Repositioning of the mandible/, values: { forward_mm: 1, left_mm: -2, front_up_mm: 2, back_up_mm: -41.1 }, chin: { forward_mm: 4 },
    outcome: { mandible_moved: { lower_incisor: [1, -2, 2], condyle_left: [null, -2, -41.1] } },
  },
  {
    name: 'two_jaw', button: /^Two-jaw/,
    values: { upper_left_mm: 2, upper_front_up_mm: 7, upper_back_up_mm: 3, lower_forward_mm: 9, lower_left_mm: 2, lower_front_up_mm: 6, lower_back_up_mm: 2 },
    chin: { left_mm: -4 }, outcome: { maxilla_moved: { incisor: [0, 2, 7], molar_left: [null, 2, 3] }, distal_moved: { lower_incisor: [9, 2, 6], lower_molar_left: [null, 2, 2] } },
  },
].filter(({ name }) => (process.env.OCTOTOMY_CASES ?? 'two_jaw').split(',').includes(name));
const near_mm = 0.001;
let server;
let one;

before(async () => {
  lay_phantom(folder, 2);
  for (const { name } of cases)
    fs.writeFileSync(path.join(folder, `${name}.plan.json`), JSON.stringify({
      octotomy_plan: 1, name, scans: { ct: { path: 'head_phantom.nrrd' } }, universe: { voxel_mm: 1 },
      steps: [{ id: 'landmarks', do: 'landmarks', points: Object.entries(marks).map(([mark, point_mm]) => ({ name: mark, point_mm })) }],
    }));
  server = await start_server(folder);
  one = await PlannerWindow.open(server.url);
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

async function open(name) {
  await one.click(one.page.locator('.brand'));
  await one.click('Scan or plan');
  await one.click(one.page.locator('.file', { hasText: `${name}.plan.json` }));
  await one.until(async () => (await one.page.locator('.plan-name').innerText()) === name, `${name} open`);
  const go_on = one.page.getByRole('button', { name: 'Continue' });
  if (await go_on.isVisible()) await one.click(go_on);
  await one.press('Escape');
}

/// Chooses a procedure, types its values and plans it.
async function perform(button, values, done, what) {
  await one.click(one.page.locator('.bar').getByRole('button', { name: 'Procedure' }));
  await one.click(one.page.locator('dialog').getByRole('button', { name: button }).first());
  for (const [name, value] of Object.entries(values)) {
    await one.page.locator(`dialog input[name="${name}"]`).fill(String(value));
    one.actions++;
  }
  await one.click('Plan it');
  await one.until(done, what);
}

/// The plan that the command line writes for the same landmarks and values.
function typed(name, values, chin) {
  const file = path.join(folder, 'marks.json'), first = path.join(folder, 'first.plan.json'), both = path.join(folder, 'both.plan.json');
  fs.writeFileSync(file, JSON.stringify({ landmarks: Object.entries(marks).map(([mark, point_mm]) => ({ name: mark, point_mm })) }));
  const sets = (typed_values) => Object.entries(typed_values).flatMap(([key, value]) => ['--set', `${key}=${value}`]);
  execFileSync(program, ['procedure', name, '--scan', path.join(folder, 'head_phantom.nrrd'), '--voxel', '1', '--landmarks', file, ...sets(values), '-o', first], { stdio: 'ignore' });
  execFileSync(program, ['procedure', 'genioplasty', '--after', first, '--landmarks', file, ...sets(chin), '-o', both], { stdio: 'ignore' });
  return both;
}

for (const { name, button, values, chin, outcome } of cases)
  test(`${name} and a chin after it are one plan, the command line's, with the outcomes that were typed`, async () => {
    await open(name);
    const plan_path = path.join(folder, `${name}.plan.json`);
    const plan = () => one.plan(plan_path);
    const has = (id) => () => plan().steps.some((step) => step.id === id);
    await perform(button, values, has('planned'), `${name} planned`);
    await perform(/^Sliding genioplasty/, chin, has('genioplasty_planned'), 'the chin planned');
    const both = typed(name, values, chin);
    const without_marks = (steps) => steps.filter((step) => step.do !== 'landmarks');
    assert.deepEqual(without_marks(plan().steps), without_marks(JSON.parse(fs.readFileSync(both, 'utf8')).steps));

    // What was typed stands in the plan, not in the page: planned again after a reload it is the same.
    const steps_before = plan().steps;
    await one.page.reload();
    for (const [again, chosen] of [[/^Sliding genioplasty/, chin], [button, values]]) {
      await one.click(one.page.locator('.bar').getByRole('button', { name: 'Procedure' }));
      await one.click(one.page.locator('dialog').getByRole('button', { name: again }).first());
      await one.page.locator('dialog [data-key="is-planned"]').waitFor();
      for (const [key, value] of Object.entries(chosen))
        assert.equal(await one.page.locator(`dialog input[name="${key}"]`).inputValue(), String(value), key);
      assert.equal(await one.page.locator('dialog [data-key="in-doubt"]').count(), 0);
      if (again === button) break;
      await one.click('Plan it');
      await one.until(async () => (await one.page.locator('dialog').count()) === 0, 'planned again');
      assert.deepEqual(plan().steps, steps_before);
    }
    await one.press('Escape');

    // Certified in the page; no object is contradicted.
    await one.press('Control+Enter');
    const badges = one.page.locator('.numbers .badge:not(.none)');
    await one.until(async () => (await badges.count()) >= 6, 'badges', 900000);
    console.log(`${name}: ${(await badges.allInnerTexts()).join(' ')}`);
    assert.deepEqual(await one.page.locator('.numbers tr', { has: one.page.locator('.badge.fail') }).locator('th').allInnerTexts(), []);

    // Numbers of the page's own plan and of the command's, and where the landmarks came to lie.
    const numbers = (file) => {
      const { status, stdout, stderr } = spawnSync(program, ['run', file, '-o', `${file}.report`, '--certify', 'never', '--json'], { maxBuffer: 1 << 28, encoding: 'utf8' });
      assert.equal(status, 0, stderr);
      const made = JSON.parse(stdout);
      return { objects: made.objects.map((object) => [object.id, object.voxel?.volume_mm3]), movements: made.movements, measurements: made.measurements };
    };
    const ours = numbers(plan_path), theirs = numbers(both);
    assert.deepEqual(ours.objects, theirs.objects);
    assert.deepEqual(ours.measurements, theirs.measurements);
    const turned = (id) => without_marks(plan().steps).find((step) => step.id === id);
    for (const [moved, wanted] of Object.entries(outcome)) {
      const movement = ours.movements.find((each) => each.object === moved);
      for (const [mark, by] of Object.entries(wanted)) {
        const found = movement.landmarks.find((each) => each.name === mark);
        assert.ok(found, `${mark} on ${moved}, ${JSON.stringify(turned(moved))}`);
        [found.forward_mm, found.left_mm, found.up_mm].forEach((mm, i) => assert.ok(by[i] === null || Math.abs(mm - by[i]) < near_mm, `${mark}: ${found.words}`));
      }
    }
    const chin_moved = ours.movements.find((each) => each.object === 'genioplasty_chin_moved');
    for (const [key, mm] of Object.entries(chin)) assert.ok(Math.abs(chin_moved.centroid[key] - mm) < near_mm, chin_moved.words);
    assert.deepEqual(one.problems, []);
  });

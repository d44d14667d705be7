// SPDX-License-Identifier: AGPL-3.0-or-later
// On the head phantom, what the page shows is the plan's own: whom it is about, values of one plan in the next, objects after
// a procedure is undone, a plan that another program wrote, a mirror's plane, interference within bone, differences.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-truthful-'));
const plan_path = path.join(folder, 'one.plan.json'), other_path = path.join(folder, 'other.plan.json');
const marks = {
  piriform_left: [12, -84, -25], piriform_right: [-12, -84, -25], buttress_left: [30, -68, -28], buttress_right: [-30, -68, -28],
  pterygoid_left: [20, -39, -30], pterygoid_right: [-20, -39, -30], incisor: [0, -85, -57.5], molar_left: [27, -52, -57.5], molar_right: [-27, -52, -57.5],
};
const plan_of = (name, low) => ({
  octotomy_plan: 1, name, scans: { ct: { path: 'head_phantom.nrrd' } },
  steps: [
    { id: 'landmarks', do: 'landmarks', points: Object.entries(marks).map(([mark, point_mm]) => ({ name: mark, point_mm })) },
    { id: 'bone', do: 'window', scan: 'ct', low },
  ],
});
let server;
let one;
const newest = (pane) => one.frames.filter(({ header }) => header.pane === pane).pop()?.header;
const written = () => one.plan(plan_path);

async function open(name) {
  await one.click(one.page.locator('.brand'));
  await one.click('Scan or plan');
  await one.click(one.page.locator('.file', { hasText: `${name}.plan.json` }));
  await one.until(async () => (await one.page.locator('.plan-name').innerText()) === name, `${name} open`);
  const go_on = one.page.getByRole('button', { name: 'Continue' });
  if (await go_on.isVisible()) await one.click(go_on);
  await one.press('Escape');
  await one.at_rest();
}

before(async () => {
  lay_phantom(folder, 2);
  fs.writeFileSync(plan_path, JSON.stringify(plan_of('one', 300)));
  fs.writeFileSync(other_path, JSON.stringify(plan_of('other', 662)));
  server = await start_server(folder);
  one = await PlannerWindow.open(server.url);
  await open('one');
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('the page says whom the plan is about, and hides it on demand', async () => {
  const patient = one.page.locator('.bar .patient');
  assert.match(await patient.innerText(), /patient not stated/);
  await one.click(patient);
  await one.until(async () => /patient hidden/.test(await patient.innerText()), 'the patient hidden');
  await one.command("Show the scan's audit");
  assert.match(await one.page.locator('dialog .facts').first().innerText(), /patient hidden/);
  const [controls, tab_index] = await one.page.locator('dialog .dialog-body').evaluate((body) => [body.querySelectorAll('button, a, input').length, body.tabIndex]);
  assert.ok(controls > 0 || tab_index === 0, 'keys can scroll the audit');
  await one.press('Escape');
  await one.click(patient);
  await one.until(async () => /not stated/.test(await patient.innerText()), 'the patient shown');
});

test('no value of a tool or a procedure goes into another plan', async () => {
  await open('other');
  await one.press('w');
  await one.until(async () => (await one.page.locator('[data-key="low"]').inputValue()) === '662', 'its own threshold');
  await one.click(one.page.locator('.bar').getByRole('button', { name: 'Procedure' }));
  await one.click(one.page.locator('dialog').getByRole('button', { name: /^Le Fort I/ }).first());
  const forward = one.page.locator('dialog [name="forward_mm"]');
  const usual = await forward.inputValue();
  assert.equal(await one.page.locator('dialog [name="bone_low"]').inputValue(), '662', "this plan's bone");
  await forward.fill('9');
  await forward.press('Tab');
  await one.press('Escape');
  await open('one');
  assert.equal(await one.page.locator('[data-key="low"]').count(), 0, 'the tool is put down');
  await one.press('w');
  await one.until(async () => (await one.page.locator('[data-key="low"]').inputValue()) === '300', 'the threshold of this plan');
  await one.press('Escape');
  await one.click(one.page.locator('.bar').getByRole('button', { name: 'Procedure' }));
  await one.click(one.page.locator('dialog').getByRole('button', { name: /^Le Fort I/ }).first());
  assert.equal(await forward.inputValue(), usual);
  assert.equal(await one.page.locator('dialog [name="bone_low"]').inputValue(), '300');
  await one.press('Escape');
});

test('a tool that is taken by its key shows its rows, whatever was in sight', async () => {
  await one.tab('Numbers');
  await one.press('w');
  await one.page.locator('[data-key="low-range"]').waitFor();
  await one.press('Escape');
  await one.command('Add step: smooth');
  await one.press('w');
  await one.page.locator('[data-key="low-range"]').waitFor();
  assert.ok(await one.page.locator('[data-key="draft-id"]').isVisible(), 'and the draft stays');
  await one.press('Escape');
  await one.click(one.page.locator('.inspector').getByRole('button', { name: 'Cancel', exact: true }));
});

test('why a scan cannot be made is said at its step, though nothing uses it yet', async () => {
  await one.command('Add step: n4 bias field');
  await one.click(one.page.locator('.inspector').getByRole('button', { name: 'Add step' }));
  const error = one.page.locator('.lists .error');
  await error.waitFor();
  assert.match(await error.innerText(), /no magnetic field to correct/);
  await one.press('Control+z');
  await one.until(async () => (await error.count()) === 0, 'the step taken back');
});

test('an error of one plan is not shown over the next', async () => {
  await one.command('Add step: combine');
  await one.click(one.page.locator('.inspector').getByRole('button', { name: 'Add step' }));
  await one.page.locator('.notice.error').waitFor();
  await one.click(one.page.locator('.inspector').getByRole('button', { name: 'Cancel', exact: true }));
  await open('other');
  assert.equal(await one.page.locator('.notice.error').count(), 0);
  await open('one');
});

test('pieces that only meet in an overlap stay in sight, also where they are joined first', async () => {
  await open('other');
  await one.click(one.page.locator('.bar').getByRole('button', { name: 'Procedure' }));
  await one.click(one.page.locator('dialog').getByRole('button', { name: 'Le Fort I in two pieces' }));
  await one.page.locator('dialog [name="up_mm"]').fill('3');
  await one.page.locator('dialog [name="bone_low"]').fill('300');
  await one.click('Plan it');
  for (const object of ['rest', 'left_moved', 'right_moved', 'overlap']) await one.shows(0, object);
  assert.deepEqual(newest(0).objects.filter((id) => ['skull', 'maxilla', 'planned', 'maxilla_moved'].includes(id)), []);
  await one.at_rest();
  assert.ok((await red_pixels(0)) > 20, 'the overlap in red');
  await one.press('Control+z');
  await one.until(() => !one.plan(other_path).steps.some(({ id }) => id === 'overlap'), 'the procedure taken back');
  await open('one');
});

test('a pane that was out of sight shows what the plan became meanwhile', async () => {
  await one.press('Shift+1');
  await one.at_rest();
  await one.click(one.page.locator('.pane').nth(1).getByRole('button', { name: /Enlarge this pane/ }));
  await one.at_rest();
  await one.tab('Steps');
  await one.select('bone');
  await one.press('w');
  await one.type('low', 500);
  await one.click(one.page.locator('[data-key="apply-window"]'));
  await one.until(() => written().steps.find((step) => step.id === 'bone').low === 500, 'another threshold');
  await one.at_rest();
  const before = newest(0).id;
  await one.press('m');
  await one.at_rest();
  assert.ok(newest(0).id > before, 'a picture of the plan as it is');
  await one.press('Control+z');
  await one.until(() => written().steps.find((step) => step.id === 'bone').low === 300, 'the threshold again');
});

test('settings of tools end with their plan', async () => {
  await one.command('Tool: Brush');
  await one.type('brush-radius', 12);
  await one.click(one.page.locator('[data-key="brush-Paint"]'));
  await one.press('Escape');
  await one.press('l');
  const snap = one.page.locator('.check', { hasText: 'Snap to the surface' }).locator('input');
  await snap.uncheck();
  await one.click(one.page.getByRole('button', { name: 'More for bone' }).first());
  assert.equal(await one.page.getByRole('menuitem').count() > 0, true);
  await open('other');
  assert.equal(await one.page.locator('.menu:not([hidden])').count(), 0, 'no menu of the plan before');
  await one.press('l');
  await one.until(() => snap.isVisible(), 'the landmark tool');
  assert.ok(await snap.isChecked(), 'landmarks snap again');
  await one.press('Escape');
  await one.command('Tool: Brush');
  await one.until(async () => (await one.page.locator('[data-key="brush-radius"]').inputValue()) === '5', 'the usual radius');
  assert.equal(await one.page.locator('[data-key="brush-Erase"]').getAttribute('aria-pressed'), 'true');
  await one.press('Escape');
  await open('one');
});

test('a threshold is followed by coarse pictures, and one at rest comes after the last', async () => {
  await one.press('w');
  const slider = one.page.locator('[data-key="low-range"]');
  await slider.waitFor();
  await one.at_rest();
  const before = await one.page.evaluate(() => window.pictures.length);
  for (const low of [320, 340, 360, 380]) await slider.fill(String(low));
  await one.at_rest();
  const came = await one.page.evaluate((from) => window.pictures.slice(from).map(({ quality }) => quality), before);
  assert.ok(came.includes('moving'), `${came}`);
  assert.equal(came.pop(), 'rest');
  await one.press('Escape');
  await one.at_rest();
});

test('what an object loses is said beside its number', async () => {
  const changed = written();
  changed.steps.push({ id: 'painted', do: 'brush', object: 'bone', mode: 'paint', strokes: [{ points_mm: [[0, -120, 0], [0, -140, 0]], radius_mm: 20 }] });
  fs.writeFileSync(other_path, JSON.stringify({ ...changed, name: 'other' }));
  await open('other');
  await one.select('painted');
  await one.tab('Inspector');
  await one.page.locator('.inspector .sentence.warn', { hasText: 'reaches the border of the universe' }).waitFor();
  await one.tab('Numbers');
  await one.page.locator('.inspector .sentence.warn', { hasText: 'reaches the border of the universe' }).waitFor();
  await open('one');
});

test('a procedure that is undone leaves what was shown before', async () => {
  await one.until(() => newest(0)?.objects?.includes('bone'), 'bone shown');
  await one.click(one.page.locator('.bar').getByRole('button', { name: 'Procedure' }));
  await one.click(one.page.locator('dialog').getByRole('button', { name: /^Le Fort I/ }).first());
  await one.click('Plan it');
  await one.until(() => newest(0)?.objects?.length && !newest(0).objects.includes('bone'), 'the pieces in its place');
  await one.press('Control+z');
  await one.until(() => newest(0)?.objects?.includes('bone'), 'bone shown again');
  await one.press('Control+y');
  await one.until(() => newest(0)?.objects?.length && !newest(0).objects.includes('bone'), 'the pieces again');
  await one.press('Control+z');
  await one.until(() => newest(0)?.objects?.includes('bone'), 'bone at last');
});

test('a plan that another program wrote is not called saved, and a button loads it', async () => {
  const changed = written();
  changed.name = 'changed outside';
  fs.writeFileSync(plan_path, JSON.stringify(changed));
  await one.press('Control+s');
  const notice = one.page.locator('.notice.error', { hasText: 'another program wrote this file' });
  await notice.waitFor();
  assert.equal(await one.page.locator('.notice', { hasText: 'Saved.' }).count(), 0);
  await one.click(notice.getByRole('button', { name: "Load the plan's file" }));
  await one.until(async () => (await one.page.locator('.plan-name').innerText()) === 'changed outside', 'the file as it is');
  await one.at_rest();
  await one.press('Control+s');
  await one.page.locator('.notice', { hasText: 'Saved.' }).waitFor();
});

test('a mirror image is about the plane that fits, which is shown with its residual and can be moved', async () => {
  await one.select('bone');
  await one.command('Mirror the selected object');
  const twin = () => written().steps.find((step) => step.do === 'mirror');
  assert.equal((await one.until(twin, 'the mirror step')).fit, true);
  await one.until(async () => /Fitted: .* mm apart/.test(await one.page.locator('.inspector').innerText()), 'the residual');
  await one.type('bone_mirrored.plane', 2);
  await one.until(() => twin().normal, 'the plane in the plan');
  assert.equal(twin().fit, undefined);
  assert.ok(Math.abs(Math.abs(twin().point_mm.reduce((sum, x, i) => sum + x * twin().normal[i], 0)) - 2) < 1, `${twin().point_mm}`);
  // The handle in the middle of the plane's trace moves it along its normal.
  await one.at_rest();
  const { cross_mm: cross } = await one.look();
  const { point_mm, normal } = twin();
  const along = (p) => p.reduce((sum, x, i) => sum + x * normal[i], 0);
  const away = (along(point_mm) - along(cross)) / (normal[0] ** 2 + normal[2] ** 2);
  const handle = [cross[0] + normal[0] * away, cross[2] + normal[2] * away];
  await one.drag(0, handle, [handle[0] + 5 * normal[0], handle[1] + 5 * normal[2]]);
  await one.until(() => Math.abs(along(twin().point_mm) - along(point_mm)) > 1, 'the plane moved by hand');
  assert.ok(Math.abs(along(twin().point_mm) - along(point_mm) - 5) < 1.5, `${twin().point_mm} from ${point_mm}`);
  for (let i = 0; i < 3; ++i) await one.press('Control+z');
  await one.until(() => !twin(), 'the plan as before');
});

test('interference shows through bone, and a button goes to it', async () => {
  const changed = written();
  changed.steps.push(
    { id: 'cut', do: 'mask', regions: [{ view: 'anterior', polygons_mm: [[[-40, -60], [40, -60], [40, -25], [-40, -25]]] },
      { view: 'left', polygons_mm: [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]] }] },
    { id: 'piece', do: 'combine', expression: 'bone & cut' }, { id: 'rest', do: 'combine', expression: 'bone - cut' },
    { id: 'moved', do: 'move', object: 'piece', by: { forward_mm: -3, up_mm: 3 } }, { id: 'both', do: 'combine', expression: 'rest & moved' },
  );
  fs.writeFileSync(other_path, JSON.stringify({ ...changed, name: 'other' }));
  await open('other');
  await one.until(() => newest(0)?.objects?.includes('both'), 'the overlap drawn');
  await one.tab('Numbers');
  await one.page.locator('[data-key="show-both"]').waitFor();
  await one.at_rest();
  assert.ok((await red_pixels(0)) > 50, 'red shows through the bone');
  await one.click(one.page.locator('[data-key="show-both"]'));
  const mark = one.page.locator('.status', { hasText: /largest of \d+ parts? of both/ });
  await mark.waitFor();
  // What it says need not be true of another state of the plan.
  await one.select('moved');
  await one.press('g');
  await one.type('move-up_mm', 3.5);
  await one.until(async () => (await mark.count()) === 0, 'the mark gone');
  await one.press('Escape');
  await one.press('Control+z');
  await one.until(() => one.plan(other_path).steps.find((each) => each.id === 'moved').by.up_mm === 3, 'the plan as before');
});

test('the point about which a piece turns is the plan\'s', async () => {
  const about = one.page.locator('[data-key="move-about"]');
  const turn = () => one.plan(other_path).steps.find((each) => each.id === 'moved').turn;
  await one.select('moved');
  await one.press('g');
  assert.equal(await about.locator('option:checked').innerText(), 'its middle');
  await about.selectOption('cross');
  await one.until(() => turn(), 'the cross-hair in the plan');
  const stated = turn().about_mm.map((x) => x.toFixed(1).replace('-', '−')).join(', ');
  await one.until(async () => (await about.locator('option:checked').innerText()) === stated, `${stated} in the form`);
  // Another number leaves it there.
  const before = turn().about_mm;
  await one.type('move-pitch_deg', 2);
  await one.until(() => turn().pitch_deg === 2, 'a turn');
  assert.deepEqual(turn().about_mm, before);
  // A number that is typed is taken back by an undo, in the form too, and is no other piece's.
  const up = one.page.locator('[data-key="move-up_mm"]');
  const up_mm = () => one.plan(other_path).steps.find((each) => each.id === 'moved').by.up_mm;
  await up.fill('9');
  await one.until(() => one.waiting.size === 0, 'what is typed is shown');
  await one.press('Control+z');
  await one.until(async () => up_mm() === 3 && (await up.inputValue()) === '3', 'the plan\'s number in the form');
  await one.select('rest');
  await one.until(async () => (await up.inputValue()) === '0', 'the motion of another piece');
  await one.press('Escape');
  for (let i = 0; i < 2; ++i) await one.press('Control+z');
  await one.until(() => !turn(), 'the plan as before');
});

test('colours of a distance end with their objects', async () => {
  const edits = () => one.plan(other_path).steps.map((step) => step.id);
  await one.select('piece');
  await one.command('Mirror the selected object');
  await one.until(() => edits().includes('piece_mirrored'), 'a mirror image');
  await one.until(() => one.waiting.size === 0, 'it is evaluated');
  await one.select('piece_mirrored');
  for (const key of ['c', 't']) {
    await one.press(key);
    await one.page.locator('[data-key="compare-object"]').waitFor();
    await one.press('Control+z');
    await one.until(() => !edits().includes('piece_mirrored'), 'the mirror image taken back');
    await one.until(async () => (await one.page.locator('[data-key="compare-object"]').count()) === 0, 'the choice of colours gone');
    await one.until(async () => (await one.page.locator('.legend:visible').count()) === 0, 'the legend gone');
    assert.ok((await one.look()).panes.every((pane) => pane.only === undefined), 'no pane shows one object alone');
    if (key === 't') break;
    await one.press('Control+y');
    await one.until(() => edits().includes('piece_mirrored'), 'the mirror image again');
    await one.until(() => one.waiting.size === 0, 'it is evaluated');
    await one.select('piece_mirrored');
  }
  await one.press('Shift+1');
  await one.at_rest();
});

test('the tissue window follows an undo of its step', async () => {
  const low = one.page.locator('[data-key="low"]'), make = one.page.locator('[data-key="apply-window"]');
  const bone = () => one.plan(other_path).steps.find((step) => step.id === 'bone').low;
  await one.select('bone');
  await one.press('w');
  const first = bone();
  await low.fill('444');
  await low.press('Tab');
  await one.click(make);
  await one.until(() => bone() === 444, 'the threshold in the plan');
  await one.press('w');
  assert.equal(await low.inputValue(), '444');
  await one.press('Control+z');
  await one.until(() => bone() === first, 'the threshold taken back');
  await one.until(async () => (await low.inputValue()) === String(first), 'the threshold of the plan in the tool');
  assert.equal(await make.innerText(), 'Set bone');
  await one.press('Escape');
});

test('the difference to another object is redrawn at each step of a drag', async () => {
  await one.tab('Inspector');
  await one.select('moved');
  await one.press('0');
  await one.press('g');
  await one.page.locator('[data-key="move-difference"]').selectOption('rest');
  const settled = () => newest(1)?.quality === 'rest' && newest(1).difference;
  const at_first = await one.until(() => settled()?.to === 'rest' && settled(), 'the difference at rest');
  const whole = (part) => part.only_moved_mm3 + part.common_mm3;
  const reading = async () => (await one.page.locator('.inspector .difference').allInnerTexts()).join();
  await one.at_rest();
  const { x, y } = await one.position(1, [-55, -40]);
  await one.page.mouse.move(x, y);
  await one.page.mouse.down();
  const read = new Set();
  for (const step_px of [12, 24, 36]) {
    const before = await reading();
    await one.page.mouse.move(x - step_px, y);
    read.add(await one.until(async () => {
      const now = await reading();
      return now !== before && !read.has(now) && now;
    }, 'another difference under the hand'));
  }
  if (process.env.OCTOTOMY_PICTURES) await one.page.screenshot({ path: path.join(process.env.OCTOTOMY_PICTURES, 'difference.png') });
  await one.page.mouse.up();
  const by = () => one.plan(other_path).steps.find((each) => each.id === 'moved').by;
  await one.until(() => by().forward_mm > -2, 'the motion in the plan');
  await one.until(() => settled() && settled().common_mm3 !== at_first.common_mm3, 'the difference after it');
  assert.ok(Math.abs(whole(newest(1).difference) / whole(at_first) - 1) < 0.02, 'the piece keeps its volume');
  await one.page.locator('[data-key="move-difference"]').selectOption('');
  await one.until(() => newest(1)?.difference === undefined, 'the objects as they were');
});

/// Pixels of a pane in which red prevails by far.
const red_pixels = (pane) => one.page.evaluate((number) => {
  const canvas = document.querySelectorAll('.pane canvas')[number];
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i] > data[i + 1] + 40 && data[i] > data[i + 2] + 40) count++;
  return count;
}, pane);

test('the console stayed empty', () => assert.deepEqual(one.problems, []));

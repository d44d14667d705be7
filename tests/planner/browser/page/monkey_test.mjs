// SPDX-License-Identifier: AGPL-3.0-or-later
// Random plans of ten steps on the head phantom, clicked together with every tool, command and procedure. After each step the
// page's numbers are the command line's and so are the pictures that it shows, nothing failed without a word, the console is
// empty and every request is answered.
//   OCTOTOMY_MONKEY_PLANS=200 OCTOTOMY_MONKEY_SEED=1 node --test monkey_test.mjs
// Plan number i has the seed SEED + i, so that OCTOTOMY_MONKEY_PLANS=1 OCTOTOMY_MONKEY_SEED=17 clicks plan 17 again.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, program, start_server } from './planner_window.mjs';

const plans = Number(process.env.OCTOTOMY_MONKEY_PLANS ?? 2);
const first_seed = Number(process.env.OCTOTOMY_MONKEY_SEED ?? 1);
const steps_a_plan = 10;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-monkey-'));
const marks = {
  piriform_left: [12, -84, -25], piriform_right: [-12, -84, -25], buttress_left: [30, -68, -28], buttress_right: [-30, -68, -28],
  pterygoid_left: [20, -39, -30], pterygoid_right: [-20, -39, -30], incisor: [0, -85, -57.5], molar_left: [27, -52, -57.5], molar_right: [-27, -52, -57.5],
};
let server;
let one;
let plan_path;
let random;
const clicked = []; // in this plan
const done = new Map(); // how often each action was clicked
const plan = () => one.plan(plan_path);

/// Numbers from 0 to 1 that follow from a seed (mulberry32).
function numbers_of(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
}
const one_of = (list) => list[Math.floor(random() * list.length)];
const between = (low, high) => low + (high - low) * random();

/// A place in a pane, in shares of its canvas about the middle, where the head is.
const place = () => [between(0.3, 0.7), between(0.3, 0.7)];
async function canvas_at(pane, [x, y]) {
  const box = await one.page.locator('.pane canvas').nth(pane).boundingBox();
  return [box.x + x * box.width, box.y + y * box.height];
}
async function click_in(pane, at) {
  await one.page.mouse.click(...(await canvas_at(pane, at)));
}
async function shown_pane() {
  const panes = await one.page.evaluate(() => [...document.querySelectorAll('.pane')].flatMap((pane) => (pane.hidden ? [] : [Number(pane.dataset.pane)])));
  return one_of(panes);
}
async function points_with(key, count, end) {
  if (key.length === 1) await one.press(key);
  else await one.command(key);
  await one.at_rest();
  const pane = await shown_pane();
  for (let i = 0; i < count; ++i) await click_in(pane, place());
  if (end) await one.press(end);
}
async function select_random() {
  await one.tab('Steps');
  const rows = await one.page.locator('.lists .name').count();
  if (rows) await one.page.locator('.lists .name').nth(Math.floor(random() * rows)).click();
}

/// What a hand can do, by its name.
const actions = {
  async region() {
    await one.press('r');
    const pane = await shown_pane();
    const [[x, y], width, height] = [place(), between(0.05, 0.3), between(0.05, 0.3)];
    for (const corner of [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]) await click_in(pane, corner);
    await one.press('Enter');
  },
  cut: () => one.press('x'),
  async move() {
    await select_random();
    await one.press('g');
    await one.page.locator('.pane canvas').nth(await shown_pane()).focus();
    for (let i = 0; i < 4; ++i) await one.press(one_of(['w', 's', 'a', 'd', 'f', 'b']));
  },
  async drag() {
    await select_random();
    await one.press('g');
    await one.at_rest();
    const pane = await shown_pane();
    const [from, to] = [await canvas_at(pane, place()), await canvas_at(pane, place())];
    await one.page.mouse.move(...from);
    await one.page.mouse.down();
    await one.page.mouse.move(...to, { steps: 6 });
    await one.page.mouse.up();
  },
  async marks() {
    await select_random();
    await points_with('j', 2, 'Enter');
  },
  landmark: () => points_with('l', 1),
  distance: () => points_with('d', 2),
  angle: () => points_with('a', 3),
  async way() {
    await select_random();
    await points_with('Tool: Way along a surface', 2);
  },
  segment: () => points_with('p', 1),
  arch: () => points_with('Tool: Dental arch', 3, 'Enter'),
  async window() {
    if (random() < 0.5) await select_random();
    await one.press('w');
    await one.page.locator('[data-key="low"]').fill(String(Math.round(between(200, 900))));
    await one.page.locator('[data-key="low"]').press('Tab');
    await one.page.locator('[data-key="apply-window"]').click();
  },
  async mirror() {
    await select_random();
    await one.command('Mirror the selected object');
  },
  compare: () => one.press('c'),
  contacts: () => one.press('t'),
  cut_plane: () => one.press('k'),
  undo: () => one.press('Control+z'),
  redo: () => one.press('Control+y'),
  async branch() {
    await one.command('New branch');
    await one.press('Enter');
  },
  async name_version() {
    await one.command('Name this version');
    await one.press('Enter');
  },
  async history() {
    await one.tab('History');
    const rows = one.page.locator('.lists [role="tabpanel"] button');
    const count = await rows.count();
    if (count) await rows.nth(Math.floor(random() * count)).click();
  },
  async remove() {
    await select_random();
    await one.command('Remove the selected step');
  },
  async operation() {
    const names = await one.page.evaluate(async () => {
      dispatchEvent(new KeyboardEvent('keydown', { key: 'k', ctrlKey: true, cancelable: true }));
      const field = document.querySelector('.palette-field');
      field.value = 'Add step:';
      field.dispatchEvent(new Event('input'));
      return [...document.querySelectorAll('.palette-list [role="option"] span')].map((each) => each.firstChild.textContent);
    });
    await one.press('Escape');
    // Its example may read a file that is not here: then the page says so.
    const name = one_of(names.filter((each) => each.startsWith('Add step:')));
    clicked.push(`(${name})`);
    await one.command(name);
    await one.page.locator('.inspector').getByRole('button', { name: 'Add step' }).click();
  },
  async field() {
    await select_random();
    const fields = one.page.locator('.inspector .field input[type="number"]:visible');
    const count = await fields.count();
    if (!count) return;
    const field = fields.nth(Math.floor(random() * count));
    await field.fill(String(Math.round(between(1, 20))));
    await field.press('Enter');
  },
  async procedure() {
    await one.command('Procedure from landmarks');
    const names = one.page.locator('dialog .procedure, dialog .presets button, dialog .list button');
    const count = await names.count();
    if (count) await names.nth(Math.floor(random() * count)).click();
    const plan_it = one.page.locator('dialog').getByRole('button', { name: 'Plan it' });
    if (await plan_it.count()) await plan_it.click();
  },
  async turn() {
    const pane = await shown_pane();
    await one.page.mouse.move(...(await canvas_at(pane, place())));
    await one.page.mouse.down();
    await one.page.mouse.move(...(await canvas_at(pane, place())), { steps: 8 });
    await one.page.mouse.up();
    await one.page.mouse.wheel(0, one_of([-100, 100]));
  },
  layout: () => one.press(one_of(['Shift+1', 'Shift+2', '0', 'm', 'n', '1', '4', '8', 'o'])),
  radiograph: () => one.command('Radiograph and landmarks'),
  async look() {
    await one.tab('Objects');
    const boxes = one.page.locator('.lists [role="tabpanel"] button');
    const count = await boxes.count();
    if (count) await boxes.nth(Math.floor(random() * count)).click();
  },
  async dialogs() {
    await one.command(one_of(["Show the scan's audit", 'Keys and help', 'Export', 'Hide the patient', 'Show the patient', 'Dark or light']));
  },
};

/// Waits until every request has its answer and the page says that it is ready.
async function quiet() {
  let still = 0;
  await one.until(async () => {
    still = one.waiting.size === 0 && (await one.page.locator('.status .idle').count()) > 0 ? still + 1 : 0;
    return still > 3;
  }, `answers to ${[...one.waiting.values()].map(({ what }) => what)}`);
}

/// Numbers of the panel "Numbers" by the ids of steps; null where it shows none.
async function page_numbers() {
  const tab = one.page.getByRole('tab', { name: 'Numbers' });
  await tab.click();
  const rows = await one.page.evaluate(() => [...document.querySelectorAll('table.numbers tr')].flatMap((row) => {
    const id = row.querySelector('.badge-cell [aria-label]')?.getAttribute('aria-label').replace(/: [^:]*$/, '');
    return id ? [{ id, text: (row.querySelector('td > div') ?? row.querySelector('td')).innerText, error: row.querySelector('.error')?.innerText }] : [];
  }));
  return new Map(rows.map(({ id, text, error }) => {
    const [value, half] = text.split('±').map((part) => part.replace(/[\u202f\s]/g, '').replace('−', '-').match(/-?\d+(\.\d+)?/)?.[0] ?? null);
    return [id, { text, value, half: half ?? null, error }];
  }));
}

/// The number that a measurement of the command line begins with; null where it has none without a surface.
function first_number(found) {
  for (const key of ['distance_mm', 'angle_deg', 'gap_mm', 'donor_used_mm']) if (typeof found[key] === 'number') return found[key];
  if (found.along?.length_mm) return found.along.length_mm;
  if (found.airway?.narrowest) return found.airway.narrowest.area_mm2;
  if (found.contacts && typeof found.nearest_mm === 'number') return found.nearest_mm;
  if (found.a !== undefined && typeof found.mean_mm === 'number') return found.mean_mm;
  if (typeof found.doubts?.[0]?.value === 'number') return found.doubts[0].value;
  if (found.gap_mm !== undefined || ['along', 'section', 'thickness', 'curvature'].some((key) => found[key] !== undefined)) return null;
  return found.volume?.value ?? undefined;
}

/// What the command line computes of the plan: {numbers, counted}, or {refused} with its message. Numbers of surfaces take
/// certificates. `counted` are voxel counts of what steps measure: the page's value until it is certified.
function command_line_numbers(certify = 'never') {
  const out = path.join(folder, 'replayed');
  fs.rmSync(out, { recursive: true, force: true });
  // Status 1: the kernels disagree, and everything is written all the same.
  const { status, stdout, stderr } = spawnSync(program, ['run', plan_path, '-o', out, '--certify', certify, '--json'], { maxBuffer: 1 << 28, encoding: 'utf8' });
  if (status > 1) return { refused: stderr.split('\n').filter((line) => !line.includes('WARN')).join(' ') };
  const made = JSON.parse(stdout);
  const numbers = new Map(made.objects.map((object) => [object.id, object.voxel?.volume_mm3 ?? null]));
  for (const found of made.measurements) if (first_number(found) !== undefined) numbers.set(found.id, first_number(found));
  const counted = new Map(made.measurements.flatMap((found) => (found.volume && typeof found.volume_mm3 === 'number' ? [[found.id, found.volume_mm3]] : [])));
  return { numbers, counted };
}

/// Half a unit of the last digit that a number is shown with.
const half_digit = (text) => 0.5 * 10 ** -(text.split('.')[1]?.length ?? 0) * 1.0001;

async function compare(what) {
  const shown = await page_numbers();
  const found = command_line_numbers();
  await one.tab('Steps');
  const errors = await one.page.evaluate(() => [...document.querySelectorAll('.notice.error, .lists .error, .inspector .error, table.numbers .error')].map((each) => each.innerText));
  if (found.refused) {
    assert.ok(errors.length, `${what}: the command line refuses the plan (${found.refused}), and the page shows no error`);
    return false;
  }
  let certified = null;
  for (const [id, { text, value, half }] of shown) {
    if (value === null) continue;
    if (half !== null && Math.abs(Number(value) - found.counted.get(id)) <= half_digit(value)) continue;
    const is_plain = half === null && typeof found.numbers.get(id) === 'number';
    const wanted = (is_plain ? found : (certified ??= command_line_numbers('now'))).numbers?.get(id);
    assert.ok(typeof wanted === 'number', `${what}: the page shows ${text} of ${id}, the command line ${wanted}`);
    assert.ok(Math.abs(Number(value) - wanted) <= half_digit(value), `${what}: the page shows ${text} of ${id}, the command line ${wanted}`);
  }
  return true;
}

/// A plan of one step and of those whose names it uses, and they.
function plan_for(step) {
  const words = new Set(), steps = [step];
  const take = (text) => { for (const word of text.match(/\w+/g) ?? []) words.add(word); };
  take(JSON.stringify(step));
  for (const each of [...plan().steps].reverse()) {
    if (!words.has(each.id) && !['landmarks', 'head_position'].includes(each.do)) continue;
    take(JSON.stringify(each));
    steps.unshift(each);
  }
  return { ...plan(), steps };
}

/// The picture at rest of a pane in sight is the one which its step of a plan writes, byte for byte.
async function compare_picture(what) {
  await one.at_rest();
  const pane = await shown_pane();
  // The newest picture that came may no longer be shown: a pane without objects forgets it.
  const id = await one.page.locator('.pane canvas').nth(pane).getAttribute('data-picture');
  const frame = one.frames.find(({ header }) => header.pane === pane && String(header.id) === id);
  assert.ok(frame || !id, `${what}: pane ${pane} shows picture ${id}, which is not among the newest ones`);
  const is_empty = frame?.header.step?.do === 'render' && !frame.header.objects.length;
  if (!frame?.header.step || is_empty) return;
  const drawing = path.join(folder, 'drawing.plan.json'), out = path.join(folder, 'drawn');
  const step = { ...frame.header.step, id: 'monkey_view', path: 'monkey_view.png' };
  const drawn_by = (described) => {
    fs.writeFileSync(drawing, JSON.stringify(described));
    fs.rmSync(out, { recursive: true, force: true });
    const { status, stderr } = spawnSync(program, ['run', drawing, '-o', out, '--certify', 'never'], { encoding: 'utf8' });
    assert.ok(status === 0 || status === 1, `${what}: the plan that draws pane ${pane} ends with ${status}: ${stderr.slice(-600)} ${JSON.stringify(described)}`);
    return fs.readFileSync(path.join(out, 'monkey_view.png'));
  };
  // The whole plan may need another universe.
  if (drawn_by(plan_for(step)).equals(frame.picture)) return;
  const drawn = drawn_by({ ...plan(), steps: [...plan().steps, step] });
  if (drawn.equals(frame.picture)) return;
  for (const [name, picture] of [['page', frame.picture], ['command', drawn]]) if (process.env.OCTOTOMY_PICTURES) fs.writeFileSync(path.join(process.env.OCTOTOMY_PICTURES, `monkey_${name}.png`), picture);
  assert.fail(`${what}: the picture of pane ${pane} is not the command line's: ${JSON.stringify(frame.header.step)}`);
}

async function open_new(seed) {
  plan_path = path.join(folder, `plan_${seed}.plan.json`);
  fs.writeFileSync(plan_path, JSON.stringify({
    octotomy_plan: 1, name: `plan_${seed}`, scans: { ct: { path: 'head_phantom.nrrd' } },
    steps: [
      { id: 'landmarks', do: 'landmarks', points: Object.entries(marks).map(([name, point_mm]) => ({ name, point_mm })) },
      { id: 'bone', do: 'window', scan: 'ct', low: 300 },
    ],
  }));
  await put_down();
  await close_notices();
  await one.page.locator('.brand').click();
  await one.click('Scan or plan');
  await one.page.locator('.file', { hasText: `plan_${seed}.plan.json` }).click();
  await one.until(async () => (await one.page.locator('.plan-name').innerText()) === `plan_${seed}`, `plan ${seed} open`);
  const go_on = one.page.getByRole('button', { name: 'Continue' });
  if (await go_on.isVisible()) await go_on.click();
  await one.press('Escape');
  await one.at_rest();
}

/// Closes what an action left open: dialogs, drafts, the tool in hand.
async function put_down() {
  for (let i = 0; i < 3; ++i) {
    await one.page.keyboard.press('Escape');
    const cancel = one.page.locator('.inspector').getByRole('button', { name: 'Cancel', exact: true });
    if (await cancel.count()) await cancel.first().click();
  }
}
async function close_notices() {
  for (;;) {
    const cross = one.page.locator('.notice button[aria-label="Close"]').first();
    if (!(await cross.count())) return;
    await cross.click({ timeout: 2000 }).catch(() => {});
  }
}

before(async () => {
  lay_phantom(folder, 2);
  server = await start_server(folder);
  one = await PlannerWindow.open(server.url);
  one.page.setDefaultTimeout(30000);
});
after(async () => {
  await one?.close();
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

for (let number = 0; number < plans; ++number) {
  const seed = first_seed + number;
  test(`plan ${seed}: the page's numbers are the command line's after every step`, async () => {
    random = numbers_of(seed);
    await open_new(seed);
    const names = Object.keys(actions);
    clicked.length = 0;
    one.problems.length = one.late.length = 0;
    for (let count = 0; count < steps_a_plan; ++count) {
      // Every action is clicked once in as many plans as it takes; the rest is chance.
      const name = random() < 0.5 ? names[(seed * steps_a_plan + count) % names.length] : one_of(names);
      clicked.push(name);
      done.set(name, (done.get(name) ?? 0) + 1);
      const what = `seed ${seed}, ${clicked.join(' ')}`;
      await close_notices();
      try {
        await actions[name]();
      } catch (error) {
        throw new Error(`${what}: ${error.message}`);
      }
      await quiet();
      await put_down();
      await quiet();
      assert.deepEqual(one.problems, [], `${what}: the console`);
      assert.deepEqual(one.late, [], `${what}: late answers`);
      // A step that fails for good reasons stays in nobody's plan.
      if (!(await compare(what))) {
        await one.press('Control+z');
        await quiet();
        continue;
      }
      await compare_picture(what);
    }
  });
}

test('every tool was in hand', (context) => {
  const missed = Object.keys(actions).filter((name) => !done.has(name));
  if (plans * steps_a_plan < 4 * Object.keys(actions).length) return context.skip(`${plans} plans are too few for ${missed}`);
  assert.deepEqual(missed, []);
});

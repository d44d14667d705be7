// SPDX-License-Identifier: AGPL-3.0-or-later
// A second window that shows one pane large and follows the first; a page that may only look, and what an attacker does with
// its link; and the start page, which stays in sight while another window edits.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PlannerWindow, lay_phantom, start_server } from './planner_window.mjs';
import { beside, violations } from './screen_checks.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-sharing-'));
const plan_path = path.join(folder, 'jaw.plan.json');
const jaw = [{ view: 'anterior', polygons_mm: [[[-40, -60], [40, -60], [40, -25], [-40, -25]]] }, { view: 'left', polygons_mm: [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]] }];
const pictures = process.env.OCTOTOMY_PICTURES;
let server;

before(async () => {
  lay_phantom(folder, 2);
  fs.writeFileSync(plan_path, JSON.stringify({
    octotomy_plan: 1, name: 'jaw', scans: { ct: { path: 'head_phantom.nrrd' } },
    steps: [
      { id: 'skull', do: 'window', scan: 'ct', low: 300 },
      { id: 'cut', do: 'mask', regions: jaw },
      { id: 'rest', do: 'combine', expression: 'skull - cut' },
      { id: 'piece', do: 'combine', expression: 'skull & cut' },
      { id: 'moved', do: 'move', object: 'piece', by: { forward_mm: 6 } },
    ],
  }));
  server = await start_server(folder, ['jaw.plan.json', '--share']);
});
after(() => {
  server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

const steps_of = (one) => one.page.locator('.lists .step .name').allInnerTexts();
/// The newest picture at rest of a pane, from what its page got.
const newest = (one, pane) => one.frames.filter(({ header }) => header.pane === pane).pop();
async function take_picture(one, name) {
  if (pictures) await one.page.screenshot({ path: path.join(pictures, `${name}.png`) });
}

/// A second window as the first one opens it, watched like any other.
async function second_window(one, pane) {
  const opened = one.context.waitForEvent('page');
  await one.page.locator('.pane').nth(pane).getByRole('button', { name: 'Show in a second window' }).click();
  const second = new PlannerWindow();
  second.page = await opened;
  second.page.on('console', (message) => { if (message.type() === 'error') second.problems.push(message.text()); });
  second.page.on('pageerror', (error) => second.problems.push(String(error)));
  await second.page.locator('.plan-name', { hasText: 'jaw' }).waitFor();
  return second;
}
/// A pane's picture as its canvas shows it.
const drawn = (one, pane) => one.page.evaluate((index) => document.querySelectorAll('.pane canvas')[index].toDataURL(), pane);
/// Waits until a canvas has changed and no picture is wanted any more.
async function changed(one, pane, before_it, what) {
  await one.until(async () => (await one.page.locator('.pane:not([hidden]) canvas[aria-busy="true"]').count()) === 0 && (await drawn(one, pane)) !== before_it, what);
  return drawn(one, pane);
}

test('a second window shows one pane large and follows the plan, the looks and a piece that is dragged', async () => {
  const one = await PlannerWindow.open(server.url);
  try {
    await one.at_rest();
    const second = await second_window(one, 1);
    await second.until(async () => (await second.page.locator('.pane:not([hidden])').count()) === 1, 'one pane');
    let shown = await changed(second, 0, '', 'a first picture');
    await take_picture(second, 'second_window');
    // It shows what the first window's left view shows, and nothing with which to edit.
    assert.equal(await second.page.locator('.pane:not([hidden]) .pane-choice').first().inputValue(), 'left');
    for (const hidden of ['.rail', '.lists', '.inspector']) assert.equal(await second.page.locator(hidden).isVisible(), false, hidden);
    const before_keys = fs.readFileSync(plan_path, 'utf8');
    for (const key of ['x', 'g', 'Control+z', 'Delete']) await second.page.keyboard.press(key);
    await second.page.waitForTimeout(300);
    assert.equal(fs.readFileSync(plan_path, 'utf8'), before_keys);
    // Hidden in the first: gone in the second.
    await one.tab('Steps');
    await one.click('Hide moved');
    shown = await changed(second, 0, shown, 'the piece is hidden in the second window');
    await one.click('Show moved');
    shown = await changed(second, 0, shown, 'the piece is back');
    // A piece that moves in the first is moving in the second, and stays where it was put.
    await one.select('moved');
    await one.press('g');
    await one.page.locator('.pane canvas').first().focus();
    for (let i = 0; i < 6; ++i) await one.press('s');
    shown = await changed(second, 0, shown, 'the piece moves in the second window');
    // No key is lost, however fast they come.
    await one.until(() => one.plan(plan_path).steps.some((step) => step.by?.up_mm === -3), 'six times half a millimetre in the plan', 30000);
    await one.press('Escape');
    await second.page.locator('.pane:not([hidden]) canvas').dblclick();
    assert.equal(await second.page.locator('.pane:not([hidden])').count(), 1);
    // Its own view is turned without the first one's.
    const in_first = await one.setting(1);
    await second.page.keyboard.press('1');
    await second.until(async () => (await second.page.locator('.pane:not([hidden]) .pane-choice').first().inputValue()) === 'anterior', 'another view');
    await changed(second, 0, shown, 'the other view');
    assert.deepEqual(await one.setting(1), in_first);
    // The first's own look is kept as it was, although both windows share the browser's store.
    await one.page.reload();
    await one.at_rest();
    assert.equal((await one.setting(1)).view, 'left');
    shown = await drawn(second, 0);
    await one.click('Hide rest');
    await changed(second, 0, shown, 'it follows a first window that was loaded again');
    assert.deepEqual([...one.problems, ...second.problems], []);
    assert.deepEqual(await violations(second, 'second window'), []);
  } finally {
    await one.close();
  }
});

test('a link to look shows the plan, follows it and changes nothing, whatever its page sends', async () => {
  const one = await PlannerWindow.open(server.url);
  const viewer = await PlannerWindow.open(server.view_url);
  try {
    await one.at_rest();
    await viewer.at_rest();
    await one.command('Link to look at this plan');
    assert.equal(await one.page.locator('dialog input[name="link"]').inputValue(), server.view_url);
    assert.deepEqual(await violations(one, 'link'), []);
    await one.press('Escape');
    await take_picture(viewer, 'viewer');
    // The same picture, and no control that edits.
    assert.deepEqual(await steps_of(viewer), await steps_of(one));
    assert.deepEqual(newest(viewer, 0).header.objects, newest(one, 0).header.objects);
    assert.equal(await viewer.page.locator('button.brand').count(), 0);
    for (const name of ['Undo', 'Certify', 'Report', 'Procedure', 'Export', 'More for moved'])
      assert.equal(await viewer.page.getByRole('button', { name, exact: true }).count(), 0, name);
    assert.equal(await viewer.page.locator('.rail').isVisible(), false);
    // Every tab and every key.
    for (const tab of ['Objects', 'History', 'Numbers', 'Movement', 'Steps', 'Inspector']) {
      await viewer.tab(tab);
      await viewer.page.waitForTimeout(150);
      assert.deepEqual(await violations(viewer, tab), []);
    }
    await viewer.select('moved');
    const before_it = fs.readFileSync(plan_path, 'utf8');
    for (const key of ['x', 'g', 'w', 'Control+z', 'Control+s', 'Control+e', 'Control+o', 'Control+Enter']) await viewer.press(key);
    assert.equal(await viewer.page.locator('dialog[open]').count(), 0);
    // It follows: a step of the editor, and the numbers.
    await one.command('Undo');
    await one.command('Mirror the selected object');
    await one.select('rest');
    await one.command('Mirror the selected object');
    await one.until(() => one.plan(plan_path).steps.some((step) => step.id === 'rest_mirrored'), 'an edit');
    await viewer.until(async () => (await steps_of(viewer)).includes('rest mirrored'), 'the step in the view');
    await viewer.at_rest();
    // An attacker has the link, and a console. No request is hidden from it, so each is refused by the server.
    const edited = fs.readFileSync(plan_path, 'utf8');
    const listing = fs.readdirSync(folder).sort();
    const answers = await viewer.page.evaluate(async (requests) => {
      const socket = new WebSocket(`ws://${location.host}/socket${location.search}`);
      await new Promise((opened) => { socket.onopen = opened; });
      const made = requests.map((_, id) => new Promise((answered) => socket.addEventListener('message', ({ data }) => {
        const message = typeof data === 'string' ? JSON.parse(data) : {};
        if (message.id === id + 1) answered(message);
      })));
      requests.forEach((request, id) => socket.send(JSON.stringify({ id: id + 1, ...request })));
      return Promise.all(made);
    }, [
      { do: 'edit', what: 'x', steps: [] }, { do: 'undo' }, { do: 'open', path: 'head_phantom.nrrd' }, { do: 'list' },
      { do: 'list', folder: '/etc' }, { do: 'save', path: 'stolen.plan.json' }, { do: 'export', object: 'skull', path: 'a.stl' },
      { do: 'report' }, { do: 'recent' }, { do: 'evaluate', certify: true },
      { do: 'pane', pane: 0, size: [9, 9], objects: [], preview: { object: 'a', steps: [{ do: 'import', path: 'head_phantom.nrrd' }] } },
    ]);
    for (const answer of answers) assert.match(answer.error?.message ?? '', /only shows the plan/);
    const uploaded = await viewer.page.evaluate(async () => (await fetch(`/upload${location.search}&name=a.txt`, { method: 'POST', body: 'x' })).status);
    assert.equal(uploaded, 403);
    assert.equal(fs.readFileSync(plan_path, 'utf8'), edited);
    assert.deepEqual(fs.readdirSync(folder).sort(), listing);
    assert.notEqual(edited, before_it);
    assert.deepEqual(viewer.problems.filter((problem) => !problem.includes('403')), []);
    // Nobody learns the editor's token or folders from it.
    const stored = await viewer.page.evaluate(() => document.documentElement.outerHTML + JSON.stringify(localStorage));
    assert.ok(!stored.includes(new URL(server.url).searchParams.get('token')) && !stored.includes(folder));
  } finally {
    await viewer.close();
    await one.close();
  }
});

for (const [width, height] of [[390, 844], [820, 1180], [1024, 768], [1600, 900]])
  for (const theme of ['light', 'dark'])
    test(`a page that only looks fits a window of ${width} pixels, ${theme}`, async () => {
      const viewer = await PlannerWindow.open(server.view_url, { size: { width, height }, theme });
      try {
        await viewer.at_rest();
        await take_picture(viewer, `viewer_${width}_${theme}`);
        for (const tab of ['Numbers', 'Inspector']) {
          await viewer.tab(tab);
          assert.deepEqual(await viewer.page.evaluate(beside, tab), []);
        }
        assert.deepEqual(await violations(viewer, 'viewer'), []);
      } finally {
        await viewer.close();
      }
    });

test('a window too many is told why it sees nothing, and comes in when another one leaves', async () => {
  const one = await PlannerWindow.open(server.url);
  try {
    await one.at_rest();
    await one.page.evaluate((token) => new Promise((done) => {
      window.viewers = Array.from({ length: 16 }, () => new WebSocket(`ws://${location.host}/socket?token=${token}`));
      let open = 0;
      for (const socket of window.viewers) socket.onopen = () => { if (++open === 16) done(); };
    }), new URL(server.view_url).searchParams.get('token'));
    const late = await PlannerWindow.open(server.view_url);
    try {
      await late.page.locator('.lost', { hasText: /16 windows look at this plan already/ }).waitFor();
      await one.page.evaluate(() => window.viewers[0].close());
      await late.page.locator('.plan-name', { hasText: 'jaw' }).waitFor();
      assert.equal(await late.page.locator('.lost').isVisible(), false);
    } finally {
      await late.close();
    }
    await one.page.evaluate(() => window.viewers.forEach((socket) => socket.close()));
    assert.deepEqual(one.problems, []);
  } finally {
    await one.close();
  }
});

test('the start page stays in sight while another window edits', async () => {
  const one = await PlannerWindow.open(server.url);
  const other = await PlannerWindow.open(server.url);
  try {
    await one.at_rest();
    await other.at_rest();
    await one.click(one.page.locator('.brand'));
    await one.page.locator('.start .offers').waitFor();
    await other.select('skull');
    await other.command('Mirror the selected object');
    await other.until(() => other.plan(plan_path).steps.some((step) => step.id === 'skull_mirrored'), 'an edit');
    await one.until(() => one.waiting.size === 0, 'the state here, too');
    await one.page.waitForTimeout(400);
    assert.ok(await one.page.locator('.start .offers').isVisible());
    // The plan, opened again, has the edit.
    await one.page.locator('.recent .file', { hasText: 'jaw' }).click();
    await one.until(async () => (await steps_of(one)).includes('skull mirrored'), 'the plan as it is now');
    await one.at_rest();
    assert.deepEqual([...one.problems, ...other.problems], []);
  } finally {
    await other.close();
    await one.close();
  }
});

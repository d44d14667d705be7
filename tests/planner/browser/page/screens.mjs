// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures of the page to look at: every screen and dialog in two sizes, light and dark. The first report certifies the plan.
//   OCTOTOMY_PROGRAM=build/release/octotomy node screens.mjs FOLDER [WORD...]   screens whose name has one of the words, or all
// The donor's screens need OCTOTOMY_SHARED_DATA, the folder of the reference scans. A screen whose controls have no name or
// do not fit where they stand is told.
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { execFileSync } from 'node:child_process';
import { PlannerWindow, donor_marks, head_scan, jaw_marks, program, start_server } from './planner_window.mjs';

const out = path.resolve(process.argv[2] ?? 'screens');
const words = process.argv.slice(3);
fs.mkdirSync(out, { recursive: true });
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-screens-'));
const octotomy = (...typed) => execFileSync(program, typed, { cwd: folder, stdio: 'ignore' });
octotomy('phantom', 'head', '-o', 'head.nrrd');
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

// Each screen: its name, and what brings it from the planner at rest; what that answers brings the planner back.
const key = (one, press) => async () => { await one.press(press); };
const command = (one, name) => () => one.command(name);
const in_views = async (one) => {
  await one.command('Four views');
  await one.at_rest();
};
const report = async (one) => {
  await one.click(one.page.locator('.bar').getByRole('button', { name: 'Report' }));
  await one.page.locator('dialog.report iframe').waitFor({ timeout: 600000 });
  await one.page.waitForTimeout(1500);
};
const of_le_fort = {
  planning: async (one) => {
    await one.select('maxilla_moved');
    await one.press('g');
    return key(one, 'Escape');
  },
  window: async (one) => {
    await one.select('skull');
    await one.press('w');
    return key(one, 'Escape');
  },
  region: async (one) => {
    await one.select('cut');
    await one.press('r');
    return key(one, 'Escape');
  },
  slices: async (one) => {
    await one.command('Views and slices');
    return () => in_views(one);
  },
  oblique: async (one) => {
    await one.command('Views and slices');
    await one.page.getByLabel('What pane 4 shows').selectOption('oblique');
    return () => in_views(one);
  },
  panoramic: async (one) => {
    await one.command('Views and slices');
    await one.at_rest();
    await one.command('Tool: Dental arch');
    await one.at_rest();
    for (const uv of [[-25, 45], [-20, 65], [0, 80], [20, 65], [25, 45]]) await one.click_at(2, uv);
    await one.press('Enter');
    return () => in_views(one);
  },
  marks: async (one) => {
    await one.select('maxilla');
    await one.press('j');
    await one.at_rest();
    await one.click_at(1, [-75, -45]);
    await one.click_at(1, [-80, -44]);
    return key(one, 'Escape');
  },
  compare: async (one) => {
    await one.select('maxilla_moved');
    await one.command('Compare in colours');
    return command(one, 'Compare in colours');
  },
  contacts: async (one) => {
    await one.select('maxilla_moved');
    await one.command('Contact map');
    return async () => {
      await one.command('Contact map');
      await in_views(one);
    };
  },
  cut_plane: async (one) => {
    await one.command('Cut plane');
    return command(one, 'Cut plane');
  },
  cephalometry: async (one) => {
    await one.command('Radiograph and landmarks');
    return async () => {
      await one.press('Escape');
      await in_views(one);
    };
  },
  report: async (one) => {
    await report(one);
    return key(one, 'Escape');
  },
  numbers: async (one) => one.tab('Numbers'),
  movement: async (one) => {
    await one.tab('Movement');
    return () => one.tab('Inspector');
  },
  objects: async (one) => {
    await one.tab('Objects');
    return () => one.tab('Steps');
  },
  history: async (one) => {
    await one.tab('History');
    return () => one.tab('Steps');
  },
  step_menu: async (one) => {
    await one.click(one.page.getByRole('button', { name: 'More for skull' }));
    return () => one.select('skull');
  },
  new_step: async (one) => {
    await one.command('Add step: smooth');
    return () => one.click('Cancel');
  },
  tip: async (one) => {
    await one.page.getByRole('button', { name: 'Compare (C)' }).hover();
    await one.page.waitForTimeout(700);
    return () => one.page.mouse.move(5, 5);
  },
  palette: async (one) => {
    await one.press('Control+k');
    return key(one, 'Escape');
  },
  help: async (one) => {
    await one.command('Keys and help');
    return key(one, 'Escape');
  },
  export: async (one) => {
    await one.press('Control+e');
    return key(one, 'Escape');
  },
  branch: async (one) => {
    await one.click('New branch beside main');
    return key(one, 'Escape');
  },
  audit: async (one) => {
    await one.command("Show the scan's audit");
    return key(one, 'Escape');
  },
  picker: async (one) => {
    await one.command('Open a scan or plan');
    await one.page.locator('.file').first().waitFor();
    return key(one, 'Escape');
  },
  procedure: async (one) => {
    await one.click(one.page.locator('.bar').getByRole('button', { name: 'Procedure' }));
    await one.click('le fort i');
    return key(one, 'Escape');
  },
  outcome: async (one) => {
    await one.command('Outcome of the operation');
    await one.click(one.page.locator('.file', { hasText: 'head.nrrd' }));
    await one.page.locator('.outcome-table').waitFor({ timeout: 300000 });
    return key(one, 'Escape');
  },
};
const of_start = {
  start: async () => {},
  tour: async (one) => {
    await one.click('Guided tour');
    const card = one.page.locator('.tour-card');
    for (const stop of [1, 2]) {
      await card.getByText(`${stop} of 7`).waitFor({ timeout: 300000 });
      await one.click(card.getByRole('button', { name: 'Do it for me' }));
    }
    await card.getByText('3 of 7').waitFor();
  },
};
const of_flap = {
  flap: async () => {},
  donor: async (one) => {
    await one.command('Views and slices');
    await one.page.locator('select[name="scan"]').selectOption('donor');
    return async () => {
      await one.page.locator('select[name="scan"]').selectOption('ct');
      await in_views(one);
    };
  },
  donor_landmarks: async (one) => {
    await one.click(one.page.locator('.bar').getByRole('button', { name: 'Procedure' }));
    await one.click('fibula flap');
    return key(one, 'Escape');
  },
};

/// What a picture hides from a quick look: words that are cut off, things that reach out of the window, controls that have no name.
function faults() {
  const found = [];
  const is_seen = (element) => element.checkVisibility({ visibilityProperty: true }) && element.getBoundingClientRect().width > 0;
  const says = (element) => `${element.tagName.toLowerCase()}.${element.className} "${(element.textContent ?? '').trim().slice(0, 40)}"`;
  const top = document.querySelector('dialog[open]') ?? document.body;
  for (const element of top.querySelectorAll('button, select, input, textarea, a, h2, h3, th, td, label, p, .words, .angles')) {
    if (!is_seen(element)) continue;
    const box = element.getBoundingClientRect();
    if (element.matches('button, .angles, h2, h3, th, td, p') && element.scrollWidth > element.clientWidth + 1 && element.clientWidth) found.push(`cut off: ${says(element)}`);
    if (box.left < -1 || box.right > innerWidth + 1) found.push(`beside the window: ${says(element)}`);
    if (!element.matches('button, select, input, textarea, a')) continue;
    const name = element.getAttribute('aria-label') ?? element.labels?.[0]?.textContent ?? element.textContent ?? element.title ?? element.placeholder;
    if (!name?.trim() && element.type !== 'file') found.push(`no name: ${element.outerHTML.slice(0, 100)}`);
    if (element.matches('select') && element.selectedOptions[0]) {
      const context = document.createElement('canvas').getContext('2d');
      context.font = getComputedStyle(element).font;
      if (context.measureText(element.selectedOptions[0].text).width > element.clientWidth - 24) found.push(`cut off: ${element.ariaLabel ?? element.name} "${element.selectedOptions[0].text}"`);
    }
  }
  return found;
}

async function take(one, screens, more) {
  for (const [name, show] of Object.entries(screens)) {
    if (words.length && !words.some((word) => name.includes(word))) continue;
    try {
      const back = await show(one);
      if (await one.page.evaluate(() => document.body.dataset.page === 'plan')) await one.at_rest();
      await one.page.waitForTimeout(200);
      await one.page.screenshot({ path: path.join(out, `${name}_${more}.png`) });
      for (const fault of await one.page.evaluate(faults)) console.log(`${name}_${more}: ${fault}`);
      await back?.();
    } catch (error) {
      console.log(`${name}_${more}: ${error.message.split('\n')[0]}`);
      await one.page.screenshot({ path: path.join(out, `${name}_${more}_failed.png`) });
      await one.press('Escape');
    }
  }
  if (one.problems.length) console.log(more, one.problems);
}

function flap_plan(scan) {
  octotomy('phantom', 'leg', '-o', 'leg.nrrd');
  fs.copyFileSync(scan, path.join(folder, 'patient.nrrd'));
  const landmarks = Object.entries({ ...jaw_marks, ...donor_marks }).map(([name, point_mm]) => ({ name, point_mm }));
  fs.writeFileSync(path.join(folder, 'marks.json'), JSON.stringify({ landmarks }));
  octotomy('procedure', 'fibula_flap', '--scan', 'patient.nrrd', '--landmarks', 'marks.json', '--donor', 'leg.nrrd', '--set', 'start_mm=20', '--set', 'aside_mm=20',
    '--set', 'least_mm3=200', '-o', 'flap.plan.json');
  return path.join(folder, 'flap.plan.json');
}

const scenes = [[of_le_fort, plan], [of_start, null]];
if (fs.existsSync(head_scan)) scenes.push([of_flap, flap_plan(head_scan)]);
else console.log(`Skipped: the donor's screens, since there is no ${head_scan}`);
try {
  for (const [screens, opened] of scenes) {
    if (words.length && !Object.keys(screens).some((name) => words.some((word) => name.includes(word)))) continue;
    for (const theme of ['dark', 'light'])
      for (const size of [{ width: 1440, height: 900 }, { width: 1024, height: 768 }]) {
        // Each window of the start page has a planner that nothing was opened in.
        const server = await start_server(folder, opened ? [opened] : []);
        const one = await PlannerWindow.open(server.url, { size, theme });
        try {
          if (opened) {
            await one.page.locator('.lists .name').first().waitFor();
            if (await one.page.getByRole('button', { name: 'Continue' }).isVisible()) await one.click('Continue');
            await one.press('Escape');
            await one.at_rest();
          } else
            await one.page.locator('.offer').nth(1).waitFor();
          await take(one, screens, `${size.width}_${theme}`);
        } finally {
          await one.close();
          server.stop();
        }
      }
  }
} finally {
  fs.rmSync(folder, { recursive: true, force: true });
}

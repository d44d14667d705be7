// SPDX-License-Identifier: AGPL-3.0-or-later
// How fast the panes follow a drag, in four panes of a window of 1200 x 900, browser and server on the same machine:
//   OCTOTOMY_PROGRAM=build/release/octotomy node frame_rate.mjs SCAN
// Prints the time to the page's first paint, in a browser just started and at best; then frames a second, the latency from
// the request to the picture on the canvas, and the program's processor time a frame, which depends less on what else the
// machine does: for views that are turned, slices, a radiograph, a threshold, and a piece that is moved with its overlap.
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { PlannerWindow, start_server } from './planner_window.mjs';

const scan = path.resolve(process.argv[2] ?? 'head.nrrd');
const drag_ms = 4000;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-frames-'));
const plan = path.join(folder, 'frames.plan.json');
// A block in the middle of the face; its numbers need no anatomy, only something that moves and something that stays.
fs.writeFileSync(plan, JSON.stringify({
  octotomy_plan: 1, name: 'frames', scans: { ct: { path: scan } },
  steps: [
    { id: 'bone', do: 'window', scan: 'ct', low: Number(process.env.BONE_LOW ?? 300) },
    { id: 'landmark', do: 'landmarks', points: [{ name: 'origin', point_mm: [0, 0, 0] }] },
  ],
}));

const ticks_per_s = 100; // of /proc, on every Linux of today
/// Seconds of processor time that the program took so far, all its threads together.
function processor_s() {
  const fields = fs.readFileSync(`/proc/${server.process.pid}/stat`, 'utf8').replace(/^.*\) /, '').split(' ');
  return (Number(fields[11]) + Number(fields[12])) / ticks_per_s;
}

/// Prints how pictures follow a drag; those of one pane, or, where `pane` is null, of all.
async function measured(one, what, pane, drag) {
  await one.at_rest();
  const first = await one.page.evaluate(() => window.pictures.length);
  const spent_before_s = processor_s();
  const began = Date.now();
  await drag(began + drag_ms);
  const seconds = (Date.now() - began) / 1000;
  const spent_s = processor_s() - spent_before_s;
  const moving = (await one.page.evaluate((from) => window.pictures.slice(from), first)).filter((each) => each.quality === 'moving');
  const pictures = moving.filter((each) => pane === null || Number(each.pane) === pane);
  const latencies = pictures.map((each) => each.latency_ms).filter((each) => each !== null).sort((a, b) => a - b);
  const at = (share) => latencies[Math.min(latencies.length - 1, Math.floor(share * latencies.length))] ?? NaN;
  const spent_ms = (1000 * spent_s) / moving.length;
  console.log(`${what.padEnd(34)} ${(pictures.length / seconds).toFixed(1).padStart(6)} frames/s   median ${at(0.5).toFixed(1)} ms   95th percentile ${at(0.95).toFixed(1)} ms   ${spent_ms.toFixed(1)} ms of processor a picture of ${moving.length}`);
}

/// Calls a function of the page once a frame of the browser, with the frame's number, until the time has come.
const each_frame = (one, until, act, given) => one.page.evaluate(`(async () => {
  for (let i = 0; Date.now() < ${until}; ++i) {
    await new Promise(requestAnimationFrame);
    (${act})(i, ${JSON.stringify(given)});
  }
})()`);

/// Moves the pressed pointer in a circle about a place until the time has come, once a frame of the browser, as it gives a
/// hand's movements to a page.
async function circle(one, pane, centre, radius, until) {
  const { mouse } = one.page;
  await mouse.move(centre.x, centre.y);
  await mouse.down();
  await each_frame(one, until, (i, given) => {
    const at = { clientX: given.x + given.radius * Math.cos(i * 0.07), clientY: given.y + given.radius * Math.sin(i * 0.07) };
    document.querySelectorAll('.pane canvas')[given.pane].dispatchEvent(new PointerEvent('pointermove', { pointerId: 1, bubbles: true, buttons: 1, ...at }));
  }, { pane, radius, x: centre.x, y: centre.y });
  await mouse.up();
}

const server = await start_server(folder, [plan]);
const one = await PlannerWindow.open(server.url, { size: { width: 1200, height: 900 } });
try {
  await one.at_rest();
  const paints = [await one.first_paint_ms()];
  while (paints.length < 6) {
    await one.page.reload();
    await one.at_rest();
    paints.push(await one.first_paint_ms());
  }
  console.log(`first paint: ${paints[0].toFixed(0)} ms in a browser just started, at best ${Math.min(...paints).toFixed(0)} ms`);
  const middle = async (pane) => {
    const box = await one.page.locator('.pane canvas').nth(pane).boundingBox();
    return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  };
  await measured(one, 'a view turned', 3, async (until) => circle(one, 3, await middle(3), 90, until));
  await measured(one, 'anterior view turned', 0, async (until) => circle(one, 0, await middle(0), 90, until));
  const shading = one.page.locator('.pane').nth(0).locator('select').nth(1);
  await shading.selectOption('radiograph');
  await measured(one, 'a radiograph turned', 0, async (until) => circle(one, 0, await middle(0), 90, until));
  await shading.selectOption('partial_volume');
  await one.press('Shift+2');
  await measured(one, 'slices by a cross-hair', null, async (until) => circle(one, 2, await middle(2), 60, until));
  await one.press('Shift+1');
  await one.press('w');
  await one.page.locator('[data-key="low-range"]').waitFor();
  await measured(one, 'a threshold dragged, four views', null, (until) => each_frame(one, until, (i, low) => {
    const slider = document.querySelector('[data-key="low-range"]');
    slider.value = String(low + 150 * Math.sin(i * 0.05));
    slider.dispatchEvent(new Event('input', { bubbles: true }));
  }, Number(process.env.BONE_LOW ?? 300)));
  await one.page.getByRole('button', { name: 'Cancel', exact: true }).click();
  // A piece: a region about the middle of the left view, cut, and moved within its ring.
  const centre = (await one.setting(1)).centre_mm;
  const corners = [[-90, -50], [-20, -50], [-20, -15], [-90, -15]].map(([y, z]) => [centre[1] + y, centre[2] + z]);
  await one.press('r');
  for (const corner of corners) await one.click_at(1, corner);
  await one.press('Enter');
  await one.page.locator('.lists .name', { hasText: /^cut$/ }).waitFor();
  await one.press('x');
  await one.shows(1, 'piece');
  await one.press('g');
  await one.page.locator('[data-key="move-forward_mm"]').waitFor();
  const ring = await one.position(1, [corners[0][0] + 35, corners[0][1] + 17]);
  await measured(one, 'a piece moved, with its overlap', 1, (until) => circle(one, 1, ring, 14, until));
} finally {
  await one.close();
  server.stop();
  fs.rmSync(folder, { recursive: true, force: true });
}

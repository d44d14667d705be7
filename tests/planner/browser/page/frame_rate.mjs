// SPDX-License-Identifier: AGPL-3.0-or-later
// How fast the panes follow a drag, in four panes of a window of 1200 x 900, browser and server on the same machine:
//   OCTOTOMY_PROGRAM=build/release/octotomy node frame_rate.mjs SCAN
// Prints the time to the page's first paint, in a browser just started and at best; then frames a second and the latency from
// the request to the picture on the canvas, for a view that is turned and for a piece that is moved with its overlap.
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

async function measured(one, what, pane, drag) {
  await one.at_rest();
  const first = await one.page.evaluate(() => window.pictures.length);
  const began = Date.now();
  await drag(began + drag_ms);
  const seconds = (Date.now() - began) / 1000;
  const pictures = (await one.page.evaluate((from) => window.pictures.slice(from), first)).filter((each) => each.quality === 'moving' && Number(each.pane) === pane);
  const latencies = pictures.map((each) => each.latency_ms).filter((each) => each !== null).sort((a, b) => a - b);
  const at = (share) => latencies[Math.min(latencies.length - 1, Math.floor(share * latencies.length))] ?? NaN;
  const row = { what, frames_per_s: pictures.length / seconds, median_ms: at(0.5), p95_ms: at(0.95) };
  console.log(`${what.padEnd(34)} ${row.frames_per_s.toFixed(1).padStart(6)} frames/s   median ${row.median_ms.toFixed(1)} ms   95th percentile ${row.p95_ms.toFixed(1)} ms`);
  return row;
}

/// Moves the pressed pointer in a circle about a place until the time has come, once a frame of the browser, as it gives a
/// hand's movements to a page.
async function circle(one, pane, centre, radius, until) {
  const { mouse } = one.page;
  await mouse.move(centre.x, centre.y);
  await mouse.down();
  await one.page.evaluate(async ([index, x, y, r, end]) => {
    const canvas = document.querySelectorAll('.pane canvas')[index];
    for (let i = 0; Date.now() < end; ++i) {
      await new Promise(requestAnimationFrame);
      const at = { clientX: x + r * Math.cos(i * 0.07), clientY: y + r * Math.sin(i * 0.07) };
      canvas.dispatchEvent(new PointerEvent('pointermove', { pointerId: 1, bubbles: true, buttons: 1, ...at }));
    }
  }, [pane, centre.x, centre.y, radius, until]);
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

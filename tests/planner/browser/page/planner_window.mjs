// SPDX-License-Identifier: AGPL-3.0-or-later
// A planner's server and a window of headless Chromium, started without any GL, that looks at it. Actions are counted as a
// person would: a click, a drag, a key, a typed field.
import { execFileSync, spawn } from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { chromium } from 'playwright-core';

export const program = process.env.OCTOTOMY_PROGRAM ?? 'build/release/octotomy';
export const browser_path = process.env.OCTOTOMY_CHROMIUM ?? '/usr/bin/chromium';

/// A real head, in the folder of the reference scans; where its jaw is rebuilt, and where the leg phantom's fibula is taken.
export const head_scan = path.join(process.env.OCTOTOMY_SHARED_DATA ?? '.', 'ct_unc_cthead.nrrd');
export const jaw_marks = { flap_1: [-56, -44, 45], flap_2: [-37, -70, 43], flap_3: [-8, -79, 41], flap_4: [7, -62, 43], flap_before: [-63, -32, 50], flap_after: [14, -50, 46] };
export const donor_marks = { donor_from: [30, 12, 105], donor_to: [33, 16, -105], donor_face: [45, 12, 105] };

/// Lays the head phantom into a folder, of voxels of 1 or 2 mm; copied where OCTOTOMY_PHANTOMS names a folder that has it.
export function lay_phantom(folder, voxel_mm = 1) {
  const laid = path.join(folder, 'head_phantom.nrrd'), made = path.join(process.env.OCTOTOMY_PHANTOMS ?? '', `head_phantom_${voxel_mm}.nrrd`);
  if (process.env.OCTOTOMY_PHANTOMS) fs.copyFileSync(made, laid);
  else execFileSync(program, ['phantom', 'head', '--voxel', `${voxel_mm}`, '-o', laid]);
}

/// Starts `octotomy serve` in a folder; answers its URL, that of pages which only look (with --share), and stop().
export function start_server(folder, more = []) {
  const child = spawn(program, ['serve', ...more], { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
  let said = '';
  return new Promise((resolve, reject) => {
    child.stdout.on('data', (data) => {
      said += data;
      const url = said.match(/http:\S+/);
      if (url) resolve({ url: url[0], view_url: said.match(/To look only: (http:\S+)/)?.[1], process: child, stop: () => child.kill() });
    });
    child.stderr.on('data', (data) => { said += data; });
    child.on('exit', (status) => reject(new Error(`octotomy serve ended with ${status}: ${said}`)));
  });
}

/// A proxy between window and server that can be cut: bytes of both directions are dropped then, and nobody is told. A
/// WebSocket through it opens `late_ms` after it was asked for.
export function start_proxy({ late_ms = 0 } = {}) {
  let is_cut = false;
  const sockets = new Set();
  const proxy = http.createServer((request, response) => {
    if (is_cut) return;
    const asked = http.request(request.url, { method: request.method, headers: request.headers }, (answer) => {
      response.writeHead(answer.statusCode, answer.headers);
      answer.pipe(response);
    });
    asked.on('error', () => response.destroy());
    request.pipe(asked);
  });
  proxy.on('connect', (request, near) => {
    if (is_cut) return;
    const [host, port] = request.url.split(':');
    let is_dead = false;
    const far = net.connect(Number(port), host, () => setTimeout(() => near.write('HTTP/1.1 200 Connection established\r\n\r\n'), late_ms).unref());
    for (const [from, to] of [[near, far], [far, near]]) {
      sockets.add(from);
      from.on('data', (bytes) => {
        is_dead ||= is_cut;
        if (!is_dead) to.write(bytes);
      });
      from.on('error', () => {});
      from.on('close', () => { if (!is_dead) to.destroy(); });
    }
  });
  return new Promise((resolve) => proxy.listen(0, '127.0.0.1', () => resolve({
    url: `http://127.0.0.1:${proxy.address().port}`,
    cut: () => { is_cut = true; },
    mend: () => { is_cut = false; },
    stop: () => {
      for (const socket of sockets) socket.destroy();
      proxy.closeAllConnections();
      proxy.close();
    },
  })));
}

const axes = {
  anterior: [[1, 0, 0], [0, 0, 1]], left: [[0, 1, 0], [0, 0, 1]], superior: [[-1, 0, 0], [0, -1, 0]],
  coronal: [[1, 0, 0], [0, 0, 1]], sagittal: [[0, 1, 0], [0, 0, 1]], axial: [[1, 0, 0], [0, -1, 0]],
};
const axial_pane = 2; // of the layout "Views and slices"
/// What is waited for comes late on a machine with other work, and is never timed by a wait.
const patience_ms = 120000;
/// What the page asks to change its plan.
const changes = new Set(['edit', 'open', 'undo', 'redo', 'branch', 'go_to', 'name_version', 'landmark', 'procedure']);
/// A request is answered, or its progress told, within this time on a machine without other work.
const silence_ms = 5000;
/// A hand turns the wheel by so many notches at once.
const notches_of_a_turn = 20;

export class PlannerWindow {
  actions = 0;
  answers = 0; // that came over the wire
  problems = [];
  asked = new Set(); // ids of changes of the plan that have no answer yet
  waiting = new Map(); // all requests without an answer by their ids: what was asked, and when the server last spoke of it
  late = []; // requests of which the server did not speak for longer than silence_ms
  frames = []; // headers and pictures that came over the wire, the newest last

  /// Opens the page. `size` is the window's; `theme` light or dark; `proxy` the URL of one between.
  static async open(url, { size = { width: 1440, height: 900 }, theme = 'dark', proxy } = {}) {
    const one = new PlannerWindow();
    one.browser = await chromium.launch({
      executablePath: browser_path, proxy: proxy && { server: proxy, bypass: '<-loopback>' }, args: ['--disable-gpu', '--disable-software-rasterizer', '--no-sandbox'],
    });
    one.context = await one.browser.newContext({ viewport: size, colorScheme: theme, acceptDownloads: true, permissions: ['clipboard-read', 'clipboard-write'] });
    one.page = await one.context.newPage();
    one.page.setDefaultTimeout(patience_ms);
    one.page.on('console', (message) => { if (message.type() === 'error') one.problems.push(message.text()); });
    one.page.on('pageerror', (error) => one.problems.push(`${error}\n${error.stack ?? ''}`));
    one.page.on('websocket', (socket) => {
      one.asked.clear();
      one.waiting.clear();
      socket.on('framesent', ({ payload }) => one.take_request(JSON.parse(payload)));
      socket.on('framereceived', ({ payload }) => (typeof payload === 'string' ? one.take_answer(JSON.parse(payload)) : one.take_picture(payload)));
      socket.on('close', () => {
        one.asked.clear();
        one.waiting.clear();
      });
    });
    // Before any script of the page: every context that a canvas is asked for is counted by its kind.
    await one.page.addInitScript(() => {
      window.asked_contexts = {};
      const before = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        window.asked_contexts[kind] = (window.asked_contexts[kind] ?? 0) + 1;
        return before.call(this, kind, ...rest);
      };
      window.pictures = [];
      addEventListener('picture', (event) => window.pictures.push({ at: performance.now(), pane: event.target.closest('.pane').dataset.pane, ...event.detail }));
    });
    await one.page.goto(url);
    return one;
  }

  take_request(message) {
    if (changes.has(message.do)) this.asked.add(message.id);
    if (message.id) this.waiting.set(message.id, { what: message.do, at: Date.now() });
  }
  take_answer(message) {
    this.answers++;
    this.asked.delete(message.id);
    this.hear(message.id ?? message.job, message.id !== undefined);
  }
  /// The server spoke of a request: it is told as late where it was silent for too long.
  hear(id, is_answer) {
    const request = this.waiting.get(id);
    if (!request) return;
    const silent_ms = Date.now() - request.at;
    if (silent_ms > silence_ms * Math.max(1, os.loadavg()[0] / os.cpus().length)) this.late.push(`${request.what}: ${silent_ms} ms`);
    request.at = Date.now();
    if (is_answer) this.waiting.delete(id);
  }
  take_picture(payload) {
    const length = payload.readUInt32LE(0);
    const header = JSON.parse(payload.subarray(4, 4 + length).toString());
    this.hear(header.id, true);
    if (header.quality !== 'rest') return;
    this.frames.push({ header, picture: payload.subarray(4 + length, 4 + length + header.parts[0].bytes) });
    if (this.frames.length > 40) this.frames.shift();
  }

  close = () => this.browser.close();

  /// Milliseconds from the page's navigation to its first paint with content; null before.
  first_paint_ms() {
    return this.page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? null);
  }

  async click(what, options = {}) {
    this.actions++;
    await (typeof what === 'string' ? this.page.getByRole('button', { name: what, ...options }).first() : what).click();
  }
  async press(key) {
    this.actions++;
    await this.page.keyboard.press(key);
  }
  async type(key, text) {
    this.actions++;
    const field = this.page.locator(`[data-key="${key}"]`);
    await field.fill(String(text));
    await field.press('Enter');
  }

  /// The canvas position of a point of a pane's view, in the view's millimetres.
  async position(pane, uv) {
    const setting = await this.setting(pane);
    const box = await this.page.locator('.pane canvas').nth(pane).boundingBox();
    const [right, up] = axes[setting.mode === 'slice' ? setting.plane : setting.view];
    const of = (axis) => setting.centre_mm.reduce((sum, value, i) => sum + value * axis[i], 0);
    return { x: box.x + box.width / 2 + (uv[0] - of(right)) / setting.pixel_mm, y: box.y + box.height / 2 - (uv[1] - of(up)) / setting.pixel_mm };
  }
  /// How the window looks at its plan, as the browser keeps it.
  look() {
    return this.page.evaluate(() => {
      const key = Object.keys(localStorage).find((name) => name.startsWith('octotomy:'));
      return JSON.parse(localStorage.getItem(key));
    });
  }
  async setting(pane) {
    return (await this.look()).panes[pane];
  }
  /// The middle of what is shown, once it is.
  async middle(what) {
    const box = await this.until(() => what.boundingBox(), `${what} in sight`);
    return [box.x + box.width / 2, box.y + box.height / 2];
  }
  /// Clicks a point in the axial slice, after the wheel has brought its height.
  async click_in_axial(point, spacing_mm) {
    const { cross_mm } = await this.look();
    const notches = Math.round((point[2] - cross_mm[2]) / spacing_mm);
    const { x, y } = await this.position(axial_pane, [point[0], -point[1]]);
    await this.page.mouse.move(x, y);
    for (let i = 0; i < Math.abs(notches); ++i) await this.page.mouse.wheel(0, Math.sign(notches) * 100);
    this.actions += Math.ceil(Math.abs(notches) / notches_of_a_turn) + 1;
    await this.page.waitForTimeout(80);
    await this.page.mouse.click(x, y);
  }
  async click_at(pane, uv) {
    this.actions++;
    const { x, y } = await this.position(pane, uv);
    await this.page.mouse.click(x, y);
  }
  async drag(pane, from, to) {
    this.actions++;
    const [a, b] = [await this.position(pane, from), await this.position(pane, to)];
    await this.page.mouse.move(a.x, a.y);
    await this.page.mouse.down();
    for (let i = 1; i <= 12; ++i) {
      await this.page.mouse.move(a.x + ((b.x - a.x) * i) / 12, a.y + ((b.y - a.y) * i) / 12);
      await this.page.waitForTimeout(20);
    }
    await this.page.mouse.up();
  }
  /// Waits until every pane that is shown has its picture at rest.
  async at_rest() {
    await this.page.waitForTimeout(350);
    await this.page.waitForFunction(() => {
      const shown = [...document.querySelectorAll('.pane')].filter((pane) => !pane.hidden).map((pane) => pane.dataset.pane);
      if (document.querySelector('.pane:not([hidden]) canvas[aria-busy="true"]')) return false;
      return shown.every((pane) => window.pictures.filter((one) => one.pane === pane).pop()?.quality === 'rest');
    });
  }
  /// Waits until a pane at rest shows an object.
  async shows(pane, object) {
    await this.until(() => this.frames.filter(({ header }) => header.pane === pane).pop()?.header.objects?.includes(object), `${object} in pane ${pane}`);
    await this.page.waitForTimeout(150);
  }
  /// Runs a command of the palette by its name.
  async command(name) {
    await this.press('Control+k');
    await this.page.locator('dialog[open] .palette-field').fill(name);
    await this.press('Enter');
  }
  select(step) {
    return this.click(this.page.locator('.lists .name', { hasText: new RegExp(`^${step.replace(/_/g, ' ')}$`) }));
  }
  tab(name) {
    return this.click(this.page.getByRole('tab', { name }));
  }
  /// The saved plan.
  plan(path) {
    return JSON.parse(fs.readFileSync(path, 'utf8'));
  }
  /// Waits until a test holds, and the page has the answers to what it asked: the plan's file changes before
  /// the page hears of it.
  async until(test, what, within_ms = patience_ms) {
    const end = Date.now() + within_ms;
    for (;;) {
      const found = await test();
      if (found && !this.asked.size) {
        await this.page.evaluate(() => new Promise((done) => setTimeout(done)));
        return found;
      }
      if (Date.now() > end) throw new Error(`${what}: not within ${within_ms / 1000} s`);
      await this.page.waitForTimeout(60);
    }
  }
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// What the page makes of certificates, kept views, names beside points and scans that are not the patient's, without a
// browser: its sources, bundled for node.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

const page = process.env.OCTOTOMY_PAGE_SOURCES ?? path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../../../../planner/browser/page');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'octotomy-badge-'));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

/// Stands for a document and all its elements: any member can be called, set and asked for.
const anything = new Proxy(function () {}, {
  get: (_, name) => (name === Symbol.toPrimitive ? () => '' : name === Symbol.iterator ? function* () {} : anything),
  apply: () => anything, construct: () => anything, set: () => true,
});
const kept = new Map();
Object.assign(globalThis, {
  document: anything, window: anything, addEventListener() {}, matchMedia: () => anything, location: { search: '', hash: '', host: '' }, Node: class {},
  localStorage: { getItem: (name) => kept.get(name) ?? null, setItem: (name, text) => kept.set(name, text) },
  Element: class {}, SVGElement: class {}, HTMLElement: class {}, HTMLInputElement: class {}, ResizeObserver: anything,
});
fs.writeFileSync(path.join(folder, 'all.ts'),
                 ['panel/certificate_badge', 'state', 'base/ink', 'tool/tool', 'tool/point_tools'].map((name) => `export * from ${JSON.stringify(`${page}/${name}`)};\n`).join(''));
execFileSync(process.env.ESBUILD ?? 'esbuild', [path.join(folder, 'all.ts'), '--bundle', '--format=esm', '--log-level=warning', `--outfile=${path.join(folder, 'all.mjs')}`]);
const { judged, is_wider_than_its_value, measured_text, kept_view, set, state, leave_scan, begin_ink, label, register_tools, take_tool, landmark_tool, arch_tool, distance_tool } = await import(pathToFileURL(path.join(folder, 'all.mjs')));

const pass = { verdict: 'PASS', sentence: 'PASS: both kernels agree' };
const volume = (value, half_width) => ({ value, unit: 'mm3', half_width });

test('an interval wider than its value is no success', () => {
  assert.equal(judged(pass, volume(26369, 45377)).verdict, 'WARN');
  assert.match(judged(pass, volume(26369, 45377)).sentence, /wider than the value/);
  assert.equal(judged(pass, volume(26461, 1269)).verdict, 'PASS');
  assert.equal(judged({ ...pass, verdict: 'FAIL' }, volume(1, 2)).verdict, 'FAIL');
  assert.equal(judged(null, volume(1, 2)), null);
  assert.ok(is_wider_than_its_value(volume(-1, 2)));
  assert.ok(!is_wider_than_its_value(volume(null, 2)) && !is_wider_than_its_value(null));
});

test('a number has its own unit, and none where there is no answer', () => {
  assert.equal(measured_text({ value: 31.5, unit: 'mm', half_width: null }), '31.50 mm');
  assert.equal(measured_text({ value: 12.25, unit: 'deg', half_width: 0.5 }), '12.25 ± 0.50 °');
  assert.equal(measured_text({ value: 253.25, unit: 'mm2', half_width: 25.2 }), '253 ± 25 mm²');
  assert.equal(measured_text({ value: 1148, unit: '1', half_width: null }), '1148');
  assert.equal(measured_text({ value: null, unit: 'mm3', half_width: null }), '–');
});

const plan_of = (scan) => ({ path: '/a/head.plan.json', plan: { steps: [] }, scans: [{ name: 'ct', path: scan, dims: [10, 10, 10], bounds_mm: [[0, 0, 0], [10, 10, 10]] }] });

test("how one scan was looked at is not taken for another scan's under the same path", async () => {
  set({ plan: plan_of('one.nrrd'), page: 'plan', arch_mm: [[1, 2, 3], [4, 5, 6]] });
  await new Promise((done) => setTimeout(done));
  assert.equal(kept_view(plan_of('one.nrrd')).arch_mm.length, 2);
  assert.equal(kept_view(plan_of('two.nrrd')), null);
  assert.equal(kept_view({ ...plan_of('one.nrrd'), path: '/b/head.plan.json' }), null);
  assert.equal(kept_view({ ...plan_of('one.nrrd'), scans: [] }).arch_mm.length, 2, 'scans that are not read yet contradict nothing');
});

test('a scan that replaces another leaves no arch, plane or preview of the one before', () => {
  set({ arch_mm: [[1, 2, 3]], cut_plane: { axis: 0, side: 1, offset_mm: 3 }, preview: { object: '', steps: [] }, tried: { mm3: 1, voxels: 1, refusal: '' } });
  leave_scan();
  assert.deepEqual([state.arch_mm, state.cut_plane, state.preview, state.tried], [[], null, null, null]);
});

/// A canvas's context that stores where words are written, with letters of six pixels.
function context_of(width, height) {
  const written = [];
  return { written, canvas: { width, height }, measureText: (words) => ({ width: 6 * words.length }), fillText: (words, x, y) => written.push({ words, x, y, right: x + 6 * words.length }),
    strokeText() {}, beginPath() {}, moveTo() {}, lineTo() {}, stroke() {}, closePath() {} };
}

test('names of crowded points do not cover each other, and one without room is left out', () => {
  const names = ['nasion', 'sella', 'ans', 'pns', 'a point', 'b point', 'pogonion', 'menton', 'orbitale left', 'orbitale right', 'zygoma left', 'zygoma right'];
  const write = (context) => {
    begin_ink(false);
    names.forEach((name, i) => label(context, name, [context.canvas.width / 2 + (i % 3), context.canvas.height / 2 + 2 * i], 1, { px: 11, may_be_left_out: true }));
    for (const [i, a] of context.written.entries())
      for (const b of context.written.slice(i + 1))
        assert.ok(a.right <= b.x || b.right <= a.x || Math.abs(a.y - b.y) >= 11, `${a.words} covers ${b.words}`);
    return context.written.length;
  };
  assert.equal(write(context_of(400, 400)), names.length);
  const few = write(context_of(150, 100));
  assert.ok(few > 0 && few < names.length, `${few} names in a small pane`);
});

test("no tool makes anything of the patient's scan while another scan is shown", () => {
  register_tools([{ name: 'navigate', is_for_any_scan: true }, landmark_tool, arch_tool, distance_tool]);
  const scan = (name) => ({ name, path: `${name}.nrrd`, bounds_mm: [[0, 0, 0], [10, 10, 10]] });
  set({ plan: { path: '/a/flap.plan.json', landmarks: [], objects: [], plan: { steps: [], scans: { ct: {}, donor: {} } }, scans: [scan('ct'), scan('donor')] },
    hello: { procedures: [{ landmarks: [{ name: 'donor_from', scan: 'donor' }] }] }, scan: 'donor', notices: [] });
  take_tool('distance');
  assert.equal(state.tool, 'navigate');
  assert.match(state.notices.at(-1).message, /^Distance works on the patient's scan: show that scan first/);
  take_tool('landmark');
  assert.equal(state.tool, 'landmark');
  landmark_tool.down({ pane: {}, at: [0, 0] });
  assert.match(state.notices.at(-1).message, /^On the scan 'donor' only landmarks can be placed that a procedure expects there/);
  set({ scan: null });
  take_tool('distance');
  assert.equal(state.tool, 'distance');
});

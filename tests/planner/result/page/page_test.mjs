// SPDX-License-Identifier: AGPL-3.0-or-later
// What the pages of results draw: OCTOTOMY_PROGRAM writes a report, and its script draws that and given data.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { drawn, parts_of } from './drawn.mjs';

const folder = mkdtempSync(join(tmpdir(), 'octotomy-page-'));
after(() => rmSync(folder, { recursive: true }));
const octotomy = (...words) => execFileSync(process.env.OCTOTOMY_PROGRAM, words, { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
const times = (text, what) => text.split(what).length - 1;
const hostile = 'A </script><b>bold</b> & "quoted" plan';

// A ball of radius 12 mm in voxels of 1 mm.
const side = 32, samples = new Int16Array(side ** 3);
for (let i = 0; i < samples.length; ++i) {
  const [x, y, z] = [i % side, Math.floor(i / side) % side, Math.floor(i / side ** 2)].map((at) => at - (side - 1) / 2);
  samples[i] = Math.max(-1000, Math.min(1000, 200 * (12 - Math.hypot(x, y, z))));
}
writeFileSync(join(folder, 'ball.nrrd'), Buffer.concat([
  Buffer.from(`NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: ${side} ${side} ${side}\n` +
              `space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (-15.5,-15.5,-15.5)\nencoding: raw\nendian: little\n\n`),
  Buffer.from(samples.buffer)
]));
writeFileSync(join(folder, 'my.plan.json'), JSON.stringify({
  octotomy_plan: 1, name: hostile, scans: { ct: { path: 'ball.nrrd' } },
  steps: [
    { id: 'ball', do: 'window', scan: 'ct', low: 0 },
    { id: 'cut', do: 'mask', regions: [{ view: 'left', polygons_mm: [[[-30, 3.2], [30, 3.2], [30, 30], [-30, 30]]] }] },
    { id: 'cap', do: 'combine', expression: 'ball & cut' },
    { id: 'cup', do: 'combine', expression: 'ball - cut' },
    { id: 'lifted', do: 'move', object: 'cap', translate_mm: [0, 0, 2] },
    { id: 'nothing', do: 'combine', expression: 'cup & lifted' },
    { id: 'all', do: 'combine', expression: 'cup | lifted' },
    { id: 'cap_size', do: 'measure', object: 'cap' },
    { id: 'lift', do: 'measure', object: 'cup', to: 'lifted' },
    { id: 'wide', do: 'measure', points_mm: [[-12, 0, 0], [12, 0, 0]] },
    { id: 'corner', do: 'measure', points_mm: [[-12, 0, 0], [0, 0, 0], [0, 5, 5]] },
    { id: 'touch', do: 'contacts', object: 'lifted', against: 'cup', within_mm: 3 },
    { id: 'surface', do: 'export', object: 'lifted', path: 'pieces/cap #1.stl' },
    { id: 'void', do: 'export', object: 'nothing', path: 'nothing.stl' }]
}));
octotomy('run', 'my.plan.json', '-o', 'out');
const page = readFileSync(join(folder, 'out/report.html'), 'utf8');
const { data, script, shell } = parts_of(page);
const { result } = data;
const report = drawn(script, data);
const contains = (text, ...parts) => parts.forEach((part) => assert.ok(text.includes(part), `${part} is not in ${text.slice(0, 4000)}`));

test('a page holds the result and needs nothing else', () => {
  assert.deepEqual(result.certificates, JSON.parse(readFileSync(join(folder, 'out/result.json'))).certificates);
  assert.equal(times(shell, 'http'), 1, 'http-equiv alone');
  assert.equal(times(shell, '<link'), 0);
  assert.equal(times(report, '<image '), times(report, 'href="data:image/png;base64,'));
  // Two views before and after, eight views of the end, two of the contacts.
  assert.equal(times(report, '<image '), 14);
  for (const object of result.objects) contains(report, object.id);
  assert.doesNotMatch(report.replace(/base64,[^"]*/g, ''), /\[object |undefined|NaN/);
});

test('without a script a page names what it is and where the numbers are', () =>
    contains(shell, '<h1>A &lt;/script&gt;&lt;b&gt;bold&lt;/b&gt; &amp; &quot;quoted&quot; plan</h1>', 'read result.json'));

test('names cannot become markup', () => {
  assert.equal(result.plan.name, hostile);
  for (const text of [page, report]) assert.equal(times(text, '<b>bold'), 0);
  contains(report, '<h1>A &lt;/script&gt;&lt;b&gt;bold');
});

test('each picture says what it shows', () => {
  const pictures = [...report.matchAll(/<svg ([^>]*)>/g)].map(([, attributes]) => attributes);
  assert.equal(pictures.length, 14);
  for (const one of pictures) assert.match(one, /role="img" aria-label="[^"]+, [^"]+"/);
  contains(report, 'aria-label="before: cup, cap, left"', '<b>Before</b>, left', "35° to the patient's left, 15° above");
});

test("a mask's outline stands where it was drawn, before the motion alone", () => {
  const left = data.pictures.find((group) => group.name === 'before').pictures.find((one) => one.view === 'left');
  const y = left.size_px / 2 - (3.2 - left.centre_mm[1]) * left.size_px / left.width_mm;
  const outlines = [...report.matchAll(/class="outline" d="([^"]*)"/g)].map(([, path]) => path);
  assert.equal(outlines.length, 1);
  contains(outlines[0], ` ${y.toFixed(2)}L`);
});

test('contacts are numbered in each of their pictures', () => {
  const { contacts } = result.measurements.find((one) => one.id === 'touch');
  assert.ok(contacts.length > 0);
  assert.equal(times(report, '<circle '), 2 * contacts.length);
  assert.equal(times(report, ' paint-order="stroke">1</text>'), 2);
});

test('movements, measurements, certificates, scans and exports have their rows', () => {
  contains(report, '<h2>Movements</h2>', 'up 2.0 mm; pitch', 'Pitch is positive where the front goes up',
           '<td><b>lifted</b></td><td class="n">0.00</td><td class="n">+2.00</td><td class="n">0.00</td>');
  contains(report, 'gap, cup to lifted', '<td>wide</td><td>distance of two points</td><td class="n">24.00 ± ', '90.00 ± ',
           '<h3>Contacts touch</h3>', 'Volume, mm³', '<div class="tiles">');
  contains(report, '<h2>Certificates</h2>', '<code>ball &amp; cut</code>', 'Voxel lineage:', 'Detection limit: ',
           `<td class="n">${result.measurements[0].volume_mm3.toFixed(1)}</td>`);
  contains(report, '<h2>Scan and audit</h2>', result.scans[0].sha256, ' × ', 'Coordinates are DICOM');
  contains(report, '<a href="pieces/cap%20%231.stl">pieces/cap #1.stl</a>', 'NOT WRITTEN', '<a href="credibility.html">',
           '14 steps, as JSON that <code>octotomy run</code> replays');
});

test('a disagreement is the first thing said', () => {
  contains(report, 'The two kernels agree');
  const worse = structuredClone(data);
  worse.counts.FAIL = 1;
  worse.result.certificates[0].verdict = 'FAIL';
  const text = drawn(script, worse);
  contains(text, '<div class="verdict fail"><b>The two kernels disagree</b>', '<details open=""><summary><code>ct from 0');
});

test('a part that fails its proof is said first, and its proof is in the measurements', () => {
  const worse = structuredClone(data);
  worse.counts.measured = { PASS: 0, WARN: 0, FAIL: 1 };
  worse.result.measurements = [
    { id: 'seats', object: 'jig', verdict: 'FAIL', findings: ['binds on <bone>'] },
    { id: 'unknown', object: 'jig', verdict: null, findings: [] }];
  const text = drawn(script, worse);
  contains(text, '<div class="verdict fail"><b>A measurement fails</b>', '; 1 measurement with a FAIL',
           '<td>seats</td><td>jig</td><td><span class="pill fail">FAIL</span></td>', 'binds on &lt;bone&gt;', 'not measured');
});

const with_measurements = (...measurements) => drawn(script, { ...data, result: { ...result, measurements } });

test('a flap has the order, lengths, angles and contacts of its segments', () => {
  const cut = { at_mm: 20, tilt_deg: 28.7 };
  const text = with_measurements({
    id: 'flap', donor_used_mm: 130.57, contact_estimator: 'a volume over a thickness',
    flap_segments: [{ number: 1, object: 'a<b', length_mm: 25.94, shortest_mm: 17.4, longest_mm: 34.5, angle_to_last_deg: null,
                      first_cut: cut, second_cut: cut }],
    osteotomies: [{ number: 1, object: 'contact_1', between: ['bone', 'a<b'], contact_voxels_mm2: 177, contact_mesh_mm2: null,
                    tolerance_mm2: null, verdict: null }]
  });
  contains(text, '1. a&lt;b', '25.9 mm', '20.0 mm, 28.7°', '177 mm²', '130.6 mm');
  assert.ok(!text.includes('a<b'));
  assert.ok(!report.includes('Free flap'));
});

test('numbers are rounded as the program rounds them', () => {
  for (const [distance_mm, text] of [[0.125, '0.12'], [0.375, '0.38'], [1.005, '1.00'], [9999.5, '9999.50'], [12345.675, '12\u202f345.67'],
                                     [-0.001, '0.00'], [-1234567.5, '−1\u202f234\u202f567.50'], [0.015625, '0.02']])
    contains(with_measurements({ id: 'd', distance_mm, distance_half_width_mm: null }), `<td class="n">${text} mm</td>`);
});

test('guesses of landmarks have their uncertainty, and what was not found', () =>
    contains(with_measurements({
      id: 'guess', missing: [{ name: 'nasion', says: 'the root', why: 'there is no brow' }], findings: ['a doubt'],
      landmarks: [{ name: 'ans', says: 'the tip <of> the spine', point_mm: [0.26, -87.7, -33.2], uncertainty_mm: 1.04 }]
    }), 'First guess of landmarks, guess', 'the tip &lt;of&gt; the spine', '>0.3<', '>−33.2<', '>1.0<', 'Nobody has confirmed them',
        'nasion: there is no brow', 'a doubt'));

test('an airway has both answers, its narrowest section and a plot', () => {
  const section = { along_mm: 20, at_mm: [1, 2, -3], area_mm2: 80, half_width_mm2: 4, voxel_mm2: 81, mesh_mm2: 80 };
  const text = with_measurements({
    id: 'air', object: 'air', findings: [],
    airway: { volume_mm3: 15000, volume_half_width_mm3: 210, volume_mesh_mm3: 15100, length_mm: 60, narrowest: section,
              sections: [{ ...section, along_mm: 0, mesh_mm2: null }, section] }
  });
  contains(text, '15\u202f000 ± 210', '80.0 ± 4.00', 'at x 1.0, y 2.0, z −3.0 mm', 'aria-label="Area of the airway');
});

test('trials name their errors and the part of each', () =>
    contains(with_measurements({
      id: 'doubt', trials: 1000, findings: [],
      errors: { landmark_mm: 0.6, seating_mm: 0.5, seating_deg: 0.4, kerf_mm: 0.1, segmentation_mm: 0.3 },
      doubts: [{ what: 'gap', of: 'rest to moved', value: 1.5, unit: 'mm', half_width: 0.9, sources: [{ name: 'kerf', half_width: 0.2 }] }]
    }), '<td>gap</td><td>rest to moved</td><td class="n">1.5 ± 0.900 mm</td><td class="n">–</td><td class="n">0.200</td>',
        '99 of 100 of 1000 trials', "a piece's seating 0.5 mm along each axis, its turn 0.4° about each"));

test('ratios of landmarks have a row each, and two predictions their difference', () => {
  const along = { forward_mm: 1.12, up_mm: 0.28, left_mm: 0 };
  const landmarks = [
    { ...along, name: 'pronasale', follows: 'ans@advanced', at_mm: [0, -115, -23], ratio: 0.28, ratio_up: 0.1, source: '<F> 1977', half_width_mm: 1.06 },
    { forward_mm: 0, up_mm: 0, left_mm: 0, name: '', follows: '', at_mm: [0, -99, -64], ratio: null, ratio_up: null, source: '', half_width_mm: null }];
  const text = drawn(script, { ...data, result: { ...result, objects: [...result.objects,
    { id: 'quick', kind: 'landmark_ratios', definition: '', mesh: null, findings: [], details: { fade_mm: 60, landmarks } }] } });
  contains(text, 'Soft tissue by ratios of landmarks', '<td>pronasale</td><td>ans@advanced</td>', '0.28, up 0.10', '&lt;F&gt; 1977',
           '+1.12', '± 1.1', '<td>0.0, −99.0, −64.0</td><td>stays</td>', 'beyond 60 mm of all landmarks it is zero');
  const way = { mean_mm: 1, signed_mean_mm: 0, p95_mm: 2, max_mm: 3, bands: [] };
  contains(with_measurements({
    id: 'apart', a: 'quick', b: 'by_elements', mean_mm: 1, hausdorff_mm: 3, hausdorff95_mm: 2, a_to_b: way, b_to_a: way, findings: [],
    face: { skin: 'head', mean_mm: 0.99, largest_mm: 3.72, largest_at_mm: [-32, -88, -28], area_mm2: 17170, definition: 'length of the difference',
            landmarks: [{ name: 'upper_lip', at_mm: [0, -101, -54], a_moved_mm: [0, -2.2, 0.55], b_moved_mm: [0, -3.2, -1.2], difference_mm: 2.05 }] }
  }), 'The face by quick and by by_elements, point by point', '0.00, −2.20, 0.55', '>2.05<', '>0.99<', 'face, largest, at −32, −88, −28 mm', '>3.72<');
});

test('cephalometry has intervals and norms, signatures what changed since', () => {
  const row = { name: 'SNA', says: 'maxilla', unit: 'deg', before: { value: 80, half_width: 1.5 }, after: { value: 84, half_width: 1.5 },
                change: { value: 4, half_width: 2 }, norm: 82, deviation: 2, source: 'Steiner 1953', norm_of: 'an average child' };
  const text = drawn(script, { ...data, patients: ['Doe, Jane', 'Doe, John'], cephalogram: 'AAAA', result: { ...result,
    cephalometry: { landmark_deviation_mm: 0.6, measures: [row, { ...row, name: 'Wits', unit: 'mm', norm: null, deviation: null, source: '', norm_of: undefined }] },
    signatures: [{ by: 'Dr <A>', as: 'surgeon', at: '2026-01-01', note: 'read', changed_since: ['steps'] }] } });
  contains(text, '80.0 ± 1.5', '+4.0 ± 2.0', '82.0 ± 2.0', 'Steiner 1953: an average child.', 'Wits, mm', 'src="data:image/png;base64,AAAA"', 'Doe, Jane; Doe, John',
           'signed by <b>Dr &lt;A&gt;</b>, surgeon, 2026-01-01, changed since: read');
});

test('the credibility page claims nothing and lists what supports each number', () => {
  const parts = parts_of(readFileSync(join(folder, 'out/credibility.html'), 'utf8'));
  assert.equal(parts.script, script);
  const text = drawn(parts.script, parts.data);
  contains(text, 'claims no conformity', 'certificate, object cap, tier bounded, verdict PASS', '<h2>Credibility factors</h2>',
           '<td><b>cap_size</b>, volume of cap</td>', '<h1>Credibility: A &lt;/script&gt;');
});

const certificate = result.certificates.find((one) => one.object === 'cap');
const verification = (certificates, counts = {}, more = {}) => drawn(script, {
  kind: 'verification', octotomy: '1', subject: 'ball <b>.plan.json', not_covered: ['cut: a mask is certified together with the objects that it cuts'], worst: null,
  counts: { PASS: certificates.length, WARN: 0, FAIL: 0, not_resolved: 0, pass_not_resolved: 0, without_certificate: 0, ...counts },
  answer: { certificates, timings_ms: { certify: 12 }, ...more }
});

test('a verification shows every quantity and what is not covered', () => {
  const text = verification([certificate]);
  contains(text, 'ball &lt;b&gt;.plan.json', 'The two kernels agree', 'a mask is certified together with the objects that it cuts', 'certify 12 ms');
  for (const quantity of ['volume', 'area', 'centroid', 'inertia', 'symmetric difference', 'hausdorff95'])
    contains(text, `<td>${quantity}</td>`);
  assert.ok(!text.includes('>FAIL<') && !text.includes('without a certificate'));
  contains(verification([certificate], { without_certificate: 2 }), '2 objects without a certificate');
});

test('a failure is seen in the head, the table and the plot', () => {
  const worse = structuredClone(certificate);
  Object.assign(worse, { verdict: 'FAIL', reasons: ['volume differs by 9 mm3 where theory allows 3'] });
  Object.assign(worse.comparisons.find((one) => one.quantity === 'volume'), { difference: 9, tolerance: 3, verdict: 'FAIL' });
  const text = verification([worse], { PASS: 0, FAIL: 1 });
  contains(text, 'The two kernels disagree', 'volume differs by 9 mm3', 'fill="var(--bad)"', '<td class="n">3.00</td>');
  assert.equal(times(text, '>FAIL<'), 2, 'of the certificate and of the quantity');
});

test('an object that is not resolved is marked and no success', () => {
  const thin = { ...certificate, resolved: false, not_resolved_because: 'smallest extent is 2.00 voxels' };
  const text = verification([thin], { not_resolved: 1, pass_not_resolved: 1 });
  contains(text, 'The two kernels agree on objects that voxels do not resolve', '>PASS, not resolved<', 'smallest extent is 2.00 voxels',
           '1 object not resolved');
  assert.ok(!text.includes('Observed against allowed'));
});

test('among many certificates the worst are listed', () => {
  const many = Array.from({ length: 50 }, (_, i) => ({ ...certificate, operation: `question ${i}`, verdict: i === 41 ? 'WARN' : 'PASS' }));
  const text = verification(many);
  contains(text, 'The 30 worst of 50 certificates');
  assert.equal(times(text, '<code>question '), 30);
  assert.ok(text.indexOf('question 41<') < text.indexOf('question 0<'));
});

test("a suite's tables have a column for each key, and gaps are not covered", () => {
  const text = verification([], {}, {
    faults: [{ fault_name: 'flipped <x>', caught: true, share: 0.123456, count: 12345, none: null, both: [1, 2] }],
    not_recomputed: [{ where: 'table 3', why: 'no scan' }]
  });
  contains(text, '<h2>Seeded faults</h2>', '>fault name</th>', '<td>flipped &lt;x&gt;</td><td>yes</td><td class="n">0.123</td><td class="n">12\u202f345</td>' +
           '<td>–</td><td>1, 2</td>', 'table 3: no scan');
});

test('a cohort has its outliers, doubtful subjects and subjects without an answer', () => {
  const subject = { reason: '', has_picture: true, is_doubtful: false, audit: '' };
  const spread = { mean: 1, sd: 0.1, least: 0.5, median: 1, greatest: 9 };
  const text = drawn(script, {
    kind: 'cohort', findings: ['a finding'],
    subjects: [{ ...subject, label: '1' }, { ...subject, label: '2', is_doubtful: true, audit: 'FAIL, patient: <two>' },
               { ...subject, label: '3', has_picture: false, reason: 'b.nrrd: no scan' }],
    columns: [{ name: 'size.volume', unit: 'mm³', plots: ['<svg>plot</svg>'],
                summary: { ...spread, subjects: 2, outliers: [{ subject: '1', value: 9 }], doubtful: ['2'], without_doubtful: spread } }]
  });
  contains(text, '<h1>Cohort of 3 subjects</h1>', 'With an answer: 2, 1 of them doubtful. Without one: 1.', '<svg>plot</svg>', 'a finding',
           '<li><a href="#2">2</a>: FAIL, patient: &lt;two&gt;</li>', '<li><a href="#3">3</a>: b.nrrd: no scan</li>', 'src="../sub-1/picture.png"',
           '<figure id="1" class="outlier">', '<figcaption>1: outlier</figcaption>', 'no picture</span><figcaption>3: without an answer');
  const outliers = text.split('<h2>Outliers</h2>')[1].split('<h2>')[0];
  assert.equal(times(outliers, '<figure>'), 1);
  contains(outliers, '<a href="#1">1</a><br></br>size.volume 9.00 mm³');
});

// SPDX-License-Identifier: AGPL-3.0-or-later
// manifold_volumes.mjs PACKAGE QUESTIONS: prints the volume of each Boolean by Manifold, or "refused", a line
// each. A question is the operation (0 union, 1 intersection, 2 difference) and two surfaces, each as the
// counts of its points and triangles, the points as doubles and the corners.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [, , folder, questions] = process.argv;
const { default: load } = await import(pathToFileURL(`${folder}/manifold.js`));
const module = await load();
module.setup();
const { Manifold, Mesh } = module;

const bytes = readFileSync(questions);
let at = 0;
function numbers(type, count) {
  const size = type.BYTES_PER_ELEMENT * count;
  const part = new type(bytes.buffer.slice(bytes.byteOffset + at, bytes.byteOffset + at + size));
  at += size;
  return part;
}
// Manifold reads meshes in single precision. So each point is passed as its number, and a warp, which computes in
// double precision, replaces the numbers by the points.
function surface() {
  const [points, triangles] = numbers(Uint32Array, 2);
  const places = numbers(Float64Array, 3 * points);
  const corners = numbers(Uint32Array, 3 * triangles);
  const known = new Map();
  for (let v = 0; v < points; ++v) {
    const place = places.subarray(3 * v, 3 * v + 3);
    known.set(Array.from(place, Math.fround).join(), place);
  }
  const mesh = new Mesh({ numProp: 3, vertProperties: new Float32Array(places), triVerts: corners });
  mesh.merge();
  return new Manifold(mesh).warp((p) => {
    const place = known.get(Array.from(p, Math.fround).join());
    if (place) for (let k = 0; k < 3; ++k) p[k] = place[k];
  });
}

while (at < bytes.length) {
  const [operation] = numbers(Uint32Array, 1);
  let answer = 'refused';
  const operands = [];
  for (let k = 0; k < 2; ++k) {
    try {
      operands.push(surface());
    } catch {
      // Its triangles are read all the same.
    }
  }
  if (operands.length === 2 && operands.every((o) => o.status() === 'NoError')) {
    const [a, b] = operands;
    const result = operation === 0 ? a.add(b) : operation === 1 ? a.intersect(b) : a.subtract(b);
    if (result.status() === 'NoError') answer = String(result.volume());
    result.delete();
  }
  for (const o of operands) o.delete();
  console.log(answer);
}

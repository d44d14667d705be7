// SPDX-License-Identifier: AGPL-3.0-or-later
// manifold_peer.mjs PACKAGE OPERANDS union|difference: prints the median seconds of several Booleans and the
// triangles of the result.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [, , folder, operands, operation] = process.argv;
const { default: load } = await import(pathToFileURL(`${folder}/manifold.js`));
const module = await load();
module.setup();
const { Manifold, Mesh } = module;

const bytes = readFileSync(operands);
let at = 0;
function numbers(type, count) {
  const part = new type(bytes.buffer.slice(bytes.byteOffset + at, bytes.byteOffset + at + 4 * count));
  at += 4 * count;
  return part;
}
function surface() {
  const [points, triangles] = numbers(Uint32Array, 2);
  const mesh = new Mesh({
    numProp: 3,
    vertProperties: numbers(Float32Array, 3 * points),
    triVerts: numbers(Uint32Array, 3 * triangles)
  });
  mesh.merge();
  return new Manifold(mesh);
}
const [a, b] = [surface(), surface()];
if (a.status() !== 'NoError' || b.status() !== 'NoError')
  throw new Error(`operands: ${a.status()}, ${b.status()}`);

const runs = 5;
const seconds = [];
let triangles = 0;
// Once before they count: the first pays for compilation.
for (let run = 0; run <= runs; ++run) {
  const start = performance.now();
  const result = operation === 'union' ? a.add(b) : a.subtract(b);
  triangles = result.numTri();  // nothing is done before it is asked for
  if (run > 0) seconds.push((performance.now() - start) / 1000);
  result.delete();
}
seconds.sort((one, other) => one - other);
console.log(seconds[runs >> 1], triangles);

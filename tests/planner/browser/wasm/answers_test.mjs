// SPDX-License-Identifier: AGPL-3.0-or-later
// answers_test.mjs NATIVE WASM [CASES]: the voxel kernel as WebAssembly against this machine's own, on random
// expressions: the same bits, in at most twice the processor time. Status 77, and a line that says why, where there is no
// WebAssembly of it. Both run in turns, a piece of the cases at a time, so that other load meets both alike.
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const [native, wasm, cases = '10000'] = process.argv.slice(2);
if (!wasm || !existsSync(wasm)) {
  console.log('Skipped: this build has no WebAssembly (apt-get install clang-19 lld-19 libc++-19-dev-wasm32 libclang-rt-19-dev-wasm32 wasi-libc)');
  process.exit(77);
}
const host = fileURLToPath(new URL('run_wasi.mjs', import.meta.url));
const count = Number(cases), piece = Math.min(count, Math.max(5000, Math.ceil(count / 20)));

function answers(command, first, number, more = []) {
  const run = spawnSync(command[0], [...command.slice(1), `${first}`, `${number}`, ...more], { encoding: 'utf8', maxBuffer: 1 << 28 });
  if (run.status !== 0) throw new Error(`${command.join(' ')} ${first} ${number}: status ${run.status}: ${run.stderr}`);
  return Object.assign({ lines: run.stdout.trim().split('\n') }, ...run.stderr.trim().split('\n').map((line) => JSON.parse(line)));
}

let same = 0, empty = 0;
const leaves = [], ratios = [], seconds = { native: 0, wasm: 0 };
for (let first = 0; first < count; first += piece) {
  const number = Math.min(piece, count - first);
  const own = answers([native], first, number);
  const other = answers([process.execPath, '--no-warnings', host, wasm], first, number);
  if (own.lines.length !== number) throw new Error(`${own.lines.length} answers instead of ${number}`);
  for (let i = 0; i < number; ++i) {
    if (own.lines[i] !== other.lines[i])
      throw new Error(`case and digest here '${own.lines[i]}', in WebAssembly '${other.lines[i]}'; replay: ${native} ${first + i} 1`);
    ++same;
  }
  ratios.push(other.seconds / own.seconds);
  seconds.native += own.seconds;
  seconds.wasm += other.seconds;
  empty += own.empty;
  own.leaves.forEach((met, kind) => { leaves[kind] = (leaves[kind] ?? 0) + met; });
}
// The twin: one voxel more or less in each answer is seen.
const [sound, spoiled] = [[], ['spoiled']].map((more) => answers([native], 0, 100, more).lines);
const unseen = spoiled.filter((line, i) => line === sound[i]).length;
if (unseen > 0) throw new Error(`${unseen} of 100 spoiled answers have the digest of the sound one`);
if (Math.min(...leaves) < count / 20) throw new Error(`a kind of leaf was hardly met: ${leaves}`);
if (empty > count / 5) throw new Error(`${empty} of ${count} results are empty`);
const median = ratios.sort((a, b) => a - b)[ratios.length >> 1];
console.log(`${same} cases, the same bits; ${empty} empty; leaves of each kind ${leaves.join(', ')}; ${seconds.native.toFixed(1)} s here, `
  + `${seconds.wasm.toFixed(1)} s in WebAssembly: ${median.toFixed(2)} times (median of ${ratios.length})`);
if (median > 2) throw new Error(`${median.toFixed(2)} times as long; 2 are allowed`);

// SPDX-License-Identifier: AGPL-3.0-or-later
// run_wasi.mjs PROGRAM.wasm ARGUMENTS...: a command of WebAssembly, without any file. Says the seconds of
// processor time on standard error: running, and compiling meanwhile.
import { readFileSync } from 'node:fs';
import { WASI } from 'node:wasi';

const wasi = new WASI({ version: 'preview1', args: process.argv.slice(2), returnOnExit: true });
const module = await WebAssembly.compile(readFileSync(process.argv[2]));
const instance = await WebAssembly.instantiate(module, wasi.getImportObject());
const before = process.cpuUsage();
process.exitCode = wasi.start(instance);
const { user, system } = process.cpuUsage(before);
console.error(JSON.stringify({ seconds: (user + system) / 1e6 }));

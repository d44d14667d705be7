// SPDX-License-Identifier: AGPL-3.0-or-later
// run_wasi.mjs PROGRAM.wasm ARGUMENTS...: a command of WebAssembly, without any file.
import { readFileSync } from 'node:fs';
import { WASI } from 'node:wasi';

const wasi = new WASI({ version: 'preview1', args: process.argv.slice(2), returnOnExit: true });
const module = await WebAssembly.compile(readFileSync(process.argv[2]));
process.exitCode = wasi.start(await WebAssembly.instantiate(module, wasi.getImportObject()));

// SPDX-License-Identifier: AGPL-3.0-or-later
// The voxel kernel in WebAssembly (page_kernel.cpp), one scan at a time.
import {Volume} from "./volume_file";

export interface Measured {
  voxels: number;
  volume_mm3: number;
  area_mm2: number;  ///< by Crofton's formula over 13 directions
  centroid_mm: [number, number, number]|null;  ///< LPS
  bytes: number;
}

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  new_scan(x: number, y: number, z: number): number;
  lps_from_voxel(): number;
  open_scan(): void;
  choose_window(low: number, high: number): number;
  draw(width: number, height: number, lx: number, ly: number, lz: number, ux: number, uy: number, uz: number): number;
}

/// An error of the kernel, with the kernel's message. The instance that threw it has ended and cannot be used
/// again.
export class Refusal extends Error {}

/// The four functions of WASI that the kernel imports. Only fd_write(), which collects the kernel's last
/// message, and proc_exit() have an effect.
function wasi(memory: () => ArrayBuffer): WebAssembly.ModuleImports {
  let words = "";
  return {
    fd_write(_: number, pieces: number, count: number, written: number): number {
      const view = new DataView(memory());
      let bytes = 0;
      for (let i = 0; i < count; ++i) {
        const at = view.getUint32(pieces + 8 * i, true), length = view.getUint32(pieces + 8 * i + 4, true);
        words += new TextDecoder().decode(new Uint8Array(memory(), at, length));
        bytes += length;
      }
      view.setUint32(written, bytes, true);
      return 0;
    },
    fd_close: () => 0,
    fd_seek: () => 70,  // ESPIPE
    proc_exit(): never {
      throw new Refusal(words.trim() || "the kernel ended");
    }
  };
}

export class Kernel {
  private constructor(private readonly exports: Exports) {}

  /// Starts a kernel and opens a scan in it. Throws Refusal.
  static async open(module: WebAssembly.Module, volume: Volume): Promise<Kernel> {
    let exports: Exports;
    const instance =
        await WebAssembly.instantiate(module, {wasi_snapshot_preview1: wasi(() => exports.memory.buffer)});
    exports = instance.exports as unknown as Exports;
    exports._initialize();
    // A call may move the kernel's memory, so each access makes a new view of it.
    const samples = exports.new_scan(...volume.dims) >>> 0;
    new Int16Array(exports.memory.buffer, samples, volume.samples.length).set(volume.samples);
    const matrix = exports.lps_from_voxel() >>> 0;
    new Float64Array(exports.memory.buffer, matrix, 16).set(volume.lps_from_voxel);
    exports.open_scan();
    return new Kernel(exports);
  }

  /// Makes the voxels with samples from `low` to `high` the object, and returns its measures.
  choose_window(low: number, high: number): Measured {
    const at = this.exports.choose_window(low, high) >>> 0;
    const [voxels, volume_mm3, area_mm2, x, y, z, bytes, any] = new Float64Array(this.exports.memory.buffer, at, 8);
    return {voxels, volume_mm3, area_mm2, centroid_mm: any ? [x, y, z] : null, bytes};
  }

  /// Draws the object as seen along `look`, with `up` upwards, as RGBA from the top left. Both are unit
  /// vectors in LPS, at right angles.
  draw(width: number, height: number, look: number[], up: number[]): Uint8ClampedArray {
    const at = this.exports.draw(width, height, look[0], look[1], look[2], up[0], up[1], up[2]) >>> 0;
    return new Uint8ClampedArray(this.exports.memory.buffer, at, 4 * width * height).slice();
  }
}

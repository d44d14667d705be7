// SPDX-License-Identifier: AGPL-3.0-or-later
// The data that come with a picture at rest: the depth and the object of every pixel of a view, the samples
// of a slice.
import {FrameHeader} from "../protocol";

export interface Planes {
  depth: Float32Array|null;  // mm along the view direction, NaN where there is no surface
  object: Uint16Array|null;  // place, from 1, in the header's objects; 0: no object
  value: Float32Array|null;  // samples, NaN outside the scan
}

// Browsers have this class, but the declarations that the compiler uses lack it.
declare class DecompressionStream implements GenericTransformStream {
  constructor(format: "deflate");
  readonly readable: ReadableStream;
  readonly writable: WritableStream;
}

async function inflated(bytes: Uint8Array): Promise<ArrayBuffer> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

export async function planes_of(header: FrameHeader, parts: Uint8Array[]): Promise<Planes> {
  const plane = async(kind: "depth"|"object"|"value"): Promise<ArrayBuffer|null> => {
    const at = header.parts.findIndex((part) => part.kind === kind);
    return at < 0 ? null : inflated(parts[at]!);
  };
  const [depth, object, value] = [await plane("depth"), await plane("object"), await plane("value")];
  return {
    depth: depth && new Float32Array(depth),
    object: object && new Uint16Array(object),
    value: value && new Float32Array(value)
  };
}

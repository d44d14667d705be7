// SPDX-License-Identifier: AGPL-3.0-or-later
// The bundler puts the compressed bytes of the kernel into the page.
declare module "page_kernel.gz" {
  const bytes: Uint8Array;
  export default bytes;
}

// In every browser since 2023, not in the compiler's list.
declare class DecompressionStream {
  constructor(format: "gzip");
  readonly readable: ReadableStream<Uint8Array>;
  readonly writable: WritableStream<Uint8Array>;
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// The bundler puts the compressed bytes of the kernel into the page.
declare module "page_kernel.gz" {
  const bytes: Uint8Array;
  export default bytes;
}

// All browsers have had this class since 2023, but the compiler's declarations lack it.
declare class DecompressionStream {
  constructor(format: "gzip");
  readonly readable: ReadableStream<Uint8Array>;
  readonly writable: WritableStream<Uint8Array>;
}

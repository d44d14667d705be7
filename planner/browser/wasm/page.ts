// SPDX-License-Identifier: AGPL-3.0-or-later
// The page: opens a file of this machine, and shows its window, numbers and picture. Nothing is sent or
// fetched.
import kernel_bytes from "page_kernel.gz";
import {Kernel, Measured} from "./kernel";
import {inflated, read_volume, Volume} from "./volume_file";

const by_id = <Kind extends HTMLElement>(id: string) => document.getElementById(id) as Kind;
const picture = by_id<HTMLCanvasElement>("picture");
const low = by_id<HTMLInputElement>("low"), high = by_id<HTMLInputElement>("high");

let module: WebAssembly.Module|null = null;
let kernel: Kernel|null = null;
let volume: Volume|null = null;
let azimuth_deg = 0, elevation_deg = 0;

function say(text: string, is_refusal = false): void {
  by_id("said").textContent = text;
  by_id("said").className = is_refusal ? "refusal" : "";
}

/// Runs work and shows its error. After an error the kernel cannot be used any more, so the scan is opened in
/// a new one.
async function attempt(work: () => void|Promise<void>): Promise<void> {
  try {
    await work();
  } catch (error) {
    say((error as Error).message, true);
    try {
      kernel = module && volume ? await Kernel.open(module, volume) : null;
    } catch {
      kernel = null;
    }
  }
}

/// The view's look and up directions in LPS. The observer's azimuth counts from the front towards the
/// patient's left, the elevation upwards, as in the program's views.
function directions(): [number[], number[]] {
  // The kernel traces nodes only if a direction is exactly along an axis, so rounding errors are removed.
  const exact = (value: number) => Math.abs(value - Math.round(value)) < 1e-12 ? Math.round(value) : value;
  const a = azimuth_deg * Math.PI / 180, e = elevation_deg * Math.PI / 180;
  const sa = exact(Math.sin(a)), ca = exact(Math.cos(a)), se = exact(Math.sin(e)), ce = exact(Math.cos(e));
  return [[-sa * ce, ca * ce, -se], [-sa * se, ca * se, ce]];
}

function draw(): void {
  if (!kernel) return;
  const start = performance.now();
  const pixels = kernel.draw(picture.width, picture.height, ...directions());
  const milliseconds = performance.now() - start;
  picture.getContext("2d")!.putImageData(new ImageData(pixels, picture.width, picture.height), 0, 0);
  by_id("time").textContent = `drawn in ${milliseconds.toFixed(0)} ms`;
}

/// A number with four significant digits, in groups of three digits. Integer digits are never rounded.
function text(value: number): string {
  const digits = Math.max(0, 3 - Math.floor(Math.log10(Math.max(Math.abs(value), 1))));
  return value.toLocaleString("en", {maximumFractionDigits: digits, useGrouping: true}).replaceAll(",", " ");
}

function show(measured: Measured): void {
  const rows: [string, string, string][] = [
    ["voxels", text(measured.voxels), `${measured.voxels}`],
    ["volume, voxels counted", `${text(measured.volume_mm3)} mm³`, `${measured.volume_mm3}`],
    ["area, Crofton 13", `${text(measured.area_mm2)} mm²`, `${measured.area_mm2}`],
    ["centroid, LPS", measured.centroid_mm ? `${measured.centroid_mm.map(value => value.toFixed(1)).join(", ")} mm` : "none", ""],
    ["octree", `${text(measured.bytes / 1024)} KB`, ""]
  ];
  by_id("numbers").replaceChildren(...rows.map(([name, value, exact]) => {
    const row = document.createElement("tr");
    row.dataset.exact = exact;
    row.append(Object.assign(document.createElement("th"), {textContent: name}),
               Object.assign(document.createElement("td"), {textContent: value}));
    return row;
  }));
}

function choose(): Promise<void> {
  return attempt(() => {
    if (!kernel) return;
    if (!(low.valueAsNumber <= high.valueAsNumber)) throw new Error("the window ends before it begins: swap its limits");
    show(kernel.choose_window(low.valueAsNumber, high.valueAsNumber));
    draw();
  });
}

function range(samples: Int16Array): [number, number] {
  let least = 32767, most = -32768;
  for (const sample of samples) {
    if (sample < least) least = sample;
    if (sample > most) most = sample;
  }
  return [least, most];
}

async function open(file: File): Promise<void> {
  await attempt(async () => {
    say(`Reading ${file.name} …`);
    kernel = null;
    volume = null;
    module ??= await WebAssembly.compile(await inflated(kernel_bytes));
    const read = await read_volume(new Uint8Array(await file.arrayBuffer()));
    kernel = await Kernel.open(module, read);
    volume = read;
    const [least, most] = range(volume.samples);
    // The window at first: bone in a CT, the upper half of the range in other scans.
    low.value = String(least < 0 && most > 300 ? 300 : Math.round((least + most) / 2));
    high.value = String(most);
    say([`${file.name}: ${volume.dims.join(" x ")} samples, ${least} to ${most}`, ...volume.remarks].join("; "));
    document.body.dataset.state = "open";
  });
  if (kernel) await choose();
}

by_id<HTMLInputElement>("file").addEventListener("change", event => {
  const file = (event.target as HTMLInputElement).files?.[0];
  if (file) void open(file);
});
document.addEventListener("dragover", event => event.preventDefault());
document.addEventListener("drop", event => {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (file) void open(file);
});
for (const input of [low, high]) input.addEventListener("change", () => void choose());
for (const button of document.querySelectorAll<HTMLButtonElement>("[data-view]"))
  button.addEventListener("click", () => {
    [azimuth_deg, elevation_deg] = button.dataset.view!.split(",").map(Number);
    void attempt(draw);
  });
picture.addEventListener("pointerdown", event => picture.setPointerCapture(event.pointerId));
picture.addEventListener("pointermove", event => {
  if (!kernel || event.buttons === 0) return;
  azimuth_deg -= event.movementX / 2;
  elevation_deg = Math.max(-89, Math.min(89, elevation_deg + event.movementY / 2));
  void attempt(draw);
});

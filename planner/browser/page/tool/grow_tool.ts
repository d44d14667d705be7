// SPDX-License-Identifier: AGPL-3.0-or-later
// Region growing: a click sets a seed, and a drag from it sets the tolerance. The growing region is shown
// meanwhile; when the person accepts it, it becomes a step of the plan.
import {add_step, free_id, try_to} from "../actions";
import {button, Child, el, slider} from "../base/html";
import {dot_at, ink, label} from "../base/ink";
import {grouped, unit_text} from "../base/numbers";
import {add, dot, hundredths, scaled, Vec2, Vec3} from "../base/vector";
import type {Pane} from "../pane/panes";
import {tried_text} from "../panel/live_step";
import {Json, ScanState, Step} from "../protocol";
import {notify, on_leaving_plan, set, shown_scan, state} from "../state";
import {place_at} from "./point_tools";
import {Tool} from "./tool";

let seeds: Vec3[] = [];
let adds = false;  // the next click adds a seed
let running_mean = false;
let typed: number|null = null;  // null: the default tolerance of the scan
let held: {at: Vec2; from: number; ratio: number}|null = null;

const colour = "#ff9f43";
/// Change of the tolerance for each pixel of a drag; for a scan without Hounsfield units, as a share of its
/// range. A drag across a pane covers about the range of a tissue.
const hounsfield_per_px = 1, share_per_px = 1 / 1500;
const usual_hounsfield = 60, usual_share = 1 / 25;
const most_seeds = 64;

const scan_of = (): ScanState|undefined => state.plan?.scans.find((scan) => scan.name === shown_scan());
const unit = (): string => unit_text(scan_of()?.unit ?? "HU");
const span = (): number => {
  const [low, high] = scan_of()?.range ?? [-1000, 3000];
  return Math.max(1e-6, high - low);
};
const is_in_hu = (): boolean => unit() === "HU";
/// Rounds a tolerance. A scan with a narrow range, such as fractions, needs decimals.
const rounded = (value: number): number => {
  const digits = Math.max(0, Math.ceil(2 - Math.log10(span())));
  return Number(Math.min(65535, Math.max(0, value)).toFixed(digits));
};
const tolerance = (): number => typed ?? rounded(is_in_hu() ? usual_hounsfield : span() * usual_share);
const tolerance_text = (): string => `±${grouped(tolerance(), tolerance() % 1 ? 2 : 0)} ${unit()}`.trim();

const step_of_seeds = (): Step => ({
  id: free_id("region"),
  do: "segment",
  scan: shown_scan(),
  seeds_mm: seeds.map((p): Json => [...p]),
  tolerance: tolerance(),
  ...(running_mean ? {running_mean} : {}),
});

/// Shows a preview of the region that grows from the seeds.
function show(): void {
  set({preview: seeds.length ? {object: "", steps: [step_of_seeds()], colour, by: "grow"} : null});
}
function forget(): void {
  seeds = [];
  held = null;
  if (state.preview?.by === "grow") set({preview: null, tried: null});
}

function is_in_scan(p: Vec3): boolean {
  const bounds = scan_of()?.bounds_mm;
  return !bounds || p.every((x, axis) => x >= bounds[0][axis]! && x <= bounds[1][axis]!);
}

/// The seed at a position. In a slice it is the point itself. In a view it lies a voxel below the surface,
/// because samples at the surface are mixed with those in front of it.
function seed_at(pane: Pane, at: Vec2): Vec3|null {
  const place = place_at(pane, at);
  if (!place || pane.is_slice) return place;
  return hundredths(add(place, scaled(pane.frame.look, state.plan?.universe?.voxel_mm ?? 1)));
}

function set_tolerance(value: number): void {
  if (!Number.isFinite(value)) return;
  typed = rounded(value);
  show();
  set({tool: state.tool});
}

async function accept(): Promise<void> {
  if (!seeds.length) {
    notify("Click a seed in a slice or view first.", "warning");
    return;
  }
  const step = step_of_seeds(), path = state.plan?.path;
  const found = await try_to<{objects: {mm3: number}[]}>("try", {steps: [step]});
  if (!found || state.plan?.path !== path) return;
  const voxel_mm3 = (state.plan?.universe?.voxel_mm ?? 0) ** 3;
  if ((found.objects[0]?.mm3 ?? 0) < (step.seeds_mm as Json[]).length * voxel_mm3 * 1.001) {
    notify(
        `Nothing grows from there: no neighbour of the seed is within ${tolerance_text()} of it. Drag to the right for a larger tolerance, or click elsewhere.`,
        "warning");
    return;
  }
  if (await add_step(step, `region grown within ${tolerance_text()}`)) forget();
}

export const grow_tool: Tool = {
  name: "grow",
  title: "Grow a region",
  says: "Click a tissue in a slice or view, and drag right or left for a larger or smaller tolerance; Enter makes the region an object.",
  key: "",
  cursor: "crosshair",
  is_pointed: true,
  down({pane, at}) {
    if (pane.setting.mode === "panoramic") {
      notify("A panoramic picture is bent: click in a view or in a slice.", "warning");
      return true;
    }
    const seed = seed_at(pane, at);
    if (!seed) return true;
    if (!is_in_scan(seed)) {
      notify("The seed lies outside of the scan, where nothing was measured: click inside of it.", "warning");
      return true;
    }
    if (adds && seeds.length >= most_seeds) {
      notify(`A region has at most ${most_seeds} seeds here: make it an object first.`, "warning");
      return true;
    }
    if (state.preview?.by !== "grow") set({tried: null});
    seeds = adds ? [...seeds, seed] : [seed];
    held = {at, from: tolerance(), ratio: pane.ratio};
    show();
    set({tool: state.tool});
    return true;
  },
  move({pane, at}) {
    if (!held) return;
    const px = (at[0] - held.at[0]) / held.ratio;
    typed = rounded(held.from + px * (is_in_hu() ? hounsfield_per_px : span() * share_per_px));
    show();
    pane.redraw();
  },
  up() {
    held = null;
    set({tool: state.tool});
  },
  cancel: forget,
  press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (event.key === "[" || event.key === "]")
      set_tolerance(tolerance() + (event.key === "[" ? -1 : 1) * (is_in_hu() ? 10 : span() / 100));
    else if (event.key === "Enter")
      void accept();
    else if (event.key === "Escape" && seeds.length)
      forget();
    else
      return false;
    return true;
  },
  draw(pane, context) {
    for (const seed of seeds) {
      const near = !pane.is_slice || Math.abs(dot(seed, pane.frame.look) - dot(state.cross_mm, pane.frame.look)) < 3;
      if (!near) continue;
      const at = pane.pixel_at(seed);
      dot_at(context, at, 4 * pane.ratio, ink.region);
      label(context, tolerance_text(), at, pane.ratio, {colour: ink.region, px: 11});
    }
  },
  left: forget,
  panel,
};

function panel(): Child {
  const choose = (words: string, tip: string, key: string, is_on: boolean, take: () => void): Child => button(
      words, `${words}. ${tip}`,
      () => {
        take();
        show();
        set({tool: state.tool});
      },
      {class: is_on ? "on" : "", "aria-pressed": String(is_on), "data-key": `grow-${key}`});
  const most = is_in_hu() ? 1000 : span() / 2;
  return [
    slider(
        unit() || "±", "grow-tolerance",
        {min: 0, step: is_in_hu() ? 1 : "any", value: tolerance(), "aria-label": unit() ? `Tolerance in ${unit()}` : "Tolerance"},
        {max: Math.max(most, tolerance())}, set_tolerance),
    el("div", {class: "presets", role: "group", "aria-label": "What the tolerance is measured from"},
       choose("Seed", "Samples that differ from the seeds' samples by at most the tolerance", "seed", !running_mean, () => running_mean = false),
       choose("Running mean", "Samples that differ from the mean of the growing region by at most the tolerance", "mean", running_mean, () => running_mean = true)),
    el("div", {class: "presets", role: "group", "aria-label": "What a click does"},
       choose("New seed", "The next click begins anew", "new", !adds, () => adds = false),
       choose("Further seed", "The next click adds a seed", "further", adds, () => adds = true)),
    seeds.length ? tried_text("Growing …") : el("p", {class: "says"}, "No seed yet."),
    el("div", {class: "row"},
       button("Make object", "Make object. Adds the region to the plan as a step. Enter", () => void accept(),
              {class: "primary", disabled: !seeds.length, "data-key": "grow-accept"}),
       button("Let go", "Let go. Leaves the plan as it is. Escape", () => {
         forget();
         set({tool: state.tool});
       }, {disabled: !seeds.length})),
  ];
}

on_leaving_plan(() => {
  seeds = [];
  held = typed = null;
  adds = running_mean = false;
});

// SPDX-License-Identifier: AGPL-3.0-or-later
// Regions: polygons drawn in a view or on a slice, whose back-projections enclose a mask. Click adds a
// corner, Enter or the first corner closes; corners are dragged, Delete removes one.
import {add_step, add_steps, edit, free_id, replace_step} from "../actions";
import {look_of} from "../drawn_objects";
import {makes_body, operands} from "../operations";
import {button, el} from "../base/html";
import {dot_at, ink, line, text} from "../base/ink";
import {is_of_panes, region_view, regions_of, uv_pixel} from "../pane/overlay";
import type {Pane} from "../pane/panes";
import {Json, Step} from "../protocol";
import {notify, selected_step, set, state, step_of, steps} from "../state";
import {Pointer, Tool, take_tool} from "./tool";
import {Vec2, hundredth} from "../base/vector";

let drawn: Vec2[] = [];  // corners so far, in the view's mm
let drawn_in: Pane|null = null;
let held: {polygon: Vec2[]; corner: number; copy: Step}|null = null;
let last_corner: {view: string; polygon: number; corner: number}|null = null;
let pointed: Vec2|null = null;

const near_px = 9;
const rounded = (uv: Vec2): Vec2 => [hundredth(uv[0]), hundredth(uv[1])];
const gap = (a: Vec2, b: Vec2): number => Math.hypot(a[0] - b[0], a[1] - b[1]);
const repaint = (pane: Pane): void => pane.redraw();

export const region_tool: Tool = {
  name: "region",
  title: "Draw a region",
  says:
      "Click the corners of a region in any view or slice; Enter closes it. A second view refines the same mask. Drag a corner to move it.",
  key: "r",
  cursor: "crosshair",
  is_pointed: true,

  down(pointer) {
    const {pane, at} = pointer;
    if (!drawn.length && take_corner(pointer)) return true;
    if (drawn_in !== pane) drawn = [];
    drawn_in = pane;
    const first = drawn[0];
    if (first && drawn.length > 2 && gap(uv_pixel(pane, first), at) < near_px * pane.ratio)
      void close();
    else
      drawn.push(rounded(pane.uv_at(at)));
    repaint(pane);
    return true;
  },
  move({pane, at}) {
    if (held) held.polygon[held.corner] = rounded(pane.uv_at(at));
    repaint(pane);
  },
  up() {
    if (!held) return;
    const {copy} = held;
    held = null;
    void replace_step(copy.id, copy, `a corner of ${copy.id} moved`);
  },
  cancel() {
    if (!held) drawn.pop();
    held = null;
  },
  hover({pane, at}) {
    if (!drawn.length) return;
    pointed = at;
    repaint(pane);
  },
  double() {
    if (drawn.length < 3) return drawn.length > 0;
    void close();
    return true;
  },
  press(event, pane) {
    if (event.key === "Enter" && drawn.length > 2)
      void close();
    else if (event.key === "Escape" && drawn.length)
      drawn = [];
    else if (event.key === "Backspace" && drawn.length)
      drawn.pop();
    else if (event.key === "Delete" && last_corner)
      void remove_corner();
    else
      return false;
    repaint(pane);
    return true;
  },
  draw(pane, context) {
    const copy = held?.copy;
    if (copy)
      for (const region of regions_of(copy))
        if (region.view === region_view(pane))
          for (const polygon of region.polygons_mm)
            line(context, polygon.map((uv) => uv_pixel(pane, uv)), ink.region, 2 * pane.ratio, true);
    if (pane !== drawn_in || !drawn.length) return;
    const corners = drawn.map((uv) => uv_pixel(pane, uv));
    line(context, pointed ? [...corners, pointed] : corners, ink.region, 2 * pane.ratio);
    corners.forEach((p, i) => dot_at(context, p, (i ? 4 : 5.5) * pane.ratio, ink.region, i === 0));
    if (drawn.length > 2)
      text(
          context, "Enter closes", [corners[0]![0] + 10 * pane.ratio, corners[0]![1] - 12 * pane.ratio],
          pane.ratio, {px: 11});
  },
  left() {
    drawn = [];
    held = null;
  },
  panel: () => {
    const step = selected_step();
    const mask = step?.do === "mask" ? step : undefined;
    const target = cut_target(mask);
    return [
      el("p", {class: "says"},
         mask ? `The next region refines the mask “${mask.id}”.` : "The first region makes a new mask."),
      mask && target ?
          el("div", {class: "row"},
             button(
                 "Cut inside", `Makes the part of ${target} inside the mask an object. The rest becomes a second one`,
                 () => void cut(mask, target), {class: "primary"}),
             button(
                 "New mask", "Begins another mask. The next region you draw starts it",
                 () => set({selected: null}))) :
          null,
    ];
  },
};

/// The object that a mask cuts by default: the last visible body before the mask, or else the last body
/// before it.
function cut_target(mask: Step|undefined): string|undefined {
  if (!mask) return undefined;
  const before = steps().slice(0, steps().findIndex((step) => step.id === mask.id));
  const solid = before.filter((step) => makes_body(step));
  return (solid.filter((step) => look_of(step.id).visible).pop() ?? solid.pop())?.id;
}

/// Cuts an object by a mask. Adds two steps: the piece inside the mask and the rest outside of it.
export async function cut(mask: Step, target: string): Promise<void> {
  const used = steps().some(
      (step) => step.do === "combine" && operands(step).includes(mask.id) && operands(step).includes(target));
  if (used) return notify(`${target} is cut by ${mask.id} already.`, "warning");
  take_tool("navigate");
  const piece = free_id("piece");
  const rest = free_id("rest");
  await add_steps(
      [
        {id: rest, do: "combine", expression: `${target} - ${mask.id}`},
        {id: piece, do: "combine", expression: `${target} & ${mask.id}`},
      ],
      `cut ${target} by ${mask.id}`,
  );
  set({selected: piece});
}
export function cut_selected(): void {
  const mask =
      selected_step()?.do === "mask" ? selected_step() : steps().filter((step) => step.do === "mask").pop();
  const target = cut_target(mask);
  if (mask && target)
    void cut(mask, target);
  else
    notify("Draw a region first: the cut follows its mask.", "warning");
}

async function close(): Promise<void> {
  if (!drawn_in || drawn.length < 3) return;
  const view = region_view(drawn_in);
  const polygon = drawn as unknown as Json;
  drawn = [];
  pointed = null;
  const step = selected_step();
  if (!step || !is_of_panes(step)) {
    await add_step(
        {id: free_id("cut"), do: "mask", regions: [{view, polygons_mm: [polygon]}]}, `region in ${view}`);
    return;
  }
  const copy = structuredClone(step);
  const regions = copy.regions as {[key: string]: Json}[];
  const same = regions.find((region) => region.view === view);
  if (same)
    (same.polygons_mm as Json[]).push(polygon);
  else
    regions.push({view, polygons_mm: [polygon]});
  await replace_step(step.id, copy, `region of ${step.id} in ${view}`);
}

function take_corner({pane, at}: Pointer): boolean {
  const step = step_of(state.selected);
  if (step?.do !== "mask") return false;
  const copy = structuredClone(step);
  for (const region of regions_of(copy))
    if (region.view === region_view(pane))
      for (const [number, polygon] of region.polygons_mm.entries())
        for (const [corner, uv] of polygon.entries())
          if (gap(uv_pixel(pane, uv), at) < near_px * pane.ratio) {
            held = {polygon, corner, copy};
            last_corner = {view: region.view, polygon: number, corner};
            return true;
          }
  return false;
}

async function remove_corner(): Promise<void> {
  const step = step_of(state.selected);
  if (!step || !last_corner) return;
  const copy = structuredClone(step);
  const region = regions_of(copy).find((one) => one.view === last_corner?.view);
  const polygon = region?.polygons_mm[last_corner.polygon];
  if (!region || !polygon) return;
  if (polygon.length > 3)
    polygon.splice(last_corner.corner, 1);
  else
    region.polygons_mm.splice(last_corner.polygon, 1);
  last_corner = null;
  const left = regions_of(copy).filter((one) => one.polygons_mm.length);
  if (!left.length) {
    await edit({remove: step.id}, `${step.id} removed`, null);
    return;
  }
  await replace_step(
      step.id, {...copy, regions: left as unknown as Json}, `a corner of ${step.id} removed`);
}

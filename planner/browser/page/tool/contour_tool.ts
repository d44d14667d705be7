// SPDX-License-Identifier: AGPL-3.0-or-later
// The contour workbench: in a slice, contours are drawn, dragged, smoothed, erased, found around a pixel,
// taken from an object, and copied to the next slices. Each edit changes one step `tile`, from whose contours
// both kernels make an object.
import {add_step, edit, free_id, replace_step, try_to} from "../actions";
import {button, Child, el} from "../base/html";
import {dot_at, ink, line, text} from "../base/ink";
import {add, dot, hundredth, hundredths, scaled, Vec2, Vec3} from "../base/vector";
import {directions_of, turned, View, view_names, ViewName, view_text, view_of_plane} from "../base/view_frame";
import {look_of} from "../drawn_objects";
import {makes_body} from "../operations";
import type {Pane} from "../pane/panes";
import {Json, Step} from "../protocol";
import {notify, on_leaving_plan, selected_step, set, shown_scan, state, steps} from "../state";
import {closed_line, contains, dragged, nearest_on, overlap, Polygon, refined, smoothed, spliced, tidy, gap} from "./contour_shape";
import {Pointer, Tool} from "./tool";

type Mode = "draw"|"drag"|"smooth"|"erase"|"seed";
let mode: Mode = "draw";
let reach_mm = 8;
let tolerance = 100;
const near_px = 9, fine_mm = 0.1, same_slice_mm = 0.02;

interface Slice {
  position_mm: number;
  polygons_mm: Polygon[];
}
/// A slice of the scan that is not repositioned: the view whose contours are drawn in it, the view's axes,
/// and the slice's position along the view direction.
interface Place {
  view: string;
  right: Vec3;
  up: Vec3;
  look: Vec3;
  position_mm: number;
}

/// An edit that is not in the plan yet: `drawn` is a new line, `held` are contours that the person drags or
/// smooths.
let drawn: {pane: Pane; points: Polygon; is_by_corners: boolean}|null = null;
let held: {pane: Pane; step: Step; slices: Slice[]; contour: Polygon; index: number; before: Polygon; point: number}|null = null;
let pointed: {pane: Pane; at: Vec2}|null = null;
let last_pane: Pane|null = null;
/// Ends when the earlier changes are in the plan. The next one waits for it, because it starts from the step
/// that they made.
let queue: Promise<unknown> = Promise.resolve();

const slices_of = (step: Step): Slice[] => structuredClone((step.contours ?? []) as unknown as Slice[]);
const is_ours = (step: Step|undefined): step is Step => step?.do === "tile" && Array.isArray(step.contours);

/// The axes of a view that a plan names by a word or as "AZ,EL".
function frame_of(view: string): {right: Vec3; up: Vec3; look: Vec3} {
  if ((view_names as string[]).includes(view)) return directions_of(view as ViewName);
  const [azimuth = 0, elevation = 0] = view.split(",").map(Number);
  return directions_of(turned({azimuth, elevation} as View));
}

/// The slice that a pane shows. A message if contours cannot be drawn in the pane.
function place_of(pane: Pane|null): Place|string {
  if (!pane || pane.setting.mode !== "slice") return "Contours are drawn in slices: choose a slice.";
  const view = view_text(view_of_plane(pane.setting.plane, pane.setting.tilt));
  const frame = frame_of(view);
  if (dot(frame.look, pane.frame.look) < 1 - 1e-9)
    return "The head is repositioned here, and contours are drawn in the scan's own slices. Remove the step head_position first.";
  return {view, ...frame, position_mm: hundredth(dot(state.cross_mm, frame.look))};
}
const needed_place = (pane: Pane|null): Place|null => {
  const place = place_of(pane);
  if (typeof place !== "string") return place;
  notify(place, "warning");
  return null;
};

/// The step whose contours are edited: the selected one, if its contours have the view of the place. Null if
/// there is no such step.
function target(place: Place): Step|null {
  const step = selected_step();
  return is_ours(step) && (step.view ?? "inferior") === place.view ? step : null;
}
const is_here = (slice: Slice, place: Place): boolean => Math.abs(slice.position_mm - place.position_mm) < same_slice_mm;
function contours_here(pane: Pane): Polygon[] {
  const place = place_of(pane);
  if (typeof place === "string") return [];
  if (held?.pane === pane) return held.slices.find((slice) => is_here(slice, place))?.polygons_mm ?? [];
  const step = target(place);
  return step ? slices_of(step).find((slice) => is_here(slice, place))?.polygons_mm ?? [] : [];
}

const uv_of = (pane: Pane, place: Place, at: Vec2): Vec2 => {
  const p = pane.point_at(at);
  return [dot(p, place.right), dot(p, place.up)];
};
const pixel_of = (pane: Pane, place: Place, uv: Vec2): Vec2 =>
    pane.pixel_at(add(add(scaled(place.right, uv[0]), scaled(place.up, uv[1])), scaled(place.look, place.position_mm)));
const near_mm = (pane: Pane): number => near_px * pane.ratio * pane.frame.pixel_mm;

/// The distance in mm between the scan's slices along a view, at least 0.2.
function slice_mm(place: Place): number {
  const spacing = state.plan?.scans.find((scan) => scan.name === shown_scan())?.spacing_mm ?? [1, 1, 1];
  return Math.max(0.2, hundredth(Math.abs(dot(spacing as Vec3, place.look.map(Math.abs) as Vec3))));
}

/// Replaces the contours of one slice by those that `take` returns, in one edit. Null leaves the plan as it
/// is. Adds a step if there is none, and removes the step if no contour is left.
async function change(place: Place, what: string, take: (now: Polygon[]) => Polygon[]|null): Promise<boolean> {
  const step = target(place);
  const slices = step ? slices_of(step) : [];
  const here = slices.find((slice) => is_here(slice, place));
  const made = take(here?.polygons_mm ?? []);
  if (!made) return false;
  const others = slices.filter((slice) => slice !== here);
  const all = made.length ? [...others, {position_mm: here?.position_mm ?? place.position_mm, polygons_mm: made}] : others;
  all.sort((a, b) => a.position_mm - b.position_mm);
  if (!step) {
    if (!all.length) return false;
    const id = free_id("contours");
    return add_step(
        {id, do: "tile", view: place.view, contours: all as unknown as Json, end_mm: hundredth(slice_mm(place) / 2)}, what);
  }
  if (!all.some((slice) => slice.polygons_mm.length)) return edit({remove: step.id}, `${step.id} removed`, null);
  return replace_step(step.id, {...step, contours: all as unknown as Json}, what);
}
function then(place: Place, what: string, take: (now: Polygon[]) => Polygon[]|null): void {
  const path = state.plan?.path;
  queue = queue.then(async () => {
    if (state.plan?.path === path) await change(place, what, take);
  });
}
const at_mm = (place: Place): string => `${place.position_mm} mm`;

/// The index of the contour under the pointer: the nearest one, if it is within reach of a click; otherwise,
/// with `may_be_inside`, the smallest one around the pointer. Null if there is none.
function contour_at(pane: Pane, uv: Vec2, may_be_inside: boolean): number|null {
  const all = contours_here(pane);
  const on = all.map((contour, i) => ({i, mm: nearest_on(contour, uv).mm})).sort((a, b) => a.mm - b.mm)[0];
  if (on && on.mm < near_mm(pane)) return on.i;
  if (!may_be_inside) return null;
  const around = all.map((contour, i) => ({i, contour})).filter(({contour}) => contains(contour, uv));
  return around.find(({contour}) => around.every((other) => other.contour === contour || contains(other.contour, contour[0]!)))?.i ?? null;
}

function finish_line(): void {
  if (!drawn) return;
  const {pane, points} = drawn;
  drawn = null;
  pane.redraw();
  const place = needed_place(pane);
  if (!place) return;
  const ends = [points[0]!, points[points.length - 1]!];
  const corrected = contours_here(pane).findIndex((contour) => ends.every((p) => nearest_on(contour, p).mm < near_mm(pane)));
  const is_part = corrected >= 0 && gap(ends[0]!, ends[1]!) > 2 * near_mm(pane);
  const made = is_part ? spliced(contours_here(pane)[corrected]!, points, fine_mm) : closed_line(points, fine_mm);
  if (!made) return notify("The line encloses nothing: draw around the region, or along a contour from one place of it to another.", "warning");
  then(place, is_part ? `a contour corrected at ${at_mm(place)}` : `a contour drawn at ${at_mm(place)}`,
       (now) => is_part ? now.map((contour, i) => (i === corrected ? made : contour)) : [...now, made]);
}

function take_hold(pane: Pane, at: Vec2): boolean {
  const place = needed_place(pane);
  if (!place) return true;
  const uv = uv_of(pane, place, at);
  const index = contour_at(pane, uv, mode === "smooth");
  const step = target(place);
  if (index === null || !step) {
    notify(step ? "No contour lies there." : "Select the step whose contours you change.", "warning");
    return true;
  }
  const slices = slices_of(step);
  const here = slices.find((slice) => is_here(slice, place))!;
  // A contour can also be grabbed between two points, so points are added near the pointer first.
  let contour = mode === "drag" && reach_mm > 0 ? refined(here.polygons_mm[index]!, uv, reach_mm, reach_mm / 6) : here.polygons_mm[index]!;
  if (mode === "smooth") contour = refined(contour, uv, reach_mm, Math.max(0.3, reach_mm / 10));
  const on = nearest_on(contour, uv);
  let point = contour.findIndex((p) => gap(p, uv) < near_mm(pane) && gap(p, uv) <= on.mm + near_mm(pane) / 2);
  if (mode === "drag" && point < 0) {
    contour = [...contour.slice(0, on.piece + 1), on.at, ...contour.slice(on.piece + 1)];
    point = on.piece + 1;
  }
  held = {pane, step, slices, contour, index, before: contour, point};
  here.polygons_mm[index] = contour;
  if (mode === "smooth") carry_on(pane, at);
  pane.redraw();
  return true;
}
function carry_on(pane: Pane, at: Vec2): void {
  const place = place_of(pane);
  if (!held || held.pane !== pane || typeof place === "string") return;
  const uv = uv_of(pane, place, at);
  held.contour = mode === "smooth" ? smoothed(refined(held.contour, uv, reach_mm, Math.max(0.3, reach_mm / 10)), uv, reach_mm) :
                                     dragged(held.before, held.point, uv, reach_mm);
  held.slices.find((slice) => is_here(slice, place))!.polygons_mm[held.index] = held.contour;
  pane.redraw();
}
function let_go(): void {
  if (!held) return;
  const {pane, index, contour} = held;
  const made = tidy(contour);
  held = null;
  const place = place_of(pane);
  if (typeof place === "string" || made.length < 3) return;
  then(place, `a contour ${mode === "smooth" ? "smoothed" : "dragged"} at ${at_mm(place)}`,
       (now) => now.map((one, i) => (i === index ? made : one)));
}

function erase(pane: Pane, at: Vec2): void {
  const place = needed_place(pane);
  if (!place) return;
  const index = contour_at(pane, uv_of(pane, place, at), true);
  if (index === null) return notify("No contour lies there.", "warning");
  then(place, `a contour erased at ${at_mm(place)}`, (now) => now.filter((_, i) => i !== index));
}

/// Requests contours from the server. The answer replaces those of the slice's contours that it overlaps.
function trace(place: Place, asked: object, what: string): void {
  const path = state.plan?.path;
  queue = queue.then(async () => {
    const found = await try_to<{polygons_mm: Polygon[]}>("trace", {view: place.view, position_mm: place.position_mm, thin_mm: fine_mm, ...asked});
    if (!found || state.plan?.path !== path) return;
    const more = found.polygons_mm;
    await change(place, what, (now) => [...now.filter((one) => !more.some((other) => overlap(one, other))), ...more]);
  });
}
function seed(pane: Pane, at: Vec2): void {
  const place = needed_place(pane);
  if (place) trace(place, {seed_mm: hundredths(pane.point_at(at)), scan: shown_scan(), tolerance}, `a region found at ${at_mm(place)}`);
}

/// The object whose contours the slice can take over: the last visible body before the step.
function other_object(): string|undefined {
  const own = selected_step();
  const all = steps().filter((step) => makes_body(step) && step !== own && (!is_ours(own) || steps().indexOf(step) < steps().indexOf(own)));
  return (all.filter((step) => look_of(step.id).visible).pop() ?? all.pop())?.id;
}
function take_over(): void {
  const place = needed_place(slice_pane()), object = other_object();
  if (!place) return;
  if (!object) return notify("There is no object before the contours.", "warning");
  trace(place, {object}, `contours of ${object} at ${at_mm(place)}`);
}

/// The pane that the pointer or a key used last; null if there is none.
const slice_pane = (): Pane|null => last_pane;

/// Copies the contours of the slice to the one `by` slices further, and shows that slice.
export function copy_contours(by: number): void {
  const pane = slice_pane(), place = needed_place(pane);
  if (!place || !pane) return;
  const path = state.plan?.path;
  queue = queue.then(async () => {
    const step = target(place);
    const here = step ? slices_of(step).find((slice) => is_here(slice, place)) : undefined;
    if (!here) return notify("This slice has no contour to copy.", "warning");
    const next: Place = {...place, position_mm: hundredth(place.position_mm + by * slice_mm(place))};
    if (step && slices_of(step).some((slice) => is_here(slice, next) && slice.polygons_mm.length))
      return notify(`The slice at ${at_mm(next)} has contours: erase them first.`, "warning");
    if (state.plan?.path !== path) return;
    if (await change(next, `contours copied to ${at_mm(next)}`, () => here.polygons_mm))
      set({cross_mm: hundredths(add(state.cross_mm, scaled(place.look, next.position_mm - dot(state.cross_mm, place.look))))});
  });
}

function set_reach(mm: number): void {
  reach_mm = Math.max(0, Math.min(60, Math.round(mm * 2) / 2));
  set({tool: state.tool});
  pointed?.pane.redraw();
}
function forget(): void {
  (drawn?.pane ?? held?.pane)?.redraw();
  drawn = held = null;
}

export const contour_tool: Tool = {
  name: "contour",
  title: "Contours",
  says: "In a slice: draw around a region, drag, smooth or erase contours, find one around a pixel, or copy them: the comma key copies to the previous slice, the full stop key to the next.",
  key: "e",
  cursor: "crosshair",
  is_pointed: true,
  down({pane, at}) {
    last_pane = pane;
    pointed = {pane, at};
    if (mode === "drag" || mode === "smooth") return take_hold(pane, at);
    if (mode === "erase") return erase(pane, at), true;
    if (mode === "seed") return seed(pane, at), true;
    const place = needed_place(pane);
    if (!place) return true;
    const uv = uv_of(pane, place, at);
    if (drawn?.is_by_corners && drawn.pane === pane) {
      if (drawn.points.length > 2 && gap(drawn.points[0]!, uv) < near_mm(pane)) return finish_line(), true;
      drawn.points.push(uv);
    } else {
      drawn = {pane, points: [uv], is_by_corners: false};
    }
    pane.redraw();
    return true;
  },
  move({pane, at}) {
    pointed = {pane, at};
    if (held) return carry_on(pane, at);
    const place = place_of(pane);
    if (!drawn || drawn.pane !== pane || drawn.is_by_corners || typeof place === "string") return;
    const uv = uv_of(pane, place, at);
    if (gap(uv, drawn.points[drawn.points.length - 1]!) > Math.max(0.05, 2 * pane.frame.pixel_mm)) drawn.points.push(uv);
    pane.redraw();
  },
  up() {
    let_go();
    if (!drawn || drawn.is_by_corners) return;
    // A click sets a corner; Enter or a click on the first corner closes the line.
    if (drawn.points.length === 1)
      drawn.is_by_corners = true;
    else
      finish_line();
  },
  cancel: forget,
  hover(pointer: Pointer) {
    if (pointed && pointed.pane !== pointer.pane) pointed.pane.redraw();
    pointed = pointer;
    if (pointer.pane.is_slice) last_pane = pointer.pane;
    pointer.pane.redraw();
  },
  press(event, pane) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (pane.is_slice) last_pane = pane;
    if (event.key === "[" || event.key === "]")
      set_reach(reach_mm + (event.key === "[" ? -0.5 : 0.5));
    else if (event.key === "," || event.key === ".")
      copy_contours(event.key === "," ? -1 : 1);
    else if (event.key === "Enter" && drawn)
      finish_line();
    else if (event.key === "Backspace" && drawn?.is_by_corners) {
      drawn.points.pop();
      if (!drawn.points.length) drawn = null;
    } else if (event.key === "Escape" && (drawn || held))
      forget();
    else
      return false;
    pane.redraw();
    return true;
  },
  draw,
  left() {
    forget();
    pointed?.pane.redraw();
    pointed = null;
  },
  panel,
};

function draw(pane: Pane, context: CanvasRenderingContext2D): void {
  const place = place_of(pane);
  if (typeof place === "string") return;
  const step = held?.pane === pane ? held.step : target(place);
  const slices = held?.pane === pane ? held.slices : step ? slices_of(step) : [];
  const outline = (contour: Polygon, colour: string, width: number): void =>
      line(context, contour.map((uv) => pixel_of(pane, place, uv)), colour, width * pane.ratio, true);
  // Draws the nearest contours before and behind the slice, as a guide for new ones.
  const below = slices.filter((slice) => slice.position_mm < place.position_mm - same_slice_mm).pop();
  const above = slices.find((slice) => slice.position_mm > place.position_mm + same_slice_mm);
  context.save();
  context.globalAlpha = 0.45;
  for (const slice of [below, above])
    for (const contour of slice?.polygons_mm ?? []) outline(contour, ink.faint, 1);
  context.restore();
  for (const contour of slices.find((slice) => is_here(slice, place))?.polygons_mm ?? []) {
    outline(contour, ink.region, 1.5);
    if (mode === "drag" && contour.length <= 400)
      for (const uv of contour) dot_at(context, pixel_of(pane, place, uv), 2.5 * pane.ratio, ink.region);
  }
  if (drawn?.pane === pane) {
    const points = drawn.points.map((uv) => pixel_of(pane, place, uv));
    line(context, drawn.is_by_corners && pointed?.pane === pane ? [...points, pointed.at] : points, ink.good, 2 * pane.ratio);
    if (drawn.is_by_corners) points.forEach((p, i) => dot_at(context, p, (i ? 3.5 : 5) * pane.ratio, ink.good, i === 0));
    if (drawn.is_by_corners && points.length > 2) text(context, "Enter closes", [points[0]![0] + 10 * pane.ratio, points[0]![1] - 12 * pane.ratio], pane.ratio, {px: 11});
  }
  const at = pane.keyed_at ?? (pointed?.pane === pane ? pointed.at : null);
  if (!at || !(mode === "smooth" || (mode === "drag" && reach_mm > 0))) return;
  const radius = reach_mm / pane.frame.pixel_mm;
  const corners = Array.from({length: 48}, (_, i): Vec2 => [at[0] + radius * Math.cos((i * Math.PI) / 24), at[1] + radius * Math.sin((i * Math.PI) / 24)]);
  line(context, corners, ink.faint, pane.ratio, true);
}

function panel(): Child {
  const step = selected_step();
  const choice = (label: string, tip: string, value: Mode): Child => button(
      label, `${label}. ${tip}`,
      () => {
        forget();
        mode = value;
        set({tool: state.tool});
      },
      {class: mode === value ? "on" : "", "aria-pressed": String(mode === value), "data-key": `contour-${label}`});
  const number = (label: string, value: number, most: number, key: string, take: (value: number) => void): Child => el(
      "label", {class: "slider"}, el("span", {}, label),
      el("input", {
        type: "number", min: 0, max: most, step: 0.5, value, "aria-label": label === "Reach" ? "Reach in mm" : "Tolerance of samples", "data-key": key, name: key,
        onchange: (event: Event) => take(Number((event.target as HTMLInputElement).value)),
      }));
  const object = other_object();
  const count = is_ours(step) ? slices_of(step).reduce((sum, slice) => sum + slice.polygons_mm.length, 0) : 0;
  return [
    el("div", {class: "presets", role: "group", "aria-label": "What the pointer does to contours"},
       choice("Draw", "A drag draws a contour, or replaces a part of one; clicks set corners, Enter closes", "draw"),
       choice("Drag", "Drags a point of a contour, and its neighbours", "drag"),
       choice("Smooth", "Smooths a contour along the drag", "smooth"),
       choice("Erase", "A click removes a contour", "erase"),
       choice("Seed", "A click finds the region of the slice around a pixel", "seed")),
    mode === "drag" || mode === "smooth" ? number("Reach", reach_mm, 60, "contour-reach", set_reach) : null,
    mode === "seed" ? number("Tolerance", tolerance, 5000, "contour-tolerance", (value) => {
      if (value > 0) tolerance = value;
    }) : null,
    el("div", {class: "row"},
       button("Copy back", "Copies this slice's contours to the slice before it along the line of sight (,)", () => copy_contours(-1), {"data-key": "contour-back"}),
       button("Copy on", "Copies this slice's contours to the next slice along the line of sight (.)", () => copy_contours(1), {"data-key": "contour-on"})),
    object ? button(`Outline of ${object.replace(/_/g, " ")}`, "Takes over the object's contours in this slice", take_over, {"data-key": "contour-object"}) : null,
    el("p", {class: "says"},
       is_ours(step) ? `${step.id.replace(/_/g, " ")} has ${count} ${count === 1 ? "contour" : "contours"} on ${slices_of(step).length} slices, seen ${step.view ?? "inferior"}.` :
                       "The next contour begins a new object."),
  ];
}

on_leaving_plan(() => {
  drawn = held = null;
  pointed = last_pane = null;
});

// SPDX-License-Identifier: AGPL-3.0-or-later
// The brush: a drag over the selected object erases it along the stroke, or paints onto it. Each stroke is
// one change of the plan; further strokes of the same mode are added to the same step.
import {add_step, free_id, replace_step} from "../actions";
import {button, Child, el, slider} from "../base/html";
import {ink, line, text} from "../base/ink";
import {add, distance, dot, hundredths, normalised, scaled, sub, length, Vec2, Vec3} from "../base/vector";
import {makes_body} from "../operations";
import type {Pane} from "../pane/panes";
import {Json, Step} from "../protocol";
import {notify, on_leaving_plan, selected_step, set, state, steps} from "../state";
import {place_at} from "./point_tools";
import {Pointer, Tool} from "./tool";

type Mode = "erase"|"paint";
type Shape = "ball"|"slab";
let mode: Mode = "erase";
let shape: Shape = "ball";
const usual_radius_mm = 5, usual_thickness_mm = 4;
let radius_mm = usual_radius_mm;
let thickness_mm = usual_thickness_mm;
const least_mm = 0.5, most_mm = 50;

/// Strokes that are drawn but not in the plan yet. A stroke in a view has several parts if there are gaps in
/// the surface under it.
interface Draft {
  pane: Pane;
  normal: Vec3;
  parts: Vec3[][];
  by_keys: boolean;
}
let draft: Draft|null = null;
let pointed: {pane: Pane; at: Vec2}|null = null;
/// Ends when the earlier strokes are in the plan. The next one waits for it, because it may belong to the
/// step that an earlier stroke creates.
let before: Promise<void> = Promise.resolve();
/// The largest number of strokes in a step and of points in a stroke that plans allow.
const most_strokes = 500, most_points = 2000;

const mode_of = (step: Step): Mode => step.mode === "paint" ? "paint" : "erase";

/// The selected body, and whether a stroke is added to its brush step. Otherwise a stroke makes a new step.
/// Null if no body is selected.
function target(as: Mode): {step: Step; going_on: boolean}|null {
  const step = selected_step();
  if (!step || !makes_body(step)) return null;
  const has_room = Array.isArray(step.strokes) && step.strokes.length < most_strokes;
  return {step, going_on: step.do === "brush" && mode_of(step) === as && has_room};
}

/// Thins a line: all left-out points lie within `within_mm` of the result (Douglas and Peucker 1973).
function simplified(points: Vec3[], within_mm: number): Vec3[] {
  const first = points[0]!, last = points[points.length - 1]!;
  if (points.length < 3) return points;
  const along = normalised(sub(last, first));
  const reach = distance(first, last);
  const beside = (p: Vec3): number => {
    const at = Math.max(0, Math.min(reach, dot(sub(p, first), along)));
    return distance(p, add(first, scaled(along, at)));
  };
  let farthest = 0, most = 0;
  for (let i = 1; i + 1 < points.length; ++i)
    if (beside(points[i]!) > most) [farthest, most] = [i, beside(points[i]!)];
  if (most <= within_mm) return [first, last];
  return [...simplified(points.slice(0, farthest + 1), within_mm).slice(0, -1), ...simplified(points.slice(farthest), within_mm)];
}

function strokes_of(drawn: Draft): Json[] {
  return drawn.parts.map((part): Json => {
    const all = simplified(part, radius_mm / 50).map(hundredths);
    const points_mm = all.filter((p, i) => i === 0 || distance(p, all[i - 1]!) > 0).slice(0, most_points);
    return {
      points_mm,
      radius_mm,
      ...(shape === "slab" ? {shape, normal: drawn.normal.map((x) => Math.round(x * 1e6) / 1e6), thickness_mm} : {})
    };
  });
}

async function add_strokes(more: Json[], as: Mode, path: string|undefined): Promise<void> {
  const on = target(as);
  if (!on || state.plan?.path !== path) return;
  const {step, going_on} = on;
  const what = as === "paint" ? `painted on ${step.id}` : `erased from ${step.id}`;
  if (going_on)
    await replace_step(step.id, {...step, strokes: [...step.strokes as Json[], ...more]}, what);
  else
    await add_step(
        {
          id: free_id(`${step.id}_${as === "paint" ? "painted" : "erased"}`),
          do: "brush",
          object: step.id,
          ...(as === "paint" ? {mode: as} : {}),
          strokes: more
        },
        what);
}

function finish(): void {
  if (!draft) return;
  const more = strokes_of(draft), as = mode, path = state.plan?.path;
  draft.pane.redraw();
  draft = null;
  before = before.then(() => add_strokes(more, as, path));
}

function forget(): void {
  draft?.pane.redraw();
  draft = null;
}

function begin(pane: Pane, at: Vec2, by_keys: boolean): boolean {
  if (pane.setting.mode === "panoramic") {
    notify("A panoramic picture is bent: draw in a view or in a slice.", "warning");
    return false;
  }
  if (!target(mode)) {
    notify("Select the object first, then draw on it.", "warning");
    return false;
  }
  const point = place_at(pane, at);
  if (!point) return false;
  draft = {pane, normal: pane.frame.look, parts: [[point]], by_keys};
  pane.redraw();
  return true;
}

/// Extends the stroke to a position. Where a view shows no surface, the position has no depth and the stroke
/// is interrupted.
function go_on(pane: Pane, at: Vec2): void {
  if (!draft || draft.pane !== pane || pane.is_beside(at)) return;
  const part = draft.parts[draft.parts.length - 1]!;
  const last = part[part.length - 1]!;
  const point = hundredths(pane.point_at(at));
  const by = sub(point, last);
  if (length(by) < Math.max(0.05, radius_mm / 10)) return;
  // A large step in depth interrupts the stroke. Otherwise it would pass through everything between both
  // depths.
  if (!pane.is_slice && Math.abs(dot(by, draft.normal)) > 2 * radius_mm)
    draft.parts.push([point]);
  else
    part.push(point);
}

function set_radius(mm: number): void {
  if (!(mm > 0)) return;
  radius_mm = Math.min(most_mm, Math.max(least_mm, Math.round(mm * 10) / 10));
  set({tool: state.tool});
  pointed?.pane.redraw();
}

const colour = (): string => mode === "paint" ? ink.good : ink.bad;

export const brush_tool: Tool = {
  name: "brush",
  title: "Brush",
  says: "Drag over the selected object in a view or slice to erase it under the brush, or to paint onto it. [ and ] change the radius.",
  key: "b",
  cursor: "crosshair",
  is_pointed: true,
  taken() {
    if (target(mode)) return;
    const last = steps().filter(makes_body).pop();
    if (last) set({selected: last.id});
  },
  down({pane, at}) {
    pointed = {pane, at};
    if (draft?.by_keys) finish();
    begin(pane, at, false);
    return true;
  },
  move(pointer) {
    pointed = pointer;
    go_on(pointer.pane, pointer.at);
    pointer.pane.redraw();
  },
  up: finish,
  cancel: forget,
  hover(pointer: Pointer) {
    if (pointed && pointed.pane !== pointer.pane) pointed.pane.redraw();
    pointed = pointer;
    if (draft?.by_keys) go_on(pointer.pane, pointer.at);
    pointer.pane.redraw();
  },
  press(event, pane) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (event.key === "[" || event.key === "]")
      set_radius(radius_mm + (event.key === "[" ? -0.5 : 0.5));
    else if (event.key === "Enter" && draft)
      finish();
    else if (event.key === "Enter")
      begin(pane, pane.keyed_at ?? [pane.size[0] / 2, pane.size[1] / 2], true);
    else if (event.key === "Escape" && draft)
      forget();
    else
      return false;
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
  const radius_px = radius_mm / pane.frame.pixel_mm;
  if (draft?.pane === pane) {
    context.save();
    context.globalAlpha = 0.4;
    context.strokeStyle = context.fillStyle = colour();
    context.lineWidth = 2 * radius_px;
    context.lineCap = context.lineJoin = "round";
    context.beginPath();
    for (const part of draft.parts) {
      const at = part.map((p) => pane.pixel_at(p));
      context.moveTo(...at[0]!);
      for (const p of at.length > 1 ? at.slice(1) : at) context.lineTo(...p);
    }
    context.stroke();
    context.restore();
  }
  const at = pane.keyed_at ?? (pointed?.pane === pane ? pointed.at : null);
  if (!at) return;
  // The outline of the ball or disc along the view direction, as a polygon of 48 corners, which looks round.
  const corners = Array.from({length: 48}, (_, i): Vec2 => [
    at[0] + radius_px * Math.cos((i * Math.PI) / 24), at[1] + radius_px * Math.sin((i * Math.PI) / 24)
  ]);
  line(context, corners, colour(), 1.5 * pane.ratio, true);
  text(context, mode === "paint" ? "+" : "−", at, pane.ratio, {align: "center", colour: colour()});
}

function panel(): Child {
  const on = target(mode);
  const choice = <Value>(label: string, tip: string, now: Value, value: Value, take: (value: Value) => void): Child => button(
      label, `${label}. ${tip}`,
      () => {
        take(value);
        set({tool: state.tool});
      },
      {class: now === value ? "on" : "", "aria-pressed": String(now === value), "data-key": `brush-${label}`});
  const size = (label: string, value: number, most: number, key: string, take: (mm: number) => void): Child =>
      slider(label, key, {min: least_mm, max: most, step: 0.5, value, "aria-label": `${label} in mm`}, {}, take);
  const name = on ? String(on.going_on ? on.step.object : on.step.id).replace(/_/g, " ") : "";
  return [
    el("div", {class: "presets", role: "group", "aria-label": "What a stroke does"},
       choice<Mode>("Erase", "A stroke removes material from the object", mode, "erase", (value) => mode = value),
       choice<Mode>("Paint", "A stroke adds to the object", mode, "paint", (value) => mode = value)),
    el("div", {class: "presets", role: "group", "aria-label": "Shape of the brush"},
       choice<Shape>("Ball", "A ball, as deep as it is wide", shape, "ball", (value) => shape = value),
       choice<Shape>("Slab", "A disc that faces you, as thick as you set it", shape, "slab", (value) => shape = value)),
    size("Radius", radius_mm, 30, "brush-radius", set_radius),
    shape === "slab" ? size("Depth", thickness_mm, 60, "brush-thickness", (mm) => {
      if (mm > 0) thickness_mm = Math.min(200, Math.max(least_mm, Math.round(mm * 10) / 10));
    }) :
                       null,
    el("p", {class: "says"},
       !on ? "Select the object to draw on." :
             `The next stroke ${mode === "paint" ? "adds to" : "erases from"} ${name}${on.going_on ? ", in the same step" : ", as a new step"}.`),
    mode === "paint" ? el("p", {class: "says"}, "No scan shows the painted material; the step's findings state its volume.") : null,
  ];
}

on_leaving_plan(() => {
  draft = pointed = null;
  [mode, shape, radius_mm, thickness_mm] = ["erase", "ball", usual_radius_mm, usual_thickness_mm];
});

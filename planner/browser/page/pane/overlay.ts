// SPDX-License-Identifier: AGPL-3.0-or-later
// What is drawn over a pane's picture: edge letters, scale, cross-hair, regions, landmarks, measured lines,
// marks and the handles of the chosen tool.
import {begin_ink, dot_at, ink, keep_words_off, keep_words_off_dot, label, line, sentence, text, TextLook} from "../base/ink";
import {draw_mirror_plane} from "./mirror_plane";
import {draw_trace} from "./oblique";
import type {Pane} from "./panes";
import {Json, Measurement, PlanState, Step} from "../protocol";
import {is_elsewhere, shown_scan, state, step_of, steps} from "../state";
import {active_tool} from "../tool/tool";
import {round_length} from "../base/numbers";
import {add, dot, scaled, Vec2, Vec3} from "../base/vector";
import {edge_letters, view_of_plane, view_text} from "../base/view_frame";

export function draw_overlay(pane: Pane, context: CanvasRenderingContext2D): void {
  if (!state.plan) return;
  begin_ink(pane.is_on_white);
  const ratio = pane.ratio;
  context.lineJoin = "round";
  // These overlays need one pixel position for each point, which a curved slice does not have.
  if (pane.setting.mode !== "panoramic") {
    draw_cross(pane, context);
    draw_trace(pane, context);
    if (!is_elsewhere()) draw_regions(pane, context);
    for (const at of Object.values(letter_places(pane))) keep_words_off_dot(at, 9 * pane.ratio);
    for (const {point} of drawn_landmarks(pane)) keep_words_off_dot(pane.pixel_at(point), landmark_px * pane.ratio);
    if (!is_elsewhere()) draw_measures(pane, context);
    if (!is_elsewhere()) draw_mirror_plane(pane, context, step_of(state.selected));
    draw_landmarks(pane, context);
    if (state.marked) draw_mark(pane, context, state.marked.at_mm);
    active_tool()?.draw?.(pane, context);
    if (pane.keyed_at && active_tool()?.is_pointed) draw_keyed(pane, context, pane.keyed_at);
    draw_letters(pane, context);
  }
  draw_scale(pane, context);
  if (pane.is_slow)
    text(context, "drawing …", [10 * ratio, pane.size[1] - 12 * ratio], ratio, {colour: ink.faint, px: 11});
  if (pane.problem)
    sentence(context, pane.problem, ratio, {colour: ink.bad});
  else if (!pane.picture && !pane.is_slice)
    sentence(
        context,
        state.plan.plan.steps.length ? "No object is shown. Turn one on in the list." :
                                       "Choose a tissue to begin.",
        ratio, {colour: ink.faint});
}

function draw_keyed(pane: Pane, context: CanvasRenderingContext2D, [x, y]: Vec2): void {
  const reach = 11 * pane.ratio;
  line(context, [[x - reach, y], [x + reach, y]], ink.region, 2 * pane.ratio);
  line(context, [[x, y - reach], [x, y + reach]], ink.region, 2 * pane.ratio);
}

// Draws lines where the planes of other panes cut this one. A gap in the middle leaves the cross-hair's point
// visible.
function draw_cross(pane: Pane, context: CanvasRenderingContext2D): void {
  const frame = pane.frame;
  const [x, y] = pane.pixel_at(state.cross_mm);
  const [width, height] = pane.size;
  const gap = 9 * pane.ratio;
  const axis = (d: Vec3): number => [0, 1, 2].reduce(
      (best, i) => (Math.abs(d[i]!) > Math.abs(d[best]!) ? i : best), 0);
  const stroke = (from: Vec2, to: Vec2, colour: string): void => {
    context.beginPath();
    context.moveTo(from[0], from[1]);
    context.lineTo(to[0], to[1]);
    context.strokeStyle = colour;
    context.lineWidth = pane.ratio;
    context.globalAlpha = pane.is_slice ? 0.75 : 0.4;
    context.stroke();
    context.globalAlpha = 1;
  };
  const vertical = ink.cross[axis(frame.right)]!;
  const horizontal = ink.cross[axis(frame.up)]!;
  stroke([x, 0], [x, y - gap], vertical);
  stroke([x, y + gap], [x, height], vertical);
  stroke([0, y], [x - gap, y], horizontal);
  stroke([x + gap, y], [width, y], horizontal);
}

/// The name of the view with which a mask stores a region drawn in this pane. For a slice it is the view
/// along its normal.
export const region_view = (pane: Pane): string => pane.is_slice ?
    view_text(view_of_plane(pane.setting.plane, pane.setting.tilt)) :
    view_text(pane.setting.view);

export const uv_pixel = (pane: Pane, uv: Vec2): Vec2 => {
  const frame = pane.frame;
  return pane.pixel_at(add(scaled(frame.right, uv[0]), scaled(frame.up, uv[1])));
};

interface Region {
  view: string;
  polygons_mm: Vec2[][];
}
/// Whether the panes draw and edit a mask's regions. They do not if the regions are in files, or if the head
/// is repositioned and the mask uses the views of the original scan.
export const is_of_panes = (step: Step|undefined): boolean =>
    step?.do === "mask" && Array.isArray(step.regions) &&
    (step.regions as unknown as Region[]).every((region) => Array.isArray(region.polygons_mm)) &&
    !(step.views_of === "scan" && steps().some(({do: word}) => word === "head_position"));
export const regions_of = (step: Step|undefined): Region[] =>
    is_of_panes(step) && Array.isArray(step?.regions) ? (step?.regions as unknown as Region[]) : [];

function draw_regions(pane: Pane, context: CanvasRenderingContext2D): void {
  const step = step_of(state.selected);
  const view = region_view(pane);
  for (const region of regions_of(step))
    if (region.view === view)
      for (const polygon of region.polygons_mm) {
        const points = polygon.map((uv) => uv_pixel(pane, uv));
        line(context, points, ink.region, 1.5 * pane.ratio, true);
        if (state.tool === "region")
          for (const p of points) dot_at(context, p, 4 * pane.ratio, ink.region);
      }
}

export function mark_mm(mark: Json|undefined): Vec3|null {
  if (Array.isArray(mark) && mark.length === 3) return mark as Vec3;
  if (typeof mark !== "string") return null;
  return state.plan?.landmarks.find((one) => one.name === mark)?.point ?? null;
}

// A slice shows only marks within this distance of it, in mm. A view shows all marks.
const near_slice_mm = 6;
const is_near = (pane: Pane, p_mm: Vec3): boolean => !pane.is_slice ||
    Math.abs(dot(p_mm, pane.frame.look) - dot(state.cross_mm, pane.frame.look)) <= near_slice_mm;

// The Move tool hides names and numbers, because it draws its handles.
const is_handled = (): boolean => state.tool === "move";

const measured_words = (found: Measurement): string =>
    found.value === null   ? "–" :
    found.unit === "deg" ? `${found.value.toFixed(1)}°` :
                             `${found.value.toFixed(2)} ${found.unit}`;

function draw_measures(pane: Pane, context: CanvasRenderingContext2D): void {
  const drawn: {step: Step; at: Vec2[]}[] = [];
  for (const step of steps()) {
    const marks = step.do === "measure" && Array.isArray(step.points_mm) ? step.points_mm : [];
    const points = marks.map(mark_mm).filter((p): p is Vec3 => p !== null);
    if (points.length < 2 || !points.every((p) => is_near(pane, p))) continue;
    const at = points.map((p) => pane.pixel_at(p));
    line(context, at, ink.measure, 1.5 * pane.ratio);
    keep_words_off(at, pane.ratio);
    for (const p of at) dot_at(context, p, 3 * pane.ratio, ink.measure);
    drawn.push({step, at});
  }
  for (const {step, at} of drawn) {
    const found = state.plan?.measurements?.find((one) => one.id === step.id);
    const middle = at[Math.floor(at.length / 2)]!;
    const before = at[Math.floor(at.length / 2) - 1]!;
    const words = found ? measured_words(found) : step.id;
    if (is_handled() || Math.hypot(middle[0] - before[0], middle[1] - before[1]) < 24 * pane.ratio) continue;
    label(
        context, words, [(middle[0] + before[0]) / 2, (middle[1] + before[1]) / 2], pane.ratio,
        {colour: ink.measure, may_be_left_out: true});
  }
}

/// The name of the additional scan on which a procedure places a landmark; empty for the patient's scan.
export const scan_of_landmark = (name: string): string => (state.hello?.procedures ?? [])
                                                       .flatMap((one) => one.landmarks)
                                                       .find((mark) => mark.name === name)
                                                       ?.scan ??
    "";

/// Whether a pane draws a landmark: it belongs to the shown scan and, in a slice, lies near the slice.
export const is_drawn = (pane: Pane, mark: {name: string; point: Vec3}): boolean =>
    scan_of_landmark(mark.name) === (is_elsewhere() ? shown_scan() : "") && is_near(pane, mark.point);

const landmark_px = 3.5;
const drawn_landmarks = (pane: Pane): PlanState["landmarks"] =>
    (state.plan?.landmarks ?? []).filter((mark) => is_drawn(pane, mark));

function draw_landmarks(pane: Pane, context: CanvasRenderingContext2D): void {
  const drawn = drawn_landmarks(pane);
  if (!is_handled() && !state.hides_names)
    for (const {name, point} of drawn)
      label(
          context, name.replace(/_/g, " "), pane.pixel_at(point), pane.ratio,
          {colour: ink.landmark, px: 11, may_be_left_out: true});
  // The dots lie over the lines that lead to their names.
  for (const {point} of drawn) dot_at(context, pane.pixel_at(point), landmark_px * pane.ratio, ink.landmark);
}

function draw_mark(pane: Pane, context: CanvasRenderingContext2D, p_mm: Vec3): void {
  const at = pane.pixel_at(p_mm);
  for (const radius of [7, 13]) {
    context.beginPath();
    context.arc(at[0], at[1], radius * pane.ratio, 0, 2 * Math.PI);
    context.strokeStyle = ink.mark;
    context.lineWidth = 2 * pane.ratio;
    context.stroke();
  }
}

function letter_places(pane: Pane): {left: Vec2; right: Vec2; bottom: Vec2} {
  const [width, height] = pane.size;
  const inset = 12 * pane.ratio;
  return {left: [inset, height / 2], right: [width - inset, height / 2], bottom: [width / 2, height - inset]};
}

function draw_letters(pane: Pane, context: CanvasRenderingContext2D): void {
  const letters = edge_letters(pane.frame), places = letter_places(pane);
  const look: TextLook = {align: "center", colour: ink.faint, px: 12};
  for (const edge of ["left", "right", "bottom"] as const) text(context, letters[edge], places[edge], pane.ratio, look);
}

// Draws a scale bar of 1, 2 or 5 times a power of ten millimetres, about a fifth of the pane's width.
function draw_scale(pane: Pane, context: CanvasRenderingContext2D): void {
  const frame = pane.frame;
  const [width, height] = pane.size;
  const mm = round_length(width * 0.2 * frame.pixel_mm);
  const long = mm / frame.pixel_mm;
  const right = width - 10 * pane.ratio;
  const y = height - 10 * pane.ratio;
  line(
      context,
      [[right - long, y - 4 * pane.ratio], [right - long, y], [right, y], [right, y - 4 * pane.ratio]],
      ink.faint, pane.ratio);
  text(
      context, `${mm} mm`, [right - long / 2, y - 9 * pane.ratio], pane.ratio,
      {align: "center", colour: ink.faint, px: 11});
}

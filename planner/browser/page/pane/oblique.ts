// SPDX-License-Identifier: AGPL-3.0-or-later
// The plane of an oblique slice, as the other panes show it: its trace through the cross-hair, with a handle
// at either end that tilts it.
import {dot_at, ink, line} from "../base/ink";
import type {Pane} from "./panes";
import {set, state} from "../state";
import {cross, dot, length, turned_about, Vec2, Vec3} from "../base/vector";
import {directions_of, turned_towards} from "../base/view_frame";

const reach_share = 0.36;  // from the cross-hair to a handle, as a share of the pane's shorter side
const near_px = 12;
/// No trace is drawn if the sine of the angle between the oblique plane and the picture is below this.
const least_sine = 0.2;

interface Trace {
  pane: number;  // that shows the slice
  normal: Vec3;
  centre: Vec2;
  ends: [Vec2, Vec2];
}

/// The line in which another pane's oblique slice cuts this pane's picture. Null if no pane shows an oblique
/// slice or the two are nearly parallel.
function trace_in(pane: Pane): Trace|null {
  if (pane.setting.mode === "panoramic") return null;
  const index = state.panes.findIndex(
      (other, number) => number !== pane.index && other.mode === "slice" && other.plane === "oblique");
  const setting = state.panes[index];
  if (!setting) return null;
  const {look, right, up} = pane.frame;
  const normal = directions_of(setting.tilt).look;
  const along = cross(normal, look);
  const sine = length(along);
  if (sine < least_sine) return null;
  const [x, y] = pane.pixel_at(state.cross_mm);
  const reach = (reach_share * Math.min(...pane.size)) / sine;
  const by: Vec2 = [dot(along, right) * reach, -dot(along, up) * reach];
  return {pane: index, normal, centre: [x, y], ends: [[x + by[0], y + by[1]], [x - by[0], y - by[1]]]};
}

/// Begins to tilt the oblique plane. Returns a function that rotates it to a pointer position; null if no
/// handle is under the pointer.
export function tilt_from(pane: Pane, at: Vec2): ((to: Vec2) => void)|null {
  const trace = trace_in(pane);
  const is_near = (end: Vec2): boolean => Math.hypot(end[0] - at[0], end[1] - at[1]) < near_px * pane.ratio;
  if (!trace?.ends.some(is_near)) return null;
  const {look} = pane.frame;
  const {centre, normal} = trace;
  // The angle grows clockwise on the screen, which is a right-handed rotation about the view direction.
  const angle = (p: Vec2): number => Math.atan2(p[1] - centre[1], p[0] - centre[0]);
  const start = angle(at);
  return (to) => {
    const tilt = turned_towards(turned_about(normal, look, angle(to) - start));
    set({panes: state.panes.map((other, index) => (index === trace.pane ? {...other, tilt} : other))});
  };
}

export function draw_trace(pane: Pane, context: CanvasRenderingContext2D): void {
  const trace = trace_in(pane);
  if (!trace) return;
  line(context, trace.ends, ink.oblique, 1.5 * pane.ratio);
  for (const end of trace.ends) dot_at(context, end, 5 * pane.ratio, ink.oblique);
}

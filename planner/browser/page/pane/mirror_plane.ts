// SPDX-License-Identifier: AGPL-3.0-or-later
// The plane of a mirror step, drawn as its trace in slices, and in views that look along it, with handles
// that move and turn it.
import {replace_step} from "../actions";
import {dot_at, ink, label, line} from "../base/ink";
import type {Pane} from "./panes";
import {Step} from "../protocol";
import {is_elsewhere, state, step_of} from "../state";
import {add, cross, dot, hundredths, normalised, scaled, sub, turned_about, Vec2, Vec3} from "../base/vector";

export interface Plane {
  point_mm: Vec3;
  normal: Vec3;
}

const is_point = (value: unknown): value is Vec3 => Array.isArray(value) && value.length === 3;

/// The mirror plane of a step: the one that the server fitted or computed from landmarks, else the one that
/// the step states. Null if the server has yet to compute it.
export function plane_of(step: Step): Plane|null {
  const found = state.plan?.objects.find((one) => one.id === step.id)?.mirror;
  if (found) return found.plane;
  if (step.fit || step.through) return null;
  return {
    point_mm: is_point(step.point_mm) ? step.point_mm : [0, 0, 0],
    normal: is_point(step.normal) ? normalised(step.normal) : [1, 0, 0]
  };
}

/// A view shows the plane only if it is seen nearly edge on: the cosine of the angle between the view
/// direction and the plane's normal is at most this.
const most_tilt = 0.2;
/// Distance between the middle of the plane's trace and a rotating handle, as a share of the pane's shorter
/// side.
const reach_share = 0.3;
const near_px = 12;

/// The plane while it is dragged, and after the drag until the plan contains it.
let held: {id: string, plane: Plane}|null = null;

const shown_plane = (step: Step): Plane|null => held?.id === step.id ? held.plane : plane_of(step);

interface Trace {
  middle: Vec3;  // on the mirror plane and the picture's plane, nearest to the cross-hair
  along: Vec3;   // unit vector
}

function trace_in(pane: Pane, plane: Plane): Trace|null {
  if (pane.setting.mode === "panoramic") return null;
  const {look} = pane.frame;
  const tilt = dot(plane.normal, look);
  const along = cross(plane.normal, look);
  const length = Math.hypot(...along);
  if (length < 0.05 || (!pane.is_slice && Math.abs(tilt) > most_tilt)) return null;
  const away = dot(sub(plane.point_mm, state.cross_mm), plane.normal);
  const across = sub(plane.normal, scaled(look, tilt));
  return {
    middle: add(state.cross_mm, scaled(across, away / dot(across, across))),
    along: scaled(along, 1 / length)
  };
}

/// Positions of the handles in canvas pixels. The first moves the plane along its normal; the other two
/// rotate it.
function handles_of(pane: Pane, {middle, along}: Trace): [Vec2, Vec2, Vec2] {
  const reach = scaled(along, reach_share * Math.min(...pane.size) * pane.frame.pixel_mm);
  return [pane.pixel_at(middle), pane.pixel_at(add(middle, reach)), pane.pixel_at(sub(middle, reach))];
}

export function draw_mirror_plane(pane: Pane, context: CanvasRenderingContext2D, step: Step|undefined): void {
  const plane = step?.do === "mirror" ? shown_plane(step) : null;
  const trace = plane && trace_in(pane, plane);
  if (!trace) return;
  const {middle, along} = trace;
  const reach = scaled(along, Math.hypot(...pane.size) * pane.frame.pixel_mm);
  line(context, [pane.pixel_at(sub(middle, reach)), pane.pixel_at(add(middle, reach))], ink.mark,
       2 * pane.ratio);
  const handles = handles_of(pane, trace);
  for (const handle of handles) dot_at(context, handle, 5 * pane.ratio, ink.mark);
  label(context, "mirror plane", handles[0], pane.ratio, {colour: ink.mark, px: 11});
}

export interface MirrorDrag {
  to(at: Vec2): void;
  /// Writes the dragged plane into the step. The step then states its plane and no longer fits it or puts it
  /// through landmarks.
  done(): void;
  cancel(): void;
}

/// Begins to move or rotate the plane of the selected mirror. Null if no handle is under the pointer.
export function mirror_from(pane: Pane, at: Vec2): MirrorDrag|null {
  const step = step_of(state.selected);
  const plane = step?.do === "mirror" && !is_elsewhere() ? plane_of(step) : null;
  const trace = plane && trace_in(pane, plane);
  if (!step || !plane || !trace) return null;
  const taken = handles_of(pane, trace).findIndex(
      (handle) => Math.hypot(handle[0] - at[0], handle[1] - at[1]) < near_px * pane.ratio);
  if (taken < 0) return null;
  const {look} = pane.frame;
  const {middle} = trace;
  const centre = pane.pixel_at(middle);
  // The angle grows clockwise on the screen, which is a right-handed rotation about the view direction.
  const angle = (p: Vec2): number => Math.atan2(p[1] - centre[1], p[0] - centre[0]);
  const start = angle(at), from = pane.point_at(at);
  return {
    to(to) {
      const moved: Plane = taken === 0 ?
          {...plane, point_mm: add(plane.point_mm, scaled(plane.normal, dot(sub(pane.point_at(to), from), plane.normal)))} :
          {point_mm: middle, normal: normalised(turned_about(plane.normal, look, angle(to) - start))};
      held = {id: step.id, plane: moved};
    },
    done() {
      if (held?.id !== step.id) return;
      const {fit, through, ...kept} = step;
      const {point_mm, normal} = held.plane;
      const rounded = normal.map((x) => Math.round(x * 1e6) / 1e6) as Vec3;
      void replace_step(step.id, {...kept, point_mm: hundredths(point_mm), normal: rounded}, "move the mirror plane")
          .then(() => (held = null));
    },
    cancel() {
      held = null;
    },
  };
}

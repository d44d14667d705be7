// SPDX-License-Identifier: AGPL-3.0-or-later
// The plane of a mirror step, drawn as its trace in slices, and in views that look along it.
import {ink, label, line} from "../base/ink";
import type {Pane} from "./panes";
import {Step} from "../protocol";
import {state} from "../state";
import {add, cross, dot, normalised, scaled, sub, Vec3} from "../base/vector";

export interface Plane {
  point_mm: Vec3;
  normal: Vec3;
}

const is_point = (value: unknown): value is Vec3 => Array.isArray(value) && value.length === 3;

/// The plane that the server found or took, else the step's own; null where neither is known yet.
export function plane_of(step: Step): Plane|null {
  const found = state.plan?.objects.find((one) => one.id === step.id)?.mirror;
  if (found) return found.plane;
  if (step.fit || step.through) return null;
  return {
    point_mm: is_point(step.point_mm) ? step.point_mm : [0, 0, 0],
    normal: is_point(step.normal) ? normalised(step.normal) : [1, 0, 0]
  };
}

/// A view shows the plane as a line where it looks along it to within this cosine.
const most_tilt = 0.2;

export function draw_mirror_plane(pane: Pane, context: CanvasRenderingContext2D, step: Step|undefined): void {
  const plane = step?.do === "mirror" ? plane_of(step) : null;
  if (!plane) return;
  const {look} = pane.frame;
  const tilt = dot(plane.normal, look);
  const along = cross(plane.normal, look);
  const length = Math.hypot(...along);
  if (length < 0.05 || (!pane.is_slice && Math.abs(tilt) > most_tilt)) return;
  // The point of both planes, the mirror's and the picture's through the cross-hair, nearest to the cross-hair.
  const away = dot(sub(plane.point_mm, state.cross_mm), plane.normal);
  const across = sub(plane.normal, scaled(look, tilt));
  const at = add(state.cross_mm, scaled(across, away / dot(across, across)));
  const reach = scaled(along, (Math.hypot(...pane.size) * pane.frame.pixel_mm) / length);
  line(context, [pane.pixel_at(sub(at, reach)), pane.pixel_at(add(at, reach))], ink.mark, 2 * pane.ratio);
  label(context, "mirror plane", pane.pixel_at(at), pane.ratio, {colour: ink.mark, px: 11});
}

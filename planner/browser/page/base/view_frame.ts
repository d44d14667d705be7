// SPDX-License-Identifier: AGPL-3.0-or-later
// Frames of orthographic pictures: directions, pixels and millimetres. Views have the same directions as on
// the command line.
import {add, cross, dot, scaled, Vec2, Vec3} from "./vector";

export interface ViewFrame {
  right: Vec3;
  up: Vec3;
  look: Vec3;
  centre_mm: Vec3;  // the point in the middle of the picture, at any depth
  pixel_mm: number;
}

export interface Turned {
  azimuth: number;    // degrees from anterior towards the patient's left
  elevation: number;  // degrees upwards
}
export type ViewName = "anterior"|"posterior"|"left"|"right"|"superior"|"inferior";
export type View = ViewName|Turned;
export const plane_names = ["axial", "coronal", "sagittal", "oblique"] as const;
export type PlaneName = typeof plane_names[number];

const directions: Record<ViewName, [Vec3, Vec3]> = {
  anterior: [[0, 1, 0], [0, 0, 1]],
  posterior: [[0, -1, 0], [0, 0, 1]],
  left: [[-1, 0, 0], [0, 0, 1]],
  right: [[1, 0, 0], [0, 0, 1]],
  superior: [[0, 0, -1], [0, -1, 0]],
  inferior: [[0, 0, 1], [0, -1, 0]],
};
export const view_names = Object.keys(directions) as ViewName[];

/// The view along a slice plane's normal, to which a region drawn on the slice belongs. The view of an
/// oblique plane is given by its angles.
export const view_of_plane = (plane: PlaneName, tilt: Turned): View =>
    plane === "oblique" ? tilt : ({axial: "inferior", coronal: "anterior", sagittal: "left"} as const)[plane];

const turned_of: Record<ViewName, Turned> = {
  anterior: {azimuth: 0, elevation: 0},
  left: {azimuth: 90, elevation: 0},
  posterior: {azimuth: 180, elevation: 0},
  right: {azimuth: -90, elevation: 0},
  superior: {azimuth: 180, elevation: 89.9},
  inferior: {azimuth: 0, elevation: -89.9},
};

/// A view as angles, from which it can be rotated further.
export const turned = (view: View): Turned => (typeof view === "string" ? turned_of[view] : view);

export function directions_of(view: View): {right: Vec3; up: Vec3; look: Vec3} {
  if (typeof view === "string") {
    const [look, up] = directions[view];
    return {look, up, right: cross(look, up)};
  }
  const a = (view.azimuth * Math.PI) / 180;
  const e = (view.elevation * Math.PI) / 180;
  const look: Vec3 = [-Math.sin(a) * Math.cos(e), Math.cos(a) * Math.cos(e), -Math.sin(e)];
  const up: Vec3 = [-Math.sin(a) * Math.sin(e), Math.cos(a) * Math.sin(e), Math.cos(e)];
  return {look, up, right: cross(look, up)};
}

/// Angles of the view that looks along a unit vector in LPS.
export function turned_towards(look: Vec3): Turned {
  const tenth = (rad: number): number => Math.round((rad * 1800) / Math.PI) / 10;
  const elevation = tenth(Math.asin(Math.max(-1, Math.min(1, -look[2]))));
  return {
    azimuth: tenth(Math.atan2(-look[0], look[1])),
    elevation: Math.max(-89.9, Math.min(89.9, elevation))
  };
}

/// A view as plans write it: its name, or "AZ,EL" in degrees.
export const view_text = (view: View): string =>
    typeof view === "string" ? view : `${view.azimuth},${view.elevation}`;

/// The position in a picture at which a point appears, in pixels from the top left.
export function pixel_of(frame: ViewFrame, size: Vec2, p_mm: Vec3): Vec2 {
  const x = dot(p_mm, frame.right) - dot(frame.centre_mm, frame.right);
  const y = dot(p_mm, frame.up) - dot(frame.centre_mm, frame.up);
  return [size[0] / 2 + x / frame.pixel_mm, size[1] / 2 - y / frame.pixel_mm];
}

/// A pixel position in the view's own millimetres: u = p . right, v = p . up for every point p that appears
/// there.
export function uv_of(frame: ViewFrame, size: Vec2, at: Vec2): Vec2 {
  return [
    dot(frame.centre_mm, frame.right) + (at[0] - size[0] / 2) * frame.pixel_mm,
    dot(frame.centre_mm, frame.up) - (at[1] - size[1] / 2) * frame.pixel_mm,
  ];
}

/// The point that appears at a pixel position and lies at the depth p . look = `depth_mm`.
export function point_of(frame: ViewFrame, size: Vec2, at: Vec2, depth_mm: number): Vec3 {
  const [u, v] = uv_of(frame, size, at);
  return add(add(scaled(frame.right, u), scaled(frame.up, v)), scaled(frame.look, depth_mm));
}

/// The letters of the patient's directions at the left, right, top and bottom edge of a picture: R, L, A, P,
/// H or F; two letters at an oblique edge.
export function edge_letters(frame: ViewFrame): {left: string; right: string; top: string; bottom: string} {
  const name = (d: Vec3): string =>
      ([[d[0], "L", "R"], [d[1], "P", "A"], [d[2], "H", "F"]] as [number, string, string][])
          .filter(([part]) => Math.abs(part) > 0.35)
          .sort((a, b) => Math.abs(b[0]) - Math.abs(a[0]))
          .slice(0, 2)
          .map(([part, plus, minus]) => (part > 0 ? plus : minus))
          .join("");
  return {
    left: name(scaled(frame.right, -1)),
    right: name(frame.right),
    top: name(frame.up),
    bottom: name(scaled(frame.up, -1)),
  };
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// Points and directions of the patient frame (LPS: x to the patient's left, y to the back, z to the head), in
// mm.

export type Vec3 = [number, number, number];
export type Vec2 = [number, number];

export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (a: Vec3, by: number): Vec3 => [a[0] * by, a[1] * by, a[2] * by];
export const cross = (a: Vec3, b: Vec3): Vec3 =>
    [a[1] * b[2] - a[2] * b[1],
     a[2] * b[0] - a[0] * b[2],
     a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
export const normalised = (a: Vec3): Vec3 => scaled(a, 1 / (length(a) || 1));
/// Rotates a vector about a unit axis, counter-clockwise if the axis points to the viewer.
export const turned_about = (v: Vec3, axis: Vec3, rad: number): Vec3 =>
    add(add(scaled(v, Math.cos(rad)), scaled(cross(axis, v), Math.sin(rad))),
        scaled(axis, dot(axis, v) * (1 - Math.cos(rad))));
export const distance = (a: Vec3, b: Vec3): number => length(sub(a, b));

/// The angle in degrees between the lines from `corner` to the points `a` and `b`.
export function angle_deg(a: Vec3, corner: Vec3, b: Vec3): number {
  const cosine = dot(normalised(sub(a, corner)), normalised(sub(b, corner)));
  return (Math.acos(Math.max(-1, Math.min(1, cosine))) * 180) / Math.PI;
}

/// Rounds to a hundredth, so that plans contain short numbers, not all digits of a pixel's position.
export const hundredth = (value: number): number => Math.round(value * 100) / 100;
export const hundredths = (p: Vec3): Vec3 => [hundredth(p[0]), hundredth(p[1]), hundredth(p[2])];

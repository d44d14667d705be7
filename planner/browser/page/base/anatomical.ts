// SPDX-License-Identifier: AGPL-3.0-or-later
// Motions in the head's words, as the plan's `move` takes them: forward, left, up; pitch, yaw, roll.
import {Motion} from "../protocol";
import {Vec3} from "./vector";

export const directions = ["forward_mm", "left_mm", "up_mm"] as const;
export const turns = ["pitch_deg", "yaw_deg", "roll_deg"] as const;
export type Direction = typeof directions[number];
export type Turn = typeof turns[number];

/// Directions in LPS of the words forward, left and up, for a head that is not repositioned.
export const lps: Record<Direction, Vec3> = {
  forward_mm: [0, -1, 0],
  left_mm: [1, 0, 0],
  up_mm: [0, 0, 1]
};

const words: Record<Direction|Turn, [string, string]> = {
  forward_mm: ["forward", "back"],
  left_mm: ["to the left", "to the right"],
  up_mm: ["up", "down"],
  pitch_deg: ["front up", "front down"],
  yaw_deg: ["front to the left", "front to the right"],
  roll_deg: ["left side up", "left side down"],
};
export const word_of = (field: Direction|Turn, value: number): string => words[field][value < 0 ? 1 : 0];

/// A motion in anatomical words, such as "6.0 mm forward, 2.0 mm up; 3.0° front up". Values below 0.05 are
/// left out.
export function motion_words(move: Motion): string {
  if (move.points) return `by ${move.points.length === 1 ? "one mark" : `${move.points.length} marks`}`;
  const said =
      (fields: readonly(Direction | Turn)[], values: {[field: string]: number|undefined}, unit: string):
          string =>
              fields.filter((field) => Math.abs(values[field] ?? 0) >= 0.05)
                  .map(
                      (field) =>
                          `${Math.abs(values[field]!).toFixed(1)}${unit} ${word_of(field, values[field]!)}`)
                  .join(", ");
  const by = said(directions, move.by ?? {}, " mm");
  const turn =
      said(turns, {...(move.turn ?? {}), about_mm: undefined} as {[field: string]: number | undefined}, "°");
  return [by, turn].filter(Boolean).join("; ") || "not moved";
}

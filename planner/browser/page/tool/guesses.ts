// SPDX-License-Identifier: AGPL-3.0-or-later
// A first guess of landmarks. A guess enters the plan only when a person keeps it, or clicks the landmark's
// true position.
import {try_to} from "../actions";
import {button, Child, el} from "../base/html";
import {ink, label} from "../base/ink";
import {Vec2} from "../base/vector";
import {makes_body, operands} from "../operations";
import {is_drawn} from "../pane/overlay";
import type {Pane} from "../pane/panes";
import {LandmarkGuess, Step} from "../protocol";
import {notify, selected_step, set, state, steps} from "../state";

/// Guesses that the person has neither confirmed nor replaced by a landmark.
export const open_guesses = (): LandmarkGuess[] =>
    state.guesses.filter((guess) => !state.plan?.landmarks.some((mark) => mark.name === guess.name));

interface Found {
  landmarks: LandmarkGuess[];
  missing: {name: string; why: string}[];
  findings: string[];
}

/// Requests guesses of landmarks on the selected object if it uses no other object, or else on the first such
/// object. Returns whether the server found any.
export async function ask_guesses(): Promise<boolean> {
  const is_whole = (step: Step): boolean => makes_body(step) && !operands(step).length;
  const object = [selected_step(), ...steps()].find((step) => step && is_whole(step))?.id;
  if (!object) {
    notify("Set bone first: landmarks are guessed on its surface.", "warning");
    return false;
  }
  const found = await try_to<Found>("find_landmarks", {object});
  if (!found) return false;
  set({guesses: found.landmarks});
  const count = open_guesses().length;
  if (!count) {
    notify(found.findings[0] ?? "Every landmark that can be guessed is placed.", "warning");
    return false;
  }
  const missing = found.missing.map((one) => `${one.name.replace(/_/g, " ")} (${one.why})`).join(", ");
  notify(`${count} landmarks are guessed. Look at each: keep it, or click where it is.${
      missing ? ` Not found: ${missing}.` : ""}`);
  return true;
}

export function pass_over(guess: LandmarkGuess): void {
  set({guesses: state.guesses.filter((one) => one !== guess)});
}

const radius_px = (pane: Pane, guess: LandmarkGuess): number =>
    Math.max(7 * pane.ratio, guess.uncertainty_mm / pane.frame.pixel_mm);

/// Draws each guess with a circle whose radius is its uncertainty.
export function draw_guesses(pane: Pane, context: CanvasRenderingContext2D, current: string): void {
  for (const guess of open_guesses()) {
    if (!is_drawn(pane, {name: guess.name, point: guess.point_mm})) continue;
    const at: Vec2 = pane.pixel_at(guess.point_mm);
    const is_current = guess.name === current;
    const colour = is_current ? ink.landmark : ink.faint;
    context.save();
    context.setLineDash([4 * pane.ratio, 3 * pane.ratio]);
    context.beginPath();
    context.arc(at[0], at[1], radius_px(pane, guess), 0, 2 * Math.PI);
    context.lineWidth = (is_current ? 2.5 : 1.5) * pane.ratio;
    context.strokeStyle = colour;
    context.stroke();
    context.restore();
    if (is_current) label(context, `${guess.name.replace(/_/g, " ")}?`, at, pane.ratio, {colour, px: 11});
  }
}

/// A card that describes a guess, with buttons to keep it or to pass over it.
export function guess_card(guess: LandmarkGuess, keep: () => void, pass: () => void): Child {
  return [
    el("p", {class: "says"}, el("b", {}, `${open_guesses().length} to look at: ${guess.name.replace(/_/g, " ")}, within ${
                                           guess.uncertainty_mm.toFixed(1)} mm. `),
       `${guess.says[0]!.toUpperCase()}${guess.says.slice(1)}. Keep it, or click where it is.`),
    el("div", {class: "row"},
       button("Keep", "Keep. The guess becomes a landmark of the plan", keep, {class: "primary", "data-key": "keep-guess"}),
       button("Pass over", "Pass over. Removes the guess", pass, {"data-key": "pass-guess"})),
  ];
}

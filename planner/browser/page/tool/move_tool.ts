// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves and turns a piece by handles in a pane; the overlap is reported and drawn meanwhile.
import {Direction, directions, lps, motion_words, Turn, turns, word_of} from "../base/anatomical";
import {el} from "../base/html";
import {dot_at, ink, text} from "../base/ink";
import type {Pane} from "../pane/panes";
import {centre_of, commit_motion, current, piece, pivot_mm, preview_motion} from "./piece_motion";
import {Difference, Motion, Step} from "../protocol";
import {notify, on_leaving_plan, set, state} from "../state";
import {Tool} from "./tool";
import {add, dot, scaled, Vec2, Vec3} from "../base/vector";

type Handle = Direction|"turn"|"free";
interface Held {
  handle: Handle;
  start: Vec2;
  pane: Pane;
  before: Motion;
}
let held: Held|null = null;

/// The ring's radius in CSS pixels. It is smaller in a small pane, so that the handles stay inside.
const ring_px = (pane: Pane): number => Math.min(84, (0.25 * Math.min(...pane.size)) / pane.ratio);
const arrow_px = (pane: Pane): number => 0.74 * ring_px(pane);
const turn_axes: Record<Turn, [Vec3, Vec3]> = {
  pitch_deg: [[0, -1, 0], [0, 0, 1]],  // the front goes up
  yaw_deg: [[0, -1, 0], [1, 0, 0]],    // the front goes to the left
  roll_deg: [[1, 0, 0], [0, 0, 1]],    // the left side goes up
};

const arrow_end = (pane: Pane, word: Direction): Vec2|null => {
  const frame = pane.frame;
  const x = dot(lps[word], frame.right);
  const y = -dot(lps[word], frame.up);
  return Math.hypot(x, y) < 0.35 ? null : [x, y];
};
/// The anatomical rotation whose axis is nearest to the pane's view direction. `sign` is 1 if a positive
/// angle appears counter-clockwise on the screen, else -1.
function turn_in(pane: Pane): {turn: Turn; sign: number} {
  const frame = pane.frame;
  const size = (turn: Turn): number => {
    const [a, b] = turn_axes[turn];
    return dot(a, frame.right) * dot(b, frame.up) - dot(a, frame.up) * dot(b, frame.right);
  };
  const best = turns.reduce((one, other) => (Math.abs(size(other)) > Math.abs(size(one)) ? other : one));
  return {turn: best, sign: Math.sign(size(best)) || 1};
}

/// The motion that keys have requested and that the plan does not contain yet. Keys repeat faster than the
/// server answers, so only the newest motion is stored.
let keyed: {source: string; move: Motion}|null = null;
let is_writing = false;
on_leaving_plan(() => { keyed = null; });

/// Writes the newest motion by keys into the plan. Repeats this if further keys were pressed before the
/// answer.
async function write_keyed(): Promise<void> {
  if (is_writing) return;
  is_writing = true;
  try {
    while (keyed && piece()?.source === keyed.source) {
      const {move}: {move: Motion} = keyed;
      await commit_motion(move);
      if (keyed?.move === move) break;
    }
  } finally {
    keyed = null;
    is_writing = false;
  }
}

export const move_tool: Tool = {
  name: "move",
  title: "Move a piece",
  says:
      "Select a piece. Drag inside the ring to move it freely, drag an arrow to move it in one direction, or drag the ring to turn it. The overlap with the parts that stay is drawn in red.",
  key: "g",
  cursor: "move",

  down({pane, at}) {
    const one = piece();
    if (!one) return false;
    const before = current();
    if (before.points) {
      notify("This piece is moved by marks. Change them with Move by marks (J).", "warning");
      return false;
    }
    const centre = pane.pixel_at(pivot_mm(one.source, before));
    const handle = handle_at(pane, at, centre, one);
    if (!handle) return false;
    held = {handle, start: at, pane, before};
    return true;
  },
  move({at, pane}) {
    const one = piece();
    if (!held || !one) return;
    preview_motion(dragged(held, one.source, at));
    pane.redraw();
  },
  up() {
    if (!held) return;
    held = null;
    if (state.preview?.move) void commit_motion(state.preview.move);
  },
  press(event) {
    const keys: {[key: string]: [Direction, number]} = {
      w: ["up_mm", 0.5],
      s: ["up_mm", -0.5],
      a: ["left_mm", -0.5],
      d: ["left_mm", 0.5],
      f: ["forward_mm", 0.5],
      b: ["forward_mm", -0.5],
    };
    const hit = event.ctrlKey || event.metaKey ? undefined : keys[event.key];
    const one = piece();
    if (!hit || !one || current().points) return false;
    const move = keyed?.source === one.source ? keyed.move : current();
    keyed = {source: one.source, move: {...move, by: {...move.by, [hit[0]]: (move.by?.[hit[0]] ?? 0) + hit[1]}}};
    void write_keyed();
    return true;
  },
  left() {
    held = null;
    set({preview: null, difference: null});
  },
  draw: draw_handles,
  panel: () =>
      (piece() ? null :
                 el("p", {class: "says"}, "Select the piece to be moved: click it in the list or in a view.")),
};

function handle_at(pane: Pane, at: Vec2, centre: Vec2, one: {source: string; step: Step | undefined}): Handle|
    null {
  const from: Vec2 = [(at[0] - centre[0]) / pane.ratio, (at[1] - centre[1]) / pane.ratio];
  const [ring, reach] = [ring_px(pane), arrow_px(pane)];
  for (const word of directions) {
    const end = arrow_end(pane, word);
    if (end && [
          1, -1
        ].some((side) => Math.hypot(from[0] - side * end[0] * reach, from[1] - side * end[1] * reach) < 13))
      return word;
  }
  const radius = Math.hypot(from[0], from[1]);
  if (Math.abs(radius - ring) < 9) return "turn";
  const picked = pane.pick(at)?.object;
  return radius < ring ||
          (picked !== null && picked !== undefined && (picked === one.source || picked === one.step?.id)) ?
      "free" :
      null;
}

function dragged(drag: Held, source: string, at: Vec2): Motion {
  const {pane, start, before, handle} = drag;
  const frame = pane.frame;
  if (handle === "turn") {
    const centre = pane.pixel_at(pivot_mm(source, before));
    const angle = (p: Vec2): number => (Math.atan2(-(p[1] - centre[1]), p[0] - centre[0]) * 180) / Math.PI;
    const {turn, sign} = turn_in(pane);
    const by = ((((angle(at) - angle(start)) * sign + 180) % 360) + 360) % 360 - 180;
    const about_mm = before.turn?.about_mm ?? centre_of(source);
    return {...before, turn: {...before.turn, about_mm, [turn]: half((before.turn?.[turn] ?? 0) + by, 0.1)}};
  }
  const x = (at[0] - start[0]) * frame.pixel_mm;
  const y = -(at[1] - start[1]) * frame.pixel_mm;
  const moved = add(scaled(frame.right, x), scaled(frame.up, y));
  const by = {...before.by};
  for (const word of directions) {
    if (handle !== "free" && handle !== word) continue;
    const along = dot(moved, lps[word]) /
        (handle === "free" ?
             1 :
             Math.max(0.35, Math.hypot(dot(lps[word], frame.right), dot(lps[word], frame.up)) ** 2));
    by[word] = half((before.by?.[word] ?? 0) + along, 0.1);
  }
  return {...before, by};
}
const half = (value: number, to: number): number => Math.round(Math.round(value / to) * to * 100) / 100;

function draw_handles(pane: Pane, context: CanvasRenderingContext2D): void {
  const one = piece();
  if (!one || pane.setting.mode === "panoramic" || current().points) return;
  const move = current();
  const [x, y] = pane.pixel_at(pivot_mm(one.source, move));
  const ratio = pane.ratio;
  const {turn} = turn_in(pane);
  const [ring, reach] = [ring_px(pane) * ratio, arrow_px(pane) * ratio];
  context.beginPath();
  context.arc(x, y, ring, 0, 2 * Math.PI);
  context.lineWidth = 5 * ratio;
  context.strokeStyle = "rgba(0,0,0,.45)";
  context.stroke();
  context.lineWidth = 2 * ratio;
  context.strokeStyle = ink.measure;
  context.stroke();
  dot_at(context, [x + ring * Math.SQRT1_2, y - ring * Math.SQRT1_2], 5 * ratio, ink.measure);
  const colours:
      Record<Direction, string> = {left_mm: ink.cross[0], forward_mm: ink.cross[1], up_mm: ink.cross[2]};
  for (const word of directions) {
    const end = arrow_end(pane, word);
    if (!end) continue;
    for (const side of [1, -1]) {
      const tip: Vec2 = [x + side * end[0] * reach, y + side * end[1] * reach];
      arrow(context, [x, y], tip, colours[word], ratio);
    }
  }
  dot_at(context, [x, y], 5 * ratio, "#fff");
  if (held?.pane !== pane) return;
  const words = held.handle === "turn" ? `${turn_words(move, turn)}` : motion_words({by: move.by ?? {}});
  text(context, words, [x, y - ring - 16 * ratio], ratio, {align: "center", px: 13});
  if (state.difference)
    text(context, difference_words(state.difference), [x, y + ring + 16 * ratio], ratio, {align: "center", px: 13});
  else if (state.overlap_mm3 !== null)
    text(context, `overlap ${state.overlap_mm3.toFixed(0)} mm³`, [x, y + ring + 16 * ratio], ratio, {
      align: "center",
      px: 13,
      colour: state.overlap_mm3 > 0.5 ? ink.bad : ink.good,
    });
}
const difference_words = ({only_moved_mm3, only_other_mm3}: Difference): string =>
    `differs by ${(only_moved_mm3 + only_other_mm3).toFixed(0)} mm³`;
const turn_words = (move: Motion, turn: Turn): string => {
  const value = (move.turn?.[turn] as number | undefined) ?? 0;
  return `${Math.abs(value).toFixed(1)}° ${word_of(turn, value)}`;
};

function arrow(context: CanvasRenderingContext2D, from: Vec2, to: Vec2, colour: string, ratio: number): void {
  const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
  const back = 10 * ratio;
  const wing = (turned_by: number):
      Vec2 => [to[0] - back * Math.cos(angle + turned_by), to[1] - back * Math.sin(angle + turned_by)];
  for (const [width, ink_of] of [[5, "rgba(0,0,0,.45)"], [2.5, colour]] as const) {
    context.beginPath();
    context.moveTo(from[0], from[1]);
    context.lineTo(to[0], to[1]);
    for (const p of [wing(0.5), wing(-0.5)]) {
      context.moveTo(to[0], to[1]);
      context.lineTo(p[0], p[1]);
    }
    context.lineWidth = width * ratio;
    context.strokeStyle = ink_of;
    context.stroke();
  }
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves a piece by marks (Ong 1992, 8.3): a point of the piece and where it is wanted, each set in one view
// and brought to its depth in another. One pair shifts the piece, further pairs turn it.
import {button, Child, el} from "../base/html";
import {dot_at, ink, label, line} from "../base/ink";
import type {Pane} from "../pane/panes";
import {commit_motion, current, piece, preview_motion} from "./piece_motion";
import {Motion} from "../protocol";
import {notify, set, state} from "../state";
import {take_tool, Tool} from "./tool";
import {distance, dot, hundredths, Vec2, Vec3} from "../base/vector";
import {point_of} from "../base/view_frame";

type End = "at"|"to";
type Pair = NonNullable<Motion["points"]>[number];
let pairs: Pair[] = [];
let open: Vec3|null = null;  // a clicked point of the piece, before its target is clicked
let held: {pair: number; end: End}|null = null;
const near_px = 11;
const most_pairs = 8;

/// The point at a position of a pane that has the same depth in this view as another point.
const as_deep_as = (pane: Pane, at: Vec2, p_mm: Vec3): Vec3 =>
    hundredths(point_of(pane.frame, pane.size, at, dot(p_mm, pane.frame.look)));

function end_at(pane: Pane, at: Vec2): {pair: number; end: End}|null {
  for (const [pair, marks] of pairs.entries())
    for (const end of ["to", "at"] as const) {
      const p = pane.pixel_at(marks[end]);
      if (Math.hypot(p[0] - at[0], p[1] - at[1]) < near_px * pane.ratio) return {pair, end};
    }
  return null;
}

function show(): void {
  if (pairs.length)
    preview_motion({points: pairs});
  else
    preview_motion({translate_mm: [0, 0, 0]});
}

function finish(): void {
  if (!pairs.length)
    return notify("Click a point of the piece, then the place where it is wanted.", "warning");
  const move: Motion = {points: pairs};
  pairs = [];
  open = null;
  void commit_motion(move).then(() => {
    if (state.tool === "marks") take_tool("navigate");
  });
}

export const marks_tool: Tool = {
  name: "marks",
  title: "Move by marks",
  says:
      "Click a point of the selected piece, then where it is wanted in the same view; drag either mark in another view to its depth. Enter moves the piece.",
  key: "j",
  cursor: "crosshair",
  is_pointed: true,
  taken() {
    pairs = (current().points ?? []).map((pair) => ({...pair}));
    open = held = null;
    // The marks lie on the piece before its motion, so the preview is drawn at that place.
    if (piece()) show();
  },
  left() {
    pairs = [];
    open = held = null;
    set({preview: null, overlap_mm3: null, difference: null});
  },
  down({pane, at}) {
    if (!piece() || pane.setting.mode === "panoramic") return false;
    held = end_at(pane, at);
    if (held) return true;
    if (open) {
      pairs.push({at: open, to: as_deep_as(pane, at, open)});
      open = null;
      show();
    } else if (pairs.length < most_pairs) {
      open = hundredths(pane.point_at(at));
    }
    set({cross_mm: pairs.length && !open ? pairs[pairs.length - 1]!.to : open ?? state.cross_mm});
    return true;
  },
  move({pane, at}) {
    if (!held) return;
    const pair = pairs[held.pair]!;
    pair[held.end] = as_deep_as(pane, at, pair[held.end]);
    pane.redraw();
    show();
  },
  up() {
    held = null;
  },
  press(event, pane) {
    if (event.key === "Enter")
      finish();
    else if (event.key === "Backspace" || event.key === "Delete") {
      if (open)
        open = null;
      else
        pairs.pop();
      show();
      pane.redraw();
    } else
      return false;
    return true;
  },
  draw(pane, context) {
    const mark = (p_mm: Vec3, words: string, is_target: boolean): void => {
      const p = pane.pixel_at(p_mm);
      dot_at(context, p, 5 * pane.ratio, is_target ? ink.measure : ink.landmark, is_target);
      if (words) label(context, words, p, pane.ratio, {px: 11});
    };
    for (const [index, {at, to}] of pairs.entries()) {
      line(context, [pane.pixel_at(at), pane.pixel_at(to)], ink.measure, 1.5 * pane.ratio);
      mark(at, "", false);
      mark(to, `${index + 1}`, true);
    }
    if (open) mark(open, "wanted where?", false);
  },
  panel: () =>
      (piece() ? marks_panel() :
                 el("p", {class: "says"}, "Select the piece to be moved: click it in the list or in a view.")),
};

function marks_panel(): Child {
  return [
    pairs.length ? el("ul", {class: "marks"},
                      pairs.map(
                          ({at, to}, index) =>
                              el("li", {class: "placed"}, el("b", {}, `Mark ${index + 1}`),
                                 ` ${distance(at, to).toFixed(1)} mm`))) :
                   null,
    el("div", {class: "row end"},
       button(
           "Move the piece", "Adds the motion that brings the marks where they are wanted. Enter", finish,
           {class: "primary"})),
  ];
}

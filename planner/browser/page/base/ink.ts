// SPDX-License-Identifier: AGPL-3.0-or-later
// How overlays draw: the colours of the page's marks, and words, lines and dots that are legible on bone and
// on the background.
import {Vec2} from "./vector";

export const ink = {
  cross: ["#ff8a65", "#7bd88f", "#64b5f6"] as const,  // sagittal, coronal, axial
  region: "#5b9dff",
  landmark: "#ffd166",
  measure: "#7ee0d0",
  mark: "#ff5d8f",
  oblique: "#c792ea",
  bad: "#ff8f93",
  good: "#9be7b0",
  text: "rgba(255,255,255,.92)",
  faint: "rgba(255,255,255,.55)",
};

// Boxes, in canvas pixels, around the labels and lines in the pane so far. label() places new labels beside
// them.
let labelled: {low: Vec2; high: Vec2}[] = [];

// Whether the pane's background is white, as in views on a light page. Words are then dark with a light
// outline.
let is_on_white = false;

/// Prepares for drawing a pane's overlay and forgets the labels of the previous one.
export function begin_ink(on_white: boolean): void {
  is_on_white = on_white;
  labelled = [];
}

export interface TextLook {
  align?: CanvasTextAlign;
  colour?: string;
  px?: number;
  plate?: boolean;
}
const dark_of: {[colour: string]: string} = {
  [ink.text]: "#18212b",
  [ink.faint]: "#52606e",
  [ink.landmark]: "#7a4b00",
  [ink.measure]: "#005e50",
  [ink.oblique]: "#7b3fa0",
  [ink.bad]: "#b3212a",
  [ink.good]: "#14713c"
};

const font_of = (look: TextLook, ratio: number): string =>
    `500 ${(look.px ?? 12) * ratio}px system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif`;

/// Draws words in one line, with an outline so that they are legible on bone and on the background. Centred
/// words are moved sideways to stay within the picture.
export function text(
    context: CanvasRenderingContext2D, words: string, at: Vec2, ratio: number, look: TextLook = {}): void {
  context.font = font_of(look, ratio);
  context.textAlign = look.align ?? "left";
  context.textBaseline = "middle";
  context.lineWidth = 3 * ratio;
  const colour = look.colour ?? ink.text;
  const half = context.measureText(words).width / 2 + 4 * ratio;
  const x = look.align === "center" && 2 * half < context.canvas.width ?
      Math.max(half, Math.min(context.canvas.width - half, at[0])) :
      at[0];
  context.strokeStyle = is_on_white ? "rgba(255,255,255,.85)" : "rgba(0,0,0,.75)";
  context.strokeText(words, x, at[1]);
  context.fillStyle = is_on_white ? dark_of[colour] ?? colour : colour;
  context.fillText(words, x, at[1]);
}

/// Makes label() avoid a line. `points` are in canvas pixels.
export function keep_words_off(points: Vec2[], ratio: number): void {
  const half = 2 * ratio;
  points.slice(1).forEach((to, i) => {
    const from = points[i]!;
    const count = Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / (3 * half));
    for (let n = 0; n <= count; ++n) {
      const [x, y] = [0, 1].map((axis) => from[axis]! + ((to[axis]! - from[axis]!) * n) / (count || 1));
      labelled.push({low: [x! - half, y! - half], high: [x! + half, y! + half]});
    }
  });
}

/// Draws a sentence in the middle of the picture, broken into lines that fit its width.
export function sentence(
    context: CanvasRenderingContext2D, words: string, ratio: number, look: TextLook = {}): void {
  const {width, height} = context.canvas;
  context.font = font_of(look, ratio);
  const lines: string[] = [];
  for (const word of words.split(" ")) {
    const longer = `${lines[lines.length - 1] ?? ""} ${word}`.trim();
    if (lines.length && context.measureText(longer).width < width - 32 * ratio)
      lines[lines.length - 1] = longer;
    else
      lines.push(word);
  }
  const row = 18 * ratio;
  lines.forEach(
      (each, i) => text(
          context, each, [width / 2, height / 2 + (i - (lines.length - 1) / 2) * row], ratio,
          {...look, align: "center"}));
}

/// Makes later labels avoid a dot.
export function keep_words_off_dot(at: Vec2, radius: number): void {
  labelled.push({low: [at[0] - radius, at[1] - radius], high: [at[0] + radius, at[1] + radius]});
}

/// The rows of text, counted from a point's own, in which its label may stand: the nearest first.
const label_rows = [0, ...Array.from({length: 9}, (_, i) => [-i - 1, i + 1]).flat()];
/// From this row on, a line leads from the point to its label.
const led_from_row = 2;

/// Draws words to the right or left of a point, moved up or down if labels are in the way. Without room, a label that
/// `may_be_left_out` is not drawn, and any other one covers what is there.
export function label(
    context: CanvasRenderingContext2D, words: string, at: Vec2, ratio: number,
    look: TextLook&{may_be_left_out?: boolean}): void {
  const px = (look.px ?? 12) * ratio;
  context.font = font_of(look, ratio);
  const width = context.measureText(words).width;
  const gap = 7 * ratio;
  const places = label_rows.flatMap(
      (row) => [gap, -gap - width].map((x) => ({row, place: [at[0] + x, at[1] + row * px] as Vec2})));
  const box = ([x, y]: Vec2): {low: Vec2; high: Vec2} =>
      ({low: [x, y - px / 2], high: [x + width, y + px / 2]});
  const edge = 4 * ratio, head = 34 * ratio;  // the pane's choices lie at its top
  const is_free = ({place}: {place: Vec2}): boolean => {
    const {low, high} = box(place);
    return low[0] >= edge && high[0] <= context.canvas.width - edge && low[1] >= head &&
        high[1] <= context.canvas.height - edge &&
        labelled.every(
            (one) =>
                one.low[0] > high[0] || one.high[0] < low[0] || one.low[1] > high[1] || one.high[1] < low[1]);
  };
  const found = places.find(is_free) ?? (look.may_be_left_out ? null : places[0]!);
  if (!found) return;
  const {row, place} = found;
  labelled.push(box(place));
  if (Math.abs(row) >= led_from_row) {
    const end: Vec2 = [place[0] > at[0] ? place[0] - 2 * ratio : place[0] + width + 2 * ratio, place[1]];
    context.globalAlpha = 0.6;
    line(context, [at, end], look.colour ?? ink.text, 0.75 * ratio);
    context.globalAlpha = 1;
  }
  text(context, words, place, ratio, {...look, align: "left"});
}

export function line(
    context: CanvasRenderingContext2D, points: Vec2[], colour: string, width: number, closed = false): void {
  if (!points.length) return;
  context.beginPath();
  points.forEach((p, i) => (i ? context.lineTo(p[0], p[1]) : context.moveTo(p[0], p[1])));
  if (closed) context.closePath();
  context.strokeStyle = is_on_white ? "rgba(255,255,255,.8)" : "rgba(0,0,0,.55)";
  context.lineWidth = width + 2;
  context.stroke();
  context.strokeStyle = is_on_white ? dark_of[colour] ?? colour : colour;
  context.lineWidth = width;
  context.stroke();
}

export function dot_at(
    context: CanvasRenderingContext2D, at: Vec2, radius: number, colour: string, hollow = false): void {
  context.beginPath();
  context.arc(at[0], at[1], radius, 0, 2 * Math.PI);
  context.fillStyle = hollow ? "rgba(0,0,0,.35)" : colour;
  context.fill();
  context.lineWidth = Math.max(1, radius * 0.35);
  context.strokeStyle = hollow ? colour : "rgba(0,0,0,.7)";
  context.stroke();
}

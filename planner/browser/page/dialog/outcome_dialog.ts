// SPDX-License-Identifier: AGPL-3.0-or-later
// How close an operation came to its plan: reads a scan from after the operation, and shows the planned and
// the achieved movements side by side, with intervals.
import {busy, done, try_to} from "../actions";
import {word_of} from "../base/anatomical";
import {open_dialog} from "../base/dialog";
import {open_picker} from "./files";
import {button, Child, el} from "../base/html";

interface By {
  forward_mm: number;
  up_mm: number;
  left_mm: number;
}
interface Turned {
  pitch_deg: number;
  yaw_deg: number;
  roll_deg: number;
}
interface Outcome {
  path: string;
  coverage: number;
  unmoved: {object: string; rms_mm: number; findings: string[]};
  pieces: {
    object: string; planned: Turned; achieved: Turned; half_width: Turned;
    points: {name: string; planned: By; achieved: By; half_width: By; off_mm: number}[];
    rms_mm: number;
    findings: string[];
  }[];
}

export function open_outcome(): void {
  open_picker("The scan after the operation", (path) => void hold_against(path));
}

async function hold_against(path: string): Promise<void> {
  const job = busy("Aligning the pieces with the later scan");
  const outcome = await try_to<Outcome>("outcome", {path});
  done(job);
  if (!outcome) return;
  const dialog = open_dialog("Outcome of the operation", "outcome");
  dialog.refill(
      el("p", {class: "says"},
         `Both scans are aligned by ${spoken(outcome.unmoved.object)}, which did not move (rms ${
             outcome.unmoved.rms_mm.toFixed(2)} mm). The intervals hold in ${
             Math.round(100 * outcome.coverage)} of 100 cases, for bone that has kept its shape.`),
      findings(outcome.unmoved.findings), outcome.pieces.map(piece_table),
      el("div", {class: "row end"}, el("small", {class: "path"}, outcome.path), el("span", {class: "spring"}),
         button("Another scan", "Chooses another later scan", () => {
           dialog.close();
           open_outcome();
         })));
}

const spoken = (name: string): string => name.replace(/_/g, " ");
const findings = (list: string[]): Child => list.map((finding) => el("p", {class: "sentence warn"}, finding));

function piece_table(piece: Outcome["pieces"][number]): Child {
  const head = (...words: string[]): Child =>
      el("thead", {}, el("tr", {}, words.map((word) => el("th", {scope: "col"}, word))));
  const place = (name: string): string => (name === piece.object ? "its middle" : spoken(name));
  return [
    el("table", {class: "numbers outcome-table"},
       el("caption", {}, `${spoken(piece.object)}, fitted to ${piece.rms_mm.toFixed(2)} mm rms`),
       head("", "", "Planned", "Achieved", "Off"),
       el("tbody", {},
          piece.points.map(
              (point) =>
                  (["forward_mm", "up_mm", "left_mm"] as const)
                      .map(
                          (word, row) => result_row(
                              row ? "" : `${place(point.name)}, ${point.off_mm.toFixed(1)} mm off`, word,
                              "mm", point.planned[word], point.achieved[word], point.half_width[word]))),
          (["pitch_deg", "yaw_deg", "roll_deg"] as const)
              .map(
                  (word, row) => result_row(
                      row ? "" : "turn", word, "°", piece.planned[word], piece.achieved[word],
                      piece.half_width[word])))),
    findings(piece.findings),
  ];
}

type Word = Parameters<typeof word_of>[0];
/// A row that compares planned and achieved motion in one direction. It is amber if the interval does not
/// contain the planned value.
function result_row(
    name: string, word: Word, unit: string, planned: number, achieved: number, half_width: number): Child {
  const is_met = Math.abs(planned - achieved) <= half_width;
  const said = (value: number): string => value.toFixed(2).replace(/^-(?=0\.00$)/, "").replace("-", "−");
  return el(
      "tr", {class: is_met ? "met" : "missed"}, el("th", {scope: "row"}, name),
      el("td", {class: "words-cell"}, word_of(word, 1)), el("td", {}, `${said(planned)} ${unit}`),
      el("td", {}, `${said(achieved)} ± ${half_width.toFixed(2)} ${unit}`),
      el("td", {}, is_met ? "" : `${said(achieved - planned)} ${unit}`));
}

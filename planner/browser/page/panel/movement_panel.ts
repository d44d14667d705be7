// SPDX-License-Identifier: AGPL-3.0-or-later
// How far each piece and landmark moves, in words.
import {try_to} from "../actions";
import {button, Child, el} from "../base/html";
import {dialogs} from "../commands";
import {moves_object} from "../operations";
import {on_leaving_plan, set, state, steps} from "../state";

/// The motion of a piece and of its landmarks, in words.
interface MovementRow {
  object: string;
  from: string;
  words: string;
  landmarks?: {name: string; words: string; since_scan?: {words: string}}[];
}
const movements = new Map<string, MovementRow[]>();
let is_fetching = false;
let fetched = "";  // the edit and evaluation for which the rows were fetched
on_leaving_plan(() => {
  movements.clear();
  fetched = "";
});

export async function fetch_movement(): Promise<void> {
  const plan = state.plan;
  // The rows are requested again only if the plan was edited or evaluated since the last request.
  const present = `${plan?.edit} ${state.evaluations}`;
  if (!plan || state.right_tab !== "movement" || fetched === present) return;
  fetched = present;
  movements.clear();
  is_fetching = true;
  for (const step of steps().filter((one) => moves_object(one))) {
    const answer = await try_to<{rows: MovementRow[]}>("movement", {object: step.id});
    if (answer) movements.set(step.id, answer.rows ?? []);
  }
  is_fetching = false;
  set({right_tab: "movement"});
}

export function movement(): Child {
  const face = state.plan?.landmarks.length ?
      button(
          "Cephalometry", "Cephalometry. Shows measures of the face with norms, before and after, and their tracing",
          () => dialogs.cephalometry(), {"data-key": "cephalometry"}) :
      null;
  if (!movements.size)
    return [face, el("p", {class: "says empty", role: "status"},
                     is_fetching && steps().some((step) => moves_object(step)) ?
                         "The motions are being read …" :
                         "No piece moves yet. Select a piece and press G to move it.")];
  return [face, ...[...movements].map(
      ([id, rows]) =>
          el("table", {class: "numbers"}, el("caption", {}, id.replace(/_/g, " ")),
             el("tbody", {}, rows.map((row) => [
                  row_of(row.from, row.words),
                  (row.landmarks ?? [])
                      .map((mark) => row_of(
                               mark.name,
                               mark.since_scan ? `${mark.words}; since the scan ${mark.since_scan.words}` :
                                                 mark.words))
                ]))))];
}
const row_of = (name: string, words: string): Child =>
    el("tr", {}, el("th", {scope: "row"}, name.replace(/_/g, " ")), el("td", {class: "words-cell"}, words));

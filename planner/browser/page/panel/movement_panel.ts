// SPDX-License-Identifier: AGPL-3.0-or-later
// How far each piece and landmark moves, in words.
import {try_to} from "../actions";
import {Child, el} from "../base/html";
import {moves_object} from "../operations";
import {Json} from "../protocol";
import {on_leaving_plan, set, state, steps} from "../state";

interface MovementRow {
  name?: string;
  says?: string;
  [field: string]: Json|undefined;
}
const movements = new Map<string, MovementRow[]>();
let fetched_edit = -1;
on_leaving_plan(() => {
  movements.clear();
  fetched_edit = -1;
});

export async function fetch_movement(): Promise<void> {
  const plan = state.plan;
  if (!plan || state.right_tab !== "movement" || fetched_edit === plan.edit) return;
  fetched_edit = plan.edit;
  movements.clear();
  for (const step of steps().filter((one) => moves_object(one))) {
    const answer = await try_to<{rows: MovementRow[]}>("movement", {object: step.id});
    if (answer) movements.set(step.id, answer.rows ?? []);
  }
  set({right_tab: "movement"});
}

export function movement(): Child {
  if (!movements.size)
    return el("p", {class: "says empty"}, "No piece moves yet. Select a piece and press G to move it.");
  return [...movements].map(
      ([id, rows]) =>
          el("table", {class: "numbers"}, el("caption", {}, id.replace(/_/g, " ")),
             el("tbody", {},
                rows.map(
                    (row) =>
                        el("tr", {}, el("th", {scope: "row"}, row_name(row)),
                           el("td", {class: "words-cell"}, row_words(row)))))));
}
const row_name = (row: MovementRow): string =>
    String(row.name ?? row.what ?? row.landmark ?? "").replace(/_/g, " ");
const row_words = (row: MovementRow): string => String(
    row.says ?? row.words ?? row.sentence ??
    Object.entries(row)
        .filter(([key]) => key !== "name")
        .map(
            ([key, value]) => `${key.replace(/_(mm|deg)$/, "")} ${
                typeof value === "number" ? value.toFixed(1) : String(value)}`)
        .join(", "));

// SPDX-License-Identifier: AGPL-3.0-or-later
// Merges the open plan with one that somebody else has changed: shows what would change, or what both changed
// differently, before anything is done.
import {change_plan, evaluate, try_to} from "../actions";
import {Dialog, open_dialog} from "../base/dialog";
import {open_picker} from "./files";
import {button, Child, el} from "../base/html";
import {notify, state} from "../state";

interface Conflict {
  step: string;
  field: string;
  base: unknown;
  a: unknown;
  b: unknown;
}
interface Attempt {
  base: number;
  conflicts: Conflict[];
  rows: string[];
}

export function open_merge(): void {
  open_picker("The plan to merge with this one", (path) => void show_merge(path));
}

async function show_merge(path: string, base?: number, shown?: Dialog): Promise<void> {
  const attempt = await try_to<Attempt>("try_merge", {path, ...(base === undefined ? {} : {base})});
  if (!attempt) return;
  const dialog = shown ?? open_dialog("Merge with another plan", "merge");
  const is_clean = attempt.conflicts.length === 0;
  const merge = async(): Promise<void> => {
    if (!await change_plan("merge", {path, base: attempt.base})) return;
    dialog.close();
    notify("Merged. Undo takes it back.");
    void evaluate();
  };
  dialog.refill(
      el("p", {class: "path"}, path),
      el("label", {class: "field", "data-tip": "The state of this plan from which both plans continue."},
         el("span", {}, "Common original"),
         el("select", {
           name: "base",
           "data-key": "merge-base",
           onchange: (event: Event) =>
               void show_merge(path, Number((event.target as HTMLSelectElement).value), dialog)
         },
            [...state.plan?.history ?? []].reverse().map(
                (one) => el("option", {value: one.id, selected: one.id === attempt.base},
                            `${one.id}: ${one.what || "first state"}`)))),
      base === undefined ?
          el("p", {class: "sentence warn"},
             "The original is a guess: the state from which the other plan differs in the fewest values.") :
          null,
      is_clean ? changes(attempt.rows) : conflicts(attempt.conflicts),
      el("div", {class: "row end"},
         button("Merge", "Records the merged plan as an edit", () => void merge(),
                {class: "primary", disabled: !is_clean || !attempt.rows.length})));
}

const changes = (rows: string[]): Child => rows.length ?
    [
      el("h3", {}, "What the other plan changes here"),
      el("ul", {class: "diff"}, rows.map((row) => el("li", {class: row[0] === "+" ? "more" : row[0] === "-" ? "less" : ""}, row)))
    ] :
    el("p", {class: "says"}, "The other plan changes nothing here.");

const text_of = (value: unknown): string => value === null || value === undefined ? "not there" : JSON.stringify(value);

const conflicts = (list: Conflict[]): Child => [
  el("p", {class: "sentence fail"},
     "Both plans changed the same values, so nothing is merged. Change one plan to the other's values, and merge again."),
  el("div", {class: "result-table", tabindex: 0, role: "group", "aria-label": "Conflicts"},
     el("table", {},
        el("thead", {}, el("tr", {}, ["Value", "Original", "This plan", "The other plan"].map((head) => el("th", {scope: "col"}, head)))),
        el("tbody", {}, list.map(
            (one) => el("tr", {},
                        el("th", {scope: "row"}, [one.step.replace(/_/g, " ") || "the plan", one.field].filter(Boolean).join(", ")),
                        [one.base, one.a, one.b].map((value) => el("td", {}, text_of(value))))))))
];

// SPDX-License-Identifier: AGPL-3.0-or-later
// The thin necks of a step that chooses parts, the largest part beyond a neck first. A click shows a neck, keeps the part
// beyond it, or cuts the neck; the decision becomes a point of the step.
import {replace_step} from "../actions";
import {button, Child, el} from "../base/html";
import {grouped} from "../base/numbers";
import {schema_of} from "../operations";
import {show_place} from "../pane/pane_grid";
import {Json, Neck, Step} from "../protocol";
import {state} from "../state";

const most_rows = 8;
type Decision = "keep_bridges_mm"|"cut_bridges_mm";
const points = (step: Step, field: Decision): Json[] => Array.isArray(step[field]) ? step[field] as Json[] : [];
const size = ({volume_mm3}: Neck): string => volume_mm3 === null ? "a part" : `${grouped(volume_mm3, 0)} mm³`;

function decide(step: Step, field: Decision, necks: Neck[], what: string): void {
  const added = necks.map(({at_mm}): Json => [...at_mm]);
  void replace_step(step.id, {...step, [field]: [...points(step, field), ...added]}, what);
}

function row(step: Step, neck: Neck): Child {
  const place = neck.at_mm.map((x) => grouped(x)).join(", ");
  const what = `${size(neck)} beyond the neck near ${place}`;
  const choice = (word: "Keep"|"Cut", tip: string, field: Decision): Child => button(
      word, `${word} ${what}. ${tip}`, () => decide(step, field, [neck], `${word.toLowerCase()} ${what} of ${step.id}`),
      {class: "small", "data-key": `${word.toLowerCase()}-${place}`});
  return el(
      "div", {class: "row", role: "group", "aria-label": what},
      button(
          `${size(neck)} near ${place}`, `Shows the neck. ${neck.kept ? "Both kernels keep the part" : "The kernels differ"}`,
          () => show_place(neck.at_mm, what), {class: "ghost small"}),
      el("span", {class: "spring"}), choice("Keep", "The part beyond the neck stays, and the certificate reports no doubt about it", "keep_bridges_mm"),
      choice("Cut", "The object loses a small cube about the neck", "cut_bridges_mm"));
}

/// Shows the thin necks of a step's object, with buttons to keep the part beyond each or to cut it off. Null
/// if the object has none, or if the step has no fields to decide it.
export function neck_rows(step: Step): Child {
  const found = state.plan?.objects.find((one) => one.id === step.id)?.necks ?? [];
  if (found.length === 0 || !schema_of(step)?.properties?.keep_bridges_mm) return null;
  const necks = [...found].sort((a, b) => (b.volume_mm3 ?? 0) - (a.volume_mm3 ?? 0));
  const more = necks.length - most_rows;
  return el(
      "section", {"aria-label": "Thin necks"}, el("h4", {}, "Thin necks"),
      el("p", {class: "says"},
         "Only one kernel connects the parts beyond these necks: look at each, and keep the part or cut the neck."),
      necks.slice(0, most_rows).map((neck) => row(step, neck)),
      more > 0 ? el("p", {class: "says"}, `${more} more, each of at most ${size(necks[most_rows]!)}.`) : null,
      necks.length > 1 ?
          el("div", {class: "row"},
             button(
                 `Keep all ${necks.length}`, "Keeps the parts beyond all these necks",
                 () => decide(step, "keep_bridges_mm", necks, `parts beyond ${necks.length} thin necks of ${step.id} kept`),
                 {class: "small", "data-key": "keep-all-necks"})) :
          null);
}

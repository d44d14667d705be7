// SPDX-License-Identifier: AGPL-3.0-or-later
// Islands: a click on a part of the selected object keeps that part alone, or removes it. Further clicks add to the
// same step.
import {add_step, add_steps, free_id, replace_step, try_to} from "../actions";
import {button, Child, el} from "../base/html";
import {grouped} from "../base/numbers";
import {Vec3} from "../base/vector";
import {makes_body} from "../operations";
import {Part} from "../panel/cleaning";
import {Json, Step} from "../protocol";
import {notify, selected_step, set, state, step_of, steps} from "../state";
import {place_at} from "./point_tools";
import {Tool} from "./tool";

let keeps = false;

/// A step of this tool that a click can extend: `chosen` is the step with the points of the chosen parts,
/// `source` the object with the parts.
interface Begun {
  chosen: Step;
  source: string;
}
function begun(step: Step): Begun|null {
  const rest = step.do === "combine" ? /^(\w+) - (\w+)$/.exec(String(step.expression)) : null;
  const chosen = rest ? step_of(rest[2]!) : step;
  if (chosen?.do !== "parts" || !Array.isArray(chosen.at_mm) || (rest && chosen.object !== rest[1])) return null;
  return {chosen, source: String(chosen.object)};
}
const is_rest = (step: Step): boolean => step.do === "combine";

// The selected body and, if it was made by this tool, the step that the next click extends. Null if no body
// is selected.
function target(): {step: Step; going_on: Begun|null}|null {
  const step = selected_step();
  if (!step || !makes_body(step)) return null;
  const before = begun(step);
  return {step, going_on: before && is_rest(step) !== keeps ? before : null};
}

async function take_part(near_mm: Vec3): Promise<void> {
  const on = target();
  if (!on) return notify("Select the object first, then click on one of its parts.", "warning");
  const {step, going_on} = on;
  // A part to remove must be one of those that remain. A part to keep may be any part of the original object.
  const object = going_on && keeps ? going_on.source : step.id;
  const part = await try_to<Part>("part", {object, near_mm});
  if (!part?.at_mm || state.selected !== step.id) return;
  const size = `${grouped(part.mm3, part.mm3 < 100 ? 1 : 0)} mm³`;
  if (part.parts === 1) return notify(`${object.replace(/_/g, " ")} is one part of ${size}.`, "warning");
  const at_mm = [...part.at_mm];
  const what = keeps ? `a part of ${object} kept` : `a part of ${object} removed`;
  const is_done = going_on ? await add_point(going_on.chosen, at_mm, step.id, what) :
      keeps ? await add_step({id: free_id(`${step.id}_kept`), do: "parts", object: step.id, at_mm: [at_mm]}, what) :
              await remove_part(step, at_mm, what);
  if (is_done) notify(`${keeps ? "Kept" : "Removed"} a part of ${size}, one of ${grouped(part.parts)}.`);
}

async function add_point(chosen: Step, at_mm: number[], select: string, what: string): Promise<boolean> {
  const is_done = await replace_step(chosen.id, {...chosen, at_mm: [...chosen.at_mm as Json[], at_mm]}, what);
  if (is_done) set({selected: select});
  return is_done;
}
function remove_part(step: Step, at_mm: number[], what: string): Promise<boolean> {
  const island = free_id(`${step.id}_islands`);
  return add_steps(
      [
        {id: island, do: "parts", object: step.id, at_mm: [at_mm]},
        {id: free_id(`${step.id}_rest`), do: "combine", expression: `${step.id} - ${island}`},
      ],
      what);
}

export const island_tool: Tool = {
  name: "islands",
  title: "Islands",
  says: "Click on a part of the selected object, in a view or slice: it is removed, or kept alone.",
  key: "",
  cursor: "crosshair",
  is_pointed: true,
  taken() {
    if (target()) return;
    const last = steps().filter(makes_body).pop();
    if (last) set({selected: last.id});
  },
  down({pane, at}) {
    const point = place_at(pane, at);
    if (point) void take_part(point);
    return true;
  },
  left() {
    keeps = false;
  },
  panel(): Child {
    const on = target();
    const mode = (label: string, tip: string, value: boolean): Child => button(
        label, `${label}. ${tip}`,
        () => {
          keeps = value;
          set({tool: state.tool});
        },
        {class: keeps === value ? "on" : "", "aria-pressed": String(keeps === value), "data-key": `islands-${label}`});
    return [
      el("div", {class: "presets", role: "group", "aria-label": "What a click does"},
         mode("Remove", "A click removes the part", false), mode("Keep", "A click keeps the part alone", true)),
      el("p", {class: "says"},
         !on            ? "Select an object with several parts." :
             on.going_on ? `The next click${keeps ? ", in a slice, keeps" : " removes"} a further part of ${on.going_on.source.replace(/_/g, " ")}.` :
                          `The next click ${keeps ? "keeps" : "removes"} a part of ${on.step.id.replace(/_/g, " ")}.`),
    ];
  },
};

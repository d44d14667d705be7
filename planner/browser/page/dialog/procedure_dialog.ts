// SPDX-License-Identifier: AGPL-3.0-or-later
// Procedures: the user chooses one by name and its additional scans, places its landmarks, and enters a few
// values.
import {change_plan, edit, evaluate, try_to} from "../actions";
import {Dialog, open_dialog} from "../base/dialog";
import {objects_of_plan} from "../drawn_objects";
import {open_picker} from "./files";
import {button, Child, el} from "../base/html";
import {label_of} from "../panel/schema_form";
import {ask_for_landmarks} from "../tool/point_tools";
import {PlanState, ProcedureSays, ProcedureValue} from "../protocol";
import {on_leaving_plan, set, state} from "../state";
import {Vec3} from "../base/vector";

// Values and ticks that a person has changed in a form since its procedure was planned. Keys are such as
// "fibula_flap.start_mm". All other values come from the plan's steps.
const typed = new Map<string, number>();
const ticks = new Map<string, boolean>();
// The changed values and ticks of the last planning. The form shows them again if the person undoes it.
const planned = {typed: new Map<string, number>(), ticks: new Map<string, boolean>()};
let pending_procedure: string|null = null;
on_leaving_plan(() => {
  pending_procedure = null;
  // Values such as a threshold or an advancement belong to one patient, so none is kept for the next plan.
  for (const kept of [typed, ticks, planned.typed, planned.ticks]) kept.clear();
});

/// How the plan already contains a procedure: the values and options of its steps, and the result of an
/// earlier procedure from which it starts.
interface Planned {
  outcome: string|null;
  is_planned: boolean;  // the plan has the procedure's steps
  with: string[];
  values: {[name: string]: {value: number; is_agreed: boolean}};
}

/// Moves the entries of one procedure to another map.
function take_over<T>(from: Map<string, T>, to: Map<string, T>, procedure: string): void {
  for (const [name, chosen] of [...from]) {
    if (!name.startsWith(`${procedure}.`)) continue;
    to.set(name, chosen);
    from.delete(name);
  }
}

/// Opens the form of a procedure: its landmarks, its values, and a button that adds its steps to the plan.
export function open_procedure(name?: string): void {
  const dialog = open_dialog("Procedure from landmarks", "procedure");
  const show = async(chosen: ProcedureSays|undefined): Promise<void> => {
    const said = chosen ? await try_to<Planned>("acts_on", {name: chosen.name}) : null;
    dialog.refill(
      el("div", {class: "presets"},
         (state.hello?.procedures ??
          []).map((one) => button(one.says.split(":")[0], one.says, () => void show(one), {
                    class: one === chosen ? "on" : ""
                  }))),
      chosen ?
          procedure_form(dialog, chosen, said ?? {outcome: null, is_planned: false, with: [], values: {}}) :
          el("p", {class: "says"},
             "Each procedure is placed by named landmarks and a few values. It writes ordinary steps that you can change."));
  };
  void show(state.hello?.procedures.find((one) => one.name === name));
}

function procedure_form(dialog: Dialog, chosen: ProcedureSays, said: Planned): Child {
  const placed = new Map((state.plan?.landmarks ?? []).map((mark) => [mark.name, mark.point]));
  const is_chosen = (option: string): boolean => ticks.get(`${chosen.name}.${option}`) ??
      (said.is_planned ? said.with.includes(option) : planned.ticks.get(`${chosen.name}.${option}`) ?? false);
  const value_of = (one: ProcedureValue): number => typed.get(`${chosen.name}.${one.name}`) ??
      said.values[one.name]?.value ?? planned.typed.get(`${chosen.name}.${one.name}`) ?? one.default;
  const in_doubt = Object.entries(said.values).flatMap(([name, {is_agreed}]) => (is_agreed ? [] : [label_of(name)]));
  const value_fields = (list: ProcedureValue[]): HTMLElement =>
      el("div", {class: "grid-2"},
         list.map(
             (one) => el(
                 "label", {class: "field", "data-tip": `${one.says}. From ${one.low} to ${one.high}.`},
                 el("span", {}, label_of(one.name)), el("input", {
                   type: "number",
                   step: "any",
                   min: one.low,
                   max: one.high,
                   name: one.name,
                   value: value_of(one),
                   onchange: (event: Event) => {
                     typed.set(`${chosen.name}.${one.name}`, Number((event.target as HTMLInputElement).value));
                   }
                 }),
                 el("i", {}, one.unit))));
  const option_fields = (option: ProcedureSays["options"][number]): Child => {
    const fields = value_fields(option.values);
    fields.hidden = !is_chosen(option.name);
    return [
      el("label", {class: "check"}, el("input", {
           type: "checkbox",
           name: option.name,
           checked: is_chosen(option.name),
           onchange: (event: Event) => {
             const {checked} = event.target as HTMLInputElement;
             fields.hidden = !checked;
             ticks.set(`${chosen.name}.${option.name}`, checked);
           }
         }),
         `With ${option.says}`),
      fields
    ];
  };
  const lacks_scan = chosen.scans.some((scan) => !scans()[scan.name]);
  const missing = chosen.landmarks.filter((mark) => !placed.has(mark.name));
  const place = (): void => {
    pending_procedure = chosen.name;
    dialog.close();
    ask_for_landmarks(chosen.landmarks);
  };
  const perform = async(): Promise<void> => {
    const landmarks: {[mark: string]: Vec3} = {};
    for (const mark of chosen.landmarks) landmarks[mark.name] = placed.get(mark.name)!;
    const options = chosen.options.filter((one) => is_chosen(one.name));
    const set_values =
        Object.fromEntries([chosen, ...options].flatMap((part) => part.values).map((one) => [one.name, value_of(one)]));
    const shown = objects_of_plan().flatMap((object) => (object.id ? [object.id] : []));
    dialog.close();
    const made_plan: (PlanState&{made?: string[]})|null =
        await change_plan(
            "procedure",
            {name: chosen.name, landmarks, values: set_values, with: options.map((one) => one.name)});
    if (!made_plan) return;
    take_over(typed, planned.typed, chosen.name);
    take_over(ticks, planned.ticks, chosen.name);
    // The new pieces are shown in place of the objects shown before. These return when the procedure is
    // undone.
    const made = made_plan.made ?? [];
    const behind = made[made.length - 1];
    const hidden = shown.filter((id) => behind && !made.includes(id)).map((id) => {
      const {visible: _visible, ...look} = state.looks[id] ?? {};
      return [id, {...look, behind}] as const;
    });
    set({looks: {...state.looks, ...Object.fromEntries(hidden)}});
    void evaluate();
  };
  return [
    el("p", {class: "says"}, chosen.says),
    said.outcome ? el("p", {class: "says"},
                `It acts on ${said.outcome}, the result of the procedure before. Place its landmarks where the scan shows them, for example in slices: landmarks on a moved piece move with it.`) :
             null,
    said.is_planned ? el("p", {class: "says", "data-key": "is-planned"},
                "The plan has this procedure. The form shows the values of its steps; “Plan it” replaces these steps, even if they were changed by hand.") :
             null,
    in_doubt.length ? el("p", {class: "sentence warn", role: "alert", "data-key": "in-doubt"},
                `Check ${in_doubt.join(", ")}: steps or landmarks were changed since they were planned, and do not state one value.`) :
             null,
    el("ul", {class: "marks"},
       chosen.landmarks.map(
           (mark) =>
               el("li", {class: placed.has(mark.name) ? "placed" : ""},
                  el("b", {}, mark.name.replace(/_/g, " ")), ` ${mark.says}`))),
    chosen.scans.map((scan) => scan_row(scan, chosen.name, dialog)),
    lacks_scan ?
        null :
        missing.length ?
        el("div", {class: "row"},
           button(
               `Place ${missing.length} landmarks`, "Click them one after the other in the panes", place,
               {class: "primary"})) :
        [
          value_fields(chosen.values),
          chosen.options.map(option_fields),
          el("div", {class: "row end"},
             button(
                 "Plan it", "Adds the procedure's steps to the plan", () => void perform(),
                 {class: "primary"})),
        ],
  ];
}
const scans = (): {[name: string]: {path: string}} => state.plan?.plan.scans ?? {};

/// A row for a scan that a procedure needs besides the patient's, such as a donor's: its file, or a button to
/// choose one.
function scan_row(scan: {name: string; says: string}, procedure: string, dialog: Dialog): Child {
  const path = scans()[scan.name]?.path;
  const take = async(chosen: string): Promise<void> => {
    await edit(
        {scans: {...scans(), [scan.name]: {path: chosen}}}, `${scan.name}: ${chosen.replace(/^.*\//, "")}`);
    open_procedure(procedure);
  };
  return el(
      "div", {class: "row"}, el("b", {}, scan.name), el("span", {class: "path"}, path ?? scan.says),
      el("span", {class: "spring"}),
      button(path ? "Another scan" : `Choose the ${scan.name}'s scan`, "A scan of the opened folders", () => {
        dialog.close();
        open_picker(`The ${scan.name}'s scan`, (chosen) => void take(chosen));
      }, {class: path ? "" : "primary"}));
}

addEventListener("landmarks-placed", () => {
  if (pending_procedure) open_procedure(pending_procedure);
  pending_procedure = null;
});

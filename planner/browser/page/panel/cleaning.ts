// SPDX-License-Identifier: AGPL-3.0-or-later
// Proposals to clean a window's object, each with its numbers, a picture before and after, and a button that
// makes it a step of the plan. No proposal is applied by itself.
import {add_step, ask, edit, free_id} from "../actions";
import {button, Child, el} from "../base/html";
import {grouped} from "../base/numbers";
import {Vec3} from "../base/vector";
import {schema_of} from "../operations";
import {Json, Step} from "../protocol";
import {Cleaning, Proposal, set, state, step_of, steps, watch} from "../state";
import {Refusal} from "../wire";

/// An answer to the request "part": the number of an object's parts, the object's volume, and volume and
/// place of the largest part or of the one at a point.
export interface Part {
  parts: number;
  whole_mm3: number;
  mm3: number;
  at_mm: Vec3|null;
}
interface Tried {
  objects: {id: string; mm3: number}[];
  scans: {id: string; details: {[name: string]: number}; findings: string[]}[];
}

// The steps that make a scan, from the last one back to the first, which works on a scan from a file. Empty
// for a scan from a file.
function makers_of(scan: Json|undefined): Step[] {
  const maker = steps().find((step) => step.id === scan && typeof step.scan === "string");
  return maker ? [maker, ...makers_of(maker.scan)] : [];
}
// Everything on which a step's proposals depend, as a text to compare.
const basis = (step: Step): string =>
    JSON.stringify([state.plan?.path, step, makers_of(step.scan), state.plan?.plan.scans]);
const is_cleaned = (step: Step): boolean => step.do === "window";

// The steps that the preview of a proposal shows in place of the window. If the proposal makes a scan, the
// window is applied to that scan.
function trial_of(step: Step, {made}: Proposal): Step[] {
  return made.scan === undefined ? [made] : [made, {...step, id: free_id(`${step.id}_tried`), scan: made.id}];
}

const cm3 = (mm3: number): string => `${grouped(mm3 / 1000, mm3 < 1e5 ? 1 : 0)} cm³`;
const share = (part: number, whole: number): string => `${grouped((100 * part) / whole, 1)} %`;
const changed_by = (mm3: number, whole: number): string => Math.abs(mm3) < 0.5 ?
    "The object keeps its volume" :
    `The object ${mm3 < 0 ? "loses" : "gains"} ${cm3(Math.abs(mm3))} (${share(Math.abs(mm3), whole)})`;

/// Requests proposals to clean a window's object one after the other, and shows each on the object's panel as
/// it arrives.
export async function look_for_cleaning(id: string): Promise<void> {
  const step = step_of(id);
  if (!step || !is_cleaned(step)) return;
  const of = basis(step);
  const dismissed = state.cleaning?.object === id ? state.cleaning.dismissed : [];
  set({cleaning: {object: id, of, is_looking: true, proposals: [], dismissed}});
  const is_wanted = (): boolean => state.cleaning?.of === of;
  const offer = (proposal: Proposal|null): void => {
    if (proposal && is_wanted()) change({proposals: [...state.cleaning!.proposals, proposal]});
  };
  try {
    await ask("evaluate", {objects: [id]});
    const part = await ask<Part>("part", {object: id});
    offer(largest(step, part));
    for (const propose of [headrest, streaks])
      if (is_wanted()) offer(await propose(step, part.whole_mm3));
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    // An object that cannot be evaluated shows the reason in the list of steps.
  }
  if (is_wanted()) change({is_looking: false});
}
const change = (part: Partial<Cleaning>): void => {
  if (state.cleaning) set({cleaning: {...state.cleaning, ...part}});
};

function largest(step: Step, {parts, mm3, whole_mm3}: Part): Proposal|null {
  if (parts < 2) return null;
  const others = parts - 1;
  return {
    name: "largest",
    title: "Keep the largest part",
    says: `Of ${grouped(parts)} parts that do not touch each other, the largest has ${share(mm3, whole_mm3)} of the volume. ` +
        `The other ${others === 1 ? "one has" : `${grouped(others)} have`} ${cm3(whole_mm3 - mm3)}.`,
    doubts: mm3 < 0.9 * whole_mm3 ? ["A lower jaw that does not touch the skull is a separate part: look before you keep only one part."] :
                                    [],
    made: {id: free_id(`${step.id}_largest`), do: "parts", object: step.id, largest: 1},
  };
}

const default_of = (operation: string, field: string): number =>
    Number(schema_of({id: "", do: operation})?.properties?.[field]?.default);
const is_made_by = (step: Step, operation: string): boolean =>
    makers_of(step.scan).some((maker) => maker.do === operation);
const scan_of = (step: Step) => state.plan?.scans.find((scan) => scan.name === step.scan);
const is_in_hu = (step: Step): boolean => scan_of(step)?.unit === "HU";

async function tried(step: Step, whole_mm3: number, operation: string, stem: string):
    Promise<{made: Step; lost: string; details: {[name: string]: number}; findings: string[]; mm3: number}|null> {
  const made: Step = {id: free_id(`${String(step.scan)}_${stem}`), do: operation, scan: step.scan!};
  const trial = trial_of(step, {made} as Proposal);
  try {
    const {objects, scans} = await ask<Tried>("try", {steps: trial});
    const [object, scan] = [objects[0], scans[0]];
    if (!object || !scan) return null;
    const mm3 = object.mm3 - whole_mm3;
    return {made, lost: changed_by(mm3, whole_mm3), details: scan.details, findings: scan.findings, mm3};
  } catch (error) {
    if (error instanceof Refusal && error.code !== "lost") return null;  // not applicable to this scan
    throw error;
  }
}

async function headrest(step: Step, whole_mm3: number): Promise<Proposal|null> {
  if (!is_in_hu(step) || is_made_by(step, "remove_headrest")) return null;
  const found = await tried(step, whole_mm3, "remove_headrest", "without_headrest");
  if (!found || !found.details.samples_removed || found.mm3 === 0) return null;
  const removed_mm3 = (found.details.volume_removed_mm3 ?? 0) + (found.details.foam_removed_mm3 ?? 0);
  return {
    name: "headrest",
    title: "Remove the headrest",
    says: `Boards, couches, foam and holders behind the patient, ${cm3(removed_mm3)}, become air in a copy of the scan. ${
        found.lost}.`,
    doubts: found.findings,
    made: found.made,
  };
}

async function streaks(step: Step, whole_mm3: number): Promise<Proposal|null> {
  const [metal, low, high] = ["metal", "low", "high"].map((field) => default_of("clamp_streaks", field)) as
      [number, number, number];
  if (!is_in_hu(step) || is_made_by(step, "clamp_streaks") || (scan_of(step)?.range?.[1] ?? 0) < metal) return null;
  const found = await tried(step, whole_mm3, "clamp_streaks", "clamped");
  const {metal_samples = 0, metal_slices = 0, raised_samples = 0, lowered_samples = 0} = found?.details ?? {};
  if (!found || raised_samples + lowered_samples === 0) return null;
  return {
    name: "streaks",
    title: "Clamp metal streaks",
    says: `${grouped(metal_samples)} samples in ${grouped(metal_slices)} slices have ${grouped(metal)} HU and more: metal, or very dense enamel. Near them, ${
        grouped(raised_samples)} samples below ${grouped(low)} HU and ${grouped(lowered_samples)} above ${
        grouped(high)} HU are held at these bounds in a copy of the scan. ${found.lost}.`,
    doubts: found.findings,
    made: found.made,
  };
}

const is_shown = (step: Step, proposal: Proposal): boolean => state.preview?.steps !== undefined &&
    state.preview.object === step.id && state.preview.steps[0]?.id === proposal.made.id;
const show = (step: Step, proposal: Proposal|null): void =>
    set({preview: proposal && {object: step.id, steps: trial_of(step, proposal)}});

async function accept(step: Step, {made, title}: Proposal): Promise<void> {
  show(step, null);
  if (made.scan === undefined) {
    await add_step(made, `${title} of ${step.id}`);
    return;
  }
  const all = steps().flatMap((one) => (one.id === step.id ? [made, {...one, scan: made.id}] : [one]));
  if (await edit({steps: all}, `${title}: ${step.id}`, step.id)) void look_for_cleaning(step.id);
}

/// The panel with proposals for a window's object. Null for other steps.
export function cleaning_rows(step: Step): Child {
  if (!is_cleaned(step) || state.draft_window) return null;
  const cleaning = state.cleaning?.of === basis(step) ? state.cleaning : null;
  if (!cleaning)
    return el(
        "div", {class: "row"},
        button(
            "Look for what to clean",
            "Look for what to clean. Proposes to remove other parts, a headrest and metal streaks",
            () => void look_for_cleaning(step.id), {"data-key": "clean"}));
  const open = cleaning.proposals.filter(
      ({name}) => !cleaning.dismissed.includes(name) &&
          !(name === "largest" && steps().some((one) => one.do === "parts" && one.object === step.id)));
  return el(
      "section", {class: "cleaning", "aria-label": `What cleans ${step.id.replace(/_/g, " ")}`},
      el("h4", {}, "Cleaning"),
      el("p", {class: "says", role: "status"},
         cleaning.is_looking     ? "Looking for other parts, a headrest and metal streaks …" :
             open.length         ? "Proposals. Nothing is done before you choose one, and each can be undone." :
             cleaning.dismissed.length ? "No other proposal." :
                                   "Nothing to clean was found."),
      open.map((proposal) => proposal_card(step, proposal)));
}

function proposal_card(step: Step, proposal: Proposal): Child {
  const {name, title} = proposal;
  const is_after = is_shown(step, proposal);
  const side = (label: string, tip: string, on: boolean, shown: Proposal|null): Child => button(
      label, `${label}. ${tip}`, () => show(step, shown),
      {class: on ? "on" : "", "aria-pressed": String(on), "data-key": `${name}-${label}`});
  return el(
      "div", {class: "proposal", role: "group", "aria-label": title}, el("h5", {}, title),
      el("p", {class: "says"}, proposal.says), proposal.doubts.map((doubt) => el("p", {class: "sentence warn"}, `! ${doubt}`)),
      el("div", {class: "row"},
         el("span", {class: "presets", role: "group", "aria-label": `Picture: ${title}`},
            side("Before", "The panes show the object as it is", !is_after, null),
            side("After", "The panes show the object after this step", is_after, proposal)),
         el("span", {class: "spring"}),
         button(
             "Dismiss", `Dismiss: ${title}. Hides the proposal and leaves the plan as it is`,
             () => {
               if (is_after) show(step, null);
               if (state.cleaning) change({dismissed: [...state.cleaning.dismissed, name]});
             },
             {class: "ghost", "data-key": `${name}-dismiss`, "aria-label": `Dismiss: ${title}`})),
      button(
          title, `${title}. Adds a step to the plan, which can be undone`, () => void accept(step, proposal),
          {class: "primary", "data-key": `${name}-do`}));
}

// Removes the preview of a proposal when its panel closes or the plan from which it was computed changes.
watch(["plan", "selected", "right_tab", "tool", "draft_window", "draft_step"], () => {
  const {preview, cleaning} = state;
  if (!preview?.steps || preview.by) return;  // another panel tries steps
  const step = step_of(preview.object);
  const is_on_panel = step && state.selected === step.id && state.right_tab === "inspector" &&
      state.tool === "navigate" && !state.draft_window && !state.draft_step;
  if (!is_on_panel || cleaning?.of !== basis(step)) set({preview: null});
});

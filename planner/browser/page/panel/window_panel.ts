// SPDX-License-Identifier: AGPL-3.0-or-later
// The window tool: tissues and two sliders over the scan's samples, shown live in views and slices before it
// is a step.
import {add_step, replace_step, window_step} from "../actions";
import {look_for_cleaning} from "./cleaning";
import {button, Child, el, slider} from "../base/html";
import {ScanState, Step, Tissue} from "../protocol";
import {bone_low, DraftWindow, first_scan, selected_step, set, shows_one_pane, state, step_of, steps, watch} from "../state";
import {take_tool, Tool} from "../tool/tool";

const usual: Tissue[] = [
  {name: "bone", low: 300},
  {name: "skin", low: -300},
  {name: "soft_tissue", low: -29, high: 150},
  {name: "fat", low: -190, high: -30},
];
const scan_of = (name: string): ScanState|undefined => state.plan?.scans.find((scan) => scan.name === name);
/// Whether a scan is in Hounsfield units, for which alone thresholds of tissues are defined.
const is_in_hu = (name: string): boolean => (scan_of(name)?.unit ?? "HU") === "HU";
/// The lowest and highest value of the sliders. In Hounsfield units the scan's range is limited to that of
/// tissues.
function range(scan: string): [number, number] {
  const [low, high] = scan_of(scan)?.range ?? [-1000, 3000];
  if (!is_in_hu(scan)) return [Math.floor(low), Math.ceil(high)];
  return [Math.max(-1024, Math.floor(low)), Math.min(4000, Math.ceil(high))];
}
const edited = (): Step|undefined => (selected_step()?.do === "window" ? selected_step() : undefined);

// The step that the draft began with, as a text; empty for a new window.
let begun_with = "";
/// Begins a draft with a step's window, or with bone.
function begin(step: Step|undefined): void {
  begun_with = step ? JSON.stringify(step) : "";
  const draft: DraftWindow = step ? {
    scan: String(step.scan),
    low: Number(step.low),
    replaces: step.id,
    ...(step.high === undefined ? {} : {high: Number(step.high)})
  } :
                                    {scan: first_scan(), low: bone_low(first_scan())};
  set({draft_window: draft, selected: step?.id ?? null});
}

// An undo, or another window, may change the step or take it out of the plan. The draft then shows a window that the plan
// no longer has, so it begins again.
watch(["plan"], () => {
  const replaced = state.draft_window?.replaces;
  if (replaced === undefined || is_applying || shows_one_pane) return;
  const step = step_of(replaced);
  if (!step || JSON.stringify(step) !== begun_with) begin(step);
});

export const window_tool: Tool = {
  name: "window",
  title: "Tissue window",
  says: "Choose a tissue or drag the thresholds; views and slices show it at once.",
  key: "w",
  cursor: "default",
  taken() {
    begin(edited() ?? (state.selected === null ? steps().find((one) => one.do === "window") : undefined));
  },
  left() {
    set({draft_window: null});
  },
  panel,
};

// Whether the draft's own change of the plan is on its way.
let is_applying = false;

async function apply(): Promise<void> {
  const draft = state.draft_window;
  if (!draft) return;
  const step = step_of(draft.replaces ?? null);
  const {high: _high, ...kept} = step ?? window_step(draft.low);
  const next: Step = {...kept, low: draft.low, ...(draft.high === undefined ? {} : {high: draft.high})} as
      Step;
  const what = `window from ${draft.low}${draft.high === undefined ? "" : ` to ${draft.high}`}`;
  is_applying = true;
  const is_made = await (step ? replace_step(step.id, next, what) : add_step(next, what));
  is_applying = false;
  begun_with = JSON.stringify(step_of(next.id) ?? "");
  if (is_made) void look_for_cleaning(next.id);
  if (state.draft_window === draft)
    take_tool("navigate");
  else if (state.draft_window)  // the person changed the window before the answer arrived
    set({draft_window: {...state.draft_window, replaces: next.id}});
}

function panel(): Child {
  const draft = state.draft_window;
  if (!draft) return null;
  const [least, most] = range(draft.scan);
  const tissues = state.hello?.tissues.length ? state.hello.tissues : usual;
  const change = (part: Partial<DraftWindow>): void => set({draft_window: {...draft, ...part}});
  const bound = (label: string, value: number, key: string, take: (value: number) => void): Child =>
      slider(label, key, {step: 1, value, "aria-label": label}, {min: least, max: most}, take);
  return [
    !is_in_hu(draft.scan) ?
        el("p", {class: "says"},
           "The samples of this scan are not in Hounsfield units, so the tissues' thresholds do not apply.") :
        el("div", {class: "presets", role: "group", "aria-label": "Tissues"}, tissues.map((tissue) => {
      const on = draft.low === (tissue.low ?? least) && draft.high === (tissue.high ?? undefined);
      return button(
          tissue.name.replace(/_/g, " "),
          `${tissue.name.replace(/_/g, " ")}: ${tissue.low ?? "lowest"} to ${tissue.high ?? "highest"} HU. ${
              tissue.says ?? ""}`,
          () => {
            const {high: _high, ...rest} = draft;
            set({
              draft_window: {
                ...rest,
                low: tissue.low ?? least,
                ...(tissue.high === null || tissue.high === undefined ? {} : {high: tissue.high})
              }
            });
          },
          {class: on ? "on" : "", "aria-pressed": String(on)});
    })),
    bound("From", draft.low, "low", (low) => change({low})),
    bound("To", draft.high ?? most, "high", (high) => change({high: high >= most ? undefined : high})),
    el("div", {class: "row"},
       button(
           draft.replaces ? `Set ${draft.replaces}` : "Make object", "Makes it a step of the plan",
           () => void apply(), {class: "primary", "data-key": "apply-window"}),
       button("Cancel", "Leaves the plan as it is", () => take_tool("navigate"))),
  ];
}

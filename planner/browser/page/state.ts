// SPDX-License-Identifier: AGPL-3.0-or-later
// What this window shows: the server's plan, and how this window looks at it. One value, changed by set(),
// watched by key.
import {Difference, Hello, Job, LandmarkGuess, Notice, PaneRequest, PlanState, Step} from "./protocol";
import {Vec3} from "./base/vector";
import {PlaneName, Turned, View} from "./base/view_frame";

export interface PaneSetting {
  mode: "view"|"slice"|"panoramic";
  view: View;
  plane: PlaneName;
  tilt: Turned;   // angles of the view direction of the oblique plane
  only?: string;  // id of the only object that the pane shows
  shading: string;
  centre_mm: Vec3;
  pixel_mm: number;  // size of a CSS pixel in the patient
}
export interface ObjectLook {
  colour?: string;
  visible?: boolean;
  opacity?: number;
  behind?: string;  // id of a step: the object is hidden while the plan has this step
}
/// An object that is drawn but not in the plan: the object `of` after a motion, or the last object made by
/// steps that are not in the plan.
export type Preview = PaneRequest["preview"]&{};
/// The volume that the server computed for a preview, or its reason to refuse the preview. `refusal` is empty
/// if there was none.
export interface Tried {
  mm3: number;
  voxels: number;
  findings?: string[];  // for example about parts that the volume leaves out
  is_coarse?: boolean;  // computed during a drag, in coarse voxels
  refusal: string;
}
/// Proposals to clean an object. The person can preview each; only a click adds its step to the plan.
export interface Cleaning {
  object: string;
  of: string;  // everything from which the proposals were computed, as a text
  is_looking: boolean;
  proposals: Proposal[];
  dismissed: string[];  // names of proposals
}
export interface Proposal {
  name: string;
  title: string;
  says: string;
  doubts: string[];
  made: Step;  // the step that a click adds
}
/// A window whose thresholds the person is setting. `replaces` is the step that it changes, which is then not
/// drawn; none for a new step.
export interface DraftWindow {
  scan: string;
  low: number;
  high?: number;
  replaces?: string;
}
export interface CutPlane {
  axis: 0|1|2;
  side: 1|- 1;
  offset_mm: number;
}
export interface Compare {
  object: string;
  reference: string;
  range_mm: number;
  mutual?: boolean;  // both objects are coloured, as in a map of contacts
}

export interface State {
  link: "opening"|"open"|"lost";
  lost_because: string;  // why the server ended the connection; empty if it stated no reason
  hello: Hello|null;
  plan: PlanState|null;
  scan: string|null;  // the scan that panes show; null: the patient's
  page: "start"|"audit"|"plan";
  theme: "system"|"light"|"dark";
  hides_patient: boolean;  // whether screens and reports of this window leave out the patient
  panes: PaneSetting[];
  maximised: number|null;
  active_pane: number;
  looks: {[object: string]: ObjectLook};
  selected: string|null;  // a step's id
  cross_mm: Vec3;
  grey: [number, number];  // level and width of slices
  draft_window: DraftWindow|null;
  draft_step: Step|null;  // a step that is being filled in and is not in the plan yet
  preview: Preview|null;
  overlap_mm3: number|null;
  tried: Tried|null;
  difference_to: string|null;    // the object with which a dragged piece is compared in two colours
  difference: Difference|null;  // as stated by the newest picture of the dragged piece
  cleaning: Cleaning|null;
  compare: Compare|null;
  cut_plane: CutPlane|null;
  arch_mm: Vec3[];                           // points of the panoramic sheet, left to right
  hides_names: boolean;                      // of landmarks; their dots stay
  marked: {at_mm: Vec3; says: string}|null;  // the place that a certificate names
  guesses: LandmarkGuess[];                  // proposed landmarks that are not in the plan
  tool: string;
  left_tab: "objects"|"steps"|"history";
  right_tab: "inspector"|"numbers"|"movement";
  jobs: Job[];
  notices: (Notice&{key: number})[];
  tour: number|null;
  evaluations: number;  // how many times evaluated objects have arrived; each may change the pictures
  pointer: string;      // description of the place under the pointer
}

const pane = (mode: PaneSetting["mode"], view: View, plane: PlaneName): PaneSetting => ({
  mode,
  view,
  plane,
  tilt: {azimuth: 45, elevation: 0},
  shading: "partial_volume",
  centre_mm: [0, 0, 0],
  pixel_mm: 0.6,
});

/// The usual panes: anterior, left and superior view, and a view to rotate freely.
export const usual_panes = (): PaneSetting[] =>
    [pane("view", "anterior", "coronal"),
     pane("view", "left", "sagittal"),
     pane("view", "superior", "axial"),
     pane("view", {azimuth: 35, elevation: 15}, "axial"),
];

/// Those parts of the state that belong to a plan, with their values while no plan is shown.
const without_plan = () => ({
  scan: null,
  maximised: null,
  looks: {},
  selected: null,
  draft_window: null,
  draft_step: null,
  preview: null,
  overlap_mm3: null,
  tried: null,
  difference_to: null,
  difference: null,
  cleaning: null,
  compare: null,
  cut_plane: null,
  arch_mm: [],
  hides_names: false,
  marked: null,
  guesses: [],
  pointer: "",
});

const first: State = {
  ...without_plan(),
  link: "opening",
  lost_because: "",
  hello: null,
  plan: null,
  page: "start",
  theme: "system",
  hides_patient: localStorage.getItem("octotomy_hides_patient") === "yes",
  panes: usual_panes(),
  active_pane: 0,
  cross_mm: [0, 0, 0],
  grey: [500, 2000],
  tool: "navigate",
  left_tab: "steps",
  right_tab: "inspector",
  jobs: [],
  notices: [],
  tour: null,
  evaluations: 0,
};

/// Whether this is a second window, which shows one large pane and follows the first window
/// (second_screen.ts).
export const shows_one_pane = new URLSearchParams(location.hash.slice(1)).has("screen");
/// Whether this window may change the plan. The server also refuses changes by other windows.
export const may_edit = (): boolean => !shows_one_pane && state.hello?.may_edit !== false;

type Key = keyof State;
export const state: State = first;
const watchers: {keys: Set<Key>; call: () => void}[] = [];
const changed = new Set<Key>();
let is_queued = false;

/// Changes the state. Afterwards each function that watches a changed key is called once, even after several
/// calls of set() in a row.
export function set(patch: Partial<State>): void {
  for (const key of Object.keys(patch) as Key[]) changed.add(key);
  Object.assign(state, patch);
  if (is_queued) return;
  is_queued = true;
  queueMicrotask(tell);
}

function tell(): void {
  is_queued = false;
  const keys = new Set(changed);
  changed.clear();
  for (const watcher of watchers)
    if ([...watcher.keys].some((key) => keys.has(key))) watcher.call();
  if ([...keys].some((key) => kept.includes(key))) keep();
}

export function watch(keys: Key[], call: () => void): void {
  watchers.push({keys: new Set(keys), call});
}

/// Shows or hides the patient in this window and in new reports, and stores the choice in the browser.
export function hide_patient(hides_patient: boolean): void {
  localStorage.setItem("octotomy_hides_patient", hides_patient ? "yes" : "no");
  set({hides_patient});
}

const plan_leavers: (() => void)[] = [];
/// Registers a function that is called when the window leaves a plan. It must clear the values that its file
/// stores about the plan, so that no patient's value reaches the next plan.
export function on_leaving_plan(call: () => void): void {
  plan_leavers.push(call);
}
/// Resets every part of the state that belongs to the plan, and calls the functions of on_leaving_plan().
export function leave_plan(): void {
  for (const call of plan_leavers) call();
  // Errors that are still shown belong to the old plan.
  set({...without_plan(), notices: state.notices.filter((notice) => notice.level !== "error")});
}
/// Clears tools and drafts that belong to a scan whose file was replaced in the same plan. The looks of
/// objects stay.
export function leave_scan(): void {
  for (const call of plan_leavers) call();
  set({
    draft_window: null,
    draft_step: null,
    preview: null,
    overlap_mm3: null,
    tried: null,
    difference: null,
    cleaning: null,
    cut_plane: null,
    arch_mm: [],
    marked: null,
    guesses: []
  });
}

// Parts of the state that the browser stores for each plan, under the plan's path. The plan itself is stored
// by the server.
const kept: Key[] = [
  "page",
  "panes",
  "looks",
  "selected",
  "cross_mm",
  "grey",
  "left_tab",
  "right_tab",
  "cut_plane",
  "compare",
  "arch_mm",
  "hides_names",
  "maximised",
];

function keep(): void {
  if (!state.plan || state.page === "start" || shows_one_pane) return;
  const view: Partial<Record<Key, unknown>> = {};
  for (const key of kept) view[key] = state[key];
  localStorage.setItem(`octotomy:${state.plan.path}`, JSON.stringify({...view, scans_then: mark_of_scans(state.plan)}));
}

// Names, files and positions of a plan's scans, as a text to compare; empty if the server has not read them
// yet.
const mark_of_scans = (plan: PlanState): string =>
    plan.scans.map(({name, path, dims, bounds_mm}) => JSON.stringify([name, path, dims, bounds_mm])).join();

/// How this browser last showed the plan. Null if it never did, or if the plan at this path now has other
/// scans.
export function kept_view(plan: PlanState): Partial<State>|null {
  const text = localStorage.getItem(`octotomy:${plan.path}`);
  if (!text || shows_one_pane) return null;
  try {
    const {scans_then, ...view} = JSON.parse(text) as Partial<State>&{scans_then?: string};
    const scans_now = mark_of_scans(plan);
    return scans_then && scans_now && scans_then !== scans_now ? null : view;
  } catch {
    return null;
  }
}

export const steps = (): Step[] => state.plan?.plan.steps ?? [];
export const step_of = (id: string|null): Step|undefined => steps().find((step) => step.id === id);
export const selected_step = (): Step|undefined => step_of(state.selected);
export const first_scan = (): string => state.plan?.scans[0]?.name ?? "ct";
export const shown_scan = (): string =>
    state.plan?.scans.find((scan) => scan.name === state.scan)?.name ?? first_scan();
/// The lower bound of bone in a scan's own samples; 300 if the server states none.
export const bone_low = (scan: string): number =>
    state.plan?.scans.find((one) => one.name === scan)?.bone_low ?? 300;
/// Whether the panes show a scan that lies in its own frame of reference, such as a donor's. The plan's
/// objects cannot be drawn in that frame.
export const is_elsewhere = (): boolean =>
    shown_scan() !== first_scan() && shown_scan() in (state.plan?.plan.scans ?? {});

let next_notice = 1;
/// Shows a message. An error stays until the person closes it; other messages vanish after some seconds.
export function notify(message: string, level: Notice["level"] = "info", act?: Notice["act"]): void {
  const key = next_notice++;
  set({
    notices:
        [...state.notices.filter((notice) => notice.message !== message).slice(-2), {message, level, act, key}]
  });
  if (level !== "error") window.setTimeout(() => dismiss(key), level === "info" ? 4000 : 8000);
}
export function dismiss(key: number): void {
  set({notices: state.notices.filter((notice) => notice.key !== key)});
}

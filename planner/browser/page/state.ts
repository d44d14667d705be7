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
  tilt: Turned;   // direction in which the oblique plane is viewed
  only?: string;  // the one object that the pane shows
  shading: string;
  centre_mm: Vec3;
  pixel_mm: number;  // size of a CSS pixel
}
export interface ObjectLook {
  colour?: string;
  visible?: boolean;
  opacity?: number;
  behind?: string;  // id of a step: this object is hidden as long as the plan has that step
}
/// An object drawn in place of another: the object `of` after a motion, or the last object that steps outside
/// the plan make.
export type Preview = PaneRequest["preview"]&{};
/// What the server computed for a preview of steps, or the reason why there is nothing.
export interface Tried {
  mm3: number;
  voxels: number;
  findings?: string[];  // for example on parts that the volume leaves out
  is_coarse?: boolean;  // the picture was made during a drag
  refusal: string;
}
/// Proposals to clean an object, to preview and to apply; none is applied by itself.
export interface Cleaning {
  object: string;
  of: string;  // the data from which the proposals were computed, as a text
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
/// A window that is being set and is not a step yet. If it changes a step, that step is not drawn.
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
  mutual?: boolean;  // both are coloured: a map of their contacts
}

export interface State {
  link: "opening"|"open"|"lost";
  lost_because: string;  // why the server ended the connection; empty if it stated no reason
  hello: Hello|null;
  plan: PlanState|null;
  scan: string|null;  // the scan that panes show; null: the patient's
  page: "start"|"audit"|"plan";
  theme: "system"|"light"|"dark";
  hides_patient: boolean;  // no screen or report of this window names the patient
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
  difference_to: string|null;    // the object whose difference to a dragged piece is drawn in two colours
  difference: Difference|null;  // of the newest picture of the dragged piece
  cleaning: Cleaning|null;
  compare: Compare|null;
  cut_plane: CutPlane|null;
  arch_mm: Vec3[];                           // points of the panoramic sheet, left to right
  hides_names: boolean;                      // of landmarks; their dots stay
  marked: {at_mm: Vec3; says: string}|null;  // the place that a certificate names
  guesses: LandmarkGuess[];                  // landmarks to look at, none of them in the plan
  tool: string;
  left_tab: "objects"|"steps"|"history";
  right_tab: "inspector"|"numbers"|"movement";
  jobs: Job[];
  notices: (Notice&{key: number})[];
  tour: number|null;
  evaluations: number;  // how often the server has sent evaluated objects, after which pictures may change
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

/// The usual layout: anterior, left, superior, and one view to rotate freely.
export const usual_panes = (): PaneSetting[] =>
    [pane("view", "anterior", "coronal"),
     pane("view", "left", "sagittal"),
     pane("view", "superior", "axial"),
     pane("view", {azimuth: 35, elevation: 15}, "axial"),
];

/// The keys that belong to a plan, with their values when no plan is shown.
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

/// Whether this is a second window, which shows one pane large and follows the first (second_screen.ts).
export const shows_one_pane = new URLSearchParams(location.hash.slice(1)).has("screen");
/// Whether this window may change the plan. The server refuses the others whatever their page requests.
export const may_edit = (): boolean => !shows_one_pane && state.hello?.may_edit !== false;

type Key = keyof State;
export const state: State = first;
const watchers: {keys: Set<Key>; call: () => void}[] = [];
const changed = new Set<Key>();
let is_queued = false;

/// Changes the state. Functions that watch one of the keys are called once, before the next picture.
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

/// Shows or hides the patient on every screen and in new reports. The choice is stored in this browser.
export function hide_patient(hides_patient: boolean): void {
  localStorage.setItem("octotomy_hides_patient", hides_patient ? "yes" : "no");
  set({hides_patient});
}

const plan_leavers: (() => void)[] = [];
/// Registers a function to be called when the window leaves a plan, so that no part of the page carries a
/// value of one patient into the next plan.
export function on_leaving_plan(call: () => void): void {
  plan_leavers.push(call);
}
/// Clears everything in this window that belongs to the shown plan, including the current tool.
export function leave_plan(): void {
  for (const call of plan_leavers) call();
  // Errors that are still shown belong to the plan that is left, so they are removed.
  set({...without_plan(), notices: state.notices.filter((notice) => notice.level !== "error")});
}
/// Clears the data of a scan whose file was replaced in the same plan: tools and their drafts. How objects
/// are shown stays.
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

// Keys by which a window shows a plan. The browser stores them by the plan's path; the plan itself is on the
// server.
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

// The files of a plan's scans and their positions, as a text; empty before they are read.
const mark_of_scans = (plan: PlanState): string =>
    plan.scans.map(({name, path, dims, bounds_mm}) => JSON.stringify([name, path, dims, bounds_mm])).join();

/// How this browser last showed the plan; null if it never did, or if the plan at this path now has other
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
/// The threshold of bone in a scan's own samples. A scan without Hounsfield units has no fixed one.
export const bone_low = (scan: string): number =>
    state.plan?.scans.find((one) => one.name === scan)?.bone_low ?? 300;
/// Whether panes show a scan in a frame of its own, such as a donor's. The plan's objects are not in that
/// frame.
export const is_elsewhere = (): boolean =>
    shown_scan() !== first_scan() && shown_scan() in (state.plan?.plan.scans ?? {});

let next_notice = 1;
/// Shows a message to the person; an error stays until it is closed.
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

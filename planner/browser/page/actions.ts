// SPDX-License-Identifier: AGPL-3.0-or-later
// What a person does to the plan: each action is a request to the server, whose answer is the plan's new
// state.
import {objects_of_plan} from "./drawn_objects";
import {makes_measurement, makes_scan} from "./operations";
import {Hello, Measured, Measurement, PlanState, Step} from "./protocol";
import {first_scan, kept_view, leave_plan, leave_scan, may_edit, notify, PaneSetting, set, shows_one_pane, State, state, steps, usual_panes} from "./state";
import {add, scaled, Vec3} from "./base/vector";
import {Refusal, Wire} from "./wire";

let wire: Wire;
export function use_wire(one: Wire): void {
  wire = one;
}
export const ask = <Answer>(word: string, fields: object = {}): Promise<Answer> =>
    wire.ask<Answer>(word, fields);

// A `lost` for try_to() that does not send the request again.
const let_go = async(): Promise<null> => null;

/// Sends a request once the connection is open. Shows a refusal to the person and returns null. If the
/// connection breaks before the answer, returns the result of `lost`; by default that sends the same request
/// once more.
export async function try_to<Answer>(
    word: string, fields: object = {},
    lost: () => Promise<Answer|null> = () =>
        next_greeting().then(() => try_to<Answer>(word, fields, let_go))): Promise<Answer|null> {
  if (!wire.is_open) await next_greeting();
  try {
    return await wire.ask<Answer>(word, fields);
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    if (error.code === "lost") return lost();
    if (error.code === "changed" && state.plan) {
      const {path} = state.plan;
      notify(error.message, "error", {label: "Load the plan's file", run: () => void open_plan({path})});
    } else if (error.code !== "cancelled") {
      notify(error.message, "error");
    }
    return null;
  }
}

let waiting_for_greeting: (() => void)[] = [];
/// Resolves when the connection is open again and the page has the server's state of the plan.
const next_greeting = (): Promise<void> => new Promise((resolve) => waiting_for_greeting.push(resolve));
/// Resolves once the server has sent its first message to this page.
export const first_greeting = (): Promise<void> => state.hello ? Promise.resolve() : next_greeting();

/// Makes `plan` the state that the page shows. If the page showed another plan before, also restores how this
/// browser last showed this one, or fits the panes to its scan. `is_opened`: the person has opened the plan,
/// so the page leaves the start page. Otherwise an open start page stays, because the state may belong to a
/// plan that the person has left or that another window has opened.
export function take_plan(plan: PlanState|null, is_opened = false): void {
  if (!plan) {
    leave_plan();
    return set({plan: null, page: "start"});
  }
  const is_unseen = state.page === "start" && !is_opened && may_edit();
  const is_new = plan.path !== state.plan?.path || (state.page === "start" && !is_unseen);
  if (!is_new && has_other_scan(plan)) leave_scan();
  if (!is_new) {
    const is_edited = plan.edit !== state.plan?.edit;
    set({
      plan: {...plan, measurements: plan.measurements ?? known_measurements(plan)},
      jobs: plan.jobs ?? state.jobs
    });
    // A window that may not edit can show other objects than the window that made this edit, so it requests
    // its own evaluation.
    if (is_edited && !may_edit()) void evaluate();
    return;
  }
  leave_plan();
  if (is_unseen) return set({plan, jobs: plan.jobs ?? []});
  const kept = kept_view(plan);
  const before: Partial<State> = kept ? {...kept, panes: with_usual(kept.panes)} : fitted(plan);
  const needs_audit = !may_edit() ? false : kept ? kept.page === "audit" : plan.plan.steps.length <= 1 && plan.history.length <= 1;
  set({
    ...before,
    plan,
    page: needs_audit ? "audit" : "plan",
    ...(shows_one_pane ? {maximised: 0, active_pane: 0} : {}),
    jobs: plan.jobs ?? []
  });
  void evaluate();
}

// Whether a scan that the shown plan has was replaced by another file or removed. Added scans do not count.
function has_other_scan(plan: PlanState): boolean {
  const before = state.plan?.plan.scans ?? {};
  return Object.entries(before).some(([name, scan]) => plan.plan.scans?.[name]?.path !== scan.path);
}

// Panes with the usual value of every field that they lack, because an earlier version of the page may have
// stored them.
const with_usual = (panes: PaneSetting[]|undefined): PaneSetting[] =>
    usual_panes().map((usual, index) => ({...usual, ...panes?.[index]}));

// The page's measurements of those steps that are the same in `plan`.
function known_measurements(plan: PlanState): Measurement[] {
  const before = new Map(steps().map((step) => [step.id, JSON.stringify(step)]));
  const unchanged = new Set(
      plan.plan.steps.filter((step) => before.get(step.id) === JSON.stringify(step)).map((step) => step.id));
  return (state.plan?.measurements ?? []).filter((found) => unchanged.has(found.id));
}

/// Pane settings that show the whole of a scan, with the cross-hair in its middle.
export function fitted(plan: PlanState, name?: string): Pick<State, "panes"|"cross_mm"|"grey"> {
  const scan = plan.scans.find((one) => one.name === name) ?? plan.scans[0];
  const bounds = scan?.bounds_mm ?? [[-100, -120, -130], [100, 120, 120]];
  const [low, high] = bounds as [Vec3, Vec3];
  const middle = scaled(add(low, high), 0.5);
  const hosts = document.querySelectorAll<HTMLElement>(".pane canvas");
  const extent = Math.max(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  const panes = (state.panes.length ? state.panes : usual_panes()).map((pane, index) => {
    const host = hosts[index];
    const side = host ? Math.min(host.clientWidth, host.clientHeight) : 0;
    return {...pane, centre_mm: middle, pixel_mm: (extent * 1.08) / (side || 360)};
  });
  return {panes, cross_mm: middle, grey: scan?.window_suggestion ?? [500, 2000]};
}

export async function greet(): Promise<void> {
  const hello = await try_to<Hello>("hello", {}, let_go);
  if (!hello) return;
  set({hello, link: "open"});
  // A restarted program has no open plan, so the plan of this window is opened again. Its file and history
  // are on the disk.
  const plan = hello.plan_state ??
      (state.plan && may_edit() ? await try_to<PlanState>("open", {path: state.plan.path}, let_go) : null);
  if (plan) take_plan(plan, !state.plan);
  const waiting = waiting_for_greeting;
  waiting_for_greeting = [];
  for (const go_on of waiting) go_on();
}

export async function open_plan(what: {path?: string; phantom?: string; series?: string}): Promise<void> {
  set({plan: null, page: "start"});
  const key = busy("Opening");
  const plan = await try_to<PlanState>("open", what);
  done(key);
  if (plan) take_plan(plan, true);
}

// Sends a change of the plan. If the connection breaks before the answer, waits for the new connection and
// sends the change once more, unless `is_done` finds it in the plan's state.
async function change(word: string, fields: object, is_done: () => boolean): Promise<PlanState|null> {
  if (!may_edit()) {
    notify("This window only shows the plan.", "warning");
    return null;
  }
  return try_to<PlanState>(word, fields, async () => {
    await next_greeting();
    return is_done() ? state.plan : try_to<PlanState>(word, fields, let_go);
  });
}

/// Makes one change of the plan; `what` describes it in the history.
export async function edit(changed: object, what: string, select?: string|null): Promise<boolean> {
  const before = state.plan?.edit;
  const plan = await change("edit", {...changed, what}, () => {
    const last = state.plan?.history.find((one) => one.id === state.plan?.edit);
    return state.plan?.edit !== before && last?.what === what;
  });
  if (!plan) return false;
  take_plan(plan);
  if (select !== undefined) set({selected: select});
  void evaluate();
  return true;
}
export const add_step = (step: Step, what: string): Promise<boolean> => edit({add: {step}}, what, step.id);
export const replace_step = (id: string, step: Step, what: string): Promise<boolean> =>
    edit({replace: {id, step}}, what, step.id);

/// Adds several steps as one edit.
export const add_steps = (more: Step[], what: string): Promise<boolean> =>
    edit({steps: [...steps(), ...more]}, what, more[more.length - 1]?.id ?? null);

/// Requests a change of the plan and shows the resulting plan. Returns null if the server refused the change.
export async function change_plan(word: string, fields: object = {}): Promise<PlanState|null> {
  const {branch, edit: before} = state.plan ?? {};
  const plan = await change(word, fields, () => state.plan?.edit !== before || state.plan?.branch !== branch);
  if (plan) take_plan(plan);
  return plan;
}

export async function change_history(
    word: "undo"|"redo"|"branch"|"go_to"|"name_version", fields: object = {}): Promise<void> {
  // A field that has the focus keeps its text, which is not the plan's any more. Leaving it enters the text first.
  if (document.activeElement instanceof HTMLInputElement) document.activeElement.blur();
  if (await change_plan(word, fields)) void evaluate();
}

/// Requests an evaluation of the shown objects and of the steps that make measurements or scans; with
/// `certify`, an evaluation of the whole plan in both kernels. The results arrive later, as the event
/// `objects`.
export async function evaluate(certify = false): Promise<void> {
  if (!steps().length) return;
  const objects = objects_of_plan().flatMap((object) => (object.id ? [object.id] : []));
  const others = steps().filter((step) => makes_measurement(step) || makes_scan(step)).map((step) => step.id);
  await try_to("evaluate", certify ? {certify: true} : {objects: [...objects, ...others]});
}

export interface MeasureAnswer extends Measured {
  sentence?: string;
}
export const measure = (kind: string, fields: object): Promise<MeasureAnswer|null> =>
    try_to("measure", {kind, ...fields});

/// Places the landmark `name` at a point, or moves it there; with `snap`, at the nearest bone. Returns the
/// position of the landmark; null if the server refused it.
export async function put_landmark(name: string, point: Vec3, snap: boolean): Promise<Vec3|null> {
  const answer = await try_to<{point: Vec3; snapped: boolean}>("landmark", {name, point, snap});
  if (answer && snap && !answer.snapped)
    notify(`No bone lies near ${name.replace(/_/g, " ")}: it stays where you clicked. Look at its depth in a second view.`, "warning");
  return answer?.point ?? null;
}

/// The stem if no step has that name, else the stem with the first free number from 2 on.
export function free_id(stem: string): string {
  const taken = new Set(steps().map((step) => step.id));
  if (!taken.has(stem)) return stem;
  let number = 2;
  while (taken.has(`${stem}_${number}`)) ++number;
  return `${stem}_${number}`;
}

export function window_step(low: number, high?: number): Step {
  const step: Step = {id: free_id("skull"), do: "window", scan: first_scan(), low};
  return high === undefined ? step : {...step, high};
}

let next_busy = -1;
/// Adds a job without a percentage to the list of running jobs. Returns its number, which done() removes.
export function busy(what: string): number {
  const id = next_busy--;
  set({jobs: [...state.jobs, {id, what, share: 0}]});
  return id;
}
export function done(id: number): void {
  set({jobs: state.jobs.filter((job) => job.id !== id)});
}

/// The address of a file on the server. The path contains this window's token, so that relative links in a
/// report reach the files beside it.
export const file_url = (name: string): string =>
    `/file/${[token(), ...name.split("/")].map(encodeURIComponent).join("/")}`;
export const token = (): string => new URLSearchParams(location.search).get("token") ?? "";

export function download(name: string): void {
  const link = document.createElement("a");
  link.href = file_url(name);
  link.download = name.replace(/^.*\//, "");
  link.click();
}

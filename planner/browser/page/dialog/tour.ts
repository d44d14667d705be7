// SPDX-License-Identifier: AGPL-3.0-or-later
// The guided tour: a Le Fort I on the head phantom in seven steps. The page recognises when the person has
// done a step.
import {add_step, free_id, open_plan, replace_step} from "../actions";
import {certify_all, dialogs} from "../commands";
import {button, Child, el, fill} from "../base/html";
import {commit_motion} from "../tool/piece_motion";
import {Step} from "../protocol";
import {cut_selected} from "../tool/region_tool";
import {set, state, steps, watch} from "../state";
import {take_tool} from "../tool/tool";

interface Stop {
  title: string;
  says: string;
  is_done(): boolean;
  show?(): void;  // chooses the tool
  do_it(): void;  // performs the stop's action for the person
}

const has = (test: (step: Step) => boolean): boolean => steps().some(test);
const mask = (): Step|undefined => steps().find((step) => step.do === "mask");
const views_of = (step: Step|undefined): number => (Array.isArray(step?.regions) ? step!.regions.length : 0);
const move = (): Step|undefined => steps().find((step) => step.do === "move");
const forward = (): number => Number((move()?.by as {forward_mm?: number} | undefined)?.forward_mm ?? 0);
let audit_seen = false;
let report_written = false;

const stops: Stop[] = [
  {
    title: "Read the audit",
    says: "First the planner reports what it found in the scan. Read it and continue.",
    is_done: () => audit_seen || (state.page === "plan" && state.plan !== null),
    do_it: () => {
      audit_seen = true;
      set({page: "plan"});
    }
  },
  {
    title: "Set bone",
    says: "Choose “bone” among the tissues and set it. The views show it at once.",
    is_done: () => has((step) => step.do === "window") && state.tool !== "window" && state.plan !== null &&
        state.plan.plan.steps.length > 0 && window_seen,
    show: () => take_tool("window"),
    do_it: () => {
      window_seen = true;
      if (!has((step) => step.do === "window"))
        void add_step({id: "skull", do: "window", scan: "ct", low: 300}, "bone");
      take_tool("navigate");
    }
  },
  {
    title: "Draw the cut",
    says:
        "In the anterior view click four corners around the upper jaw, from the roots down past the teeth. Enter closes the region.",
    is_done: () => views_of(mask()) >= 1,
    show: () => {
      set({selected: null});
      take_tool("region");
    },
    do_it:
        () =>
            void add_step(
                {
                  id: free_id("cut"),
                  do: "mask",
                  regions: [{view: "anterior", polygons_mm: [[[-40, -60], [40, -60], [40, -25], [-40, -25]]]}]
                },
                "region in anterior")
  },
  {
    title: "Refine it from the left",
    says: "Draw the same jaw in the left view: the mask contains the points inside both regions.",
    is_done: () => views_of(mask()) >= 2,
    show: () => {
      set({selected: mask()?.id ?? null});
      take_tool("region");
    },
    do_it: () => {
      const step = mask();
      if (step)
        void replace_step(
            step.id, {
              ...step,
              regions: [
                ...(step.regions as never[]),
                {view: "left", polygons_mm: [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]]}
              ]
            } as Step,
            "region in left");
    }
  },
  {
    title: "Cut",
    says: "Cut (X) makes two objects: the piece inside the mask and the rest.",
    is_done: () => has((step) => step.do === "combine" && String(step.expression).includes("&")),
    show: () => set({selected: mask()?.id ?? null, right_tab: "inspector"}),
    do_it: cut_selected
  },
  {
    title: "Advance the maxilla by 6 mm",
    says:
        "With the Move tool (G) drag the piece forward, or type 6 for Forward. The overlap with the skull shows in red.",
    is_done: () => Math.abs(forward() - 6) < 0.6,
    show: () => {
      const piece = steps().find((step) => step.do === "combine" && String(step.expression).includes("&"));
      set({selected: move()?.id ?? piece?.id ?? null});
      take_tool("move");
    },
    do_it: () => {
      const piece = steps().find((step) => step.do === "combine" && String(step.expression).includes("&"));
      set({selected: move()?.id ?? piece?.id ?? null});
      void commit_motion({by: {forward_mm: 6}});
    }
  },
  {
    title: "Certify and report",
    says: "Certify compares both kernels. A green badge means that they agree. Then write the report.",
    is_done: () => (state.plan?.objects ?? []).some((object) => object.certificate),
    show: () => set({right_tab: "numbers"}),
    do_it: () => void certify_all()
  },
];
let window_seen = false;

/// Opens a new phantom and begins the tour on it.
export async function start_tour(): Promise<void> {
  audit_seen = window_seen = report_written = false;
  await open_plan({phantom: "head"});
  if (state.plan) set({tour: 0, page: state.plan.plan.steps.length > 1 ? "plan" : "audit"});
}

export function make_tour(host: HTMLElement): void {
  let shown = -1;
  const again = (): void => {
    const at = state.tour;
    host.hidden = at === null;
    if (at === null) {
      shown = -1;
      return;
    }
    if (state.tool === "window") window_seen = true;
    const stop = stops[at]!;
    if (at < stops.length - 1 && stop.is_done()) {
      if (at === 0) audit_seen = true;
      return set({tour: at + 1});
    }
    if (shown !== at) {
      shown = at;
      stop.show?.();
    }
    fill(host, card(at, stop));
  };
  watch(["tour", "plan", "page", "tool", "preview"], again);
}

function card(at: number, stop: Stop): Child {
  const is_last = at === stops.length - 1;
  const is_done = stop.is_done();
  return el(
      "div", {class: "tour-card", role: "dialog", "aria-label": "Guided tour"},
      el("div", {class: "tour-dots"}, stops.map((_one, index) => el("i", {
                                                  class: index < at ? "past" :
                                                      index === at  ? "now" :
                                                                      ""
                                                })),
         el("small", {}, `${at + 1} of ${stops.length}`)),
      el("h3", {}, stop.title), el("p", {}, stop.says),
      el("div", {class: "row"},
         is_last && is_done ?
             button(
                 report_written ? "End the tour" : "Write the report",
                 "Writes the report with every certificate",
                 () => {
                   if (report_written) return set({tour: null});
                   report_written = true;
                   dialogs.report();
                   set({tour: at});
                 },
                 {class: "primary"}) :
             button("Do it for me", "Does this step of the tour", stop.do_it, {class: "primary"}),
         el("span", {class: "spring"}),
         button("End", "Ends the tour; the plan stays", () => set({tour: null}), {class: "ghost"})));
}

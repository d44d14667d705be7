// SPDX-License-Identifier: AGPL-3.0-or-later
// The page of `octotomy serve`: makes its parts, opens the connection, and stores the server's messages in
// the state.
import {evaluate, greet, take_plan, use_wire} from "./actions";
import {command_of, dialogs} from "./commands";
import {objects_of_plan} from "./drawn_objects";
import {open_picker, take_drops} from "./dialog/files";
import {follow_access, make_bar, make_lost, make_notices, make_rail, make_status} from "./frame";
import {el} from "./base/html";
import {make_inspector} from "./panel/inspector";
import {marks_tool} from "./tool/marks_tool";
import {move_tool} from "./tool/move_tool";
import {open_cephalometry} from "./dialog/cephalometry_dialog";
import {open_merge} from "./dialog/merge_dialog";
import {open_outcome} from "./dialog/outcome_dialog";
import {open_signatures} from "./dialog/sign_dialog";
import {grow_tool} from "./tool/grow_tool";
import {brush_tool} from "./tool/brush_tool";
import {contour_tool} from "./tool/contour_tool";
import {island_tool} from "./tool/island_tool";
import {open_help, open_palette} from "./dialog/palette";
import {make_panes, reconnected, take_picture} from "./pane/pane_grid";
import {use_picture_asker} from "./pane/panes";
import {open_audit, open_export, open_link, take_screenshot, write_report} from "./dialog/plan_dialogs";
import {angle_tool, arch_tool, distance_tool, landmark_tool, segment_tool, surface_tool} from "./tool/point_tools";
import {open_procedure} from "./dialog/procedure_dialog";
import {Job, Json, Measurement, Notice, ObjectState, PlanState, ScanState} from "./protocol";
import {region_tool} from "./tool/region_tool";
import {make_start} from "./dialog/start_page";
import {notify, set, state, watch} from "./state";
import {close_menu, make_lists} from "./panel/step_lists";
import {follow_theme} from "./base/theme";
import {begin_screen} from "./second_screen";
import {register_tools, take_tool, Tool} from "./tool/tool";
import {attach_tips} from "./base/tool_tip";
import {make_tour, start_tour} from "./dialog/tour";
import {window_tool} from "./panel/window_panel";
import {Wire} from "./wire";

const navigate: Tool = {
  name: "navigate",
  title: "Look",
  says: "Drag turns a view, the wheel zooms, a click selects.",
  key: "v",
  cursor: "default",
  is_for_any_scan: true
};

function take_event(word: string, message: {[key: string]: Json}): void {
  if (word === "plan")
    take_plan((message.plan_state ?? message.plan ?? message) as unknown as PlanState);
  else if (word === "objects")
    take_objects(message as unknown as {
      objects: ObjectState[];
      measurements?: Measurement[];
      scans?: ScanState[]
    });
  else if (word === "progress")
    take_progress(message);
  else if (word === "job_done")
    set({jobs: state.jobs.filter((job) => job.id !== message.job)});
  else if (word === "notice")
    notify(String(message.message), (message.level as Notice["level"]) ?? "info");
}

function take_objects(found: {objects: ObjectState[]; measurements?: Measurement[]; scans?: ScanState[]}):
    void {
  const plan = state.plan;
  if (!plan) return;
  const news = new Map(found.objects.map((object) => [object.id, object]));
  const known = plan.objects.map((object) => ({...object, ...news.get(object.id)}));
  const more = found.objects.filter((object) => !plan.objects.some((one) => one.id === object.id));
  set({
    plan: {
      ...plan,
      objects: [...known, ...more],
      measurements: found.measurements ?? plan.measurements,
      scans: found.scans ?? plan.scans
    },
    evaluations: state.evaluations + 1
  });
}

function take_progress(message: {[key: string]: Json}): void {
  const job: Job = {
    id: Number(message.job),
    what: String(message.what ?? "Working"),
    share: Number(message.share ?? 0),
    left_s: message.left_s as number | null
  };
  set({jobs: [...state.jobs.filter((one) => one.id !== job.id), job]});
}

function make_page(): void {
  const part =
      (name: string, tag: "header"|"nav"|"aside"|"main"|"section"|"footer"|"div", label?: string): HTMLElement => {
        const element = el(tag, {class: name, ...(label ? {"aria-label": label} : {})});
        document.body.append(element);
        return element;
      };
  make_bar(part("bar", "header", "Plan"));
  make_lists(part("lists", "aside", "Objects, steps and history"));
  make_rail(part("rail", "nav", "Tools"));
  make_panes(part("panes", "main", "Panes"), (pane, frame) => wire.say("shown", {pane, frame}));
  make_inspector(part("inspector", "aside", "Inspector"));
  make_status(part("status", "footer", "Status"));
  make_start(part("start-host", "div"));
  make_tour(part("tour", "section", "Guided tour"));
  make_notices(part("notices", "section", "Notices"));
  make_lost(part("lost", "section", "Connection"));
  attach_tips();
  take_drops();
}

function follow_keys(): void {
  addEventListener("keydown", (event) => {
    const is_palette = (event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "k";
    // Without this, the browser would use the key for its address bar.
    if (is_palette) event.preventDefault();
    if (document.querySelector("dialog[open]")) return;
    if (is_palette) return open_palette();
    if (event.defaultPrevented) return;
    if (event.key === "Escape" && state.tool !== "navigate") return take_tool("navigate");
    const command = command_of(event);
    if (!command) return;
    event.preventDefault();
    command.run();
  });
  addEventListener("pointerdown", (event) => {
    if (!(event.target as Element).closest(".menu-host")) close_menu();
  });
}

const socket_url =
    `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket${location.search}`;
const wire = new Wire(socket_url, {
  opened: () => {
    set({link: "open"});
    void greet().then(() => {
      reconnected();
    });
  },
  lost: (lost_because) => set({link: "lost", lost_because, jobs: []}),
  event: take_event,
  picture: take_picture,
});
use_wire(wire);
use_picture_asker((fields, on_id) => wire.ask("pane", fields, on_id));
register_tools([
  navigate, window_tool, region_tool, move_tool, marks_tool, landmark_tool, distance_tool, angle_tool,
  surface_tool, segment_tool, grow_tool, island_tool, brush_tool, contour_tool, arch_tool
]);
Object.assign(dialogs, {
  palette: open_palette,
  help: open_help,
  open: () => open_picker(),
  audit: open_audit,
  procedure: open_procedure,
  export: open_export,
  report: () => void write_report(),
  outcome: open_outcome,
  screenshot: take_screenshot,
  link: open_link,
  merge: open_merge,
  sign: () => void open_signatures(),
  cephalometry: () => void open_cephalometry(),
  tour: () => void start_tour(),
});
follow_theme();
begin_screen();
make_page();
follow_access();
follow_keys();
let shown_ids = "";
watch(["looks"], () => {
  const ids = objects_of_plan().map((object) => object.id).join();
  if (ids !== shown_ids) void evaluate();
  shown_ids = ids;
});
wire.open();

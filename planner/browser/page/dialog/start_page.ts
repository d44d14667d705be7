// SPDX-License-Identifier: AGPL-3.0-or-later
// The start page, and the page with a scan's audit, which is shown before the plan.
import {open_plan, try_to} from "../actions";
import {audit_rows} from "../panel/audit";
import {doubtful_places} from "../panel/doubtful_places";
import {grouped, unit_text} from "../base/numbers";
import {dialogs} from "../commands";
import {patient_button, patient_facts} from "../panel/patient";
import {file_chooser, most_upload_words} from "./files";
import {button, Child, el, fill} from "../base/html";
import {icon, IconName} from "../base/icons";
import {ScanState} from "../protocol";
import {may_edit, set, state, watch} from "../state";
import {take_tool} from "../tool/tool";
import {start_tour} from "./tour";

export function make_start(host: HTMLElement): void {
  const again = (): void => {
    document.body.dataset.page = state.page;
    host.hidden = state.page === "plan";
    if (state.page === "start") fill(host, start());
    if (state.page === "audit") fill(host, audit_page());
  };
  watch(["page", "hello", "plan", "jobs", "hides_patient"], again);
  let looked_at = "";
  watch(["page", "hello"], () => {
    // The list of plans is requested once for each visit and connection. Refilling the page with the answer
    // must not request it again.
    const now = `${state.page} ${state.hello !== null}`;
    if (now !== looked_at) void look_for_recent();
    looked_at = now;
  });
  again();
}

function start(): Child {
  if (!may_edit())
    return el(
        "main", {class: "start"},
        el("header", {}, el("h1", {}, el("span", {class: "logo"}), "Octotomy"),
           el("p", {role: "status"}, "No plan is open. This page will show the next plan that is opened.")));
  const is_opening = state.jobs.some((job) => job.what === "Opening");
  return el(
      "main", {class: "start"},
      el("header", {}, el("h1", {}, el("span", {class: "logo"}), "Octotomy"),
         el("p", {}, "Plans an operation on a skull in two geometry kernels that check each other.")),
      el("div", {class: "offers"},
         offer(
             "play", "Guided tour", "A Le Fort I on the head phantom, in seven steps and five minutes.",
             () => void start_tour(), "primary"),
         offer(
             "head", "Head phantom", "A CT of a head made of geometric solids, so every number is known.",
             () => void open_plan({phantom: "head"})),
         offer(
             "folder", "Scan or plan",
             "A DICOM folder, .nii.gz, .nrrd, .mha, or a .plan.json of the opened folders.",
             () => dialogs.open())),
      el("section", {class: "drop", "aria-label": "Files of this computer"}, icon("file", 20),
         el("span", {},
            `Drop a DICOM folder, a scan or a plan here: up to ${
                most_upload_words()}, kept in the folder “uploads”.`),
         el("div", {class: "row"},
            file_chooser(
                "Choose files", "Choose files. One file of a scan or a plan, or all images of a series", false),
            file_chooser(
                "Choose a folder", "Choose a folder. A DICOM series, with all folders below it", true))),
      recent_plans(),
      is_opening ? el("p", {class: "opening", role: "status"}, el("span", {class: "spinner"}),
                      "Reading and checking the scan …") :
                   null,
      el("footer", {},
         `Octotomy ${state.hello?.version ?? ""} · Nothing leaves this machine · Not a medical device`));
}

interface RecentPlan {
  path: string;
  name: string;
  changed_at_ms: number;
}
let recent: RecentPlan[]|null = null;

/// Buttons for the most recently changed plans of the opened folders.
function recent_plans(): Child {
  if (!recent?.length) return null;
  return el(
      "section", {class: "recent", "aria-label": "Recent plans"}, el("h2", {}, "Recent plans"),
      recent.map(
          (plan) => el(
              "button",
              {type: "button", class: "file", title: plan.path, onclick: () => void open_plan({path: plan.path})},
              icon("report", 16), el("span", {}, plan.name),
              el("small", {}, new Date(plan.changed_at_ms).toLocaleString()))));
}

/// Requests the list of plans in the opened folders. Refills the page if the list has changed.
async function look_for_recent(): Promise<void> {
  if (state.page !== "start" || !state.hello || !may_edit()) return;
  const answer = await try_to<{plans: RecentPlan[]}>("recent");
  const before = JSON.stringify(recent);
  recent = answer?.plans ?? [];
  if (JSON.stringify(recent) !== before) set({page: state.page});
}

function offer(name: IconName, title: string, says: string, run: () => void, more = ""): Child {
  return el(
      "button", {type: "button", class: `offer ${more}`, onclick: run}, icon(name, 28), el("b", {}, title),
      el("span", {}, says));
}

export function scan_facts(scan: ScanState): Child {
  const fact = (name: string, value: string): Child => [el("dt", {}, name), el("dd", {}, value)];
  return el(
      "dl", {class: "facts"}, patient_facts(scan), scan.dims ? fact("Samples", scan.dims.join(" × ")) : null,
      scan.spacing_mm ? fact("Spacing", `${scan.spacing_mm.map((x) => x.toFixed(2)).join(" × ")} mm`) : null,
      fact(
          "Extent",
          `${scan.bounds_mm[1].map((high, i) => (high - scan.bounds_mm[0][i]!).toFixed(0)).join(" × ")} mm`),
      scan.range ?
          fact("Range", `${grouped(scan.range[0])} to ${grouped(scan.range[1])} ${unit_text(scan.unit ?? "")}`) :
          null,
      fact("File", scan.path));
}

function audit_page(): Child {
  const scan = state.plan?.scans[0];
  if (!scan) return null;
  const worst = scan.audit.some((row) => row.verdict === "FAIL") ? "FAIL" :
      scan.audit.some((row) => row.verdict === "WARN")           ? "WARN" :
                                                                   "PASS";
  const headline = {
    PASS: "The scan is in order",
    WARN: "Read this before you plan",
    FAIL: "The scan has a problem"
  }[worst];
  return el(
      "main", {class: "start audit-page"},
      el("header", {}, el("h1", {}, headline),
         el("p", {}, "The audit checks what a plan relies on: orientation, spacing, units, gaps.")),
      el("section", {class: "card wide"}, doubtful_places(scan.name, () => undefined), audit_rows(scan.audit),
         scan_facts(scan)),
      el("div", {class: "row"},
         button(
             "Continue", "Continue to the planner",
             () => {
               set({page: "plan"});
               if (state.tour === null) take_tool("window");
             },
             {class: "primary big", autofocus: true}),
         button("Another scan", "Back to the start page", () => set({page: "start"}), {class: "big"}),
         patient_button()));
}

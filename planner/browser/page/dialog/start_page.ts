// SPDX-License-Identifier: AGPL-3.0-or-later
// The start page, and the audit of a scan that is shown before anything else.
import {open_plan} from "../actions";
import {audit_rows} from "../panel/audit";
import {grouped} from "../panel/certificate_badge";
import {dialogs} from "../commands";
import {patient_button, patient_facts} from "../panel/patient";
import {upload} from "./files";
import {button, Child, el, fill} from "../base/html";
import {icon, IconName} from "../base/icons";
import {ScanState} from "../protocol";
import {set, state, watch} from "../state";
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
  again();
}

function start(): Child {
  const picker = el("input", {
    type: "file",
    hidden: true,
    onchange: () => {
      const file = picker.files?.[0];
      if (file) void upload(file);
    }
  });
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
             "head", "Head phantom", "A CT of a head made of closed forms: every number has a known truth.",
             () => void open_plan({phantom: "head"})),
         offer(
             "folder", "Scan or plan",
             "A DICOM folder, .nii.gz, .nrrd, .mha, or a .plan.json of the opened folders.",
             () => dialogs.open())),
      el("button", {type: "button", class: "drop", onclick: () => picker.click()}, icon("file", 20),
         "Drop a scan or plan here, or choose a file", picker),
      is_opening ? el("p", {class: "opening", role: "status"}, el("span", {class: "spinner"}),
                      "Reading and checking the scan …") :
                   null,
      el("footer", {},
         `Octotomy ${state.hello?.version ?? ""} · Nothing leaves this machine · Not a medical device`));
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
          fact("Range", `${grouped(scan.range[0])} to ${grouped(scan.range[1])} ${scan.unit ?? ""}`) :
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
      el("section", {class: "card wide"}, audit_rows(scan.audit), scan_facts(scan)),
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

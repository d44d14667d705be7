// SPDX-License-Identifier: AGPL-3.0-or-later
// The plan's cephalometric measures with their norms, before and after, and their tracing on the radiograph, as in the report.
import {busy, done, try_to} from "../actions";
import {open_dialog} from "../base/dialog";
import {button, el} from "../base/html";
import {icon} from "../base/icons";
import {cephalometry} from "../../../result/page/movements";
import {CephalometryTable} from "../../../result/page/result";

export async function open_cephalometry(): Promise<void> {
  const job = busy("Measuring the face");
  const found = await try_to<{table: CephalometryTable; cephalogram: string; findings: string[]}>("cephalometry");
  done(job);
  if (!found) return;
  const dialog = open_dialog("Cephalometry", "cephalometry");
  const lacking = found.table.lacking ?? [];
  dialog.refill(
      found.findings.map((finding) => el("p", {class: "sentence warn"}, finding)),
      el("div", {class: "result-table", tabindex: 0, role: "group", "aria-label": "Measures and tracing"},
         cephalometry(found.table, found.cephalogram)),
      lacking.length ?
          el("details", {}, el("summary", {}, `${lacking.length} measures lack landmarks`),
             el("ul", {class: "marks"}, lacking.map(
                 ({name, landmarks}) => el("li", {}, `${name}: ${landmarks.join(", ").replace(/_/g, " ")}`)))) :
          null,
      found.cephalogram ?
          el("div", {class: "row end"}, button([icon("export", 15), "Tracing"], "Downloads the tracing as a PNG", () => {
               el("a", {href: `data:image/png;base64,${found.cephalogram}`, download: "tracing.png"}).click();
             })) :
          null);
}

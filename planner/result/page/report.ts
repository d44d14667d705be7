// SPDX-License-Identifier: AGPL-3.0-or-later
// The report from top to bottom: heading with the overall verdict, pictures, movements, measurements, certificates,
// scans with their audit, exports, plan, times.
import {Child, el} from "../../browser/page/base/html";
import {grouped} from "../../browser/page/base/numbers";
import {certificates, findings_table, scans} from "./certificates";
import {footer, list, overall_verdict, pill, plural, section, soft, table, times} from "./elements";
import {measurements, tiles} from "./measurements";
import {cephalometry, movements, ratios} from "./movements";
import {pictures} from "./pictures";
import {Report} from "./result";

function heading({result, patients, counts}: Report): Child {
  return el(
      "header", {},
      el("div", {}, el("h1", {}, result.plan.name ?? ""),
         el("p", {class: "patient"}, el("b", {}, "Patient: "), patients.join("; ")),
         el("p", {class: "soft"},
            `Scan ${result.scans.map((scan) => scan.made_by ?? scan.path).join(", ")} · Octotomy ${result.octotomy}`),
         result.signatures.map((one) => el(
             "p", {class: "small"}, pill(one.changed_since.length ? "WARN" : "PASS"), " signed by ", el("b", {}, one.by),
             `, ${one.as}, ${one.at}, ${one.changed_since.length ? "changed" : "unchanged"} since`,
             one.note && `: ${one.note}`))),
      overall_verdict(counts));
}

function parts({result}: Report): Child {
  const most_shown = 6;
  const rows = result.components.map((of) => [
    of.object, grouped(of.count),
    of.volumes_mm3.slice(0, most_shown).map((mm3) => grouped(mm3)).join(" · ") + (of.count > most_shown ? " …" : "")
  ]);
  return rows.length ? section("Connected parts", table(["Object", "#parts", "#volumes of the largest, mm³"], rows),
                               soft("Voxels are connected where they share a face.")) : null;
}

function exports_table({result, contents}: Report): Child {
  const rows = result.exports.map((file, i) => [
    file.written ? el("a", {href: file.path.split("/").map(encodeURIComponent).join("/")}, file.path) : file.path, file.object,
    [file.written ? contents[i] : el("span", {class: "pill warn"}, "NOT WRITTEN"), list(file.findings)],
    file.written ? grouped((file.bytes ?? 0) / 1000) : "–"
  ]);
  return rows.length ? section("Exports", table(["File", "Object", "Content", "#kB"], rows)) : null;
}

/// The plan as JSON, which the program can replay.
function plan_section({result: {plan}, plan_text}: Report): Child {
  const count = Array.isArray(plan.steps) ? plan.steps.length : Number(plan.steps);
  return section(
      "Plan",
      el("details", {},
         el("summary", {}, `${plural(count, "step")}, as JSON that `, el("code", {}, "octotomy run"), " replays"),
         el("pre", {}, plan_text)));
}

export const report = (of: Report): Child => [
  heading(of), tiles(of.result.measurements), section("Findings", findings_table("Check", of.result.findings)),
  pictures(of.pictures), movements(of.result), ratios(of.result), cephalometry(of.result.cephalometry, of.cephalogram),
  measurements(of.result.measurements), certificates(of.result), parts(of), scans(of.result), exports_table(of), plan_section(of),
  footer(of.result.octotomy, "A planning and research tool, not a medical device. Which checks support which number: ",
         el("a", {href: "credibility.html"}, "credibility"),
         `. Times, some of them side by side: ${times(of.result.timings_ms)}.`)
];

// SPDX-License-Identifier: AGPL-3.0-or-later
// The report's table of certificates, with the terms of each tolerance; and the audits of the scans.
import {Child, el} from "../../browser/page/base/html";
import {grouped, three_figures} from "../../browser/page/base/numbers";
import {facts, gauge, list, pill, Row, section, soft, table, wide_row} from "./elements";
import {Certificate, Finding, Result} from "./result";

/// Remarks on a certificate: its reasons, whether the object is resolved, and the findings on the object.
export const notes_of = (of: Certificate): string[] => [
  ...of.reasons, ...(of.resolved ? [] : [`not resolved: ${of.not_resolved_because ?? ""}`]), ...(of.findings ?? [])
];
/// A difference, the allowed difference, and a bar with the share of one in the other.
export function difference_of({difference_mm3, tolerance_mm3, verdict}: Certificate): Child {
  if (difference_mm3 === null || tolerance_mm3 === null) return "–";
  return [`${grouped(difference_mm3, 1)} / ${grouped(tolerance_mm3, 1)}`, gauge(difference_mm3, tolerance_mm3, verdict)];
}

function terms_of(of: Certificate, definition: string): Child {
  const quiet = (words: string): Child => el("span", {class: "soft"}, words);
  const limit = of.detection_limit;
  return el(
      "details", {open: of.verdict === "FAIL"}, el("summary", {}, el("code", {}, definition)),
      table(
          ["Source of difference that theory allows", "Formula", "#mm³"],
          of.terms.map((term) => [term.cause, el("code", {}, term.formula), three_figures(term.value_mm3)])),
      limit?.volume_mm3 ? el(
          "p", {class: "small"},
          `Detection limit: an error of more than ${three_figures(limit.volume_mm3)} mm³ in one place`,
          limit.shift_mm === null ? "" : `, or a shift of more than ${three_figures(limit.shift_mm)} mm,`,
          " would have been seen.") : null,
      el("p", {class: "small"}, quiet("Voxel lineage:"), ` ${of.voxel.lineage}. `, quiet("Mesh lineage:"),
         ` ${of.mesh.lineage}. Tier ${of.tier}.`));
}

export function certificates({objects, certificates}: Result): Child {
  if (!certificates.length) return null;
  const rows = objects.flatMap((object): Row[] => {
    const of = certificates.find((one) => one.object === object.id);
    const name = el("b", {}, object.id);
    if (!of) return object.findings.length ? [wide_row(8, name, " no certificate", list(object.findings))] : [];
    return [
      {lead: [
        name, pill(of.verdict, of.resolved), grouped(of.voxel.volume_mm3, 1),
        object.mesh ? grouped(of.mesh.volume_mm3, 1) : "–", difference_of(of),
        `${grouped(of.symmetric_difference_mm3)} / ${grouped(of.symmetric_difference_tolerance_mm3)}`,
        `${grouped(of.centroid_distance_mm, 2)} / ${grouped(of.centroid_tolerance_mm, 2)}`, grouped(of.hausdorff95_mm, 2)
      ]},
      wide_row(8, list(notes_of(of)), terms_of(of, object.definition))
    ];
  });
  return section(
      "Certificates",
      el("p", {class: "soft"}, "Each object with a mesh was made twice: by Booleans of octrees, and by corefinement of " +
         "meshes from the scan's own samples. The difference must stay within the bound that voxel size and boundary allow, " +
         "computed beforehand."),
      table(["Object", "Verdict", "#voxel, mm³", "#mesh, mm³", "#difference / allowed, mm³",
             "#symmetric difference / allowed, mm³", "#centroids / allowed, mm", "#Hausdorff 95, mm"], rows),
      soft("Symmetric difference: volume of the voxels that only one kernel's answer contains. Hausdorff 95: the larger of the two " +
           "directed 95th percentiles of distance between voxel faces and triangles."));
}

export const findings_table = (head: string, all: Finding[]): Child =>
    all.length ? table([head, "", "Finding"], all.map((one) => [one.check, pill(one.verdict), one.detail])) : null;

export function scans({scans, universe}: Result): Child {
  const unit = (scan: Result["scans"][0]): string => scan.unit === "1" ? "(no unit known)" : scan.unit;
  const matrix = (lengths: number[]): string => `${lengths.map((mm) => grouped(mm, 3)).join(" × ")} mm`;
  return section(
      "Scan and audit",
      scans.map((scan) => [
        facts(
            ["Scan", `${scan.name}: ${scan.made_by ?? scan.path}`], ["Modality", scan.modality || "not stated"],
            ["Samples", scan.dims.join(" × ")], ["Spacing", matrix(scan.spacing_mm)],
            ["Range", `${scan.range.map((end) => grouped(end)).join(" to ")} ${unit(scan)}`],
            ["SHA-256", scan.made_by ? "made by a step of the plan" :
                                       el("code", {title: scan.sha256}, `${scan.sha256.slice(0, 16)}…`)]),
        findings_table("Check", scan.audit)
      ]),
      soft(`Universe: ${universe.side}³ voxels of ${matrix(universe.voxel_mm)}. Coordinates are DICOM's LPS in ` +
           "millimetres."));
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// What the audit found in a scan, or in the mesh file that a step reads.
import {try_to} from "../actions";
import {Child, el} from "../base/html";
import {schema_of} from "../operations";
import {AuditRow, Step} from "../protocol";
import {on_leaving_plan, set, state} from "../state";

const words = {
  PASS: "in order",
  WARN: "to know",
  FAIL: "a problem"
} as const;
const marks = {
  PASS: "✓",
  WARN: "!",
  FAIL: "✕"
} as const;

/// The sentence of a line. If the patient is hidden, a line that compares identities does not quote the
/// files.
function sentence_of(row: AuditRow): string {
  const quotes = /^(identity|patient(?!_position|_orientation).*)$/.test(row.check ?? "");
  return state.hides_patient && quotes && row.verdict !== "PASS" ?
      "the files state different things about the patient; hidden here" :
      row.sentence;
}

/// The lines of an audit as a list, the worst verdicts first.
export function audit_rows(audit: readonly AuditRow[]): Child {
  const order = {FAIL: 0, WARN: 1, PASS: 2};
  const rows = [...audit].sort((a, b) => order[a.verdict] - order[b.verdict]);
  return el(
      "ul", {class: "audit"},
      rows.map(
          (row) => el(
              "li", {},
              el("span",
                 {class: `badge ${row.verdict.toLowerCase()}`, role: "img", "aria-label": words[row.verdict]},
                 marks[row.verdict]),
              el("span", {}, row.check ? el("b", {}, `${row.check.replace(/_/g, " ")}: `) : null,
                 sentence_of(row)))));
}

/// Audits by the request as a text. Null while the answer is pending, or if the server cannot read the file.
const audits = new Map<string, AuditRow[]|null>();
on_leaving_plan(() => audits.clear());

/// Shows the audit of a step's mesh file. Null for steps that lack a path, a frame or a unit.
export function mesh_audit(step: Step): Child {
  const fields = schema_of(step)?.properties;
  if (!fields?.path || !fields.frame || !fields.unit || typeof step.path !== "string") return null;
  const asked = {path: step.path, frame: step.frame ?? null, unit: step.unit ?? null};
  const key = JSON.stringify(asked);
  if (!audits.has(key)) {
    audits.set(key, null);
    void try_to<{audit: AuditRow[]}>("mesh_audit", asked).then((answer) => {
      if (!answer) return;
      audits.set(key, answer.audit);
      set({right_tab: state.right_tab});
    });
  }
  const audit = audits.get(key);
  return audit ? [el("h4", {}, "The file's statements"), audit_rows(audit)] : null;
}

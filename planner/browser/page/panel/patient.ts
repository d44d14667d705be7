// SPDX-License-Identifier: AGPL-3.0-or-later
// The patient of the plan, and the switch that hides the name.
import {button, Child, el} from "../base/html";
import {icon} from "../base/icons";
import {Patient, ScanState} from "../protocol";
import {hide_patient, state} from "../state";

const hidden = "patient hidden";
const unstated = "patient not stated";

/// Name, number and birth date of a patient, such as "Doe, Jane · A17 · 1970-01-31": enough to recognise the
/// patient.
function short_words(patient: Patient|null|undefined): string {
  if (!patient) return unstated;
  return [patient.name, patient.number, patient.birth_date].filter(Boolean).join(" · ");
}

/// A button in the bar with the patient of the plan's first scan. A click hides or shows the name.
export function patient_button(): Child {
  const scan = state.plan?.scans[0];
  if (!scan) return null;
  const words = state.hides_patient ? hidden : short_words(scan.patient);
  return button(
      [icon(state.hides_patient ? "eye_off" : "eye", 14), el("span", {class: "words"}, words)],
      state.hides_patient ? "Shows the patient's name, number and dates, here and in new reports" :
                            `${words}. A click hides the patient's name, number and dates, here and in new reports`,
      () => hide_patient(!state.hides_patient),
      {class: "ghost small patient", "aria-label": `${words}. ${state.hides_patient ? "Show" : "Hide"} the patient`});
}

/// A scan's facts about its patient, each on its own line.
export function patient_facts(scan: ScanState): Child {
  const fact = (name: string, value: string): Child => [el("dt", {}, name), el("dd", {}, value)];
  if (state.hides_patient) return fact("Patient", hidden);
  const patient = scan.patient;
  if (!patient) return fact("Patient", "not stated by the scan");
  return [
    fact("Patient", patient.name ?? "name not stated"),
    fact("Number", [patient.number ?? "not stated", patient.issuer].filter(Boolean).join(", ")),
    fact("Born", [patient.birth_date ?? "not stated", patient.sex].filter(Boolean).join(", ")),
    fact("Study of", patient.study_date ?? "not stated"),
  ];
}

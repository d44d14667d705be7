// SPDX-License-Identifier: AGPL-3.0-or-later
// The plan's numbers: volumes and measurements with their certificates.
import {try_to} from "../actions";
import {badge, judged, measured_text} from "./certificate_badge";
import {certify_all} from "../commands";
import {is_overlap} from "../drawn_objects";
import {button, Child, el} from "../base/html";
import {icon} from "../base/icons";
import {grouped} from "../base/numbers";
import {makes_body} from "../operations";
import {show_place} from "../pane/pane_grid";
import {Measurement} from "../protocol";
import {may_edit, set, state, step_of, steps} from "../state";
import {step_words} from "./step_lists";
import {Vec3} from "../base/vector";

export function numbers(): Child {
  const all = steps();
  const objects =
      (state.plan?.objects ?? []).filter((object) => makes_body(step_of(object.id)));
  const measurements = state.plan?.measurements ?? [];
  const counts = {PASS: 0, WARN: 0, FAIL: 0};
  for (const object of objects) {
    const certificate = judged(object.certificate, object.volume);
    if (certificate) counts[certificate.verdict]++;
  }
  const certified = counts.PASS + counts.WARN + counts.FAIL;
  return [
    el("section", {class: "card"},
       el("h3", {}, "Certificates", el("span", {class: "spring"}),
          !may_edit() ? null : button(
              [icon("certify", 15), "Certify"], "Certify. Computes all objects in both kernels and compares them",
              () => void certify_all(), {class: "primary"})),
       el("p", {class: "says"},
          certified ? `${counts.PASS} agree, ${counts.WARN} in doubt, ${counts.FAIL} disagree; ${
                          objects.length - certified} not certified.` :
                      "No number is certified yet.")),
    el("table", {class: "numbers"}, el("caption", {}, "Objects"), el("tbody", {}, objects.map((object) => {
         const step = step_of(object.id)!;
         return el(
             "tr", {
               class: state.selected === object.id ? "selected" : "",
               onclick: () => set({selected: object.id})
             },
             el("th", {scope: "row"}, object.id.replace(/_/g, " "),
                is_overlap(step, all) && !object.id.includes("overlap") ? el("small", {}, " overlap") : null,
                may_edit() && is_overlap(step, all) && (object.volume?.value ?? 0) > 0 ?
                    button(
                        "Show", `Shows the largest part of ${object.id} in all panes`,
                        (event) => {
                          event.stopPropagation();
                          void show_largest(object.id);
                        },
                        {class: "small", "data-key": `show-${object.id}`}) :
                    null,
                object.error ? el("p", {class: "error"}, object.error) : null,
                object.findings?.map((finding) => el("p", {class: "sentence warn"}, finding))),
             el("td", {}, el("div", {}, measured_text(object.volume)),
                object.area ? el("small", {}, measured_text(object.area)) : null),
             el("td", {class: "badge-cell"}, badge(object.id, object.certificate, object.volume)));
       }))),
    el("table", {class: "numbers"}, el("caption", {}, "Measurements"),
       el("tbody", {},
          measurements.length ?
              measurements.map(measurement_row) :
              el("tr", {}, el("td", {class: "says"}, "Measure with the distance (D) and angle (A) tools.")))),
  ];
}

/// Shows the largest connected part of an overlap in all panes, with its volume.
async function show_largest(object: string): Promise<void> {
  const part = await try_to<{parts: number; mm3: number; at_mm: Vec3 | null}>("part", {object});
  if (!part?.at_mm) return;
  const {looks} = state;
  set({selected: object, looks: {...looks, [object]: {...looks[object], visible: true}}});
  show_place(
      part.at_mm,
      `the largest of ${part.parts} ${part.parts === 1 ? "part" : "parts"} of ${object.replace(/_/g, " ")}: ${
          grouped(part.mm3)} mm³`);
}

function measurement_row(found: Measurement): Child {
  const step = step_of(found.id);
  const object = typeof step?.object === "string" ?
      state.plan?.objects.find((one) => one.id === step.object) :
      undefined;
  return el(
      "tr", {
        class: state.selected === found.id ? "selected" : "",
        onclick: () => set({selected: found.id}),
        "data-tip": found.sentence ?? found.says ?? (step ? step_words(step) : "")
      },
      el("th", {scope: "row"}, found.id.replace(/_/g, " "),
         el("small", {}, ` ${found.says ?? (step ? step_words(step) : "")}`),
         found.value === null && found.sentence ? el("p", {class: "error"}, found.sentence) : null),
      el("td", {}, measured_text(found)),
      el("td", {class: "badge-cell"}, badge(found.id, object?.certificate, found)));
}

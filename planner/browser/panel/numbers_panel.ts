// SPDX-License-Identifier: AGPL-3.0-or-later
// The plan's numbers: volumes and measurements with their certificates.
import {badge, judged, measured_text} from "./certificate_badge";
import {certify_all} from "../commands";
import {is_overlap} from "../drawn_objects";
import {button, Child, el} from "../base/html";
import {icon} from "../base/icons";
import {makes_body} from "../operations";
import {Measurement} from "../protocol";
import {set, state, step_of, steps} from "../state";
import {step_words} from "./step_lists";

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
          button(
              [icon("certify", 15), "Certify"], "Certify. Asks both kernels and compares their answers",
              () => void certify_all(), {class: "primary"})),
       el("p", {class: "says"},
          certified ? `${counts.PASS} agree, ${counts.WARN} in doubt, ${counts.FAIL} disagree; ${
                          objects.length - certified} not asked.` :
                      "No number is certified yet.")),
    el("table", {class: "numbers"}, el("caption", {}, "Objects"), el("tbody", {}, objects.map((object) => {
         const step = step_of(object.id)!;
         return el(
             "tr", {
               class: state.selected === object.id ? "selected" : "",
               onclick: () => set({selected: object.id})
             },
             el("th", {scope: "row"}, object.id.replace(/_/g, " "),
                is_overlap(step, all) && !object.id.includes("overlap") ? el("small", {}, " overlap") : null),
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
         el("small", {}, ` ${found.says ?? (step ? step_words(step) : "")}`)),
      el("td", {}, measured_text(found)),
      el("td", {class: "badge-cell"}, badge(found.id, object?.certificate, found)));
}

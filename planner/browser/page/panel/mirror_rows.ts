// SPDX-License-Identifier: AGPL-3.0-or-later
// The plane about which a selected object was mirrored: where it lies, how well it fits, and fields that move
// it.
import {replace_step} from "../actions";
import {Child, el} from "../base/html";
import {grouped} from "../base/numbers";
import {plane_of} from "../pane/mirror_plane";
import {Step} from "../protocol";
import {state} from "../state";
import {add, hundredths, scaled} from "../base/vector";

/// Shows the plane of a mirror step and how well it fits. Null for other steps.
export function mirror_rows(step: Step): Child {
  if (step.do !== "mirror") return null;
  const plane = plane_of(step);
  if (!plane) return el("p", {class: "says"}, "The plane is shown once it is fitted.");
  const {point_mm, normal} = plane;
  const fit = state.plan?.objects.find((one) => one.id === step.id)?.mirror;
  const residual = typeof fit?.rms_mm === "number" ?
      `Fitted: the two halves lie ${fit.rms_mm.toFixed(2)} mm apart (root mean square) over ${
          Math.round(100 * (fit.kept_share ?? 1))} % of the surface.${
          fit.converged === false ? " The fit did not converge: look at the plane." : ""}` :
      "The plane was given, not fitted, so it has no residual.";
  const move = (event: Event): void => {
    const by_mm = Number((event.target as HTMLInputElement).value);
    if (!by_mm) return;
    const {fit: _fit, through: _through, ...kept} = step;
    void replace_step(
        step.id, {...kept, point_mm: hundredths(add(point_mm, scaled(normal, by_mm))), normal: [...normal]} as Step,
        `plane of ${step.id} moved by ${by_mm} mm`);
  };
  return [
    el("p", {class: "says"}, residual),
    el("p", {class: "says"},
       `Plane through ${point_mm.map((x) => grouped(x, 1)).join(", ")} mm, normal ${
           normal.map((x) => grouped(x, 3)).join(", ")}; drawn in the panes.`),
    el("label", {class: "field", "data-tip": "Moves the plane along its normal. The plane is then no longer fitted"},
       el("span", {}, "Move the plane by"), el("input", {
         type: "number",
         step: "any",
         value: "",
         placeholder: "0",
         "data-key": `${step.id}.plane`,
         name: "plane",
         onchange: move
       }),
       el("i", {}, "mm")),
  ];
}

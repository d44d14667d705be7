// SPDX-License-Identifier: AGPL-3.0-or-later
// The result of a measuring step: its tables and plots, as in the report, and buttons that show it in the
// panes.
import {clear_compare} from "../commands";
import {open_dialog} from "../base/dialog";
import {button, Child, el} from "../base/html";
import {show_place} from "../pane/pane_grid";
import {Measurement, Step} from "../protocol";
import {set, state} from "../state";
import {Vec3} from "../base/vector";
import {measurement} from "../../../result/page/measurements";
import {Measurement as Measured} from "../../../result/page/result";

const measured = (found: Measurement): Measured => found.details as unknown as Measured;

/// The two objects of a measurement whose distance the panes can show in colours. Null for measurements
/// without such objects.
function pair_of(one: Measured): {object: string; reference: string; mutual: boolean; range_mm: number}|null {
  if (one.contacts !== undefined)
    return {object: one.object, reference: one.against, mutual: true, range_mm: Math.max(0.5, one.within_mm)};
  if (one.mean_mm !== undefined)
    return {object: one.a, reference: one.b, mutual: false, range_mm: Math.max(0.5, Number((one.hausdorff95_mm ?? 5).toFixed(1)))};
  return null;
}
/// The place of a measurement's smallest section or nearest contact, with words for it. Null for other
/// measurements.
function place_of(one: Measured): {at_mm: Vec3; says: string}|null {
  if (one.airway) return {at_mm: one.airway.narrowest.at_mm, says: `narrowest section of ${one.object}`};
  const nearest = one.contacts?.reduce<NonNullable<Measured["contacts"]>[number]|null>(
      (best, of) => (best === null || of.nearest_mm < best.nearest_mm ? of : best), null);
  return nearest ? {at_mm: nearest.at_mm, says: `nearest contact of ${one.object} with ${one.against}`} : null;
}

/// Table, plot and buttons of a step's result. Null if the step has no result with a table.
export function result_rows(step: Step): Child {
  const found = state.plan?.measurements?.find((one) => one.id === step.id);
  if (!found?.details) return null;
  const one = measured(found);
  const drawn = measurement(one);
  if (!drawn || (Array.isArray(drawn) && !drawn.length)) return null;
  const pair = pair_of(one), place = place_of(one);
  const is_shown = pair !== null && state.compare?.object === pair.object && state.compare.reference === pair.reference;
  return el(
      "section", {class: "result", "aria-label": `Result of ${step.id.replace(/_/g, " ")}`},
      el("div", {class: "result-table", tabindex: 0, role: "group", "aria-label": "Table and plot"}, drawn),
      el("div", {class: "row"},
         button("Enlarge", "Enlarge. Shows the result over the whole page", () => {
           const dialog = open_dialog(`Result of ${step.id.replace(/_/g, " ")}`, "result-dialog");
           dialog.refill(el("div", {class: "result-table"}, measurement(one)));
         }, {"data-key": "result-enlarge"}),
         pair ? button(
                    "In colours", `In colours. Colours ${pair.object} by its distance from ${pair.reference} in the panes`,
                    () => is_shown ? clear_compare() : set({compare: pair}),
                    {"aria-pressed": String(is_shown), class: is_shown ? "on" : "", "data-key": "result-colours"}) :
                null,
         place ? button(
                     "Show the place", `Show the place. Brings all panes to the ${place.says}`,
                     () => show_place(place.at_mm, place.says), {"data-key": "result-place"}) :
                 null));
}

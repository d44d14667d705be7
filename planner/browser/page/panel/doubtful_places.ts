// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures of where a scan is doubtful: gaps, metal, a headrest. Each leads to its place in the panes.
import {try_to} from "../actions";
import {button, Child, el, fill} from "../base/html";
import {show_in, show_place} from "../pane/pane_grid";
import {may_edit, on_leaving_plan, set, state} from "../state";
import {Vec3} from "../base/vector";

interface Place {
  check: string;
  sentence: string;
  at_mm: Vec3;
  plane: "axial"|"coronal"|"sagittal";
  png: string;
}

// Doubtful places by plan, scan and file. Pending requests are stored too, because the page may be refilled
// before the answer and must not send them again.
const found = new Map<string, Promise<Place[]>>();
on_leaving_plan(() => found.clear());

/// Pictures of a scan's doubtful places. They arrive after the rest of the audit. `leave` closes the dialog
/// or page that covers the panes.
export function doubtful_places(scan: string, leave: () => void): Child {
  if (!may_edit()) return null;
  const host = el("div", {class: "places", "aria-live": "polite"}, el("p", {class: "says"}, "Looking for gaps, metal and a headrest …"));
  const key = `${state.plan?.path} ${scan} ${state.plan?.plan.scans?.[scan]?.path}`;
  if (!found.has(key))
    found.set(key, try_to<{places: Place[]}>("doubtful_places", {scan}).then((answer) => {
      if (!answer) found.delete(key);
      return answer?.places ?? [];
    }));
  void found.get(key)!.then((places) => fill(
      host,
      places.length ? places.map((place) => figure(place, leave)) :
                      el("p", {class: "says"}, "No gap, metal or headrest was found in the samples.")));
  return host;
}

function figure(place: Place, leave: () => void): Child {
  const name = place.check.replace(/_/g, " ");
  const show = (): void => {
    leave();
    set({page: "plan"});
    // The panes have a size only after the browser has laid out the page.
    requestAnimationFrame(() => {
      show_in(0, place.plane);
      show_place(place.at_mm, `${name}: ${place.sentence}`);
    });
  };
  return el(
      "figure", {class: "place"},
      el("img", {src: `data:image/png;base64,${place.png}`, alt: `${place.plane} slice, the ${name} in orange`}),
      el("figcaption", {}, el("span", {}, el("b", {}, `${name}: `), place.sentence),
         el("div", {class: "row"},
            button("Show the place", `Show the place. Brings all panes to the ${name}`, show, {class: "small", "data-key": `place-${place.check}`}))));
}

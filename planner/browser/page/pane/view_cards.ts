// SPDX-License-Identifier: AGPL-3.0-or-later
// Temporary settings of the views, which are not steps of the plan: the cut plane, colours by distance,
// contacts.
import {add_step, free_id} from "../actions";
import {clear_compare} from "../commands";
import {object_ids} from "../drawn_objects";
import {button, Child, el} from "../base/html";
import {icon} from "../base/icons";
import {grouped} from "../base/numbers";
import {set, shown_scan, state} from "../state";

export function cut_plane_card(): Child {
  const cut = state.cut_plane!;
  const bounds = state.plan?.scans.find((scan) => scan.name === shown_scan())?.bounds_mm;
  const names = ["Sagittal", "Coronal", "Axial"];
  const place = (offset_mm: number): string => `${grouped(offset_mm, 1)} mm`;
  const shown = el("output", {}, place(cut.offset_mm));
  return el(
      "section", {class: "card"},
      el("h3", {}, icon("plane", 16), "Cut plane", el("span", {class: "spring"}),
         button(
             icon("close", 14), "Remove the cut plane", () => set({cut_plane: null}),
             {class: "ghost small"})),
      el("div", {class: "presets"},
         names.map(
             (name, axis) => button(
                 name, `${name} plane`,
                 () => set({
                   cut_plane: {...cut, axis: axis as 0 | 1 | 2, offset_mm: state.cross_mm[axis as 0 | 1 | 2]}
                 }),
                 {class: cut.axis === axis ? "on" : ""})),
         button(
             "Other side", "Hides the other side of the plane instead",
             () => set({cut_plane: {...cut, side: cut.side === 1 ? -1 : 1}}))),
      el("label", {class: "slider"}, el("span", {}, "At"), el("input", {
           type: "range",
           "data-key": "cut-range",
           "aria-label": "Place of the cut plane",
           min: bounds?.[0][cut.axis] ?? -150,
           max: bounds?.[1][cut.axis] ?? 150,
           step: 0.5,
           value: cut.offset_mm,
           oninput: (event: Event) => {
             const offset_mm = Number((event.target as HTMLInputElement).value);
             shown.textContent = place(offset_mm);
             set({cut_plane: {...cut, offset_mm}});
           }
         }),
         shown));
}

export function compare_card(): Child {
  const compare = state.compare!;
  const {mutual} = compare;
  const choose = (field: "object"|"reference", label: string): Child =>
      el("label", {class: "field"}, el("span", {}, label),
         el("select", {
           "data-key": `compare-${field}`,
           onchange: (event: Event) =>
               set({compare: {...compare, [field]: (event.target as HTMLSelectElement).value}})
         },
            object_ids().map(
                (id) => el("option", {value: id, selected: id === compare[field]}, id.replace(/_/g, " ")))));
  return el(
      "section", {class: "card"},
      el("h3", {}, icon(mutual ? "contact" : "compare", 16), mutual ? "Contacts" : "Compare",
         el("span", {class: "spring"}),
         button(
             icon("close", 14), "Back to the objects' own colours", clear_compare, {class: "ghost small"})),
      el("p", {class: "says"},
         mutual ?
             "Colours both by their distance to each other: white where they touch, blue where they overlap, orange where they are apart. The views from below and above show one alone." :
             "Colours each surface point of the first object by its distance to the nearest point of the second: orange outside of it, blue inside."),
      choose("object", mutual ? "One" : "Object"),
      choose("reference", mutual ? "The other" : "Compared with"),
      el("label", {class: "field"}, el("span", {}, "Last colours at"), el("input", {
           type: "number",
           min: 0.5,
           step: 0.5,
           value: compare.range_mm,
           "data-key": "compare-range",
           onchange: (event: Event) => set({
             compare: {...compare, range_mm: Math.max(0.1, Number((event.target as HTMLInputElement).value))}
           })
         }),
         el("i", {}, "mm")),
      mutual ? button(
                   "Measure the gap", "Adds a step that measures the narrowest gap between both",
                   () => void add_step(
                       {id: free_id("gap"), do: "measure", object: compare.object, to: compare.reference},
                       `gap from ${compare.object} to ${compare.reference}`)) :
               button(
                   "Measure both ways", "Adds a step that measures the distances with their definition",
                   () =>
                       void add_step(
                           {
                             id: free_id(`${compare.object}_to_${compare.reference}`),
                             do: "compare",
                             a: compare.object,
                             b: compare.reference
                           },
                           `compare ${compare.object} with ${compare.reference}`)));
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// The four panes, each with its head: the choice of its picture, its slider, its buttons. They request new
// pictures when what they show has changed.
import {fitted} from "../actions";
import {button, Child, el, fill} from "../base/html";
import {icon} from "../base/icons";
import {grouped, unit_text} from "../base/numbers";
import {change_pane, Pane} from "./panes";
import {FrameHeader} from "../protocol";
import {first_scan, on_leaving_plan, PaneSetting, set, shown_scan, shows_one_pane, State, state, watch} from "../state";
import {open_second_screen} from "../second_screen";
import {active_tool, take_tool} from "../tool/tool";
import {Vec2, Vec3} from "../base/vector";
import {plane_names, PlaneName, turned, view_names, ViewName} from "../base/view_frame";
import {attach_input} from "./view_input";

const panes: Pane[] = [];
export const all_panes = (): Pane[] => panes;

/// Creates the four panes in their host. `acknowledge` receives each frame that a pane has shown.
export function make_panes(host: HTMLElement, acknowledge: (pane: number, frame: number) => void): void {
  for (let index = 0; index < 4; ++index) {
    const pane = new Pane(index, acknowledge);
    const head = el("div", {class: "pane-head"});
    const legend = el("div", {class: "legend"});
    const frame = el("div", {class: "pane", "data-pane": index}, pane.canvas, head, legend);
    host.append(frame);
    panes.push(pane);
    attach_input(pane, all_panes, tell_pointer);
    let shown = "";
    const head_again = (): void => {
      const now = JSON.stringify([{...pane.setting, centre_mm: 0}, state.maximised, state.arch_mm.length]);
      frame.classList.toggle("active", state.active_pane === index);
      frame.hidden = state.maximised !== null && state.maximised !== index;
      host.classList.toggle("one", state.maximised !== null);
      pane.canvas.setAttribute(
          "aria-label",
          `${pane_title(pane.setting)} pane. Arrow keys turn the view or go through the slices.`);
      if (now === shown) return;
      shown = now;
      fill(head, head_of(pane));
    };
    watch(["panes", "maximised", "active_pane", "arch_mm"], head_again);
    head_again();
    pane.canvas.addEventListener("picture", () => {
      const about = pane.picture?.header.legend;
      const first_view = panes.findIndex(
          (other, number) => !other.is_slice && (state.maximised === null || state.maximised === number));
      legend.hidden = !about || index !== first_view;
      if (about)
        fill(
            legend,
            el("div", {class: "ramp", style: `background:linear-gradient(90deg,${about.colours.join()})`}),
            el("span", {}, `−${- about.low_mm} mm`), el("span", {}, "0"),
            el("span", {}, `+${about.high_mm} mm`));
      legend.title = about?.definition ?? "";
    });
    legend.hidden = true;
  }
  watch(["plan", "compare", "theme"], () => want_all(false));
  // These values change while a slider moves, so coarse pictures are requested. A full picture follows soon
  // after the last change.
  watch(["looks", "draft_window", "cut_plane"], () => want_all(true));
  watch(["preview"], follow_preview);
  watch(
      ["panes", "selected", "marked", "tool", "cross_mm", "arch_mm", "hides_names"],
      () => panes.forEach((pane) => pane.redraw()));
  watch(["tool"], () => panes.forEach((pane) => {
    pane.canvas.style.cursor = active_tool()?.cursor ?? "default";
  }));
}

// While a piece is dragged, the active pane requests every picture and the other panes one in this many ms,
// so that the motion stays smooth.
const others_every_ms = 300;
let others_at = 0;
function follow_preview(): void {
  if (!state.preview) return want_all(false);
  const now = performance.now();
  const is_turn_of_others = now - others_at > others_every_ms;
  if (is_turn_of_others) others_at = now;
  for (const pane of panes)
    if (is_turn_of_others || pane.index === state.active_pane) pane.want(true);
}

export function want_all(dragging: boolean): void {
  for (const pane of panes) pane.want(dragging);
}
export function want_slices(dragging: boolean): void {
  for (const pane of panes)
    if (pane.is_slice) pane.want(dragging);
}
export function take_picture(header: FrameHeader, parts: Uint8Array[]): void {
  void panes[header.pane]?.take(header, parts);
}
export function reconnected(): void {
  for (const pane of panes) pane.reconnected();
}

/// Fits every pane to the scan, once the browser has laid out the panes.
export function fit_all(): void {
  requestAnimationFrame(() => {
    for (const pane of panes) pane.resized();
    if (state.plan) set({panes: fitted(state.plan, shown_scan()).panes});
    want_all(false);
  });
}

// What a window shows of one scan, in that scan's frame.
type OfScan = Pick<State, "panes"|"cross_mm"|"grey"|"arch_mm"|"cut_plane"|"marked">;
const left_at = new Map<string, OfScan>();
on_leaving_plan(() => left_at.clear());
/// Shows a scan of the plan in all panes, with the settings that it had last. Null means the patient's scan.
export function show_scan(name: string|null): void {
  const before = shown_scan();
  const next = name ?? first_scan();
  if (next === before || !state.plan) return;
  // A tool's unfinished work belongs to the previous scan. Only the landmark tool stays, because a procedure
  // may need landmarks on several scans.
  if (state.tool !== "landmark") take_tool("navigate");
  const {panes: shown, cross_mm, grey, arch_mm, cut_plane, marked} = state;
  left_at.set(before, {panes: shown, cross_mm, grey, arch_mm, cut_plane, marked});
  const {panes: fits, ...looked}: OfScan =
      left_at.get(next) ?? {...fitted(state.plan, next), arch_mm: [], cut_plane: null, marked: null};
  set({
    scan: name,
    preview: null,
    ...looked,
    panes: state.panes.map(
        (pane, index) => ({...pane, centre_mm: fits[index]!.centre_mm, pixel_mm: fits[index]!.pixel_mm})),
  });
  for (const pane of panes) {
    pane.forget();
    pane.want(false);
  }
}

// The edit of the plan about which the mark says something. After another edit it may no longer be true.
let marked_edit: number|undefined;
watch(["plan"], () => {
  if (state.marked && state.plan?.edit !== marked_edit && !shows_one_pane) set({marked: null});
});

/// Moves the cross-hair and the middle of every pane to a place, and marks it with words until the plan changes.
export function show_place(at_mm: Vec3, says: string): void {
  marked_edit = state.plan?.edit;
  set({
    cross_mm: at_mm,
    marked: {at_mm, says},
    panes: state.panes.map((pane) => ({...pane, centre_mm: at_mm, pixel_mm: Math.min(pane.pixel_mm, 0.25)})),
  });
  want_all(false);
}

export const pane_title = (setting: PaneSetting): string => setting.mode === "panoramic" ?
    "Panoramic" :
    capital(
        setting.mode === "slice"             ? setting.plane :
            typeof setting.view === "string" ? setting.view :
                                               "free view");
const capital = (word: string): string => word.charAt(0).toUpperCase() + word.slice(1);

function head_of(pane: Pane): Child {
  const setting = pane.setting;
  const value = setting.mode === "panoramic" ? "panoramic" :
      setting.mode === "slice"               ? setting.plane :
      typeof setting.view === "string"       ? setting.view :
                                               "free";
  const option = (name: string, label: string): HTMLOptionElement =>
      el("option", {value: name, selected: name === value}, label);
  const choose =
      el("select", {
        class: "pane-choice",
        "aria-label": `What pane ${pane.index + 1} shows`,
        "data-tip": "Choose a view of the objects or a slice of the scan.",
        onchange: (event: Event) => show_in(pane.index, (event.target as HTMLSelectElement).value),
      },
         el("optgroup", {label: "Views"},
            [...view_names, "free" as const].map(
                (name) => option(name, name === "free" ? "Free view" : capital(name)))),
         el("optgroup", {label: "Slices"}, plane_names.map((name) => option(name, capital(name))),
            option("panoramic", "Panoramic")));
  const turned_by = pane.is_oblique                               ? setting.tilt :
      setting.mode === "view" && typeof setting.view !== "string" ? setting.view :
                                                                    null;
  const about = (words: string): Child => el("span", {class: "angles", title: words}, words);
  const shading =
      el("select", {
        class: "pane-choice faint",
        "aria-label": "Shading",
        "data-tip": "How surfaces are drawn: shaded, as a radiograph, the largest sample, or for red and cyan glasses.",
        hidden: setting.mode !== "view",
        onchange: (event: Event) => {
          change_pane(pane.index, {shading: (event.target as HTMLSelectElement).value});
          pane.want(false);
        },
      },
         ([
           ["partial_volume", "Surface"], ["radiograph", "Radiograph"], ["mip", "Largest sample"],
           ["context", "Context"], ["stereo", "Stereo, red and cyan"]
         ] as const)
             .map(([name, label]) => el("option", {value: name, selected: name === setting.shading}, label)));
  return [
    choose,
    turned_by ? about(`${turned_by.azimuth.toFixed(0)}°, ${turned_by.elevation.toFixed(0)}°`) : null,
    setting.only ? about(`${setting.only.replace(/_/g, " ")} alone`) : null,
    shading,
    el("span", {class: "spring"}),
    shows_one_pane ? null : [
      button(
          icon("screen", 14), "Show in a second window, for another screen", () => open_second_screen(pane.index),
          {class: "ghost small to-screen"}),
      button(
        icon("maximise", 14),
        state.maximised === null ? "Enlarge this pane. Double click does it too" : "Show four panes",
        () => set({maximised: state.maximised === null ? pane.index : null, active_pane: pane.index}),
        {class: "ghost small"}),
    ],
  ];
}

/// Shows a view or a slice in a pane, by its name in the pane's menu.
export function show_in(index: number, name: string): void {
  if (name === "panoramic")
    change_pane(index, {mode: "panoramic"});
  else if (name === "free")
    change_pane(index, {mode: "view", view: turned(state.panes[index]!.view)});
  else if (plane_names.some((plane) => plane === name))
    change_pane(index, {mode: "slice", plane: name as PlaneName});
  else
    change_pane(index, {mode: "view", view: name as ViewName});
  panes[index]?.forget();
  panes[index]?.want(false);
}

function tell_pointer(pane: Pane, at: Vec2): void {
  const picked = pane.pick(at);
  const value = pane.value_at(at);
  const unit = unit_text(state.plan?.scans.find((scan) => scan.name === shown_scan())?.unit ?? "HU");
  const words = picked ? `${picked.point.map((x) => grouped(x, 1)).join("  ")} mm${
                             value === null ? "" : `   ${grouped(value)} ${unit}`.trimEnd()}${
                             picked.object ? `   ${picked.object}` : ""}` :
                                             "";
  if (words !== state.pointer) set({pointer: words});
}

// SPDX-License-Identifier: AGPL-3.0-or-later
// Tools that take points: landmarks by name, distances, angles, ways along a surface, seeds of a
// segmentation, the dental arch.
import {add_step, free_id, put_landmark} from "../actions";
import {button, el} from "../base/html";
import {ask_guesses, draw_guesses, guess_card, open_guesses, pass_over} from "./guesses";
import {dot_at, ink, line, text} from "../base/ink";
import {is_drawn, scan_of_landmark} from "../pane/overlay";
import {show_in, show_scan, want_all} from "../pane/pane_grid";
import type {Pane} from "../pane/panes";
import {Json, LandmarkGuess} from "../protocol";
import {first_scan, is_elsewhere, notify, on_leaving_plan, selected_step, set, shown_scan, state} from "../state";
import {take_tool, Tool} from "./tool";
import {angle_deg, distance, hundredths, Vec2, Vec3} from "../base/vector";

let taken: Vec3[] = [];
let pointed: Vec3|null = null;
let landmark_name = "";
interface Wanted {
  name: string;
  says: string;
  scan?: string;
}
let procedure_wants: Wanted[] = [];
let held: {name: string; point: Vec3}|null = null;  // a landmark that is dragged
let is_snapping = true;

const named = (p: Vec3): Json =>
    state.plan?.landmarks.find((mark) => distance(mark.point, p) < 0.005)?.name ?? [...p];

/// A click within this many CSS pixels of a landmark grabs it.
const near_px = 10;

function landmark_at(pane: Pane, at: Vec2): {name: string; point: Vec3}|undefined {
  return state.plan?.landmarks.find((mark) => {
    if (!is_drawn(pane, mark)) return false;
    const p = pane.pixel_at(mark.point);
    return Math.hypot(p[0] - at[0], p[1] - at[1]) < near_px * pane.ratio;
  });
}
/// The point under the pointer. Null, with a message, if a view shows no surface there or its picture is not
/// at rest.
export function place_at(pane: Pane, at: Vec2): Vec3|null {
  if (!pane.has_places) {
    notify("The picture is still being drawn: click again once it is at rest.", "warning");
    return null;
  }
  if (!pane.is_beside(at)) return hundredths(pane.point_at(at));
  notify("No surface lies there, so the point has no depth: click on an object, or in a slice.", "warning");
  return null;
}
/// Whether a clicked landmark snaps to bone. Points in slices stay where they are clicked. On another scan,
/// such as a donor's, there is no object of the plan to snap to.
const snaps = (pane: Pane): boolean => is_snapping && !pane.is_slice && !is_elsewhere();

function point_tool(
    kind: "distance"|"angle"|"surface_distance", count: number, title: string, says: string,
    key: string): Tool {
  return {
    name: kind,
    title,
    says,
    key,
    cursor: "crosshair",
    is_pointed: true,
    down({pane, at}) {
      const point = landmark_at(pane, at)?.point ?? place_at(pane, at);
      if (!point) return true;
      taken.push(point);
      pointed = null;
      if (taken.length === count) {
        const points = taken;
        taken = [];
        void finish(kind, points);
      }
      pane.redraw();
      return true;
    },
    hover({pane, at}) {
      if (!taken.length) return;
      pointed = pane.point_at(at);
      pane.redraw();
    },
    press(event, pane) {
      if (event.key !== "Escape" || !taken.length) return false;
      taken = [];
      pane.redraw();
      return true;
    },
    draw(pane, context) {
      const points = (pointed && taken.length ? [...taken, pointed] : taken).map((p) => pane.pixel_at(p));
      line(context, points, ink.measure, 2 * pane.ratio);
      for (const p of points) dot_at(context, p, 4 * pane.ratio, ink.measure);
      const last = points[points.length - 1];
      if (!last || !pointed || !taken.length) return;
      const words = taken.length === 2 ? `${angle_deg(taken[0]!, taken[1]!, pointed).toFixed(1)}°` :
                                         `${distance(taken[0]!, pointed).toFixed(1)} mm`;
      text(
          context, words, [last[0] + 12 * pane.ratio, last[1] - 12 * pane.ratio], pane.ratio,
          {colour: ink.measure});
    },
    left() {
      taken = [];
      pointed = null;
    },
  };
}

async function finish(kind: string, points: Vec3[]): Promise<void> {
  const id = free_id(kind === "surface_distance" ? "surface_way" : kind);
  const step = selected_step();
  if (kind === "surface_distance") {
    const object = step && step.do !== "measure" && step.do !== "landmarks" ? step.id : undefined;
    if (!object)
      return notify("Select the object on whose surface the path runs, then click both ends of the path.", "warning");
    await add_step({id, do: "measure", object, along: points.map((p) => [...p])}, `way along ${object}`);
  } else {
    await add_step({id, do: "measure", points_mm: points.map(named)}, kind);
  }
  set({right_tab: "numbers"});
}

export const distance_tool = point_tool("distance", 2, "Distance", "Click two points or landmarks.", "d");
export const angle_tool =
    point_tool("angle", 3, "Angle", "Click three points or landmarks; the angle is at the second.", "a");
export const surface_tool = point_tool(
    "surface_distance", 2, "Way along a surface", "Select an object, then click two points of its surface.",
    "");

/// Lets the person place landmarks that a procedure needs, one click each.
export function ask_for_landmarks(wanted: Wanted[]): void {
  procedure_wants = wanted;
  next_wanted();
  take_tool("landmark");
}
// Chooses the procedure's next missing landmark and shows its scan. Ends the tool if none is missing.
// `placed` counts as placed, even if the plan's state does not contain it yet.
function next_wanted(placed = ""): void {
  const missing = procedure_wants.find(
      (one) => one.name !== placed && !state.plan?.landmarks.some((mark) => mark.name === one.name));
  landmark_name = missing?.name ?? "";
  if (missing) show_scan(missing.scan || null);
  show_guess();
  if (procedure_wants.length && !missing) {
    procedure_wants = [];
    show_scan(null);
    take_tool("navigate");
    window.dispatchEvent(new Event("landmarks-placed"));
  }
}

/// The guess for the landmark that the next click places; undefined if there is none.
const current_guess = (): LandmarkGuess|undefined =>
    open_guesses().find((guess) => guess.name === landmark_name);

export async function guess_landmarks(): Promise<void> {
  if (!await ask_guesses()) return;
  take_tool("landmark");
  set({right_tab: "inspector"});
  if (procedure_wants.length)
    show_guess();
  else
    next_guess();
}

/// Chooses the next guess and moves the cross-hair to it. `placed` is passed over, even if the plan's state
/// does not contain it yet.
function next_guess(placed = ""): void {
  const next = open_guesses().find((guess) => guess.name !== placed);
  landmark_name = next?.name ?? "";
  show_guess();
}

/// The largest pixel of a pane that shows a guess: the surroundings by which a person judges it are some 10 cm.
const guess_pixel_mm = 0.35;

/// Shows the guess for the next landmark in the panel, and moves the cross-hair and all panes to it.
function show_guess(): void {
  const guess = current_guess();
  if (!guess) return set({tool: state.tool});
  const at_mm = hundredths(guess.point_mm);
  set({
    tool: state.tool,
    cross_mm: at_mm,
    panes: state.panes.map((pane) => ({...pane, centre_mm: at_mm, pixel_mm: Math.min(pane.pixel_mm, guess_pixel_mm)}))
  });
  want_all(false);
}

async function place(name: string, point: Vec3, snap: boolean): Promise<void> {
  const asked = landmark_name;
  const at = await put_landmark(name, point, snap);
  if (!at) return;
  set({cross_mm: hundredths(at)});
  if (landmark_name !== asked) return;  // the person typed another name before the answer arrived
  if (procedure_wants.length)
    next_wanted(name);
  else if (open_guesses().length)
    next_guess(name);
  else
    landmark_name = "";
}

/// Why a landmark of this name cannot be placed on the shown scan: its position would be taken for one of
/// another scan. Empty: it can be placed.
function refusal_here(name: string): string {
  const wanted = scan_of_landmark(name), words = name.replace(/_/g, " ");
  if (wanted === (is_elsewhere() ? shown_scan() : "")) return "";
  return wanted ? `${words} lies on the scan '${wanted}': show that scan first.` :
                  `On the scan '${shown_scan()}' only landmarks can be placed that a procedure expects there. ${
                      words} would belong to the patient's scan: show that scan first.`;
}

export const landmark_tool: Tool = {
  name: "landmark",
  title: "Landmark",
  says:
      "Name a landmark, then click it in a view or slice. It snaps to the surface; drag a placed one to move it.",
  key: "l",
  cursor: "crosshair",
  is_for_any_scan: true,
  is_pointed: true,
  down({pane, at}) {
    const known = landmark_at(pane, at);
    if (known) {
      held = {...known};
      return true;
    }
    const name =
        landmark_name.trim().replace(/\s+/g, "_") || `point_${(state.plan?.landmarks.length ?? 0) + 1}`;
    const refusal = refusal_here(name);
    if (refusal) {
      notify(refusal, "warning");
      return true;
    }
    const point = place_at(pane, at);
    if (point) void place(name, point, snaps(pane));
    return true;
  },
  move({pane, at}) {
    if (!held || !pane.has_places || pane.is_beside(at)) return;
    held.point = hundredths(pane.point_at(at));
    pane.redraw();
  },
  up({pane}) {
    if (!held) return;
    const {name, point} = held;
    held = null;
    if (distance(point, state.plan?.landmarks.find((mark) => mark.name === name)?.point ?? point) < 0.01)
      return;
    void put_landmark(name, point, snaps(pane)).then((at) => {
      if (at) set({cross_mm: hundredths(at)});
    });
  },
  draw(pane, context) {
    if (held) dot_at(context, pane.pixel_at(held.point), 6 * pane.ratio, ink.landmark, true);
    draw_guesses(pane, context, landmark_name);
  },
  panel: () => {
    const wanted = procedure_wants.find((one) => one.name === landmark_name);
    const placed =
        procedure_wants.filter((one) => state.plan?.landmarks.some((mark) => mark.name === one.name)).length;
    const guess = current_guess();
    return [
      wanted ?
          el("p", {class: "says"},
             el("b", {}, `${placed + 1} of ${procedure_wants.length}: ${wanted.name.replace(/_/g, " ")}. `),
             wanted.says) :
          null,
      guess ? guess_card(
                  guess, () => void place(guess.name, guess.point_mm, false),
                  () => {
                    pass_over(guess);
                    if (!procedure_wants.length) next_guess();
                  }) :
              null,
      el("label", {class: "field"}, el("span", {}, "Name"), el("input", {
           value: landmark_name,
           placeholder: "ans, nasion, …",
           "data-key": "landmark-name",
           name: "landmark",
           oninput: (event: Event) => {
             landmark_name = (event.target as HTMLInputElement).value;
           },
         })),
      el("label", {class: "check"}, el("input", {
           type: "checkbox",
           checked: is_snapping,
           onchange: (event: Event) => {
             is_snapping = (event.target as HTMLInputElement).checked;
           }
         }),
         "Snap to the surface"),
      state.guesses.length ?
          null :
          button(
              "First guess", "First guess. Looks for landmarks by the skull's symmetry and extremal points",
              () => void guess_landmarks(), {"data-key": "first-guess"}),
    ];
  },
  left() {
    procedure_wants = [];
    held = null;
    landmark_name = "";
  },
};

on_leaving_plan(() => {
  is_snapping = true;
});

export const segment_tool: Tool = {
  name: "segment",
  title: "Segment by click",
  says:
      "Click a tissue in a slice or view: the connected part with samples like those of the selected window becomes an object.",
  key: "p",
  cursor: "crosshair",
  is_pointed: true,
  down({pane, at}) {
    const seed = place_at(pane, at);
    if (!seed) return true;
    const base = [selected_step(), ...(state.plan?.plan.steps ?? [])].find((step) => step?.do === "window");
    const window_text =
        base ? `${String(base.low)}:${base.high === undefined ? "" : String(base.high)}` : "bone";
    void add_step(
        {id: free_id("part"), do: "segment", scan: first_scan(), window: window_text, seeds_mm: [[...seed]]},
        "segment by click");
    return true;
  },
};

export const arch_tool: Tool = {
  name: "arch",
  title: "Dental arch",
  says:
      "In an axial slice click along the arch from the patient's right to the left; Enter shows the panoramic slice.",
  key: "",
  cursor: "crosshair",
  is_for_any_scan: true,
  is_pointed: true,
  taken() {
    set({arch_mm: []});
    show_in(2, "axial");
  },
  down({pane, at}) {
    const point = place_at(pane, at);
    if (!point) return true;
    set({arch_mm: [...state.arch_mm, point]});
    pane.redraw();
    return true;
  },
  press(event) {
    if (event.key !== "Enter" || state.arch_mm.length < 2) return false;
    show_panoramic();
    return true;
  },
  draw(pane, context) {
    const points = state.arch_mm.map((p) => pane.pixel_at(p));
    line(context, points, ink.landmark, 2 * pane.ratio);
    for (const p of points) dot_at(context, p, 3.5 * pane.ratio, ink.landmark);
  },
  panel: () => button(
      "Show panoramic slice", "Shows the curved slice along the points in the fourth pane",
      () => {
        if (state.arch_mm.length < 2) return notify("Click at least two points along the arch.", "warning");
        show_panoramic();
      },
      {class: "primary"}),
};

function show_panoramic(): void {
  show_in(3, "panoramic");
  take_tool("navigate");
}

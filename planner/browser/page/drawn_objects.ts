// SPDX-License-Identifier: AGPL-3.0-or-later
// Which objects of the plan are drawn, in what colour: by default the pieces at their final places, and their
// interference.
import {DrawnObject, Step} from "./protocol";
import {makes_body, makes_shape, moves_object, operands} from "./operations";
import {bone_low, is_elsewhere, shown_scan, state, steps} from "./state";

const bone = ["#ede3cc", "#d9c7a0", "#cfd3d6"];
const moved = ["#e08a3c", "#3fa7a0", "#a678de", "#d0649b", "#7fae3e"];
export const mask_colour = "#5b9dff";
export const overlap_colour = "#e5484d";
// Colours of the difference between a dragged piece and another object: the part only in the piece, the part
// only in the other object, and the common part.
export const only_moved_colour = "#e08a3c";
export const only_other_colour = "#5b9dff";
export const common_colour = "#cfd3d6";
/// Whether a step displaces its object, rigidly or by a warp.
const is_displaced = (step: Step): boolean => moves_object(step) || step.do === "warp";
const is_union = (step: Step): boolean =>
    step.do === "combine" && typeof step.expression === "string" && !/[&^~-]/.test(step.expression);

/// Whether a step is the overlap of pieces, which is drawn in red. It is an intersection, and one of its
/// operands has been moved or a union of the plan joins all of them, such as a graft and the bone.
export function is_overlap(step: Step, all: Step[]): boolean {
  if (step.do !== "combine" || typeof step.expression !== "string" || !/^[\w\s&|()]*&[\w\s&|()]*$/.test(step.expression))
    return false;
  const pieces = operands(step);
  if (all.some((other) => is_union(other) && pieces.every((name) => operands(other).includes(name)))) return true;
  return !step.expression.includes("|") &&
      pieces.some((name) => all.some((other) => other.id === name && is_displaced(other)));
}

/// Whether a step is an intersection without unions and differences, usually an object's part inside a mask.
/// Such a piece has its own colour even before a step moves it.
export const is_piece = (step: Step): boolean => step.do === "combine" &&
    typeof step.expression === "string" && /^[^|^~-]*&[^|^~-]*$/.test(step.expression);

/// Whether a step is a piece that a later union leaves out, because the piece is removed or only measured.
function is_left_out(step: Step, all: Step[]): boolean {
  return is_piece(step) && !is_overlap(step, all) &&
      all.slice(all.indexOf(step)).some((later) => is_union(later) && !operands(later).includes(step.id));
}

function is_used_up(id: string, all: Step[]): boolean {
  return all.some((step) => {
    if (step.id === id) return is_left_out(step, all);
    if (!operands(step).includes(id)) return false;
    if (step.do === "combine") return !is_union(step) && !is_overlap(step, all);
    return makes_shape(step) && step.do !== "mirror" && step.object === id;
  });
}

export interface Shown {
  colour: string;
  opacity: number;
  visible: boolean;
}

/// How an object is drawn: as the person has set it, else by the kind of its step.
export function look_of(id: string): Shown {
  const all = steps();
  const index = all.findIndex((step) => step.id === id);
  const step = all[index];
  const look = state.looks[id] ?? {};
  let usual: Shown = {colour: bone[0]!, opacity: 1, visible: false};
  if (step) {
    const earlier = all.slice(0, index);
    const number = Math.max(
        earlier.filter(is_displaced).length,
        is_piece(step) ? earlier.filter((other) => is_piece(other) && !is_left_out(other, all)).length : 0);
    const visible = !is_used_up(id, all);
    if (makes_shape(step) && !makes_body(step))
      usual = {colour: mask_colour, opacity: 0.35, visible};
    else if (is_overlap(step, all))
      usual = {colour: overlap_colour, opacity: 1, visible};
    else if (is_displaced(step))
      usual = {colour: moved[number % moved.length]!, opacity: 1, visible};
    else if (step.do === "mirror")
      usual = {colour: "#8fb8de", opacity: 1, visible: false};
    else if (is_piece(step))
      usual = {colour: moved[number % moved.length]!, opacity: 1, visible};
    else
      usual = {colour: is_union(step) ? bone[2]! : bone[0]!, opacity: 1, visible: visible && !is_union(step)};
  }
  return {
    colour: look.colour ?? usual.colour,
    opacity: look.opacity ?? usual.opacity,
    visible: look.visible ?? (usual.visible && !all.some((other) => other.id === look.behind)),
  };
}

/// The ids of the plan's objects, in the order of its steps.
export const object_ids = (): string[] => steps().filter(makes_shape).map((step) => step.id);

/// The objects that panes request. For a scan that lies in its own frame of reference, that is its bone;
/// otherwise the objects of the plan.
export function drawn_objects(): DrawnObject[] {
  if (!is_elsewhere()) return objects_of_plan();
  return [{window: {scan: shown_scan(), low: bone_low(shown_scan()), alone: true}, colour: bone[0]!, opacity: 1}];
}

/// The plan's visible objects, and the window that the person is setting.
export function objects_of_plan(): DrawnObject[] {
  const drawn: DrawnObject[] = [];
  const failed =
      new Set((state.plan?.objects ?? []).filter((object) => object.error).map((object) => object.id));
  for (const id of object_ids()) {
    const look = look_of(id);
    if (state.draft_window?.replaces === id) continue;
    if (look.visible && look.opacity > 0 && !failed.has(id))
      drawn.push({id, colour: look.colour, opacity: look.opacity});
  }
  if (state.draft_window) {
    const {replaces, ...window} = state.draft_window;
    drawn.push({window, colour: replaces ? look_of(replaces).colour : bone[0]!, opacity: 1});
  }
  return drawn;
}

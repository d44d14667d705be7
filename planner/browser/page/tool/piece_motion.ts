// SPDX-License-Identifier: AGPL-3.0-or-later
// The piece that moves: its object, its present motion, the preview of another motion, and the step that
// stores it.
import {add_steps, free_id, replace_step} from "../actions";
import {directions, lps, motion_words} from "../base/anatomical";
import {is_overlap, look_of} from "../drawn_objects";
import {makes_body} from "../operations";
import {mark_mm} from "../pane/overlay";
import {Json, Motion, Step} from "../protocol";
import {selected_step, set, shows_one_pane, state, steps, watch} from "../state";
import {add, scaled, Vec3} from "../base/vector";

/// The piece that the tool moves: the object of the selected move, or the selected object. `step` is its
/// move, if the plan has one. Null if no body is selected.
export function piece(): {source: string; step: Step | undefined}|null {
  const step = selected_step();
  if (!step || !makes_body(step)) return null;
  if (step.do === "move" && typeof step.object === "string") return {source: step.object, step};
  const moved = steps().find((one) => one.do === "move" && one.object === step.id);
  return moved ? {source: step.id, step: moved} : {source: step.id, step: undefined};
}

const motion_of = (step: Step|undefined): Motion =>
    step?.points ? {points: step.points as unknown as Motion["points"]} : ({
      by: {...((step?.by as Motion["by"]) ?? {})},
      ...(step?.turn ? {turn: {...(step.turn as unknown as NonNullable<Motion["turn"]>)}} : {}),
    });
/// The motion of the piece: that of its preview, if there is one, else that of its step.
export function current(): Motion {
  const one = piece(), {preview} = state;
  return preview?.move && preview.of === one?.source ? preview.move : motion_of(one?.step);
}

/// The position of a piece's handles in mm: the centre of its rotation, after the motion.
export function pivot_mm(source: string, move: Motion): Vec3 {
  const about = mark_mm(move.turn?.about_mm as Json | undefined) ?? centre_of(source);
  return directions.reduce<Vec3>((p, word) => add(p, scaled(lps[word], move.by?.[word] ?? 0)), about);
}
export function centre_of(id: string): Vec3 {
  const bounds = state.plan?.objects.find((object) => object.id === id)?.bounds_mm;
  return bounds ? scaled(add(bounds[0], bounds[1]), 0.5) : state.cross_mm;
}

/// Visible objects that stay in place. Their overlap with the piece is shown.
function others(source: string, moved: string|undefined): string[] {
  return steps()
      .filter((step) => makes_body(step) && step.id !== source && step.id !== moved)
      .filter((step) => look_of(step.id).visible && !is_overlap(step, steps()) && step.object !== source)
      .map((step) => step.id);
}

export function preview_motion(move: Motion): void {
  const one = piece();
  if (!one) return;
  const object = one.step?.id ?? `${one.source}_moved`;
  const to = difference_to();
  shown_at = place_in_plan();
  set({
    preview: {
      object: one.step?.id ?? one.source,
      of: one.source,
      move,
      against: others(one.source, object),
      ...(to ? {difference: to} : {})
    }
  });
}

/// Bodies with which the moving piece can be compared: the plan's other bodies, and the piece before its
/// motion.
export function difference_choices(): string[] {
  const one = piece();
  return steps()
      .filter((step) => makes_body(step) && step.id !== one?.step?.id && !is_overlap(step, steps()))
      .map((step) => step.id);
}
/// The object with which the piece is compared. Null if none is chosen, or if the plan no longer contains it.
export const difference_to = (): string|null =>
    difference_choices().find((id) => id === state.difference_to) ?? null;

// Edit and selection for which the difference was drawn. If either changes, the difference is removed.
let shown_at = "";
const place_in_plan = (): string => `${state.plan?.edit} ${state.selected}`;
watch(["plan", "selected"], () => {
  if (state.preview?.move && state.preview.difference && place_in_plan() !== shown_at)
    set({preview: null, difference: null});
});
// A motion that was typed and not taken over ends with another piece, or when an undo takes its piece out of the plan.
watch(["plan", "selected"], () => {
  const {preview} = state;
  if (preview?.move && preview.of !== piece()?.source && !shows_one_pane) set({preview: null, overlap_mm3: null, difference: null});
});

/// Chooses the object with which the piece is compared, and shows the difference at the piece's present
/// position. Null ends the comparison.
export function show_difference(to: string|null): void {
  set({difference_to: to, difference: null, overlap_mm3: null});
  if (to) preview_motion(current());
  else if (state.preview?.move) set({preview: null});
}

export async function commit_motion(move: Motion): Promise<void> {
  const one = piece();
  if (!one) return;
  const fields = move.points ? {points: move.points as unknown as Json} : {
    by: clean(move.by ?? {}),
    ...(move.turn ? {turn: {...clean(move.turn as {[f: string]: Json}), about_mm: move.turn.about_mm}} : {})
  };
  const what = `${one.source}: ${motion_words(move)}`;
  if (one.step) {
    const {by: _by, turn: _turn, points: _points, ...kept} = one.step;
    await replace_step(one.step.id, {...kept, ...fields} as Step, what);
  } else {
    const id = free_id(`${one.source}_moved`);
    const stays = others(one.source, id);
    const more: Step[] = [{id, do: "move", object: one.source, ...fields} as Step];
    // Adds the overlap with the objects that stay and, as the last step, the union of all, which is the
    // planned result.
    if (stays.length)
      more.push(
          {
            id: free_id("overlap"),
            do: "combine",
            expression: stays.length > 1 ? `(${stays.join(" | ")}) & ${id}` : `${stays[0]} & ${id}`
          },
          {id: free_id("planned"), do: "combine", expression: `${stays.join(" | ")} | ${id}`});
    await add_steps(more, what);
    set({selected: id});
  }
  set({preview: null, overlap_mm3: null, difference: null});
  if (difference_to()) preview_motion(current());
}
const clean = (values: {[field: string]: Json|undefined}): {[field: string]: Json} =>
    Object.fromEntries(Object.entries(values).filter(
        ([, value]) => typeof value === "number" && value !== 0)) as {[field: string]: Json};

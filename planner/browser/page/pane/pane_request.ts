// SPDX-License-Identifier: AGPL-3.0-or-later
// A pane's requests for pictures, and everything else that its pictures depend on.
import {drawn_objects, is_overlap} from "../drawn_objects";
import {makes_shape} from "../operations";
import type {Pane} from "./panes";
import {DrawnObject, PaneRequest} from "../protocol";
import {is_elsewhere, PaneSetting, shown_scan, state, step_of, steps} from "../state";
import {dark_ground, is_dark} from "../base/theme";
import {directions_of} from "../base/view_frame";

const sheet_height_mm = 70;
const most_sample = 32767;
/// Angle between two eyes 65 mm apart that look at a point 0.6 m away.
const between_eyes_deg = 6;

export function request_of(pane: Pane, dragging: boolean): PaneRequest {
  const setting = pane.setting;
  const objects = drawn_objects();
  const shown =
      setting.only && !is_elsewhere() ? objects.filter((object) => object.id === setting.only) : objects;
  const request: PaneRequest = {
    pane: pane.index,
    kind: pane.is_slice ? "slice" : "view",
    centre_mm: setting.centre_mm,
    size: pane.size,
    pixel_mm: setting.pixel_mm / pane.ratio,
    objects: shown,
    dragging,
  };
  if (pane.is_slice)
    add_slice(request, setting);
  else
    add_view(request, setting);
  if (state.preview && !is_elsewhere()) {
    // Steps are tried in coarse voxels while a slider is dragged, if the plan has many voxels.
    request.preview = dragging && state.preview.steps ? {...state.preview, coarse: true} : state.preview;
    if (state.preview.move && !state.preview.difference) request.overlap = true;
    request.objects = shown.filter((object) => !object.id || !is_interference(object.id));
  }
  // The tried object may lie inside the other objects, so these are drawn half transparent.
  if (!pane.is_slice && request.preview?.by && request.preview.by !== "step") request.objects = request.objects.map(seen_through);
  if (pane.is_slice) request.objects = request.objects.map(hatched_where_interfering);
  if (!pane.is_slice && !is_elsewhere() && !state.compare && has_interference(request))
    request.objects = request.objects.map(seen_through);
  return request;
}

/// Whether drawn pieces overlap. An overlap lies inside bone, so opaque bone would hide it. False while a
/// piece is dragged, because drawing translucent surfaces is too slow then.
function has_interference({preview, objects, dragging}: PaneRequest): boolean {
  if (preview?.move && preview.difference) return false;
  if (preview) return !dragging && (state.overlap_mm3 ?? 0) > 0;
  return objects.some(({id}) => id !== undefined && is_interference(id) && volume_of(id) > 0);
}
const volume_of = (id: string): number => state.plan?.objects.find((one) => one.id === id)?.volume?.value ?? 0;

/// Opacity of objects that could hide an overlap. A click still picks surfaces of this opacity.
const see_through = 0.5;
const seen_through = (object: DrawnObject): DrawnObject => object.id !== undefined && is_interference(object.id) ?
    object :
    {...object, opacity: Math.min(object.opacity, see_through)};

const hatched_where_interfering = (object: DrawnObject): DrawnObject =>
    object.id !== undefined && is_interference(object.id) ? {...object, hatched: true} : object;

function add_view(request: PaneRequest, setting: PaneSetting): void {
  request.view = setting.view;
  if (is_dark()) request.background = dark_ground;
  if (setting.shading === "stereo")
    request.stereo_deg = between_eyes_deg;
  else if (setting.shading !== "partial_volume")
    request.shading = setting.shading;
  const cut = state.cut_plane;
  if (cut) {
    const normal: [number, number, number] = [0, 0, 0];
    normal[cut.axis] = cut.side;
    request.cut_planes = [[...normal, cut.offset_mm * cut.side]];
    request.cut_face = "grey";
  }
  if (state.compare && !is_elsewhere()) request.colour_by = state.compare;
}

function add_slice(request: PaneRequest, setting: PaneSetting): void {
  request.scan = shown_scan();
  request.window = state.grey;
  request.at_mm = state.cross_mm;
  const {look, up} = directions_of(setting.tilt);
  request.plane = setting.mode === "panoramic" && state.arch_mm.length > 1 ?
      {curve_mm: state.arch_mm, height_mm: sheet_height_mm} :
      setting.plane === "oblique" ? {normal: look, up} :
                                    setting.plane;
  if (state.draft_window)
    request.threshold = [state.draft_window.low, state.draft_window.high ?? most_sample];
}

/// Whether an object is an overlap of pieces. Previews leave it out, because it was computed for the pieces'
/// earlier positions.
function is_interference(id: string): boolean {
  const step = step_of(id);
  return step !== undefined && is_overlap(step, steps());
}

/// A text that changes when the plan's objects may look different. A pane requests a new picture if this or
/// its own settings have changed.
export const shapes = (): string => JSON.stringify([
  state.plan?.path, state.evaluations,
  steps().filter((step) => makes_shape(step) || step.do === "head_position")
]);

/// Whether an object to be drawn is not evaluated yet. The pane shows its earlier picture in the meantime.
export function is_pending(): boolean {
  const pending = new Set((state.plan?.objects ?? [])
                              .filter((object) => object.evaluated === false && !object.error)
                              .map((object) => object.id));
  return drawn_objects().some((object) => object.id !== undefined && pending.has(object.id));
}

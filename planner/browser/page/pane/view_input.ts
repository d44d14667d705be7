// SPDX-License-Identifier: AGPL-3.0-or-later
// Pointer, pen, touch, wheel and keys in a pane. The chosen tool handles them first, then turning, panning,
// zooming, slices and the cross-hair.
import {mirror_from, MirrorDrag} from "./mirror_plane";
import {tilt_from} from "./oblique";
import type {Pane} from "./panes";
import {change_pane} from "./panes";
import {set, shown_scan, shows_one_pane, state} from "../state";
import {Pointer, Tool, active_tool} from "../tool/tool";
import {Vec2, Vec3, add, dot, hundredths, scaled} from "../base/vector";
import {turned} from "../base/view_frame";

const turn_deg_per_px = 0.45;
const click_px = 4;
const coarse_px = 12, fine_px = 1;
const arrows:
    {[key: string]: Vec2} = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};

type Drag = "turn"|"pan"|"zoom"|"grey"|"cross"|"tilt"|"mirror"|"tool";

export function attach_input(pane: Pane, all: () => Pane[], pointed: (pane: Pane, at: Vec2) => void): void {
  const canvas = pane.canvas;
  const fingers = new Map<number, Vec2>();
  let drag: Drag|null = null;
  let last: Vec2 = [0, 0];
  let start: Vec2 = [0, 0];
  let has_moved = false;
  let pinch = 0;
  let tilt: ((to: Vec2) => void)|null = null;
  let mirror: MirrorDrag|null = null;

  const at_of = (event: PointerEvent|WheelEvent|MouseEvent): Vec2 => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) * pane.ratio, (event.clientY - box.top) * pane.ratio];
  };
  const pointer = (event: PointerEvent): Pointer => ({pane, at: at_of(event)});
  const want_slices = (): void => {
    for (const other of all())
      if (other.is_slice) other.want(true);
  };
  const redraw_all = (): void => {
    for (const other of all()) other.redraw();
  };
  const want_oblique = (): void => {
    for (const other of all()) {
      if (other.is_oblique) other.want(true);
      other.redraw();
    }
  };
  const put_cross = (at: Vec2): void => {
    set({cross_mm: hundredths(pane.point_at(at))});
    want_slices();
  };

  /// Stores where the fingers are now, as the start of the next motion.
  function hold_fingers(): void {
    last = middle(fingers);
    pinch = spread(fingers);
  }
  /// Pans by the motion of the middle between two fingers, and zooms by the change of their distance.
  function pinch_to(): void {
    const from = last, before = pinch;
    hold_fingers();
    if (before && pinch) pane.zoom(before / pinch, last);
    pane.pan([last[0] - from[0], last[1] - from[1]]);
  }

  function drag_of(event: PointerEvent): Drag {
    if (event.button === 1 || event.shiftKey) return "pan";
    if (event.button === 2) return pane.is_slice ? "grey" : "pan";
    if (event.ctrlKey || event.metaKey) return "zoom";
    return pane.is_slice ? "cross" : "turn";
  }

  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({preventScroll: true});
    canvas.setPointerCapture(event.pointerId);
    set({active_pane: pane.index});
    fingers.set(event.pointerId, at_of(event));
    last = start = at_of(event);
    has_moved = false;
    if (fingers.size > 1) {
      // The second finger begins a pinch, so the action of the first finger is undone.
      const tool = active_tool();
      if (drag === "tool" && tool?.cancel)
        tool.cancel();
      else if (drag === "tool")
        tool?.up?.(pointer(event));
      mirror?.cancel();
      drag = "pan";
      return hold_fingers();
    }
    const is_plain = event.button === 0 && !event.shiftKey && !event.ctrlKey && !event.metaKey;
    tilt = is_plain ? tilt_from(pane, last) : null;
    mirror = is_plain && !tilt ? mirror_from(pane, last) : null;
    drag = tilt ? "tilt" : mirror ? "mirror" : is_plain && active_tool()?.down?.(pointer(event)) ? "tool" : drag_of(event);
    if (drag === "cross") put_cross(last);
  });

  canvas.addEventListener("pointermove", (event) => {
    const at = at_of(event);
    pane.keyed_at = null;
    pointed(pane, at);
    if (!drag) return active_tool()?.hover?.(pointer(event));
    if (fingers.has(event.pointerId)) fingers.set(event.pointerId, at);
    if (Math.hypot(at[0] - start[0], at[1] - start[1]) > click_px * pane.ratio) has_moved = true;
    if (drag === "tool") return active_tool()?.move?.(pointer(event));
    if (fingers.size > 1) return pinch_to();
    const by: Vec2 = [at[0] - last[0], at[1] - last[1]];
    last = at;
    if (drag === "turn" && has_moved) turn(pane, by[0] / pane.ratio, by[1] / pane.ratio);
    if (drag === "pan") pane.pan(by);
    if (drag === "zoom") pane.zoom(Math.exp(by[1] * 0.006), start);
    if (drag === "cross") put_cross(at);
    if (drag === "tilt") {
      tilt?.(at);
      want_oblique();
    }
    if (drag === "mirror" && has_moved) {
      mirror?.to(at);
      redraw_all();
    }
    if (drag === "grey") {
      const width = Math.max(1, state.grey[1] + (by[0] / pane.ratio) * 8);
      set({grey: [Math.round(state.grey[0] - (by[1] / pane.ratio) * 5), Math.round(width)]});
      want_slices();
    }
  });

  const ended = (event: PointerEvent): void => {
    if (!fingers.delete(event.pointerId)) return;
    if (drag === "tool")
      active_tool()?.up?.(pointer(event));
    else if (drag === "mirror")
      mirror?.done();
    else if (drag === "turn" && !has_moved)
      click(at_of(event));
    if (fingers.size)
      hold_fingers();
    else
      drag = null;
  };
  // A dialog that opens during a drag takes the pointer capture away. The drag ends then, too.
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"] as const)
    canvas.addEventListener(end, ended);

  // A click in a view moves the cross-hair to the surface and selects the object's step.
  function click(at: Vec2): void {
    const picked = pane.pick(at);
    if (!picked) return;
    set({cross_mm: hundredths(picked.point), ...(picked.object ? {selected: picked.object} : {})});
    want_slices();
  }

  canvas.addEventListener("dblclick", (event) => {
    const tool = active_tool();
    if (tool?.double?.({pane, at: at_of(event)})) return;
    if (state.tool === "navigate" && !shows_one_pane) set({maximised: state.maximised === null ? pane.index : null});
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        if (pane.is_slice && !event.ctrlKey)
          step_slice(pane, event.deltaY > 0 ? 1 : -1, want_slices);
        else
          pane.zoom(Math.exp(event.deltaY * 0.0012), at_of(event));
      },
      {passive: false},
  );

  // Moves a position over the pane by arrow keys and clicks it by Space, for a tool that works on positions.
  // Returns whether it used the key.
  function point_by_key(event: KeyboardEvent, tool: Tool): boolean {
    const arrow = arrows[event.key];
    const at = pane.keyed_at ?? [pane.size[0] / 2, pane.size[1] / 2];
    if (arrow) {
      const by = (event.shiftKey ? fine_px : coarse_px) * pane.ratio;
      pane.keyed_at = [0, 1].map((axis) => Math.max(0, Math.min(pane.size[axis]!, at[axis]! + by * arrow[axis]!))) as Vec2;
      pointed(pane, pane.keyed_at);
      tool.hover?.({pane, at: pane.keyed_at});
    } else if (event.key === " ") {
      pane.keyed_at = at;
      if (tool.down?.({pane, at})) tool.up?.({pane, at});
    } else
      return false;
    pane.redraw();
    return true;
  }

  canvas.addEventListener("focus", () => {
    if (state.active_pane !== pane.index) set({active_pane: pane.index});
  });
  canvas.addEventListener("keydown", (event) => {
    const tool = active_tool();
    if (tool?.press?.(event, pane)) return event.preventDefault();
    if (tool?.is_pointed && !event.ctrlKey && !event.metaKey && point_by_key(event, tool))
      return event.preventDefault();
    const step = event.shiftKey ? 15 : 5;
    const arrow = arrows[event.key];
    if (arrow && pane.is_slice && arrow[1])
      step_slice(pane, arrow[1] * (event.shiftKey ? 5 : 1), want_slices);
    else if (arrow && pane.is_oblique) {
      const {azimuth, elevation} = pane.setting.tilt;
      change_pane(pane.index, {
        tilt: event.shiftKey ? {azimuth, elevation: within(elevation + 5 * arrow[0])} :
                               {azimuth: round_about(azimuth + 5 * arrow[0]), elevation}
      });
      want_oblique();
    } else if (arrow && !pane.is_slice)
      turn(pane, (arrow[0] * step) / turn_deg_per_px, (arrow[1] * step) / turn_deg_per_px);
    else if (event.key === "+" || event.key === "=")
      pane.zoom(1 / 1.15, [pane.size[0] / 2, pane.size[1] / 2]);
    else if (event.key === "-")
      pane.zoom(1.15, [pane.size[0] / 2, pane.size[1] / 2]);
    else if (event.key === "PageUp")
      step_slice(pane, -1, want_slices);
    else if (event.key === "PageDown")
      step_slice(pane, 1, want_slices);
    else
      return;
    event.preventDefault();
  });
}

function spread(fingers: Map<number, Vec2>): number {
  const [a, b] = [...fingers.values()];
  return a && b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
}

/// The middle between the first two fingers. With one finger, its position.
function middle(fingers: Map<number, Vec2>): Vec2 {
  const places = [...fingers.values()];
  const a = places[0] ?? [0, 0];
  const b = places[1] ?? a;
  return [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
}

const round_about = (azimuth: number): number => ((((azimuth + 180) % 360) + 360) % 360) - 180;
const within = (elevation: number): number => Math.max(-90, Math.min(90, elevation));

/// Rotates a view by a pointer's motion in CSS pixels, so that the surface follows the pointer.
export function turn(pane: Pane, by_x: number, by_y: number): void {
  const from = turned(pane.setting.view);
  const azimuth = round_about(from.azimuth - by_x * turn_deg_per_px);
  const elevation = within(from.elevation + by_y * turn_deg_per_px);
  const tenth = (value: number): number => Math.round(value * 10) / 10;
  change_pane(pane.index, {view: {azimuth: tenth(azimuth), elevation: tenth(elevation)}});
  pane.want(true);
}

/// Moves the cross-hair by a number of slices of the scan along the view direction.
function step_slice(pane: Pane, by: number, want_slices: () => void): void {
  const spacing = state.plan?.scans.find((scan) => scan.name === shown_scan())?.spacing_mm ?? [1, 1, 1];
  const look = pane.frame.look;
  const step = Math.max(0.2, Math.abs(dot(spacing as Vec3, look.map(Math.abs) as Vec3)));
  set({cross_mm: hundredths(add(state.cross_mm, scaled(look, by * step)))});
  want_slices();
}

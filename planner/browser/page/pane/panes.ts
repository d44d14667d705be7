// SPDX-License-Identifier: AGPL-3.0-or-later
// A pane: a 2D canvas that shows the newest picture of the server, requests the next, and picks by the depth
// and object planes of the picture at rest. At most two requests are pending; the newest setting wins.
import {ask} from "../actions";
import {drawn_objects} from "../drawn_objects";
import {el} from "../base/html";
import {draw_overlay} from "./overlay";
import {is_pending, request_of, shapes} from "./pane_request";
import {Planes, planes_of} from "./picture_planes";
import {FrameHeader, PaneRequest} from "../protocol";
import {PaneSetting, set, State, state} from "../state";
import {dark_ground, is_dark} from "../base/theme";
import {add, dot, scaled, sub, Vec2, Vec3} from "../base/vector";
import {directions_of, pixel_of, point_of, uv_of, view_of_plane, ViewFrame} from "../base/view_frame";
import {Refusal} from "../wire";

const most_in_flight = 2;
const rest_after_ms = 140;
const slow_after_ms = 500;

/// Number of the newest request whose answer stated volumes of the dragged piece.
let newest_volumes = 0;

interface Picture {
  header: FrameHeader;
  bitmap: ImageBitmap;
  planes: Planes|null;  // only of a picture at rest; null before they have arrived
}

export class Pane {
  readonly canvas = el("canvas", {tabindex: 0, role: "img"});
  picture: Picture|null = null;
  problem = "";
  keyed_at: Vec2|null = null;  // position that arrow keys move for a tool that works on positions
  private is_wanted = false;
  private in_flight = 0;
  private rest_timer = 0;
  private newest_decoded = 0;
  private is_sized = false;
  private waiting_since = 0;
  private last_asked = "";
  private is_dirty = false;
  private readonly sent = new Map<number, number>();
  private readonly previews = new Map<number, State["preview"]>();  // of pending requests

  constructor(readonly index: number, private readonly acknowledge: (pane: number, frame: number) => void) {
    new ResizeObserver(() => this.resized()).observe(this.canvas);
  }

  get setting(): PaneSetting {
    return state.panes[this.index]!;
  }
  /// Canvas pixels per CSS pixel.
  get ratio(): number {
    return Math.min(2, window.devicePixelRatio || 1);
  }
  get size(): Vec2 {
    return [this.canvas.width, this.canvas.height];
  }
  /// Whether the pane waits for a picture, or for the planes of the shown one.
  get is_busy(): boolean {
    return this.is_wanted || this.in_flight > 0 || this.lacks_planes;
  }
  /// Whether positions in the pane can be converted to points. That is impossible in a view while its picture
  /// moves or its planes have not arrived.
  get has_places(): boolean {
    return this.is_slice || !this.picture || (this.picture.header.quality === "rest" && !this.lacks_planes);
  }
  // Whether the picture is at rest and its planes have not arrived yet.
  private get lacks_planes(): boolean {
    return this.picture?.header.quality === "rest" && this.picture.planes === null;
  }
  /// Whether a picture takes so long that the page shows a message.
  get is_slow(): boolean {
    return this.in_flight > 0 && performance.now() - this.waiting_since > slow_after_ms;
  }
  get is_slice(): boolean {
    return this.setting.mode !== "view";
  }
  /// Whether the background is white: for views of surfaces on a light page. Slices, radiographs and largest
  /// samples have a black one.
  get is_on_white(): boolean {
    return !this.is_slice && !is_dark() && !["radiograph", "mip"].includes(this.setting.shading);
  }
  get is_oblique(): boolean {
    return this.setting.mode === "slice" && this.setting.plane === "oblique";
  }

  /// The frame of the pane's present setting. Uses the directions of the shown picture if they are similar,
  /// because the server rotates them with a repositioned head.
  get frame(): ViewFrame {
    const setting = this.setting;
    const own = this.picture?.header.view_frame;
    const wanted = directions_of(this.is_slice ? view_of_plane(setting.plane, setting.tilt) : setting.view);
    const turned_little = own && dot(own.look, wanted.look) > 0.7 && this.picture_is_of(setting);
    return {
      ...(turned_little ? {right: own.right, up: own.up, look: own.look} : wanted),
      centre_mm: setting.mode === "panoramic" && own ? own.centre_mm : setting.centre_mm,
      pixel_mm: setting.mode === "panoramic" && own ? own.pixel_mm / this.fit(this.picture!.header) :
                                                      setting.pixel_mm / this.ratio,
    };
  }
  private picture_is_of(setting: PaneSetting): boolean {
    return typeof setting.view === "string" || this.is_slice || this.is_dragging === false;
  }
  private is_dragging = false;

  /// Adapts the canvas to its size in the page. A pane that becomes visible again sends its postponed
  /// request.
  resized(): void {
    const width = Math.round(this.canvas.clientWidth * this.ratio);
    const height = Math.round(this.canvas.clientHeight * this.ratio);
    if (!width || !height) return;
    if (width === this.canvas.width && height === this.canvas.height) return this.pump();
    // A pane that changes its size continues to show the same part of the scene.
    const before = this.is_sized ? Math.min(this.canvas.width, this.canvas.height) : Math.min(width, height);
    this.is_sized = true;
    const scale = before / Math.min(width, height);
    this.canvas.width = width;
    this.canvas.height = height;
    if (state.plan && scale !== 1) change_pane(this.index, {pixel_mm: this.setting.pixel_mm * scale});
    this.want(false);
    this.redraw_now();
  }

  /// Requests a picture of the present setting. While dragging, the picture is coarse, and a picture at rest
  /// follows when the requests have ceased for rest_after_ms.
  want(dragging: boolean): void {
    this.is_wanted = true;
    this.is_dragging = dragging;
    window.clearTimeout(this.rest_timer);
    if (dragging) this.rest_timer = window.setTimeout(() => this.want(false), rest_after_ms);
    this.pump();
    this.redraw();
  }

  private pump(): void {
    if (!this.is_wanted || this.in_flight >= (this.is_dragging ? most_in_flight : 1) ||
        state.link !== "open" || !state.plan)
      return;
    if (!this.canvas.clientWidth || !this.canvas.width) return;
    if (!this.is_slice && drawn_objects().length === 0 && !state.preview) {
      this.is_wanted = false;
      this.forget();
      this.problem = "";
      return this.redraw();
    }
    if (!this.is_slice && is_pending()) return;
    this.is_wanted = false;
    const started = performance.now();
    const fields = request_of(this, this.is_dragging);
    const asked = JSON.stringify(fields) + shapes();
    if (asked === this.last_asked) return;
    this.last_asked = asked;
    if (!this.in_flight++) {
      this.waiting_since = started;
      window.setTimeout(() => this.redraw(), slow_after_ms + 20);
    }
    const {preview} = state;
    ask_picture(fields, (id) => {
      this.sent.set(id, started);
      if (preview) this.previews.set(id, preview);
    }).catch((error: unknown) => {
      this.in_flight = Math.max(0, this.in_flight - 1);
      this.last_asked = "";
      if (error instanceof Refusal && error.code !== "cancelled" && error.code !== "lost") {
        // The panel of a preview shows why the server refused it. The pane keeps its picture.
        if (preview?.steps && is_same(state.preview, preview))
          set({tried: {mm3: 0, voxels: 0, refusal: refusal_text(error.message)}});
        else
          this.problem = error.message;
      }
      this.pump();
      this.redraw();
    });
  }

  /// Forgets the requests that were pending when the connection broke, and requests a new picture.
  reconnected(): void {
    this.in_flight = 0;
    this.last_asked = "";
    this.sent.clear();
    this.previews.clear();
    this.newest_decoded = 0;
    newest_volumes = 0;
    this.want(false);
  }

  async take(header: FrameHeader, parts: Uint8Array[]): Promise<void> {
    this.in_flight = Math.max(0, this.in_flight - 1);
    const started = this.sent.get(header.id);
    this.sent.delete(header.id);
    const preview = this.previews.get(header.id);
    this.previews.delete(header.id);
    this.pump();
    this.redraw();
    const image = header.parts.findIndex((part) => part.kind === "jpeg" || part.kind === "png");
    const type = header.parts[image]?.kind === "png" ? "image/png" : "image/jpeg";
    const bitmap = await createImageBitmap(new Blob([parts[image]!], {type}));
    this.acknowledge(this.index, header.id);
    if (header.id < this.newest_decoded) return bitmap.close();
    this.newest_decoded = header.id;
    this.picture?.bitmap.close();
    const picture: Picture = {header, bitmap, planes: null};
    this.picture = picture;
    this.problem = "";
    this.redraw_now();
    const latency_ms = started === undefined ? null : performance.now() - started;
    this.canvas.dispatchEvent(
        new CustomEvent("picture", {bubbles: true, detail: {latency_ms, quality: header.quality}}));
    this.take_volumes(header);
    if (header.preview && is_same(state.preview, preview)) set({tried: {...header.preview, is_coarse: header.quality !== "rest", refusal: ""}});
    if (header.quality !== "rest") return;
    picture.planes = await planes_of(header, parts);
    this.redraw();
  }

  /// Shows the volumes that a picture states of the dragged piece, unless the answer to a later request is
  /// already shown.
  private take_volumes({id, overlap_mm3, difference}: FrameHeader): void {
    if (!state.preview || (overlap_mm3 === undefined && !difference) || id < newest_volumes) return;
    newest_volumes = id;
    if (overlap_mm3 !== undefined) set({overlap_mm3});
    if (difference && state.preview.move && difference.to === state.preview.difference) set({difference});
  }

  /// The point at a canvas position, and the object whose surface it is on. Null where a view shows no
  /// surface or is not at rest. In a slice the object is null.
  pick(at: Vec2): {point: Vec3; object: string | null}|null {
    const frame = this.frame;
    if (this.is_slice)
      return {point: point_of(frame, this.size, at, dot(state.cross_mm, frame.look)), object: null};
    const {header, planes} = this.picture ?? {};
    if (!header || header.quality !== "rest") return null;
    const pixel = this.picture_pixel(header, at);
    const depth = planes?.depth?.[pixel.index];
    if (depth === undefined || Number.isNaN(depth)) return null;
    const number = planes?.object?.[pixel.index] ?? 0;
    const point =
        point_of(header.view_frame, [header.width, header.height], [pixel.x + 0.5, pixel.y + 0.5], depth);
    return {point, object: number ? header.objects?.[number - 1] ?? null : null};
  }
  /// Whether a view at rest shows no surface at a position. Always false in slices and in pictures without
  /// depths, such as radiographs.
  is_beside(at: Vec2): boolean {
    const {header, planes} = this.picture ?? {};
    if (this.is_slice || !header || header.quality !== "rest" || !planes?.depth) return false;
    return Number.isNaN(planes.depth[this.picture_pixel(header, at).index] ?? Number.NaN);
  }
  private picture_pixel(header: FrameHeader, at: Vec2): {x: number; y: number; index: number} {
    const x = Math.floor((at[0] * header.width) / this.canvas.width);
    const y = Math.floor((at[1] * header.height) / this.canvas.height);
    return {x, y, index: y * header.width + x};
  }

  /// The scan's sample at a position of a slice at rest. Null outside of the scan and while the slice moves.
  value_at(at: Vec2): number|null {
    const {header, planes} = this.picture ?? {};
    const value = header && planes?.value?.[this.picture_pixel(header, at).index];
    return value === undefined || Number.isNaN(value) ? null : value;
  }

  /// Discards the picture, so that the pane does not show it under a new setting.
  forget(): void {
    this.last_asked = "";
    this.picture?.bitmap.close();
    this.picture = null;
  }

  /// The point at a position. Where a view shows no surface, this is the point at the depth of the
  /// cross-hair.
  point_at(at: Vec2): Vec3 {
    const frame = this.frame;
    return this.pick(at)?.point ?? point_of(frame, this.size, at, dot(state.cross_mm, frame.look));
  }
  uv_at = (at: Vec2): Vec2 => uv_of(this.frame, this.size, at);
  pixel_at = (p_mm: Vec3): Vec2 => pixel_of(this.frame, this.size, p_mm);

  redraw(): void {
    if (this.is_dirty) return;
    this.is_dirty = true;
    requestAnimationFrame(() => {
      if (this.is_dirty) this.redraw_now();
    });
  }

  private redraw_now(): void {
    this.is_dirty = false;
    this.canvas.setAttribute("aria-busy", String(this.is_busy));
    this.canvas.dataset.picture = this.picture ? String(this.picture.header.id) : "";
    const context = this.canvas.getContext("2d", {alpha: false});
    if (!context) return;
    const [width, height] = this.size;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.is_slice ? "#000" : is_dark() ? dark_ground : "#fff";
    context.fillRect(0, 0, width, height);
    if (this.picture) this.draw_picture(context, this.picture);
    draw_overlay(this, context);
  }

  // The scale at which the whole picture fits into the canvas.
  private fit({width, height}: FrameHeader): number {
    return Math.min(this.canvas.width / width, this.canvas.height / height);
  }

  // Draws the newest picture, moved and scaled to the present setting, so that panning and zooming need not
  // wait for a new picture.
  private draw_picture(context: CanvasRenderingContext2D, picture: Picture): void {
    const shown = picture.header.view_frame;
    const frame = this.frame;
    const scale = shown.pixel_mm / frame.pixel_mm;
    const offset = sub(shown.centre_mm, frame.centre_mm);
    const turned = dot(shown.look, frame.look) < 0.999 || this.setting.mode === "panoramic";
    const x = turned ? 0 : dot(offset, frame.right) / frame.pixel_mm;
    const y = turned ? 0 : -dot(offset, frame.up) / frame.pixel_mm;
    const stretch = turned ? this.fit(picture.header) : scale;
    const width = picture.header.width * stretch;
    const height = picture.header.height * stretch;
    context.imageSmoothingEnabled = Math.abs(width - picture.bitmap.width) > 1;
    const left = (this.canvas.width - width) / 2 + x;
    const top = (this.canvas.height - height) / 2 + y;
    const near = (value: number): number =>
        (Math.abs(value - Math.round(value)) < 0.02 ? Math.round(value) : value);
    context.drawImage(picture.bitmap, near(left), near(top), near(width), near(height));
  }

  /// Moves the picture by canvas pixels.
  pan(by: Vec2): void {
    const frame = this.frame;
    const moved = add(scaled(frame.right, -by[0] * frame.pixel_mm), scaled(frame.up, by[1] * frame.pixel_mm));
    change_pane(this.index, {centre_mm: add(this.setting.centre_mm, moved)});
    this.want(true);
  }

  /// Multiplies the size of a pixel by `factor`. The point at the position `at` stays there.
  zoom(factor: number, at: Vec2): void {
    const frame = this.frame;
    const pixel_mm = Math.max(0.02, Math.min(4, this.setting.pixel_mm * factor));
    const rest = 1 - pixel_mm / this.setting.pixel_mm;
    const x = (at[0] - this.canvas.width / 2) * frame.pixel_mm * rest;
    const y = (at[1] - this.canvas.height / 2) * frame.pixel_mm * rest;
    const centre_mm = add(this.setting.centre_mm, sub(scaled(frame.right, x), scaled(frame.up, y)));
    change_pane(this.index, {centre_mm, pixel_mm});
    this.want(true);
  }
}

/// Whether the page still shows the preview for which a request was sent.
const is_same = (now: State["preview"], then: State["preview"]|undefined): boolean =>
    now !== null && JSON.stringify(now) === JSON.stringify(then);
/// The message of a refusal without the temporary name of the step that was tried.
export const refusal_text = (message: string): string => message.replace(/^step 'dragged_piece'(\.\w+)?: /, "");

export function change_pane(index: number, change: Partial<PaneSetting>): void {
  set({panes: state.panes.map((pane, number) => (number === index ? {...pane, ...change} : pane))});
}

let picture_asker: ((fields: PaneRequest, on_id: (id: number) => void) => Promise<unknown>)|null = null;
/// Sets the function that requests pictures. The function must pass the request's id to `on_id` before the
/// answer arrives.
export function use_picture_asker(asker: typeof picture_asker): void {
  picture_asker = asker;
}
const ask_picture = (fields: PaneRequest, on_id: (id: number) => void): Promise<unknown> =>
    picture_asker ? picture_asker(fields, on_id) : ask("pane", fields);

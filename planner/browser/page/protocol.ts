// SPDX-License-Identifier: AGPL-3.0-or-later
// The messages between the planner's server and its page.
import {Vec3} from "./base/vector";
import {View, ViewFrame} from "./base/view_frame";

export type Json = null|boolean|number|string|Json[]|{[key: string]: Json};
export interface Step {
  id: string;
  do: string;
  [field: string]: Json;
}

export interface Certificate {
  verdict: "PASS"|"WARN"|"FAIL";
  sentence: string;
  place?: Vec3|null;
  resolved?: boolean;
}
export interface Measured {
  value: number|null;  // null if there is no result yet
  unit: string;
  half_width?: number|null;
  coverage?: number;
}
export interface AuditRow {
  check?: string;
  verdict: "PASS"|"WARN"|"FAIL";
  sentence: string;
}
export interface ScanState {
  name: string;
  path: string;
  audit: AuditRow[];
  dims?: Vec3;
  spacing_mm?: Vec3;
  bounds_mm: [Vec3, Vec3];
  range?: [number, number];
  unit?: string;
  window_suggestion?: [number, number]|null;
  bone_low?: number|null;  // lower bound of bone in this scan's samples
  patient?: Patient|null;  // null: the scan states none
}
/// A patient as a scan states it. Attributes that the scan does not state are null.
export interface Patient {
  name: string|null;
  number: string|null;
  issuer: string|null;
  birth_date: string|null;
  sex: string|null;
  study_date: string|null;
}
/// The plane about which an object was mirrored. If the step states the plane, the values of the fit are
/// null.
export interface MirrorPlane {
  plane: {point_mm: Vec3; normal: Vec3};
  rms_mm: number|null;
  kept_share: number|null;
  converged: boolean|null;
}
/// A thin neck by which a part is connected in only one kernel. `kept`: both kernels keep the part. Otherwise
/// they differ, and the plan should decide.
export interface Neck {
  at_mm: Vec3;
  volume_mm3: number|null;  // of the part beyond the neck
  kept: boolean;
}
export interface ObjectState {
  id: string;
  kind: string;
  colour?: string;
  evaluated?: boolean;
  bounds_mm?: [Vec3, Vec3]|null;
  error?: string|null;
  findings?: string[];
  mirror?: MirrorPlane;
  certificate?: Certificate|null;
  necks?: Neck[];  // once certified
  volume?: Measured|null;
  area?: Measured|null;
}
export interface Measurement extends Measured {
  id: string;
  says?: string;
  sentence?: string;
  details?: {[key: string]: Json};  // as in a result's `measurements`
}
export interface HistoryEdit {
  id: number;
  parent: number|null;
  what: string;
  made_at: string;
  names: string[];
}
export interface Job {
  id: number;
  what: string;
  share: number;
  left_s?: number|null;
}
export interface PlanDocument {
  name?: string;
  scans?: {[name: string]: {path: string}};
  universe?: {voxel_mm?: number};
  steps: Step[];
}
export interface PlanState {
  path: string;
  name: string;
  dirty?: boolean;
  branch: string;
  edit: number;
  can_undo: boolean;
  can_redo: boolean;
  history: HistoryEdit[];
  branches: [string, number][];
  plan: PlanDocument;
  scans: ScanState[];
  objects: ObjectState[];
  universe?: {voxel_mm: number}|null;
  landmarks: {name: string; point: Vec3}[];
  measurements?: Measurement[];
  jobs?: Job[];
}
/// A landmark proposed by a rule, which no person has confirmed.
export interface LandmarkGuess {
  name: string;
  says: string;
  point_mm: Vec3;
  uncertainty_mm: number;
}
export interface ProcedureValue {
  name: string;
  unit: string;
  default: number;
  says: string;
  low: number;
  high: number;
}
export interface ProcedureSays {
  name: string;
  says: string;
  landmarks: {name: string; says: string; scan?: string}[];
  scans: {name: string; says: string}[];
  values: ProcedureValue[];
  options: {name: string; says: string; values: ProcedureValue[]}[];  // optional further steps
}
export interface Tissue {
  name: string;
  low?: number|null;
  high?: number|null;
  says?: string;
}
export interface Schema {
  description?: string;
  type?: string|string[];
  title?: string;
  properties?: {[field: string]: Schema};
  required?: string[];
  items?: Schema|{anyOf: Schema[]};
  oneOf?: Schema[];
  enum?: string[];
  const ?: string;
  default?: Json;
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  minItems?: number;
  maxItems?: number;
  examples?: Step[];
  "x-unit"?: string;
  "x-makes"?: "object"|"tool"|"scan"|"measurement"|"file"|"names";
  "x-moves"?: string;  // the field whose object it moves
  "x-names"?: "object";
}
export interface Hello {
  version: string;
  may_edit: boolean;    // false: this window only shows the plan
  view_token?: string;  // the token of windows that only show the plan; absent if the server has none
  plan_state: PlanState|null;
  schema: Schema;
  procedures: ProcedureSays[];
  tissues: Tissue[];
  folders: string[];
  most_upload_bytes?: number;
}

/// A point of a piece and the point to which it is to move.
export type MarkPair = {
  at: Vec3; to: Vec3
};
export interface Motion {
  by?: {forward_mm?: number; left_mm?: number; up_mm?: number};
  turn?: {pitch_deg?: number; yaw_deg?: number; roll_deg?: number; about_mm: Vec3 | string};
  points?: MarkPair[];
  [field: string]: Json|undefined;
}
export interface DrawnObject {
  id?: string;
  window?: {scan: string; low: number; high?: number; alone?: boolean};
  colour: string;
  opacity: number;
  hatched?: boolean;  // a slice hatches the inside of this object
}
export interface PaneRequest {
  pane: number;
  kind: "view"|"slice";
  view?: View;
  plane?: string|{
    normal: Vec3;
    up: Vec3
  }
  |{
    curve_mm: Vec3[];
    height_mm: number
  };
  at_mm?: Vec3;
  centre_mm: Vec3;
  size: [number, number];
  pixel_mm: number;
  scan?: string;
  window?: [number, number];
  threshold?: [number, number];
  objects: DrawnObject[];
  preview?: {object: string; of: string; move: Motion; against: string[]; difference?: string; steps?: undefined; by?: undefined}|
      {object: string; steps: Step[]; move?: undefined; coarse?: boolean; colour?: string; by?: "grow"|"draft"|"step"};
  overlap?: boolean;
  colour_by?: {object: string; reference: string; range_mm: number; mutual?: boolean};
  cut_planes?: [number, number, number, number][];
  cut_face?: "plain"|"grey";
  shading?: string;
  stereo_deg?: number;  // angle between the two eyes of a picture for red and cyan glasses
  background?: string;
  dragging: boolean;
}
/// A dragged piece compared with the object `to`: the volume that only the piece contains, that only the
/// other object contains, and that both contain.
export interface Difference {
  to: string;
  only_moved_mm3: number;
  only_other_mm3: number;
  common_mm3: number;
}
export interface FrameHeader {
  id: number;
  pane: number;
  quality: "moving"|"rest";
  width: number;
  height: number;
  view_frame: ViewFrame;
  objects?: string[];
  command?: string;
  legend?: {low_mm: number; high_mm: number; colours: string[]; definition: string};
  overlap_mm3?: number|null;
  preview?: {mm3: number; voxels: number; findings?: string[]};  // volume of the previewed object
  difference?: Difference;
  parts: {kind: "jpeg"|"png"|"depth"|"object"|"value"; bytes: number}[];
}
export interface Notice {
  message: string;
  level: "info"|"warning"|"error";
  act?: {label: string; run(): void};  // a button with an action that solves the problem
}

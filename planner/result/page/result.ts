// SPDX-License-Identifier: AGPL-3.0-or-later
// The members of `result.json` that pages read, and those that the program adds for a page. The C++ side:
// members_of() of the measured values in `planner/operation`, `planner/result/report/result_record.h` and
// `report_page.cpp`.
import {AuditRow, PlanDocument} from "../../browser/page/protocol";
import {Vec2, Vec3} from "../../browser/page/base/vector";

export type Verdict = AuditRow["verdict"];
export type Maybe<Type> = Type|null;
export interface Finding { check: string; verdict: Verdict; detail: string }
export interface Interval { value: number; half_width: Maybe<number> }
export interface Counts {
  PASS: number; WARN: number; FAIL: number; not_resolved: number; pass_not_resolved: number; without_certificate: number;
  measured?: {PASS: number; WARN: number; FAIL: number};  // verdicts of measurements; only in reports
}

export interface Scan {
  name: string; path: string; made_by?: string; modality: string; dims: Vec3; spacing_mm: Vec3; range: [number, number];
  unit: string; sha256: string; audit: Finding[];
}
export interface KernelAnswer { lineage: string; volume_mm3: Maybe<number> }
export interface Certificate {
  object?: string; operation: string; tier: string; verdict: Verdict; resolved: boolean; not_resolved_because: Maybe<string>;
  reasons: string[]; findings?: string[]; shared_makers: string[]; shared_values: string[];
  voxel: KernelAnswer; mesh: KernelAnswer; difference_mm3: Maybe<number>; tolerance_mm3: Maybe<number>;
  terms: {cause: string; formula: string; value_mm3: Maybe<number>}[];
  symmetric_difference_mm3: Maybe<number>; symmetric_difference_tolerance_mm3: Maybe<number>;
  centroid_distance_mm: Maybe<number>; centroid_tolerance_mm: Maybe<number>; hausdorff95_mm: Maybe<number>;
  detection_limit: Maybe<{volume_mm3: Maybe<number>; shift_mm: Maybe<number>}>;
  comparisons: {quantity: string; difference: Maybe<number>; tolerance: Maybe<number>; verdict: Maybe<Verdict>}[];
}

export interface Displacement { forward_mm: number; up_mm: number; left_mm: number }
export interface Movement {
  object: string; words: string; centroid: Maybe<Displacement>;
  landmarks: (Displacement&{name: string; words: string; since_scan?: {words: string}})[];
  points?: (Displacement&{name: string; wanted: string; residual_mm: number})[];
}
type Cephalometric = Maybe<{value: number; half_width: number}>;
export interface CephalometryTable {
  landmark_deviation_mm: number; not_predicted?: {name: string; landmarks: string[]}[];
  measures: {
    name: string; says: string; unit: string; before: Cephalometric; after: Cephalometric; change: Cephalometric;
    norm: Maybe<number>; deviation: Maybe<number>; source: string; norm_of?: string;
  }[];
  lacking?: {name: string; landmarks: string[]}[];
}

export interface Contact {
  at_mm: Vec3; nearest_mm: number; voxel_nearest_mm: Maybe<number>; depth_mm: number; area_mm2: Maybe<number>;
  half_width_mm: number;
}
export interface Section {
  along_mm: number; at_mm: Vec3; area_mm2: number; half_width_mm2: number; voxel_mm2: number; mesh_mm2: Maybe<number>;
}
export interface Airway {
  volume_mm3: number; volume_half_width_mm3: number; volume_mesh_mm3: Maybe<number>; length_mm: number; narrowest: Section;
  sections: Section[];
}
interface DonorCut { at_mm: number; tilt_deg: number }
export interface FlapSegment {
  number: number; object: string; length_mm: number; shortest_mm: number; longest_mm: number;
  angle_to_last_deg: Maybe<number>; first_cut: DonorCut; second_cut: DonorCut;
}
export interface Osteotomy {
  number: number; object: string; between: string[]; contact_voxels_mm2: number; contact_mesh_mm2: Maybe<number>;
  tolerance_mm2: Maybe<number>; verdict: Maybe<string>; finding?: string;
}
/// The difference between two predictions of the same skin.
export interface FaceDifference {
  skin: string; mean_mm: number; largest_mm: number; largest_at_mm: Vec3; area_mm2: number; definition: string;
  landmarks: {name: string; at_mm: Vec3; a_moved_mm: Vec3; b_moved_mm: Vec3; difference_mm: number}[];
}
/// A landmark of a landmark_ratios step, in the details of its object.
export interface RatioLandmark extends Displacement {
  name: string; follows: string; at_mm: Vec3; ratio: Maybe<number>; ratio_up: Maybe<number>; source: string;
  half_width_mm: Maybe<number>;
}
export interface DoubtfulNumber {
  what: string; of: string; value: number; unit: string; half_width: number; sources: {name: string; half_width: number}[];
}
/// Distances from the points of one surface to another surface.
export interface OneWay {
  mean_mm: number; p95_mm: number; max_mm: number; signed_mean_mm: number;
  bands: {tolerance_mm: number; share_within: number}[];
}
/// A measurement. Its kind is that of the first optional member in this list that it has.
export interface Measurement {
  id: string; object: string; to: string; finding?: string; findings?: string[];
  volume_mm3?: number; voxel: {area_mm2: Maybe<number>}; mesh: Maybe<{volume_mm3: number}>; area_mm2: Maybe<number>;
  difference_mm3: Maybe<number>; difference_percent: Maybe<number>; volume?: Interval; area?: Interval;
  gap_mm?: Maybe<number>; gap_mesh_mm: Maybe<number>; gap_half_width_mm: Maybe<number>; overlap_mm3: Maybe<number>;
  distance_mm?: number; distance_half_width_mm: Maybe<number>;
  angle_deg?: number; angle_half_width_deg: Maybe<number>;
  contacts?: Contact[]; against: string; within_mm: number; certain_count: Maybe<number>; nearest_mm: Maybe<number>;
  airway?: Airway; verdict?: Maybe<Verdict>;
  flap_segments?: FlapSegment[]; osteotomies: Osteotomy[]; donor_used_mm: number; contact_estimator: string;
  missing?: {name: string; why: string}[];
  landmarks: {name: string; says: string; point_mm: Vec3; uncertainty_mm: number}[];
  mean_mm?: Maybe<number>; a: string; b: string;
  hausdorff_mm?: number; hausdorff95_mm?: number; rms_mm?: number; dice?: Maybe<number>; dice_half_width?: Maybe<number>;
  face?: FaceDifference; a_to_b?: OneWay; b_to_a?: OneWay; histogram?: {low_mm: number; width_mm: number; shares: number[]};
  doubts?: DoubtfulNumber[]; trials: number; errors: {[error: string]: number};
}

export interface Result {
  octotomy: string; timings_ms: {[stage: string]: number}; plan: PlanDocument; universe: {side: number; voxel_mm: Vec3};
  scans: Scan[]; objects: {
    id: string; kind: string; definition: string; mesh: Maybe<object>; findings: string[];
    details?: {fade_mm?: number; landmarks?: RatioLandmark[]};
  }[];
  components: {object: string; count: number; volumes_mm3: number[]}[];
  exports: {object: string; path: string; written: boolean; bytes?: number; findings: string[]}[];
  movements: Movement[]; movement_words: string; cephalometry: Maybe<CephalometryTable>;
  signatures: {by: string; as: string; at: string; note: string; changed_since: string[]}[];
  measurements: Measurement[]; certificates: Certificate[]; findings: Finding[];
}

export interface Picture {
  view: string; right: Vec3; up: Vec3; centre_mm: Vec2; width_mm: number; size_px: number; png: string;
  outlines_mm: Vec2[][];  // outlines of the plan's regions that belong to this view
}
export interface PictureGroup {
  name: string; title: string; objects: {name: string; colour: string}[]; pictures: Picture[]; marks_mm: Vec3[];
  most_mm: number|null;  // distance at the ends of the colour scale; null: colours identify objects
  colours: string[];  // of the colour scale, from inside to outside
}
export interface Report {
  kind: "report"; result: Result; patients: string[]; counts: Counts; pictures: PictureGroup[];
  cephalogram: string;  // PNG in base64; empty if there is none
  contents: string[];   // words on each exported file, for readers
  plan_text: string;    // text of the plan as its author wrote it
}

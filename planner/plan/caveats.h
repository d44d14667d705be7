// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/object.h"
#include "planner/operation/table/operation.h"
#include "verify/certificate/necks.h"

// Reasons why an object's certificate cannot be a PASS even if both kernels agree: samples that were not
// measured, parts that left the universe, and caveats of the objects from which it was made.
namespace octotomy::planner {

/// The inputs from which an object was made.
struct MadeOf {
  const Action& action;
  const Objects& objects;                  ///< all earlier objects
  const Scans& scan;                       ///< access to the scans that the action uses
  const std::vector<ScanRecord>& records;  ///< records of all scans so far
};

/// Adds caveats and findings to an object: gaps between images that it reaches into; samples of its scans
/// that were not finite numbers; for an object with voxels only, the part that a motion moved out of the
/// universe; and the caveats of the objects from which it was made. A FAIL if samples that are not finite lie
/// between samples of the object's own windows, because a part is missing there, or if a part lies outside;
/// the operands' caveats are a WARN. A moved object does not inherit that a part of its operand lies outside,
/// because it has a position of its own. If the scan's border cuts the object off, adds a finding.
/// Precondition: both kernels have answered and the object's bound is set. Cost: one pass over a scan that
/// has such samples.
void add_caveats(const MadeOf& from, Object& made);

/// Copies, into the audit of a scan made from others, their findings on samples that were not finite numbers,
/// unless it has such a finding.
void keep_unmeasured(const Action& action, const std::vector<ScanRecord>& records, ScanRecord& made);

/// Adds a finding with the parts that stay in an object because only one kernel joins them by a thin neck,
/// except for those in `open`; a WARN if they exceed a twentieth of the object. Also lists their positions in
/// the details.
void add_kept_parts(std::vector<verify::OpenPart> kept, const std::vector<verify::OpenPart>& open,
                    Object& made);

/// Adds a finding, and a FAIL with the volume, if a part of an object lies outside the universe, a box in LPS
/// millimetres. Tools and objects made only of masks are exempt, because they normally end there.
/// Preconditions: the mesh's `whole` reaches out of the box, and `within` is the part inside, if the mesh
/// kernel could cut it.
void add_part_outside(const voxel::Box& universe_mm, Object& made);

}  // namespace octotomy::planner

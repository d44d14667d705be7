// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/object.h"
#include "planner/operation/table/operation.h"
#include "verify/certificate/necks.h"

// Reasons why an object's certificate cannot be a PASS even if both kernels agree: samples that were not
// measured, parts outside of the universe, and caveats of the objects from which it was made.
namespace octotomy::planner {

/// The inputs of an object: its action, and the objects and scans that the action may use.
struct MadeOf {
  const Action& action;
  const Objects& objects;                  ///< all earlier objects
  const Scans& scan;                       ///< returns the scan of a name, for those that the action uses
  const std::vector<ScanRecord>& records;  ///< records of all scans that were read or made so far
};

/// Adds caveats and findings to an object. A FAIL: samples that are not finite, or more than a small share of
/// padding, lie between samples of the object's windows, so that a part is missing; or a part of a moved
/// object lies outside of the universe and it has no mesh (for others see add_part_outside()). A WARN: the
/// object extends into gaps between images; its scans have other samples that are not finite, or other
/// padding that the object encloses; an object from which it was made has a caveat. A moved object does not
/// inherit that a part of its operand lies outside of the universe, because it has another position. Also
/// adds a finding if the scan's border cuts the object off. Precondition: both kernels have answered, and the
/// object's bound is set. Cost: one pass over each scan that has samples that are not finite.
void add_caveats(const MadeOf& from, Object& made);

/// Copies the finding on samples that are not finite from the audits of the scans from which a scan was made
/// to the audit of that scan, unless it has such a finding itself.
void keep_unmeasured(const Action& action, const std::vector<ScanRecord>& records, ScanRecord& made);

/// Adds a finding on parts that stay in an object because one kernel connects them by a thin neck, and the
/// places of the necks to its details. Parts in `open` are left out. Adds a WARN if the parts have more than
/// a twentieth of the object's volume.
void add_kept_parts(std::vector<verify::OpenPart> kept, const std::vector<verify::OpenPart>& open,
                    Object& made);

/// If a part of an object lies outside of the universe, a box in LPS millimetres, adds a finding, and a FAIL
/// with the part's volume. Leaves out tools and objects of masks alone, because these normally extend beyond
/// the universe. Preconditions: the mesh `whole` extends beyond the box, and `within` is its part inside,
/// unless the mesh kernel could not cut it.
void add_part_outside(const voxel::Box& universe_mm, Object& made);

}  // namespace octotomy::planner

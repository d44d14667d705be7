// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/object.h"
#include "planner/operation/table/operation.h"
#include "verify/certificate/necks.h"

// What forbids an object's certificate a PASS however well both kernels agree: samples that nobody measured,
// parts that left the universe, and doubts about the objects that it was made of.
namespace octotomy::planner {

/// What an object was made of.
struct MadeOf {
  const Action& action;
  const Objects& objects;                  ///< all earlier ones
  const Scans& scan;                       ///< of the scans that the action uses
  const std::vector<ScanRecord>& records;  ///< of all scans so far
};

/// Adds to an object's caveats and findings the gaps between images that it reaches into, samples of its
/// scans that were no finite numbers, what a motion brought out of the universe of an object that has voxels
/// alone, and the caveats of the objects that it was made of. A FAIL where such samples lie between samples
/// of the object's own windows, because a part is missing there, and where one lies outside; the operands'
/// caveats are a WARN. That a part of an operand lies outside is none of an image's, which has its own
/// place. Where the scan's border cuts the object off is a finding. Precondition: both kernels have answered
/// and the object's bound is known. Cost: where a scan has such samples one walk over it.
void add_caveats(const MadeOf& from, Object& made);

/// Adds to the audit of a scan that an action made of others what theirs say of samples that were no finite
/// numbers, unless it says so itself.
void keep_unmeasured(const Action& action, const std::vector<ScanRecord>& records, ScanRecord& made);

/// Adds a finding with the parts that stay in an object because one kernel joins them by a thin neck, but for
/// those that are still open; a WARN where they are over a twentieth of it. Their places are details, too.
void add_kept_parts(std::vector<verify::OpenPart> kept, const std::vector<verify::OpenPart>& open,
                    Object& made);

/// Adds a finding, and a FAIL with the volume, where a part of an object lies outside of the universe, a box
/// in LPS millimetres. Tools and objects of masks alone end there by their nature. Preconditions: the mesh's
/// `whole` reaches out of the box, and `within` is the rest of it, if the mesh kernel could cut it.
void add_part_outside(const voxel::Box& universe_mm, Object& made);

}  // namespace octotomy::planner

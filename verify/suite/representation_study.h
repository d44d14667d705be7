// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "verify/suite/thesis_tables.h"

namespace octotomy::verify {

/// A row of a printed table that depends on an unpublished scan of a patient, beside the same row for the
/// head phantom. The two need not agree.
struct ThesisComparison {
  std::string where;    ///< "table A.2"
  std::string item;     ///< "level 8, visits per node"
  std::string printed;  ///< columns as printed, separated by blanks
  std::string ours;
};

struct RepresentationStudy {
  /// Relations that hold for any object: face codes, the order of algorithms by cost, and bounds of theorem
  /// 3.1.
  std::vector<ThesisEntry> entries;
  std::vector<ThesisComparison> beside;
};

/// Repeats the thesis's study of representations (chapters 3 to 5, 7, appendix A) on the head phantom: 256
/// voxels a side, 64 grey levels of which the upper 44 are bone. Costs are counted in visits to nodes; the
/// thesis also prints seconds on two computers of 1989. Deterministic. Cost: about ten seconds of processor
/// time, half of it for the phantom.
RepresentationStudy representation_study();

}  // namespace octotomy::verify

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "verify/suite/thesis_tables.h"

namespace octotomy::verify {

/// A row of a printed table that depends on an unpublished scan of a patient, and the same row for the head
/// phantom. The two are shown side by side and need not agree.
struct ThesisComparison {
  std::string where;    ///< "table A.2"
  std::string item;     ///< "level 8, visits per node"
  std::string printed;  ///< as printed, columns separated by blanks
  std::string ours;
};

struct RepresentationStudy {
  /// Relations that hold for any object: face codes, orders of algorithms by their cost, bounds of theorem
  /// 3.1.
  std::vector<ThesisEntry> entries;
  std::vector<ThesisComparison> beside;
};

/// The thesis's study of representations (chapters 3 to 5, 7, appendix A) on the head phantom: 256 voxels a
/// side, 64 grey levels of which the upper 44 are bone. Costs are counted in visits to nodes; the thesis also
/// prints seconds of two computers of 1989. Deterministic. Cost: about ten seconds of processor time, half of
/// it for the phantom.
RepresentationStudy representation_study();

}  // namespace octotomy::verify

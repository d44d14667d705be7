// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include "voxel/scan/dicom_series.h"

namespace octotomy::voxel {

/// The position of a lattice in a stack of slices, and the source slices of each of its slices.
struct SlicePlan {
  /// Two slices of the stack, interpolated linearly; below == above: a copy.
  struct Source {
    std::size_t below = 0;
    std::size_t above = 0;
    double share_above = 0.0;
  };
  std::vector<Source> sources;  ///< sources of each slice of the lattice
  double step_mm = 1.0;
  double low_mm = 0.0;               ///< height of the lattice's first slice above the stack's first
  bool leans = false;                ///< slices are shifted sideways against each other
  std::vector<glm::dvec2> aside_px;  ///< sideways shift of each slice of the stack, from `origin_px`; empty:
                                     ///< none is shifted
  glm::dvec2 origin_px{0.0};         ///< in pixels of the first slice, whose own place may be noisy
  glm::ivec2 low_px{0};              ///< first pixel of the lattice, from `origin_px`
  glm::ivec2 size_px{0};
  std::vector<Hole> holes;
  std::size_t slice_count = 0;  ///< of the stack

  /// Whether slice k of the lattice is slice k of the stack, for all k.
  bool is_copy() const;
};

/// The lattice of a plan.
Lattice lattice_of(const DicomStack& stack, const SlicePlan& plan);

/// Length without measured slices, in mm, from which the audit fails: half the height of the floor of an
/// orbit or of the crown of a lower canine, which could otherwise be missing completely.
constexpr double longest_unmeasured_mm() {
  return 5.0;
}

/// Some scanners write positions with two decimals, so that the difference of two positions errs by up to
/// 0.01 mm. A shift of a hundredth of the step changes samples by less than interpolation would.
inline double position_tolerance_mm(double step_mm) {
  return std::max(0.01, 0.01 * step_mm);
}

/// Lays a lattice through an ordered stack. Its step is the finest distance that at least a fifth of the
/// neighbours have. Slices whose positions scatter around an even distance, by up to a tenth of it or by the
/// rounding of the positions' decimals, are copied: the error is in the tags, not in the scan. So are slices
/// that scatter sideways by up to half a pixel. A gap of more than one and a half steps is a hole, unless at
/// least three such gaps follow each other and the slices are numbered without a break: then the protocol has
/// two distances. Findings: slice_spacing, missing_slices, gantry_tilt, sideways. Throws Error (Input) if the
/// lattice would have more than four times as many slices as the stack, or a slice lies beside the others.
SlicePlan slice_plan(const DicomStack& stack, const std::filesystem::path& path, std::vector<Finding>& audit);

}  // namespace octotomy::voxel

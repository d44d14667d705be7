// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include "voxel/scan/dicom_series.h"

namespace octotomy::voxel {

/// A lattice laid through a stack of slices: its position, and for each of its slices the slices of the stack
/// from which samples come.
struct SlicePlan {
  /// Two slices of the stack between which a slice of the lattice is interpolated linearly; if below ==
  /// above, it is a copy.
  struct Source {
    std::size_t below = 0;
    std::size_t above = 0;
    double share_above = 0.0;
  };
  std::vector<Source> sources;  ///< one for each slice of the lattice
  double step_mm = 1.0;
  double low_mm = 0.0;  ///< height of the lattice's first slice above the stack's first
  bool leans = false;   ///< the stack's slices are shifted sideways against each other
  /// Sideways shift of each slice of the stack, counted from `origin_px`; empty if no slice is shifted.
  std::vector<glm::dvec2> aside_px;
  /// Reference for sideways shifts, in pixels of the first slice; not always 0, because that slice's position
  /// may be noisy.
  glm::dvec2 origin_px{0.0};
  glm::ivec2 low_px{0};  ///< first pixel of the lattice, counted from `origin_px`
  glm::ivec2 size_px{0};
  std::vector<Hole> holes;
  std::size_t slice_count = 0;  ///< number of slices of the stack

  /// Whether slice k of the lattice is slice k of the stack, for all k.
  bool is_copy() const;
};

/// The lattice that a plan describes, in LPS.
Lattice lattice_of(const DicomStack& stack, const SlicePlan& plan);

/// The audit fails if at least this length, in mm, has no measured slices: half the height of the floor of an
/// orbit or of the crown of a lower canine, which could otherwise be missing completely.
constexpr double longest_unmeasured_mm() {
  return 5.0;
}

/// The tolerance for differences of positions, in mm. Some scanners write positions with two decimals, so
/// that differences are wrong by up to 0.01 mm. A shift by a hundredth of the step changes samples less than
/// interpolation does.
inline double position_tolerance_mm(double step_mm) {
  return std::max(0.01, 0.01 * step_mm);
}

/// Lays a lattice through an ordered stack. Its step is the least distance that occurs in at least a fifth of
/// the gaps between neighbours. Slices whose positions scatter around an even distance, by up to a tenth of
/// it or by the rounding of the positions' decimals, are copied, because the error is in the stated
/// positions, not in the scan. Slices that scatter sideways by up to half a pixel are copied too. A gap of
/// more than one and a half steps is a hole, unless at least three such gaps follow each other and the slices
/// are numbered consecutively; the protocol then has two distances. Findings: slice_spacing, missing_slices,
/// gantry_tilt, sideways. Throws Error (Input) if the lattice would have more than four times as many slices
/// as the stack, or if a slice lies too far to the side of the others.
SlicePlan slice_plan(const DicomStack& stack, const std::filesystem::path& path, std::vector<Finding>& audit);

}  // namespace octotomy::voxel

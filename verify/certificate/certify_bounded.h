// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "brep/mesh/solid.h"
#include "verify/certificate/certificate.h"
#include "verify/witness/reading.h"
#include "voxel/measure/measure.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// Inputs of the bound in addition to the two objects.
struct BoundInputs {
  std::string operation;
  std::string voxel_lineage;
  std::string mesh_lineage;
  std::optional<voxel::Measures> voxel_measures = {};  ///< of the octree; none: measured here
  glm::dvec3 scan_spacing_mm{1.0};                     ///< of the samples that the isosurface was made from
  /// Area of flat cuts by direction of their normal (x, y, z). Only cuts along the universe's planes count.
  glm::dvec3 flat_cut_mm2{0.0};
  /// The box that the scan's voxels fill, if the solid may end with the scan.
  std::optional<voxel::Box> scan_box_mm = {};
  /// The mean distance between the surfaces of two right answers, because each kernel measures distances by itself
  /// (offset_allowance_mm()). If it is above 0, totals fail beyond twice their tolerance even with a witness, because
  /// the witness of such an object is coarser than the totals.
  double measured_apart_mm = 0.0;
  /// Every voxel's centre is a sample, and the object is one window of these samples. All other samples lie
  /// below the window, or all above it. Then topology must agree too.
  bool voxels_are_samples = false;
  /// The right answer is the empty set, as for a - a. Two empty answers then pass.
  bool is_surely_empty = false;
  /// Judges the places at which the answers differ, and measures the object along lines. The witness must end
  /// with the universe, as both answers do. Without a witness, totals and distances decide.
  Witness witness = {};
};

/// Compares an octree with a solid that other code computed (tier Bounded). The source derives the terms of
/// the tolerance. A solid with Proof::Connection may be inside out or meet itself; the comparison reports
/// that. Throws as convert::voxelise(); voxel::Stopped. Cost: about as much as computing both objects.
Certificate certify_bounded(const voxel::Octree& octree, const brep::Solid& solid, const BoundInputs& inputs,
                            const voxel::Progress& progress = {});

}  // namespace octotomy::verify

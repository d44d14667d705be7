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

/// What certify_bounded() needs in addition to the two objects.
struct BoundInputs {
  std::string operation;
  std::string voxel_lineage;
  std::string mesh_lineage;
  std::optional<voxel::Measures> voxel_measures = {};  ///< of the octree; none: computed by certify_bounded()
  glm::dvec3 scan_spacing_mm{1.0};                     ///< of the samples from which the isosurface was made
  /// Area of flat cuts, by the axis (x, y, z) of their normal. Only cuts along the universe's planes count.
  glm::dvec3 flat_cut_mm2{0.0};
  /// The box that the scan's voxels fill. Set if the solid may end at the scan's border.
  std::optional<voxel::Box> scan_box_mm = {};
  /// Mean distance between the surfaces of two right answers where each kernel computes distances by code of
  /// its own, as for an offset (offset_allowance_mm()). Above 0, totals beyond twice their tolerance fail
  /// even with a witness, because the witness of such an object is less precise than the totals.
  double measured_apart_mm = 0.0;
  /// Every voxel's centre is a sample, and the object is one window of these samples. The other samples lie
  /// either all below the window or all above it. Then topology must agree, too.
  bool voxels_are_samples = false;
  /// The right answer is the empty set, as for a - a. Two empty answers then pass.
  bool is_surely_empty = false;
  /// Judges the places at which the answers differ, and measures the object along lines. The witness must end
  /// with the universe, as both answers do. If it is empty, totals and distances alone decide.
  Witness witness = {};
};

/// Compares an octree with a solid that other code computed (tier Bounded). The source derives the terms of
/// the tolerance. A solid with Proof::Connection may be inside out or meet itself; the comparison reports
/// that. Throws as convert::voxelise(); voxel::Stopped. Cost: about as much as computing both objects.
Certificate certify_bounded(const voxel::Octree& octree, const brep::Solid& solid, const BoundInputs& inputs,
                            const voxel::Progress& progress = {});

}  // namespace octotomy::verify

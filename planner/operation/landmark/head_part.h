// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "brep/mesh/mesh.h"
#include "voxel/space/progress.h"
#include "voxel/view/drawn_object.h"

namespace octotomy::planner {

/// The patient's bone, separated from other dense objects in the scan.
struct HeadPart {
  voxel::Octree bone;
  /// The centre of the space that the skull surrounds, LPS; none if the space is too small for a brain case.
  std::optional<glm::dvec3> cavity_mm;
  std::size_t removed_count = 0;  ///< number of parts that do not belong to the patient
  double removed_mm3 = 0.0;

  /// The triangles within about 2 mm of this bone.
  brep::Mesh surface_of(const brep::Mesh& surface) const;

  /// For each cell of about 2 mm, x fastest, whether it or a neighbour contains this bone; cell c has the
  /// voxels from c * cell_voxels on.
  glm::ivec3 cells{0}, cell_voxels{1};
  std::vector<bool> is_near;
};

/// Separates the skull, and the bones near it, from couch, headrest, frame, mask and markers. The skull is
/// the part that surrounds most cells: a cell is surrounded where at least five of the six directions along
/// the axes hit the part. Another part belongs to the patient if most of it lies within the skull's box or
/// below, and soft tissue covers it, too; a marker in the air or on the skin is next to air. Without samples
/// or soft tissue, as for a dry skull, parts smaller than 1/20 of the skull are left out. Cost: a component
/// search for each of the ten largest parts, and a pass over cells.
HeadPart head_part(const voxel::DrawnObject& bone, const voxel::Progress& progress = {});

}  // namespace octotomy::planner

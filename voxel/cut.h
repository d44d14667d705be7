// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "voxel/camera.h"
#include "voxel/depth_image.h"
#include "voxel/expression.h"

namespace octotomy::voxel {

/// What is taken out of a picture so that one sees inside: all that a half-space does not hold, or all that
/// a box holds.
using Cut = std::variant<HalfSpace, Box>;

/// What a cut takes of a line of sight: depths from and until, either of which may be infinite, and the
/// outward normal of what is left behind it.
struct TakenSpan {
  double from_mm = 0.0;
  double until_mm = 0.0;
  glm::dvec3 normal{0.0};
};
/// Of the line start_mm + depth * along, LPS; none where the cut takes nothing of it.
std::optional<TakenSpan> taken_span(const Cut& cut, const glm::dvec3& start_mm, const glm::dvec3& along);

/// The expression without what the cuts take away. Throws std::invalid_argument where a normal is not of
/// unit length.
Expression without(const Expression& object, const std::vector<Cut>& cuts);

/// The objects without what the cuts take away; samples stay, counts of visits are of binary octrees.
/// Cost: that of combine() for every object.
std::vector<Drawn> without(const std::vector<Drawn>& objects, const std::vector<Cut>& cuts);

/// Moves the pixels that show voxels' faces which the cuts have made onto the cuts, so that a cut face is
/// flat instead of stepped. A pixel shows a cut's face where its depth is a voxel's face and lies off the cut
/// by no more than half a voxel as the cut's normal spans it, which is as far as faces between kept and
/// removed voxels reach. Faces seen at more than 76 degrees (surface_break.h) stay as they are: there a pixel
/// shows the voxels' sides. Returns the outward normals (right, up, look) of the pixels moved, no length
/// elsewhere; empty without cuts. Precondition: drawn of objects of this universe from which the cuts were
/// taken. Parallel over rows.
std::vector<glm::vec3> flatten_cuts(DepthImage& image, const ImagePlane& plane, const Universe& universe,
                                    const std::vector<Cut>& cuts);

}  // namespace octotomy::voxel

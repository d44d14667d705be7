// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/view/camera.h"
#include "voxel/view/depth_image.h"

namespace octotomy::voxel {

/// A part that is left out of a picture to show the inside of objects: all points outside a half-space, or
/// all points in a box.
using Cutaway = std::variant<HalfSpace, Box>;

/// The part of a line of sight that a cut removes: its first and last depth, which may be infinite, and the
/// outward normal of the cut face at its end.
struct TakenSpan {
  double from_mm = 0.0;
  double until_mm = 0.0;
  glm::dvec3 normal{0.0};
};
/// The removed part of the line start_mm + depth * along, LPS; none if the cut misses the line.
std::optional<TakenSpan> taken_span(const Cutaway& cut, const glm::dvec3& start_mm, const glm::dvec3& along);

/// The expression without the parts that the cuts remove. Throws std::invalid_argument if a normal does not
/// have unit length.
Expression without(const Expression& object, const std::vector<Cutaway>& cuts);

/// The objects without the parts that the cuts remove, as expressions (DrawnObject::unbuilt). The objects
/// retain their samples, but visits are counted in their binary octrees.
std::vector<DrawnObject> without(const std::vector<DrawnObject>& objects, const std::vector<Cutaway>& cuts);

/// Moves pixels from the voxel faces that a cut made onto the cut itself. The cut face is then flat instead
/// of stepped. A pixel shows a cut's face if its depth is that of a voxel's face whose distance from the cut
/// is at most half a voxel's extent along the cut's normal. No face between a kept and a removed voxel is
/// farther from the cut. Cut faces seen at more than 76 degrees (break_mm() of depth_plane.h) are not
/// changed, because pixels show the voxels' sides there. Returns the outward normals (right, up, look) of the
/// moved pixels and zero elsewhere; empty without cuts. Precondition: the image is of objects of this
/// universe, drawn without the parts that the cuts remove. Parallel over rows.
std::vector<glm::vec3> flatten_cuts(DepthImage& image, const ImagePlane& plane, const Universe& universe,
                                    const std::vector<Cutaway>& cuts);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/camera.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {
namespace {

/// A direction counts as parallel to an axis if the deviation across the whole universe is below this number
/// of voxels: a quarter of the finest step of depth that 8-bit shading shows on a slope of one.
constexpr double unnoticed_voxels = 1.0 / 64.0;

/// The range of an object's voxels along each axis, low and high included; empty if low > high.
struct Extents {
  glm::ivec3 low{std::numeric_limits<int>::max()};
  glm::ivec3 high{std::numeric_limits<int>::min()};

  void add(const glm::ivec3& first, const glm::ivec3& last) {
    low = glm::min(low, first);
    high = glm::max(high, last);
  }
  bool holds(const glm::ivec3& first, const glm::ivec3& last) const {
    return glm::all(glm::greaterThanEqual(first, low)) && glm::all(glm::lessThanEqual(last, high));
  }
};

void extend(Extents& extents, const Node& node, const glm::ivec3& first) {
  const int edge = 1 << (2 * (node.height - 1));
  for (std::uint64_t children = node.full | node.partial; children != 0; children &= children - 1) {
    const int child = std::countr_zero(children);
    const glm::ivec3 low = first + child_place(child) * edge;
    // Nodes inside the extents found so far cannot enlarge these, so only nodes at the boundary are visited.
    if (extents.holds(low, low + (edge - 1))) continue;
    if ((node.full >> child) & 1) {
      extents.add(low, low + (edge - 1));
    } else if (node.height > 2) {
      extend(extents, *node.nodes()[node.rank(child)], low);
    } else {
      for (std::uint64_t word = node.words()[node.rank(child)]; word != 0; word &= word - 1) {
        const glm::ivec3 voxel = low + child_place(std::countr_zero(word));
        extents.add(voxel, voxel);
      }
    }
  }
}

/// The corners of a box of voxels, voxel edges included, in LPS millimetres.
std::array<glm::dvec3, 8> corners_mm(const Universe& universe, const glm::ivec3& low,
                                     const glm::ivec3& high) {
  const Lattice lattice = universe.lattice();
  std::array<glm::dvec3, 8> corners;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
    corners[static_cast<std::size_t>(corner)] =
        lattice.lps_mm(glm::dvec3(low) - 0.5 + side * glm::dvec3(high - low + 1));
  }
  return corners;
}

}  // namespace

Frame frame_about(const std::vector<DrawnObject>& objects, const View& view, const glm::ivec2& size_px) {
  assert(!objects.empty());
  const Universe& universe = objects.front().octree.universe();
  Extents extents;
  for (const DrawnObject& object : objects) {
    const BlockRef root = object.octree.root();
    if (root.is_full()) extents.add(glm::ivec3(0), glm::ivec3(universe.side() - 1));
    if (root.node() != nullptr) extend(extents, *root.node(), glm::ivec3(0));
  }
  if (extents.low.x > extents.high.x) extents.add(glm::ivec3(0), glm::ivec3(universe.side() - 1));
  glm::dvec2 low(std::numeric_limits<double>::infinity());
  glm::dvec2 high(-std::numeric_limits<double>::infinity());
  for (const glm::dvec3& corner : corners_mm(universe, extents.low, extents.high)) {
    low = glm::min(low, view.project(corner));
    high = glm::max(high, view.project(corner));
  }
  const double square_mm = std::max(high.x - low.x, high.y - low.y) * 1.05;
  return {(low + high) * 0.5, square_mm * size_px.x / std::min(size_px.x, size_px.y)};
}

ImagePlane image_plane(const Universe& universe, const View& view, const glm::ivec2& size_px,
                       const Frame& frame) {
  ImagePlane plane{view, size_px, frame.centre_mm, frame.width_mm / size_px.x};
  const Box box = bounds(universe.lattice());
  double nearest = 0.0;
  double farthest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = view.look[axis] * box.low_mm[axis];
    const double high = view.look[axis] * box.high_mm[axis];
    nearest += std::min(low, high);
    farthest += std::max(low, high);
  }
  plane.nearest_mm = nearest;
  plane.depth_range_mm = farthest - nearest;
  return plane;
}

ImagePlane seen_from(ImagePlane plane, double eye_distance_mm) {
  plane.eye = Eye{eye_distance_mm, 0.5 * plane.depth_range_mm};
  return plane;
}

VoxelRays voxel_rays(const Universe& universe, const ImagePlane& plane) {
  const glm::dmat4 voxel_from_lps = glm::inverse(universe.lps_from_voxel);
  const glm::dmat3 turn(voxel_from_lps);
  VoxelRays rays;
  rays.first = glm::dvec3(voxel_from_lps * glm::dvec4(plane.lps_mm({0, 0}, 0.0), 1.0));
  if (plane.eye) {
    const auto along = [&](const glm::dvec2& p_px) {
      return turn * (plane.lps_mm(p_px, 1.0) - plane.lps_mm(p_px, 0.0));
    };
    rays.per_px_x = turn * (plane.lps_mm({1, 0}, 0.0) - plane.lps_mm({0, 0}, 0.0));
    rays.per_px_y = turn * (plane.lps_mm({0, 1}, 0.0) - plane.lps_mm({0, 0}, 0.0));
    rays.per_mm = along({0, 0});
    rays.per_mm_px_x = along({1, 0}) - rays.per_mm;
    rays.per_mm_px_y = along({0, 1}) - rays.per_mm;
    return rays;
  }
  rays.per_px_x = turn * (plane.view.right * plane.pixel_mm);
  rays.per_px_y = turn * (plane.view.up * -plane.pixel_mm);
  rays.per_mm = turn * plane.view.look;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(rays.per_mm[axis]) * plane.depth_range_mm < unnoticed_voxels) rays.per_mm[axis] = 0.0;
  return rays;
}

std::optional<AxisView> axis_view(const Universe& universe, const View& view) {
  const glm::dmat3 turn(glm::inverse(universe.lps_from_voxel));
  const glm::dvec3 spacing_mm = universe.lattice().spacing_mm();
  const std::array<glm::dvec3, 3> directions{view.right, view.up, view.look};
  AxisView axes;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 along = turn * directions[i] * spacing_mm;
    const glm::dvec3 size = glm::abs(along);
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    for (int other = 0; other < 3; ++other)
      if (other != axis && size[other] * universe.side() >= unnoticed_voxels * size[axis])
        return std::nullopt;
    axes.axis[i] = axis;
    axes.reversed[i] = along[axis] < 0.0;
  }
  return axes;
}

}  // namespace octotomy::voxel

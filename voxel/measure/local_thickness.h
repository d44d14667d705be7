// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

struct LocalThicknessOptions {
  std::size_t samples =
      20000;  ///< about how many of all voxels are measured, and also how many of the surface's; at least 64
  /// A voxel belongs to a wall if its largest ball touches the outside, within a voxel's shortest edge, at
  /// two places whose directions from the ball's centre enclose at least this angle, 91..179 degrees. In a
  /// wedge of angle a these directions enclose 180 - a degrees. At 150, wedges of more than 30 degrees are
  /// therefore no walls.
  double wall_angle_deg = 150.0;
  Progress progress = {};
};

/// A voxel of the object with at least one face to the outside, and the local thickness at the voxel's
/// centre.
struct ThicknessAtVoxel {
  glm::ivec3 voxel{0};
  double thickness_mm = 0.0;
  bool is_wall = false;  ///< whether the voxel belongs to a wall, see LocalThicknessOptions::wall_angle_deg
};

/// Statistics of the local thickness over an object's voxels, and its values at the surface.
struct VoxelThickness {
  double mean_mm = 0.0, deviation_mm = 0.0, median_mm = 0.0, largest_mm = 0.0;
  /// In 99 of 100 cases the mean deviates from the true value by at most this. It is the sum of three terms:
  /// half a voxel's longest edge for each of a ball's two sides, because digitisation displaces parallel
  /// walls in the same way; a quarter of that edge for the lattice of centres; and 2.6 standard errors of the
  /// sampled voxels.
  double mean_half_width_mm = 0.0;
  std::vector<ThicknessAtVoxel> surface;
  /// Its index in `surface`; none if no sampled voxel belongs to a wall.
  std::optional<std::size_t> thinnest_wall;
};

/// Local thickness of an octree's voxels: the diameter of the largest ball inside the object that contains a
/// voxel's centre. Centres of balls are voxels' centres and the points half-way between them; if these are
/// more than 2^26 points, voxels' centres alone. A ball's radius is its distance to the nearest candidate
/// centre that touches no voxel of the object, less half the distance between lattice planes across that
/// direction. A flat wall along the lattice is therefore measured to its voxels' faces, an oblique or round
/// wall to the first point outside. Voxels beyond the universe are outside. All zero for an empty octree.
/// Throws std::invalid_argument if the universe's axes are not perpendicular or an option is out of its
/// range, std::length_error above 2^28 voxels in the object's extent; Stopped. The same bits on any number of
/// threads. Cost: linear in the extent, 5 bytes for each centre, and about log n for each sample; parallel.
/// Source: Hildebrand and Ruegsegger, Journal of Microscopy 185, 1997; distances as in distance_map().
/// Departure: a pyramid of largest distances is searched at sampled voxels, whereas the source paints a ball
/// at each point of the distance ridge.
VoxelThickness local_thickness(const Octree& octree, const LocalThicknessOptions& options = {});

/// Only the thinnest wall that local_thickness() reports; none if no sampled voxel belongs to a wall. Throws
/// as local_thickness() does. Cost: lower, because the sides of most balls are not searched.
std::optional<ThicknessAtVoxel> thinnest_wall(const Octree& octree,
                                              const LocalThicknessOptions& options = {});

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "voxel/grey_octree.h"
#include "voxel/octree.h"
#include "voxel/view.h"

namespace octotomy::voxel {

/// An object to be drawn. Where `grey` is given, depth is interpolated by partial volume at `threshold`
/// (thesis 5.2.2.2); otherwise the surface is the voxels'.
struct Drawn {
  std::string name;
  Octree octree;
  glm::vec3 colour{0.93f, 0.89f, 0.80f};  ///< sRGB, 0..1
  std::optional<GreyOctree> grey;
  double threshold = 0.0;
};

/// NodeTrace: quadtree rays through the octree, for views along the universe's axes (thesis 4.5).
/// RayCast: one ray a pixel that steps over homogeneous blocks, for any view.
enum class Algorithm { NodeTrace, RayCast };

struct RenderOptions {
  View view;
  glm::ivec2 size_px{512, 512};
  /// What the picture spans; by default the square about the objects' extents, a twentieth wider.
  std::optional<glm::dvec2> centre_mm;
  std::optional<double> width_mm;
  /// By default NodeTrace where the view allows it. Asking for it elsewhere throws std::invalid_argument.
  std::optional<Algorithm> algorithm;
  glm::vec3 background{1.0f, 1.0f, 1.0f};
};

/// Pixels row by row from the top left.
struct Picture {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;  ///< 3 a pixel, sRGB
  std::vector<float>
      depth_mm;  ///< along `look` from the nearest corner of the universe; infinity: background
  std::vector<std::int16_t> object;  ///< index of the object seen, -1: background
  double pixel_mm = 0.0;
  std::uint64_t lit_pixels = 0;
  Algorithm algorithm = Algorithm::NodeTrace;
};

/// Draws objects of one universe, shaded from the gradient of the depth image with break detection (thesis
/// 5.2.2.1). Throws std::invalid_argument where universes differ or the size is not positive. Parallel over
/// pixels; same bits on any thread count.
Picture render(const std::vector<Drawn>& objects, const RenderOptions& options);

}  // namespace octotomy::voxel

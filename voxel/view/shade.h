// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "voxel/view/depth_image.h"

namespace octotomy::voxel {

/// A light with parallel rays.
struct Light {
  /// Direction from the surface to the light, in (right, up, look); any length above 0.
  glm::vec3 towards{-0.45f, 0.55f, -1.0f};
  float strength = 0.9f;  ///< brightness, 0..1, of a white surface that faces the light
};

/// Shaded: Phong's model, summed over the lights. Depth: brightness depends only on depth. Silhouette: one
/// tone per object. Outline: dark lines on white at edges and creases of surfaces, for print.
enum class Style { Shaded, Depth, Silhouette, Outline };

/// Colours of pixels that replace the objects' colours.
struct Paint {
  /// Lit: replaces the object's colour under the lights. Tone: the pixel has this colour without lights.
  enum class Kind : std::uint8_t { None, Lit, Tone };
  std::vector<Kind> kinds;         ///< one for each pixel, or empty for no paint
  std::vector<glm::vec3> colours;  ///< sRGB 0..1, one for each entry of `kinds`
};

/// Colours, scale, style and lights for shading a depth image.
struct Scenery {
  std::vector<glm::vec3> colours;  ///< one for each object, sRGB 0..1
  glm::vec3 background{1.0f};      ///< sRGB 0..1
  double pixel_mm = 1.0;
  double voxel_mm = 1.0;        ///< edge of a voxel, the size of the finest detail in the depths
  double depth_range_mm = 1.0;  ///< depth at which the depth cue has its full effect
  Style style = Style::Shaded;
  /// At most eight lights. Default: a key light from the upper left and a fill light from the lower right.
  std::vector<Light> lights{Light{}, Light{{0.7f, -0.25f, -1.0f}, 0.25f}};
  float ambient = 0.06f;  ///< light from everywhere
  float gloss = 0.06f;    ///< strength of the first light's mirror image
  /// Exponent of the mirror image's cosine: the larger, the smaller the highlight.
  float exponent = 48.0f;
  bool occlusion = true;  ///< darkens surfaces that lie behind their surroundings
  bool depth_cue = true;  ///< darkens the far end by a third
  Paint paint{};          ///< Style::Shaded only
};

/// The slopes of the depth image at every pixel, row by row: x is the growth of depth towards the picture's
/// right, y that towards its top, both without unit. Each is a weighted mean of forward and backward
/// differences over three rows or columns. The smaller difference has the larger weight, so that next to a
/// break in the surface the slope is that on the side away from the break (Gordon, Reynolds 1985; thesis
/// 5.2.2.1). Differences span at least a voxel. Depths are smoothed before by depth_plane(). Slopes of
/// background pixels are 0. Parallel over rows.
std::vector<glm::vec2> slopes(const DepthImage& image, const Scenery& scenery);

/// The picture of a depth image, 8-bit sRGB row by row: Phong's model (1975) for the scenery's lights,
/// slightly darker far parts, and darker surfaces behind their surroundings (Luft, Colditz, Deussen 2006:
/// unsharp masking of the depth buffer). Normals come from slopes(), or from `normals` if given, one per
/// pixel in (right, up, look). Precondition: colours are within 0..1. Light outside 0..1 is clamped. Parallel
/// over rows; same bits on any thread count.
std::vector<std::uint8_t> shade(const DepthImage& image, const Scenery& scenery,
                                std::span<const glm::vec3> normals = {});

/// The indices of the pixels, ascending, at which an object or surface borders on another one or on the
/// background.
std::vector<std::uint32_t> edge_pixels(const DepthImage& image, const Scenery& scenery);

/// The mean colour of the parts of an edge pixel. Each part gets the colour of the edge pixel or of the
/// neighbour to whose surface the part belongs.
std::array<std::uint8_t, 3> blend(const DepthImage& image, const std::vector<std::uint8_t>& rgb,
                                  const Scenery& scenery, std::uint32_t pixel, std::span<const Seen> parts);

}  // namespace octotomy::voxel

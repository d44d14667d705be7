// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "voxel/depth_image.h"

namespace octotomy::voxel {

/// A light so far away that its rays are parallel.
struct Light {
  glm::vec3 towards{-0.45f, 0.55f, -1.0f};  ///< (right, up, look), from the surface to the light; any length
  float strength = 0.9f;                    ///< of a surface that faces it, 0..1 of white
};

/// Shaded: Phong's model, every light in turn. Depth: brightness falls with depth alone. Silhouette: one tone
/// an object. Outline: dark lines where a surface ends or creases, on white, for print.
enum class Style { Shaded, Depth, Silhouette, Outline };

/// Colours of pixels that are not those of the objects they show.
struct Paint {
  /// Lit: the object's colour is this one instead. Tone: the pixel is this colour, whatever the light.
  enum class Kind : std::uint8_t { None, Lit, Tone };
  std::vector<Kind> kinds;         ///< one a pixel; empty: nothing is painted
  std::vector<glm::vec3> colours;  ///< sRGB 0..1, one a pixel where kinds are
};

/// What a depth image does not say about its picture.
struct Scenery {
  std::vector<glm::vec3> colours;  ///< of the objects, sRGB 0..1
  glm::vec3 background{1.0f};      ///< sRGB 0..1
  double pixel_mm = 1.0;
  double voxel_mm = 1.0;        ///< edge of a voxel: the finest detail that depth has
  double depth_range_mm = 1.0;  ///< over which the depth cue takes its full effect
  Style style = Style::Shaded;
  /// At most eight; key light from the upper left, fill light from the lower right.
  std::vector<Light> lights{Light{}, Light{{0.7f, -0.25f, -1.0f}, 0.25f}};
  float ambient = 0.06f;  ///< light from everywhere
  float gloss = 0.06f;    ///< of the first light's mirror image
  bool occlusion = true;  ///< darkens what lies behind its surroundings
  bool depth_cue = true;  ///< darkens the far end by a third
  Paint paint{};          ///< Style::Shaded only
};

/// Slopes of the depth image at every pixel, row by row: x is the growth of depth towards the picture's
/// right, y towards its top, both without unit. Each is the mean of forward and backward differences over
/// three rows or columns, weighted against the larger, so that a break of the surface on one side leaves the
/// slope to the other (Gordon, Reynolds 1985; thesis 5.2.2.1). Differences reach over a voxel where pixels
/// are smaller. Depths are smoothed first over four voxels on each side, those that are voxels' faces
/// twice, by half a voxel at the most. 0 where nothing is lit. Parallel over rows.
std::vector<glm::vec2> slopes(const DepthImage& image, const Scenery& scenery);

/// The picture of a depth image, 8-bit sRGB row by row: Phong's model (1975) for the scenery's lights, a
/// gentle depth cue, and darkening of what lies behind its surroundings (Luft, Colditz, Deussen 2006: unsharp
/// masking of the depth buffer). Normals are those of slopes(), or `normals`, one a pixel in (right, up,
/// look), where these are given. Parallel over rows; same bits on any thread count.
std::vector<std::uint8_t> shade(const DepthImage& image, const Scenery& scenery,
                                std::span<const glm::vec3> normals = {});

/// Pixel numbers, ascending, where an object or surface ends against another or the background.
std::vector<std::uint32_t> edge_pixels(const DepthImage& image, const Scenery& scenery);

/// The mean colour of what parts of an edge pixel see. A part takes the colour of the neighbouring pixel,
/// itself included, whose surface it belongs to.
std::array<std::uint8_t, 3> blend(const DepthImage& image, const std::vector<std::uint8_t>& rgb,
                                  const Scenery& scenery, std::uint32_t pixel, std::span<const Seen> parts);

}  // namespace octotomy::voxel

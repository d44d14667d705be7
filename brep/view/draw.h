// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "brep/mesh/progress.h"
#include "brep/mesh/triangles.h"
#include "brep/view/camera.h"
#include "brep/view/lighting.h"

// Draws surfaces as facets, lines, and pictures on planes, all through one depth buffer (thesis 4.4.1).
namespace octotomy::brep {

/// Flat: one tone a triangle. Gouraud: tones of the corners, interpolated. Phong: normals of the corners,
/// interpolated. Wire: the edges alone.
enum class FacetShading { Flat, Gouraud, Phong, Wire };

/// Any triangles, open ones too; both sides are drawn.
struct DrawnSurface {
  const Triangles* triangles = nullptr;  ///< not null; of finite points
  glm::vec3 colour{1.0f};                ///< sRGB, 0..1
};

/// Lines in space, without shading.
struct DrawnLines {
  std::vector<std::vector<glm::dvec3>>
      lines_mm;            ///< from each point to the next; a closed one repeats its first
  glm::vec3 colour{0.0f};  ///< sRGB, 0..1
  double width_px = 1.5;
};

/// A picture at its place in space, in its own tones.
struct DrawnSheet {
  glm::dvec3 first_mm{0.0};        ///< centre of the first pixel
  glm::dvec3 per_column{1, 0, 0};  ///< from a pixel to the next of its row, mm
  glm::dvec3 per_row{0, 1, 0};     ///< from a row to the next, perpendicular to per_column, mm
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;       ///< sRGB, 3 bytes per pixel, row by row
  std::vector<std::uint8_t> is_shown;  ///< by pixel; 0: transparent
};

/// Items are numbered: surfaces first, then lines, then sheets.
struct DrawnScene {
  std::vector<DrawnSurface> surfaces;
  std::vector<DrawnLines> lines;
  std::vector<DrawnSheet> sheets;
};

struct DrawOptions {
  Camera camera;
  FacetShading shading = FacetShading::Phong;
  Lighting lighting;
  glm::vec3 background{1.0f};  ///< sRGB, 0..1
  bool cull = false;           ///< leaves out triangles that face away from the observer
  bool hide = false;           ///< Wire: triangles hide edges behind them
  double wire_px = 1.0;        ///< Wire: width of the edges
};

/// Row by row from the top left.
struct DrawnPicture {
  std::vector<std::uint8_t> rgb;   ///< sRGB, 3 bytes per pixel: the mean of four points
  std::vector<float> depth_mm;     ///< at the pixel's centre; infinity: nothing
  std::vector<std::int32_t> item;  ///< at the pixel's centre; -1: nothing
  std::uint64_t lit_pixels = 0;
  std::vector<std::uint64_t> culled;  ///< by surface: triangles that were left out
};

/// The extent of a scene: along right, up and look. Without any point, low is above high.
struct ViewExtent {
  glm::dvec3 low_mm{std::numeric_limits<double>::infinity()};
  glm::dvec3 high_mm{-std::numeric_limits<double>::infinity()};
};
ViewExtent extent(const DrawnScene& scene, const glm::dvec3& right, const glm::dvec3& up,
                  const glm::dvec3& look);

/// Draws a scene. A point on an edge of two triangles belongs to exactly one triangle. At equal depths the
/// item of lower number wins, and within it the earlier triangle. A line comes before a surface that is
/// nearer by less than the line's width, so that outlines of a surface show on it. What lies behind the
/// observer is cut off. Throws InvalidInput if the size or the pixel is not positive, and Stopped. Parallel
/// over bands of rows; same bits on any thread count. Memory: 8 bytes per pixel, 100 per triangle.
DrawnPicture draw(const DrawnScene& scene, const DrawOptions& options, const Progress& progress = {});

}  // namespace octotomy::brep

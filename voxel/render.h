// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/camera.h"
#include "voxel/cut.h"
#include "voxel/drawn.h"
#include "voxel/shade.h"
#include "voxel/view.h"
#include "voxel/visits.h"

namespace octotomy::voxel {

/// NodeTrace: quadtree rays through the octree, for views along the universe's axes (thesis 4.5).
/// RayCast: one ray a pixel that steps over homogeneous blocks, for any view.
/// FrontToBack, BackToFront: node by node into the picture, for any view; slower (thesis 4.4.3).
enum class Algorithm { NodeTrace, RayCast, FrontToBack, BackToFront };

/// Depth: brightness by depth alone. Gradient: from the gradient of the depth image of voxels' faces (thesis
/// 5.2.2.1). PartialVolume: the same of depths interpolated by partial volume (5.2.2.2) where an object has
/// its samples. Context: object-based, from each voxel's neighbours (5.2.1.1). GreyGradient: object-based,
/// from the gradient of the samples (5.2.1.2). Silhouette, Outline: for print.
enum class Shading { Depth, Gradient, Context, PartialVolume, GreyGradient, Silhouette, Outline };

/// Samples painted on cut faces as they are, like a slice: from black to white.
struct CutTones {
  GreyOctree grey;
  double black = 0.0;
  double white = 1.0;  ///< more than black
};

struct RenderOptions {
  View view;
  glm::ivec2 size_px{512, 512};
  /// What the picture spans; by default the square about the objects' extents, a twentieth wider.
  std::optional<glm::dvec2> centre_mm;
  std::optional<double> width_mm;
  /// Distance of the eye from the middle of the universe; none: orthographic, in true scale. Ray casting
  /// only.
  std::optional<double> eye_mm;
  /// By default NodeTrace where the view allows it; asking for it elsewhere throws std::invalid_argument. It
  /// shows whole columns of voxels, so that outlines are angular where pixels are much smaller; RayCast
  /// follows the interpolated surface there.
  std::optional<Algorithm> algorithm;
  Shading shading = Shading::PartialVolume;
  glm::vec3 background{1.0f, 1.0f, 1.0f};  ///< sRGB, 0..1
  /// Taken out of every object; the picture's frame is that of the whole objects. Cut faces are flat.
  std::vector<Cut> cuts;
  /// What cut faces show; none: the object's colour. The samples are of the objects' universe.
  std::optional<CutTones> cut_tones;
  std::vector<Light> lights;  ///< none: a key light from the upper left, a fill light from the lower right
  bool occlusion = true;      ///< darkens what lies behind its surroundings
  /// Counts what the algorithm visits (appendix A); takes far longer than drawing does.
  bool count = false;
  /// Blends the colours of what four parts of a pixel see along edges; depth, object and lit pixels are those
  /// of the pixel's centre either way. Adds a sixth (node tracing) to a half (ray casting) to the time of
  /// a frame.
  bool antialias = true;
};

/// Pixels row by row from the top left. A pixel's centre is what it shows.
struct Picture {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;  ///< 3 a pixel, sRGB
  std::vector<float>
      depth_mm;  ///< along `look` from the nearest corner of the universe; infinity: background
  std::vector<std::int16_t> object;  ///< index of the object seen, -1: background
  double pixel_mm = 0.0;
  glm::dvec2 centre_mm{0.0};  ///< of the picture, in the view's millimetres
  double nearest_mm = 0.0;    ///< p . look where depth is 0
  std::optional<Eye> eye;     ///< none: orthographic
  std::uint64_t lit_pixels = 0;
  Algorithm algorithm = Algorithm::NodeTrace;
  std::optional<Visits> visits;  ///< where they were to be counted
  View view;

  /// The plane that the picture lies in; the depth of the universe's farthest corner is not known to it.
  ImagePlane plane() const { return {view, size_px, centre_mm, pixel_mm, nearest_mm, 0.0, eye}; }
  /// The LPS point that a pixel shows; none where it shows the background.
  std::optional<glm::dvec3> point_mm(const glm::ivec2& pixel) const;
};

/// Draws objects of one universe: opaque ones by the algorithm asked for, translucent ones over them, objects
/// of no opacity not at all. Depth and object are those of the nearest surface that is at least half opaque.
/// Throws std::invalid_argument where there is no object, more than 32767, universes differ, or
/// size or width are not positive. Parallel over pixels; same bits on any thread count.
Picture render(const std::vector<Drawn>& objects, const RenderOptions& options);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/solid/grey_owner.h"
#include "voxel/space/view.h"
#include "voxel/view/camera.h"
#include "voxel/view/cutaway.h"
#include "voxel/view/drawn_object.h"
#include "voxel/view/shade.h"
#include "voxel/view/visits.h"

namespace octotomy::voxel {

/// How surfaces are traced. NodeTrace: quadtree rays through the octree (thesis 4.5), fastest for views along
/// the universe's axes. RayCast: one ray per pixel, which skips homogeneous blocks, for any view.
/// FrontToBack, BackToFront: node by node into the picture, for any orthographic view; slower (thesis 4.4.3).
enum class Algorithm { NodeTrace, RayCast, FrontToBack, BackToFront };

/// How brightness is computed. Depth: only from depth. Gradient: from the gradient of the depth image of
/// voxels' faces (thesis 5.2.2.1). PartialVolume: like Gradient, but with depths interpolated by partial
/// volume (5.2.2.2) for objects with samples. Context: from the neighbours of each visible voxel (5.2.1.1).
/// GreyGradient: from the gradient of the samples (5.2.1.2). Silhouette, Outline: for print. Density: the
/// sample of the visible voxel, darker with its depth (5.2.1.2); needs RenderOptions::densities.
enum class Shading { Depth, Gradient, Context, PartialVolume, GreyGradient, Silhouette, Outline, Density };

/// Paints cut faces in grey tones, like a slice. Each point shows the sample of the operand that contains the
/// point; samples move with their operands. A point in no window keeps the object's colour.
struct CutTones {
  GreyOwners samples;
  double black = 0.0;
  double white = 1.0;  ///< above black
};

/// A colour for the surface voxels whose samples lie in a range, both ends included.
struct DensityColour {
  double low = 0.0;
  double high = 0.0;
  glm::vec3 colour{1.0f};  ///< sRGB, 0..1
};

/// Samples that colour surfaces. A pixel gets the sample of the first voxel behind the surface, on the
/// pixel's ray, that a window owns.
struct Densities {
  CutTones tones;  ///< Shading::Density only
  /// The first range that contains the sample determines the colour; without one it is the object's.
  std::vector<DensityColour> colours;
};

struct RenderOptions {
  View view;
  glm::ivec2 size_px{512, 512};
  /// The picture's frame; by default that of frame_about(): the objects' extents with a margin of a
  /// twentieth.
  std::optional<glm::dvec2> centre_mm;
  std::optional<double> width_mm;
  /// Distance of the eye from the middle of the universe; none: orthographic, in true scale. Ray casting
  /// only.
  std::optional<double> eye_mm;
  /// By default NodeTrace for views along the universe's axes and RayCast for others. Along an axis NodeTrace
  /// shows whole columns of voxels, so that outlines are angular if pixels are much smaller than voxels;
  /// RayCast follows the interpolated surface.
  std::optional<Algorithm> algorithm;
  Shading shading = Shading::PartialVolume;
  glm::vec3 background{1.0f, 1.0f, 1.0f};  ///< sRGB, 0..1
  /// Parts to remove from every object. The frame is still that of the whole objects. Cut faces are flat.
  std::vector<Cutaway> cuts;
  /// Grey tones on cut faces; none: the object's colour. Precondition: the samples have the objects'
  /// universe.
  std::optional<CutTones> cut_tones;
  std::vector<Light> lights;  ///< none: a key light from the upper left, a fill light from the lower right
  bool occlusion = true;      ///< darkens surfaces that lie behind their surroundings
  /// Counts the nodes that the algorithm visits (appendix A); takes much longer than drawing.
  bool count = false;
  /// Blends the colours of four parts of each edge pixel; depth and object remain those at the pixel's
  /// centre. A frame takes a sixth (node tracing) to a half (ray casting) longer.
  bool antialias = true;
  /// The strength of light from everywhere; the strength and the exponent of the first light's mirror image
  /// (thesis 5.1). By default those of Scenery.
  std::optional<float> ambient{};
  std::optional<float> gloss{};
  std::optional<float> exponent{};
  /// Colours surfaces by their samples. Precondition: the samples have the objects' universe.
  std::optional<Densities> densities{};
};

/// A picture with its depths and objects, row by row from the top left; each pixel shows the point at its
/// centre.
struct Picture {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;  ///< 3 bytes per pixel, sRGB
  std::vector<float>
      depth_mm;  ///< depth along `look` from the universe's nearest corner; infinity: background
  std::vector<std::int16_t> object;  ///< index of the visible object, -1: background
  double pixel_mm = 0.0;
  glm::dvec2 centre_mm{0.0};  ///< centre of the picture, in the view's millimetres
  double nearest_mm = 0.0;    ///< p . look for the points p of depth 0
  std::optional<Eye> eye;     ///< none: orthographic
  std::uint64_t lit_pixels = 0;
  Algorithm algorithm = Algorithm::NodeTrace;
  std::optional<Visits> visits;  ///< if RenderOptions::count is set
  View view;

  /// The picture's plane; the depth of the universe's farthest corner is not set.
  ImagePlane plane() const { return {view, size_px, centre_mm, pixel_mm, nearest_mm, 0.0, eye}; }
  /// The LPS point that a pixel shows; none for the background.
  std::optional<glm::dvec3> point_mm(const glm::ivec2& pixel) const;
};

/// Draws objects of one universe: the opaque ones, and the translucent ones over them. Skips objects of
/// opacity 0. Depth and object of a pixel are those of the nearest surface that is at least half opaque.
/// Throws std::invalid_argument if there are no objects or more than 32767, if their universes differ, or if
/// size or width is not positive. Parallel over pixels; same bits on any thread count.
Picture render(const std::vector<DrawnObject>& objects, const RenderOptions& options);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "voxel/view/render.h"

namespace octotomy::voxel {

// A picture consists of layers: one of the opaque objects, and one of each translucent object. Tracing a
// layer takes most of the time and does not depend on colours. Shading it does not read octrees.

/// A range of depths along a ray.
struct DepthSpan {
  double near_mm = -std::numeric_limits<double>::infinity();
  double far_mm = std::numeric_limits<double>::infinity();
};

/// The depths at which the ray start + depth * per_mm, in index space, runs among the centres of a universe's
/// voxels; beyond the outermost centres there is only background. None if it misses them.
inline std::optional<DepthSpan> span_among_centres(const glm::dvec3& start, const glm::dvec3& per_mm,
                                                   int side) {
  DepthSpan span;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = -start[axis];
    const double high = side - 1 - start[axis];
    if (per_mm[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return std::nullopt;
      continue;
    }
    span.near_mm = std::max(span.near_mm, std::min(low / per_mm[axis], high / per_mm[axis]));
    span.far_mm = std::min(span.far_mm, std::max(low / per_mm[axis], high / per_mm[axis]));
  }
  if (!(span.near_mm <= span.far_mm)) return std::nullopt;
  return span;
}

/// The surface at a pixel position between two depths.
using SeenAt = std::function<Seen(const glm::dvec2& p_px, const DepthSpan& span)>;

/// The visible surfaces of some objects, and a function that traces more of them, for parts of edge pixels.
struct Layer {
  DepthImage image;                    ///< objects are numbered in the order given
  std::vector<glm::vec3> cut_normals;  ///< from flatten_cuts()
  SeenAt seen_at;                      ///< owns its data; any number of threads may call it
};

/// The objects without the parts that the options' cuts remove. Builds their octrees, except for node tracing
/// along an axis, which evaluates expressions only where they are visible.
std::vector<DrawnObject> to_trace(const std::vector<DrawnObject>& objects, const RenderOptions& options,
                                  Algorithm algorithm);

/// Traces a layer. Preconditions: at least one object, all of the plane's universe and from to_trace(). Counts
/// visits if given.
Layer draw_layer(const std::vector<DrawnObject>& objects, const ImagePlane& plane,
                 const std::vector<Cutaway>& cuts, Algorithm algorithm, Visits* visits = nullptr);

/// Shades a layer's pixels with the objects' colours and the options' shading, lights and background. Ignores
/// the options' size, view, algorithm and cuts, because the layer was traced with its own.
std::vector<std::uint8_t> shade_layer(const Layer& layer, const std::vector<DrawnObject>& objects,
                                      const ImagePlane& plane, const RenderOptions& options);

/// A layer of background.
Layer empty_layer(const glm::ivec2& size_px);

/// The object to trace for a shading: without samples if the shading uses only voxels' faces.
DrawnObject as_shaded(const DrawnObject& object, Shading shading);

/// Replaces each object's number i by numbers[i].
void number_objects(DepthImage& image, const std::vector<std::int16_t>& numbers);

/// Merges layers of one object each: the nearest surface wins; at equal depth, that of the first layer.
/// Precondition: at least one layer, all of one plane and the same cuts.
Layer nearest_of(const std::vector<const Layer*>& layers);

/// A translucent object of a scene.
struct Translucent {
  DepthImage image;
  std::vector<std::uint8_t> rgb;
  std::int16_t number = 0;  ///< of the object in its scene
  float opacity = 0.5f;
};

/// Fills the pixels, depths and objects of a picture: the translucent objects, back to front, over the
/// colours of its opaque layer. Objects of the opaque layer are numbered as in the scene.
void lay_together(DepthImage opaque, std::vector<std::uint8_t> rgb, std::vector<Translucent> translucent,
                  Picture& picture);

/// A picture without pixels: its size, view, frame and algorithm. Throws as render() does.
Picture blank_picture(const std::vector<DrawnObject>& objects, const RenderOptions& options);

/// The plane of a blank picture.
ImagePlane plane_of(const std::vector<DrawnObject>& objects, const Picture& picture);

}  // namespace octotomy::voxel

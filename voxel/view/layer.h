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

// A picture consists of layers: one of all opaque objects, and one for each translucent object. Tracing a
// layer takes most of the time and does not depend on colours. Shading a layer does not read octrees.

/// A range of depths along a ray.
struct DepthSpan {
  double near_mm = -std::numeric_limits<double>::infinity();
  double far_mm = std::numeric_limits<double>::infinity();
};

/// The depths between which the ray start + depth * per_mm, in index space, lies within the box of the
/// centres of a universe's voxels. Beyond the outermost centres there is only background. None if the ray
/// misses this box.
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

/// A function that returns the surface at a pixel position between two depths.
using SeenAt = std::function<Seen(const glm::dvec2& p_px, const DepthSpan& span)>;

/// The visible surfaces of some objects at all pixels, and a function that traces them at other positions,
/// for the parts of edge pixels.
struct Layer {
  DepthImage image;                    ///< an object's number is its index in the list of objects drawn
  std::vector<glm::vec3> cut_normals;  ///< from flatten_cuts()
  /// Traces surfaces at other positions; owns its data, and any number of threads may call it.
  SeenAt seen_at;
};

/// The objects without the parts that the options' cuts remove. Builds their octrees, except for node tracing
/// along an axis, which evaluates expressions only where they are visible.
std::vector<DrawnObject> to_trace(const std::vector<DrawnObject>& objects, const RenderOptions& options,
                                  Algorithm algorithm);

/// Traces a layer. Adds visits to `visits` if given. Preconditions: there is at least one object, and all
/// have the plane's universe and were returned by to_trace().
Layer draw_layer(const std::vector<DrawnObject>& objects, const ImagePlane& plane,
                 const std::vector<Cutaway>& cuts, Algorithm algorithm, Visits* visits = nullptr);

/// Shades a layer's pixels with the objects' colours and the options' shading, lights and background. Ignores
/// the options' size, view, algorithm and cuts, which were fixed when the layer was traced.
std::vector<std::uint8_t> shade_layer(const Layer& layer, const std::vector<DrawnObject>& objects,
                                      const ImagePlane& plane, const RenderOptions& options);

/// A layer of background.
Layer empty_layer(const glm::ivec2& size_px);

/// The object to trace for a shading: without samples if the shading uses only voxels' faces.
DrawnObject as_shaded(const DrawnObject& object, Shading shading);

/// Replaces each object's number i by numbers[i].
void number_objects(DepthImage& image, const std::vector<std::int16_t>& numbers);

/// Merges layers that contain one object each. At every pixel the nearest surface is visible; at equal depth,
/// that of the first layer. Precondition: there is at least one layer, and all have one plane and the same
/// cuts.
Layer nearest_of(const std::vector<const Layer*>& layers);

/// The shaded layer of a translucent object.
struct Translucent {
  DepthImage image;
  std::vector<std::uint8_t> rgb;
  std::int16_t number = 0;  ///< number of the object in its scene
  float opacity = 0.5f;
};

/// Sets the pixels, depths and objects of a picture. The translucent objects are blended, back to front, over
/// the colours of the opaque layer. Objects of the opaque layer are numbered as in the scene.
void lay_together(DepthImage opaque, std::vector<std::uint8_t> rgb, std::vector<Translucent> translucent,
                  Picture& picture);

/// A picture without pixels, which has only its size, view, frame and algorithm. Throws as render() does.
Picture blank_picture(const std::vector<DrawnObject>& objects, const RenderOptions& options);

/// The plane of a blank picture.
ImagePlane plane_of(const std::vector<DrawnObject>& objects, const Picture& picture);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "voxel/render.h"

namespace octotomy::voxel {

// A picture is made of layers: the opaque objects, and every translucent one. A layer is found, which takes
// most of the time and knows no colours, and shaded, which knows no octrees.

/// Depths between which something is looked for.
struct DepthSpan {
  double near_mm = -std::numeric_limits<double>::infinity();
  double far_mm = std::numeric_limits<double>::infinity();
};

/// What a pixel position sees between two depths.
using SeenAt = std::function<Seen(const glm::dvec2& p_px, const DepthSpan& span)>;

/// What is seen of some objects, and what sees more of them: for the parts of pixels at edges.
struct Layer {
  DepthImage image;                    ///< objects are numbered in the order given
  std::vector<glm::vec3> cut_normals;  ///< as flatten_cuts() returned them
  SeenAt seen_at;                      ///< keeps what it needs; any number of threads may call it
};

/// Finds what is seen. Preconditions: one object at least, all of the plane's universe, from which the cuts
/// were taken; node tracing where the view is along its axes. Visits are counted where given.
Layer draw_layer(const std::vector<Drawn>& objects, const ImagePlane& plane, const std::vector<Cut>& cuts,
                 Algorithm algorithm, Visits* visits = nullptr);

/// The layer's pixels as the options' shading, lights and background and the objects' colours make them;
/// size, view, algorithm and cuts are those it was drawn with, and are not looked at.
std::vector<std::uint8_t> shade_layer(const Layer& layer, const std::vector<Drawn>& objects,
                                      const ImagePlane& plane, const RenderOptions& options);

/// A layer in which nothing is seen.
Layer empty_layer(const glm::ivec2& size_px);

/// The object as a shading wants it drawn: gradients of voxels' faces leave out what samples could add.
Drawn as_shaded(const Drawn& object, Shading shading);

/// Gives the objects seen the numbers that they have in their scene.
void number_objects(DepthImage& image, const std::vector<std::int16_t>& numbers);

/// Layers of one object each as one layer of all: the nearest is seen, of equally near ones the first.
/// Precondition: one at least, all of one plane and of the same cuts.
Layer nearest_of(const std::vector<const Layer*>& layers);

/// A translucent object of a scene.
struct Translucent {
  DepthImage image;
  std::vector<std::uint8_t> rgb;
  std::int16_t number = 0;  ///< of the object
  float opacity = 0.5f;
};

/// Fills pixels, depths and objects of a picture from its opaque layer, whose objects are numbered as in the
/// scene, its colours, and translucent objects, which are laid over it back to front.
void lay_together(DepthImage opaque, std::vector<std::uint8_t> rgb, std::vector<Translucent> translucent,
                  Picture& picture);

/// Everything about a picture but its pixels: size, view, frame, algorithm. Throws as render().
Picture blank_picture(const std::vector<Drawn>& objects, const RenderOptions& options);

/// The plane of a blank picture.
ImagePlane plane_of(const std::vector<Drawn>& objects, const Picture& picture);

}  // namespace octotomy::voxel

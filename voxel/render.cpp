// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/render.h"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "voxel/camera.h"
#include "voxel/depth_image.h"
#include "voxel/node_trace.h"
#include "voxel/ray_cast.h"
#include "voxel/shade.h"
#include "voxel/surface_break.h"

namespace octotomy::voxel {
namespace {

void check(const std::vector<Drawn>& objects, const RenderOptions& options) {
  if (objects.empty()) throw std::invalid_argument("nothing to draw: give one object at least");
  if (objects.size() > std::numeric_limits<std::int16_t>::max())
    throw std::invalid_argument("cannot draw " + std::to_string(objects.size()) +
                                " objects in one picture: at most 32767");
  for (const Drawn& object : objects) {
    if (object.octree.universe() != objects.front().octree.universe())
      throw std::invalid_argument("object '" + object.name + "' is of another universe than '" +
                                  objects.front().name + "': combine it into that universe first");
    if (object.grey && object.grey->universe() != object.octree.universe())
      throw std::invalid_argument("the grey octree of object '" + object.name +
                                  "' is of another universe than the object: build it for the same");
  }
  if (options.size_px.x < 1 || options.size_px.y < 1)
    throw std::invalid_argument("a picture of " + std::to_string(options.size_px.x) + " x " +
                                std::to_string(options.size_px.y) + " pixels: both must be positive");
  if (options.width_mm && !(std::isfinite(*options.width_mm) && *options.width_mm > 0.0))
    throw std::invalid_argument("a picture " + std::to_string(*options.width_mm) +
                                " mm wide: the width must be positive");
  if (options.centre_mm && !(std::isfinite(options.centre_mm->x) && std::isfinite(options.centre_mm->y)))
    throw std::invalid_argument("the picture's centre is not finite");
}

/// Depths between which the surfaces about a pixel lie.
struct DepthSpan {
  double near_mm = -std::numeric_limits<double>::infinity();
  double far_mm = std::numeric_limits<double>::infinity();
};

/// Fills the depth image by `seen_at`, asked for the centres of all pixels, tile by tile.
template <typename SeenAt>
DepthImage sample(const glm::ivec2& size_px, const SeenAt& seen_at) {
  constexpr int tile_px = 16;
  DepthImage image{size_px, {}};
  image.pixels.resize(static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y));
  const glm::ivec2 tiles = (size_px + (tile_px - 1)) / tile_px;
  tbb::parallel_for(0, tiles.x * tiles.y, [&](int tile) {
    const glm::ivec2 first = glm::ivec2(tile % tiles.x, tile / tiles.x) * tile_px;
    const glm::ivec2 last = glm::min(first + tile_px, size_px);
    for (int y = first.y; y < last.y; ++y)
      for (int x = first.x; x < last.x; ++x)
        image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_px.x) +
                     static_cast<std::size_t>(x)] = seen_at({x + 0.5, y + 0.5}, DepthSpan());
  });
  return image;
}

/// The span of what a pixel and its neighbours see, as far beyond as a surface may reach within a pixel.
DepthSpan span_about(const DepthImage& image, const glm::ivec2& pixel, double reach_mm) {
  DepthSpan span{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const glm::ivec2 first = glm::max(pixel - 1, glm::ivec2(0));
  const glm::ivec2 last = glm::min(pixel + 1, image.size_px - 1);
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) {
      const Seen& seen = image.at(x, y);
      if (!seen.lit()) continue;
      span.near_mm = std::min(span.near_mm, seen.depth_mm - reach_mm);
      span.far_mm = std::max(span.far_mm, seen.depth_mm + reach_mm);
    }
  return span;
}

/// Blends edge pixels of four parts each. A part is only looked at between the depths that the pixels about
/// it see: what lies elsewhere has no shaded pixel to take a colour from.
template <typename SeenAt>
void antialias(const DepthImage& image, const Scenery& scenery, const SeenAt& seen_at,
               std::vector<std::uint8_t>& rgb) {
  const double reach_mm = break_mm(std::max(scenery.pixel_mm, scenery.voxel_mm));
  const std::vector<std::uint32_t> edges = edge_pixels(image, scenery);
  // Blended from the picture as shaded, whatever the order in which pixels are done.
  std::vector<std::array<std::uint8_t, 3>> blended(edges.size());
  tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t i) {
    const auto width = static_cast<std::uint32_t>(image.size_px.x);
    const glm::ivec2 corner(edges[i] % width, edges[i] / width);
    const DepthSpan span = span_about(image, corner, reach_mm);
    std::array<Seen, 4> parts;
    for (std::size_t part = 0; part < parts.size(); ++part)
      parts[part] = seen_at(
          glm::dvec2(corner) + glm::dvec2((part & 1) != 0 ? 0.75 : 0.25, part > 1 ? 0.75 : 0.25), span);
    blended[i] = blend(image, rgb, scenery, edges[i], parts);
  });
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t channel = 0; channel < 3; ++channel)
      rgb[3 * std::size_t{edges[i]} + channel] = blended[i][channel];
}

template <typename SeenAt>
void draw(const SeenAt& seen_at, const Scenery& scenery, bool antialiased, Picture& picture) {
  const DepthImage image = sample(picture.size_px, seen_at);
  picture.rgb = shade(image, scenery);
  if (antialiased) antialias(image, scenery, seen_at, picture.rgb);
  picture.depth_mm.resize(image.pixels.size());
  picture.object.resize(image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    picture.depth_mm[i] = image.pixels[i].depth_mm;
    picture.object[i] = image.pixels[i].object;
    picture.lit_pixels += image.pixels[i].lit() ? 1 : 0;
  }
}

}  // namespace

Picture render(const std::vector<Drawn>& objects, const RenderOptions& options) {
  check(objects, options);
  const Universe& universe = objects.front().octree.universe();
  Frame frame;
  if (!options.centre_mm || !options.width_mm) frame = frame_about(objects, options.view, options.size_px);
  if (options.centre_mm) frame.centre_mm = *options.centre_mm;
  if (options.width_mm) frame.width_mm = *options.width_mm;
  const ImagePlane plane = image_plane(universe, options.view, options.size_px, frame);
  const std::optional<AxisView> axes = axis_view(universe, options.view);

  Picture picture;
  picture.size_px = options.size_px;
  picture.pixel_mm = plane.pixel_mm;
  picture.centre_mm = plane.centre_mm;
  picture.nearest_mm = plane.nearest_mm;
  picture.algorithm = options.algorithm.value_or(axes ? Algorithm::NodeTrace : Algorithm::RayCast);
  if (picture.algorithm == Algorithm::NodeTrace && !axes)
    throw std::invalid_argument(
        "node tracing needs a view along the universe's axes: use one of the six named views of an upright "
        "universe, or ray casting");

  Scenery scenery;
  for (const Drawn& object : objects) scenery.colours.push_back(object.colour);
  scenery.background = options.background;
  scenery.pixel_mm = plane.pixel_mm;
  scenery.voxel_mm = std::cbrt(universe.lattice().voxel_mm3());
  scenery.depth_range_mm = plane.depth_range_mm;
  if (picture.algorithm == Algorithm::NodeTrace) {
    const ColumnMap map = node_trace(objects, *axes);
    const VoxelRays rays = voxel_rays(universe, plane);
    draw(
        [&](const glm::dvec2& p_px, const DepthSpan&) {
          const glm::dvec3 p_voxel = rays.start(p_px);
          return map.seen({p_voxel[axes->axis[0]], p_voxel[axes->axis[1]]});
        },
        scenery, options.antialias, picture);
  } else {
    const RayCast cast(objects, plane);
    draw([&](const glm::dvec2& p_px,
             const DepthSpan& span) { return cast.seen(p_px, span.near_mm, span.far_mm); },
         scenery, options.antialias, picture);
  }
  return picture;
}

}  // namespace octotomy::voxel

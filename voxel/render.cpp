// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "voxel/back_to_front.h"
#include "voxel/camera.h"
#include "voxel/counted_trace.h"
#include "voxel/depth_image.h"
#include "voxel/depth_plane.h"
#include "voxel/front_to_back.h"
#include "voxel/interpolate.h"
#include "voxel/node_trace.h"
#include "voxel/object_normals.h"
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
    if (object.scalar && object.scalar->universe != object.octree.universe())
      throw std::invalid_argument("the scalar that colours object '" + object.name +
                                  "' is of another universe than the object: make it for the same");
    if (object.grey && object.grey->universe() != object.octree.universe())
      throw std::invalid_argument("the grey octree of object '" + object.name +
                                  "' is of another universe than the object: build it for the same");
  }
  if (options.cut_tones && options.cut_tones->grey.universe() != objects.front().octree.universe())
    throw std::invalid_argument(
        "the samples for cut faces are of another universe than the objects: build them for the same");
  if (options.cut_tones && !(options.cut_tones->white > options.cut_tones->black))
    throw std::invalid_argument("white must be a larger sample than black on cut faces");
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
template <typename At>
void antialias(const DepthImage& image, const Scenery& scenery, const At& seen_at,
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

/// What a pixel position sees between two depths.
using SeenAt = std::function<Seen(const glm::dvec2&, const DepthSpan&)>;

/// A depth image, and what sees more of the same scene.
struct Drawing {
  DepthImage image;
  SeenAt seen_at;
};

Drawing drawing_of_columns(ColumnMap columns, const AxisView& axes, const VoxelRays& rays,
                           const glm::ivec2& size_px) {
  const auto map = std::make_shared<const ColumnMap>(std::move(columns));
  const auto seen_at = [map, axes, rays](const glm::dvec2& p_px, const DepthSpan&) {
    const glm::dvec3 p_voxel = rays.start(p_px);
    return map->seen({p_voxel[axes.axis[0]], p_voxel[axes.axis[1]]});
  };
  return {picture_of(*map, axes, rays, size_px), seen_at};
}

/// The surface that samples show about the voxels' faces that were found.
DepthImage refined(DepthImage image, const RayCast& cast) {
  tbb::parallel_for(0, image.size_px.y, [&](int y) {
    for (int x = 0; x < image.size_px.x; ++x) {
      Seen& seen = image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size_px.x) +
                                static_cast<std::size_t>(x)];
      if (seen.lit()) seen = cast.seen({x + 0.5, y + 0.5});
    }
  });
  return image;
}

/// Finds what is seen, by the algorithm asked for.
Drawing drawing_of(const std::vector<Drawn>& objects, const ImagePlane& plane, Algorithm algorithm,
                   Visits* visits) {
  const Universe& universe = objects.front().octree.universe();
  const VoxelRays rays = voxel_rays(universe, plane);
  const std::optional<AxisView> axes = axis_view(universe, plane.view);
  if (algorithm == Algorithm::NodeTrace)
    return drawing_of_columns(
        visits != nullptr ? quadtree_trace(objects, *axes, visits) : node_trace(objects, *axes), *axes, rays,
        plane.size_px);
  if (algorithm != Algorithm::RayCast && axes)
    return drawing_of_columns(algorithm == Algorithm::FrontToBack ? front_to_back(objects, *axes, visits)
                                                                  : back_to_front(objects, *axes, visits),
                              *axes, rays, plane.size_px);
  const RayCast cast(objects, plane);
  const SeenAt seen_at = [cast](const glm::dvec2& p_px, const DepthSpan& span) {
    return cast.seen(p_px, span.near_mm, span.far_mm);
  };
  if (algorithm == Algorithm::RayCast) {
    if (visits != nullptr) count_rays(objects, plane, *visits);
    return {cast.picture(), seen_at};
  }
  DepthImage faces = algorithm == Algorithm::FrontToBack ? front_to_back(objects, plane, visits)
                                                         : back_to_front(objects, plane, visits);
  const bool grey = std::any_of(objects.begin(), objects.end(),
                                [](const Drawn& object) { return object.grey.has_value(); });
  return {grey ? refined(std::move(faces), cast) : std::move(faces), seen_at};
}

Scenery scenery_of(const std::vector<Drawn>& objects, const ImagePlane& plane, const RenderOptions& options) {
  Scenery scenery;
  for (const Drawn& object : objects) scenery.colours.push_back(object.colour);
  scenery.background = options.background;
  scenery.pixel_mm = plane.pixel_mm;
  scenery.voxel_mm = std::cbrt(objects.front().octree.universe().lattice().voxel_mm3());
  scenery.depth_range_mm = plane.depth_range_mm;
  scenery.occlusion = options.occlusion;
  if (!options.lights.empty()) scenery.lights = options.lights;
  if (options.shading == Shading::Depth) scenery.style = Style::Depth;
  if (options.shading == Shading::Silhouette) scenery.style = Style::Silhouette;
  if (options.shading == Shading::Outline) scenery.style = Style::Outline;
  return scenery;
}

/// What colours a pixel besides its object: samples on cut faces, scalars on surfaces.
Paint paint_of(const DepthImage& image, const std::vector<Drawn>& objects, const ImagePlane& plane,
               const RenderOptions& options, const Scenery& scenery,
               const std::vector<glm::vec3>& cut_normals) {
  Paint paint;
  const bool cuts_painted = options.cut_tones && !cut_normals.empty();
  if (!cuts_painted && std::none_of(objects.begin(), objects.end(),
                                    [](const Drawn& object) { return object.scalar != nullptr; }))
    return paint;
  paint.kinds.assign(image.pixels.size(), Paint::Kind::None);
  paint.colours.resize(image.pixels.size());
  const glm::dmat4 voxel_from_lps = glm::inverse(objects.front().octree.universe().lps_from_voxel);
  // Voxels' faces step by up to a voxel, and scalars along them: they are taken where shading sees the
  // surface.
  const DepthPlane smooth = depth_plane(image, scenery);
  tbb::parallel_for(0, image.size_px.y, [&](int y) {
    for (int x = 0; x < image.size_px.x; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size_px.x) +
                                static_cast<std::size_t>(x);
      const Seen& seen = image.pixels[pixel];
      if (!seen.lit()) continue;
      const bool on_cut = cuts_painted && cut_normals[pixel] != glm::vec3(0.0f);
      const auto& scalar = objects[static_cast<std::size_t>(seen.object)].scalar;
      if (!on_cut && scalar == nullptr) continue;
      const double depth_mm = on_cut ? seen.depth_mm : smooth.depth.row(y)[x];
      const glm::dvec3 p_mm = plane.lps_mm({x + 0.5, y + 0.5}, depth_mm);
      const glm::dvec3 p_voxel(voxel_from_lps * glm::dvec4(p_mm, 1.0));
      if (on_cut) {
        const CutTones& tones = *options.cut_tones;
        const double sample = interpolate(tones.grey, p_voxel, Interpolation::Linear);
        paint.kinds[pixel] = Paint::Kind::Tone;
        paint.colours[pixel] = glm::vec3(
            static_cast<float>(std::clamp((sample - tones.black) / (tones.white - tones.black), 0.0, 1.0)));
      } else {
        paint.kinds[pixel] = Paint::Kind::Lit;
        paint.colours[pixel] = diverging_colour(scalar->at(p_voxel) / scalar->most);
      }
    }
  });
  return paint;
}

/// Finds and shades one set of objects.
struct Layer {
  DepthImage image;
  std::vector<std::uint8_t> rgb;
};
Layer layer_of(const std::vector<Drawn>& objects, const ImagePlane& plane, const RenderOptions& options,
               Algorithm algorithm, Visits* visits) {
  Drawing drawing = drawing_of(objects, plane, algorithm, visits);
  const std::vector<glm::vec3> cut_normals =
      flatten_cuts(drawing.image, plane, objects.front().octree.universe(), options.cuts);
  Scenery scenery = scenery_of(objects, plane, options);
  scenery.paint = paint_of(drawing.image, objects, plane, options, scenery, cut_normals);
  std::vector<glm::vec3> normals;
  if (options.shading == Shading::Context || options.shading == Shading::GreyGradient)
    normals =
        object_normals(drawing.image, objects, plane,
                       options.shading == Shading::Context ? ObjectNormals::Context : ObjectNormals::Grey);
  if (!normals.empty())
    for (std::size_t i = 0; i < cut_normals.size(); ++i)
      if (cut_normals[i] != glm::vec3(0.0f)) normals[i] = cut_normals[i];
  Layer layer{std::move(drawing.image), {}};
  layer.rgb = shade(layer.image, scenery, normals);
  if (options.antialias && options.shading != Shading::Outline)
    antialias(layer.image, scenery, drawing.seen_at, layer.rgb);
  return layer;
}

/// Lays a translucent object's layer over the picture where it is nearer than what is opaque there.
void lay_over(const Layer& layer, float opacity, const DepthImage& opaque, std::vector<std::uint8_t>& rgb) {
  for (std::size_t i = 0; i < layer.image.pixels.size(); ++i) {
    const Seen& seen = layer.image.pixels[i];
    if (!seen.lit() || seen.depth_mm > opaque.pixels[i].depth_mm) continue;
    for (std::size_t channel = 3 * i; channel < 3 * i + 3; ++channel)
      rgb[channel] = static_cast<std::uint8_t>(std::lround(
          glm::mix(static_cast<float>(rgb[channel]), static_cast<float>(layer.rgb[channel]), opacity)));
  }
}

/// Objects of a scene by how they are drawn; numbers are those of the scene.
struct Parted {
  std::vector<Drawn> opaque;
  std::vector<std::int16_t> opaque_numbers;
  std::vector<std::int16_t> translucent_numbers;
};
Parted parted(const std::vector<Drawn>& objects, const RenderOptions& options) {
  Parted parts;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].opacity >= 1.0f) {
      parts.opaque.push_back(objects[i]);
      // Gradients of the voxels' faces: what samples could add is left out.
      if (options.shading == Shading::Gradient) parts.opaque.back().grey.reset();
      parts.opaque_numbers.push_back(static_cast<std::int16_t>(i));
    } else if (objects[i].opacity > 0.0f) {
      parts.translucent_numbers.push_back(static_cast<std::int16_t>(i));
    }
  }
  return parts;
}

/// Median depth of a layer, by which whole objects are sorted: layers are laid over each other back to front.
float middle_mm(const DepthImage& image) {
  std::vector<float> depths;
  for (const Seen& seen : image.pixels)
    if (seen.lit()) depths.push_back(seen.depth_mm);
  if (depths.empty()) return 0.0f;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

/// Lets the object `number`, seen by itself, be what is seen where it is nearer.
void take_nearer(const DepthImage& own, std::int16_t number, DepthImage& image) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (!own.pixels[i].lit() || own.pixels[i].depth_mm >= image.pixels[i].depth_mm) continue;
    image.pixels[i] = own.pixels[i];
    image.pixels[i].object = number;
  }
}

void compose(const std::vector<Drawn>& objects, const ImagePlane& plane, const RenderOptions& options,
             Picture& picture) {
  const Parted parts = parted(objects, options);
  Visits* visits = picture.visits ? &*picture.visits : nullptr;
  Layer opaque{{plane.size_px, {}}, {}};
  if (parts.opaque.empty()) {
    opaque.image.pixels.resize(static_cast<std::size_t>(plane.size_px.x) *
                               static_cast<std::size_t>(plane.size_px.y));
    opaque.rgb = shade(opaque.image, scenery_of(objects, plane, options));
  } else {
    opaque = layer_of(parts.opaque, plane, options, picture.algorithm, visits);
    if (parts.opaque.size() < objects.size())
      for (Seen& seen : opaque.image.pixels)
        if (seen.lit()) seen.object = parts.opaque_numbers[static_cast<std::size_t>(seen.object)];
  }
  picture.rgb = std::move(opaque.rgb);
  std::vector<std::pair<Layer, std::int16_t>> layers;
  for (const std::int16_t number : parts.translucent_numbers)
    layers.emplace_back(
        layer_of({objects[static_cast<std::size_t>(number)]}, plane, options, picture.algorithm, visits),
        number);
  std::stable_sort(layers.begin(), layers.end(), [](const auto& a, const auto& b) {
    return middle_mm(a.first.image) > middle_mm(b.first.image);
  });
  if (!layers.empty()) {
    const DepthImage behind = opaque.image;
    for (const auto& [layer, number] : layers) {
      const float opacity = objects[static_cast<std::size_t>(number)].opacity;
      lay_over(layer, opacity, behind, picture.rgb);
      if (opacity >= 0.5f) take_nearer(layer.image, number, opaque.image);
    }
  }
  picture.depth_mm.resize(opaque.image.pixels.size());
  picture.object.resize(opaque.image.pixels.size());
  for (std::size_t i = 0; i < opaque.image.pixels.size(); ++i) {
    const Seen& seen = opaque.image.pixels[i];
    picture.depth_mm[i] = seen.depth_mm;
    picture.object[i] = seen.object;
    picture.lit_pixels += seen.lit() ? 1 : 0;
  }
}

}  // namespace

std::optional<glm::dvec3> Picture::point_mm(const glm::ivec2& pixel) const {
  const std::size_t index = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(size_px.x) +
                            static_cast<std::size_t>(pixel.x);
  if (object[index] < 0) return std::nullopt;
  return plane().lps_mm(glm::dvec2(pixel) + 0.5, depth_mm[index]);
}

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
  picture.view = options.view;
  picture.algorithm = options.algorithm.value_or(axes ? Algorithm::NodeTrace : Algorithm::RayCast);
  if (picture.algorithm == Algorithm::NodeTrace && !axes)
    throw std::invalid_argument(
        "node tracing needs a view along the universe's axes: use one of the six named views of an upright "
        "universe, or ray casting");
  if (options.count) picture.visits.emplace();
  compose(options.cuts.empty() ? objects : without(objects, options.cuts), plane, options, picture);
  return picture;
}

}  // namespace octotomy::voxel

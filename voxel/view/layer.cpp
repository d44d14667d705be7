// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/layer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <numeric>
#include <tbb/parallel_for.h>

#include "voxel/tree/interpolate.h"
#include "voxel/view/back_to_front.h"
#include "voxel/view/column_map.h"
#include "voxel/view/counted_trace.h"
#include "voxel/view/depth_plane.h"
#include "voxel/view/front_to_back.h"
#include "voxel/view/node_trace.h"
#include "voxel/view/object_normals.h"
#include "voxel/view/pixel_index.h"
#include "voxel/view/ray_cast.h"
#include "voxel/view/srgb.h"

namespace octotomy::voxel {
namespace {

/// The span of the depths at a pixel and its neighbours, extended by the depth that a surface spans within a
/// pixel.
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

/// Blends four parts of each edge pixel. A part is traced only between the depths of the surrounding pixels,
/// because for a surface elsewhere no shaded pixel has the colour.
template <typename At>
void antialias(const DepthImage& image, const Scenery& scenery, const At& seen_at,
               std::vector<std::uint8_t>& rgb) {
  const double reach_mm = break_mm(std::max(scenery.pixel_mm, scenery.voxel_mm));
  const std::vector<std::uint32_t> edges = edge_pixels(image, scenery);
  // Reads only the unblended picture, so that the order of pixels does not matter.
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

/// A depth image, and a function that traces single rays of the same scene.
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

/// Replaces depths of voxels' faces by those of the surface in the samples.
DepthImage refined(DepthImage image, const RayCast& cast) {
  tbb::parallel_for(0, image.size_px.y, [&](int y) {
    for (int x = 0; x < image.size_px.x; ++x) {
      Seen& seen = image.pixels[pixel_index(image.size_px, x, y)];
      if (seen.lit()) seen = cast.seen({x + 0.5, y + 0.5});
    }
  });
  return image;
}

/// Traces the objects by the given algorithm.
Drawing drawing_of(const std::vector<DrawnObject>& objects, const ImagePlane& plane, Algorithm algorithm,
                   Visits* visits) {
  const Universe& universe = objects.front().octree.universe();
  const VoxelRays rays = voxel_rays(universe, plane);
  const std::optional<AxisView> axes = axis_view(universe, plane.view);
  if (algorithm == Algorithm::NodeTrace && axes)
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
  DepthImage faces = algorithm == Algorithm::NodeTrace     ? quadtree_trace(objects, plane, visits)
                     : algorithm == Algorithm::FrontToBack ? front_to_back(objects, plane, visits)
                                                           : back_to_front(objects, plane, visits);
  const bool grey = std::any_of(objects.begin(), objects.end(),
                                [](const DrawnObject& object) { return object.grey.has_value(); });
  return {grey ? refined(std::move(faces), cast) : std::move(faces), seen_at};
}

Scenery scenery_of(const std::vector<DrawnObject>& objects, const ImagePlane& plane,
                   const RenderOptions& options) {
  Scenery scenery;
  for (const DrawnObject& object : objects) scenery.colours.push_back(object.colour);
  scenery.background = options.background;
  scenery.pixel_mm = plane.pixel_mm;
  scenery.voxel_mm = std::cbrt(objects.front().octree.universe().lattice().voxel_mm3());
  scenery.depth_range_mm = plane.depth_range_mm;
  scenery.occlusion = options.occlusion;
  if (!options.lights.empty()) scenery.lights = options.lights;
  if (options.ambient) scenery.ambient = *options.ambient;
  if (options.gloss) scenery.gloss = *options.gloss;
  if (options.exponent) scenery.exponent = *options.exponent;
  if (options.shading == Shading::Depth) scenery.style = Style::Depth;
  if (options.shading == Shading::Silhouette) scenery.style = Style::Silhouette;
  if (options.shading == Shading::Outline) scenery.style = Style::Outline;
  return scenery;
}

/// The sample of the voxel visible at a point of a surface or cut face, read at the point or at the voxel's
/// centre. A surface runs between voxels' centres, so the voxel may begin up to a voxel's diagonal behind the
/// point. It is searched for along the view direction, `ahead`, in steps of a quarter voxel.
std::optional<double> sample_behind(const GreyOwners& samples, const glm::dvec3& p_voxel,
                                    const glm::dvec3& ahead, bool at_centre) {
  constexpr int most_steps = 8;
  const glm::dvec3 step = 0.25 * glm::normalize(ahead);
  for (int i = 0; i <= most_steps; ++i) {
    const glm::ivec3 voxel(glm::floor(p_voxel + double(i) * step + 0.5));
    if (const std::optional<OwnedSample> owned = samples.at(voxel, at_centre ? glm::dvec3(voxel) : p_voxel))
      return owned->value();
  }
  return std::nullopt;
}

/// The grey tone of a sample between black and white.
glm::vec3 tone_of(const CutTones& tones, double sample) {
  return glm::vec3(
      static_cast<float>(std::clamp((sample - tones.black) / (tones.white - tones.black), 0.0, 1.0)));
}

/// The share of light that remains at a depth. The farthest pixels keep a tenth, as in Style::Depth.
class Attenuation {
 public:
  explicit Attenuation(const DepthImage& image) {
    for (const Seen& seen : image.pixels) {
      if (!seen.lit()) continue;
      near_mm_ = std::min(near_mm_, seen.depth_mm);
      far_mm_ = std::max(far_mm_, seen.depth_mm);
    }
  }
  glm::vec3 operator()(const glm::vec3& srgb, float depth_mm) const {
    if (!(far_mm_ > near_mm_)) return srgb;
    const float left = 1.0f - 0.9f * (depth_mm - near_mm_) / (far_mm_ - near_mm_);
    std::array<std::uint8_t, 3> dimmed{};
    put_srgb(dimmed.data(), left * linear_from_srgb(srgb));
    return glm::vec3(dimmed[0], dimmed[1], dimmed[2]) / 255.0f;
  }

 private:
  float near_mm_ = std::numeric_limits<float>::infinity(), far_mm_ = -near_mm_;
};

/// Sets the paint of a pixel that shows a sample (thesis 5.2.1.2).
void paint_density(const Densities& densities, double sample, const Attenuation* attenuation, float depth_mm,
                   Paint::Kind& kind, glm::vec3& colour) {
  const auto range =
      std::find_if(densities.colours.begin(), densities.colours.end(),
                   [&](const DensityColour& each) { return each.low <= sample && sample <= each.high; });
  const bool is_coloured = range != densities.colours.end();
  if (attenuation != nullptr) {
    kind = Paint::Kind::Tone;
    colour = (*attenuation)(is_coloured ? range->colour : tone_of(densities.tones, sample), depth_mm);
  } else if (is_coloured) {
    kind = Paint::Kind::Lit;
    colour = range->colour;
  }
}

/// The paint of all pixels: samples on cut faces, and scalars or samples on surfaces.
Paint paint_of(const DepthImage& image, const std::vector<DrawnObject>& objects, const ImagePlane& plane,
               const RenderOptions& options, const Scenery& scenery,
               const std::vector<glm::vec3>& cut_normals) {
  Paint paint;
  const bool cuts_painted = options.cut_tones && !cut_normals.empty();
  if (!cuts_painted && !options.densities &&
      std::none_of(objects.begin(), objects.end(),
                   [](const DrawnObject& object) { return object.scalar != nullptr; }))
    return paint;
  paint.kinds.assign(image.pixels.size(), Paint::Kind::None);
  paint.colours.resize(image.pixels.size());
  const glm::dmat4 voxel_from_lps = glm::inverse(objects.front().octree.universe().lps_from_voxel);
  // Scalars are read on the smoothed surface, because voxels' faces step by up to a voxel.
  const DepthPlane smooth = depth_plane(image, scenery);
  std::optional<Attenuation> attenuation;
  if (options.shading == Shading::Density) attenuation.emplace(image);
  tbb::parallel_for(0, image.size_px.y, [&](int y) {
    for (int x = 0; x < image.size_px.x; ++x) {
      const std::size_t pixel = pixel_index(image.size_px, x, y);
      const Seen& seen = image.pixels[pixel];
      if (!seen.lit()) continue;
      const bool on_cut = cuts_painted && cut_normals[pixel] != glm::vec3(0.0f);
      const auto& scalar = objects[static_cast<std::size_t>(seen.object)].scalar;
      if (!on_cut && !options.densities && scalar == nullptr) continue;
      const bool reads_samples = on_cut || options.densities.has_value();
      const double depth_mm = reads_samples ? seen.depth_mm : smooth.depth.row(y)[x];
      const glm::dvec3 p_mm = plane.lps_mm({x + 0.5, y + 0.5}, depth_mm);
      const glm::dvec3 p_voxel(voxel_from_lps * glm::dvec4(p_mm, 1.0));
      if (!reads_samples) {
        paint.kinds[pixel] = Paint::Kind::Lit;
        paint.colours[pixel] = diverging_colour(scalar->at(p_voxel) / scalar->most);
        continue;
      }
      const CutTones& tones = on_cut ? *options.cut_tones : options.densities->tones;
      const glm::dvec3 ahead_mm = plane.lps_mm({x + 0.5, y + 0.5}, depth_mm + 1.0) - p_mm;
      const std::optional<double> sample =
          sample_behind(tones.samples, p_voxel, glm::dmat3(voxel_from_lps) * ahead_mm, !on_cut);
      if (!sample) continue;
      if (on_cut) {
        paint.kinds[pixel] = Paint::Kind::Tone;
        paint.colours[pixel] = tone_of(tones, *sample);
      } else {
        paint_density(*options.densities, *sample, attenuation ? &*attenuation : nullptr, seen.depth_mm,
                      paint.kinds[pixel], paint.colours[pixel]);
      }
    }
  });
  return paint;
}

/// Whether the shading reads voxels around the visible voxels.
bool reads_voxels(Shading shading) {
  return shading == Shading::Context || shading == Shading::GreyGradient;
}

}  // namespace

std::vector<DrawnObject> to_trace(const std::vector<DrawnObject>& objects, const RenderOptions& options,
                                  Algorithm algorithm) {
  std::vector<DrawnObject> left = without(objects, options.cuts);
  const bool along_axis = axis_view(objects.front().octree.universe(), options.view).has_value();
  if (algorithm == Algorithm::NodeTrace && along_axis && !options.count && !reads_voxels(options.shading))
    return left;
  return built(std::move(left));
}

Layer draw_layer(const std::vector<DrawnObject>& objects, const ImagePlane& plane,
                 const std::vector<Cutaway>& cuts, Algorithm algorithm, Visits* visits) {
  Drawing drawing = drawing_of(objects, plane, algorithm, visits);
  Layer layer{std::move(drawing.image), {}, std::move(drawing.seen_at)};
  layer.cut_normals = flatten_cuts(layer.image, plane, objects.front().octree.universe(), cuts);
  return layer;
}

std::vector<std::uint8_t> shade_layer(const Layer& layer, const std::vector<DrawnObject>& objects,
                                      const ImagePlane& plane, const RenderOptions& options) {
  Scenery scenery = scenery_of(objects, plane, options);
  scenery.paint = paint_of(layer.image, objects, plane, options, scenery, layer.cut_normals);
  std::vector<glm::vec3> normals;
  if (reads_voxels(options.shading))
    normals =
        object_normals(layer.image, built(objects), plane,
                       options.shading == Shading::Context ? ObjectNormals::Context : ObjectNormals::Grey);
  if (!normals.empty())
    for (std::size_t i = 0; i < layer.cut_normals.size(); ++i)
      if (layer.cut_normals[i] != glm::vec3(0.0f)) normals[i] = layer.cut_normals[i];
  std::vector<std::uint8_t> rgb = shade(layer.image, scenery, normals);
  if (options.antialias && options.shading != Shading::Outline)
    antialias(layer.image, scenery, layer.seen_at, rgb);
  return rgb;
}

Layer empty_layer(const glm::ivec2& size_px) {
  return {unlit(size_px), {}, [](const glm::dvec2&, const DepthSpan&) { return Seen{}; }};
}

DrawnObject as_shaded(const DrawnObject& object, Shading shading) {
  DrawnObject drawn = object;
  if (shading == Shading::Gradient || shading == Shading::Density) drawn.grey.reset();
  return drawn;
}

void number_objects(DepthImage& image, const std::vector<std::int16_t>& numbers) {
  // In most pictures each object already has the right number.
  std::vector<std::int16_t> same(numbers.size());
  std::iota(same.begin(), same.end(), std::int16_t{0});
  if (numbers == same) return;
  for (Seen& seen : image.pixels) {
    assert(seen.object < static_cast<int>(numbers.size()));
    if (seen.lit()) seen.object = numbers[static_cast<std::size_t>(seen.object)];
  }
}

Layer nearest_of(const std::vector<const Layer*>& layers) {
  assert(!layers.empty());
  Layer nearest = *layers.front();
  for (std::size_t other = 1; other < layers.size(); ++other) {
    const Layer& layer = *layers[other];
    tbb::parallel_for(std::size_t{0}, layer.image.pixels.size(), [&](std::size_t i) {
      const Seen& seen = layer.image.pixels[i];
      if (!seen.lit() || !(seen.depth_mm < nearest.image.pixels[i].depth_mm)) return;
      nearest.image.pixels[i] = seen;
      nearest.image.pixels[i].object = static_cast<std::int16_t>(other);
      if (!layer.cut_normals.empty()) nearest.cut_normals[i] = layer.cut_normals[i];
    });
  }
  std::vector<SeenAt> all;
  all.reserve(layers.size());
  for (const Layer* layer : layers) all.push_back(layer->seen_at);
  nearest.seen_at = [all = std::move(all)](const glm::dvec2& p_px, const DepthSpan& span) {
    Seen least;
    for (std::size_t i = 0; i < all.size(); ++i) {
      Seen seen = all[i](p_px, span);
      if (!seen.lit() || !(seen.depth_mm < least.depth_mm)) continue;
      seen.object = static_cast<std::int16_t>(i);
      least = seen;
    }
    return least;
  };
  return nearest;
}

}  // namespace octotomy::voxel

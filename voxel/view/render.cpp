// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/render.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "voxel/space/error.h"
#include "voxel/view/layer.h"
#include "voxel/view/pixel_index.h"

namespace octotomy::voxel {
namespace {

void check(const std::vector<DrawnObject>& objects, const RenderOptions& options) {
  if (objects.empty()) throw InvalidInput("nothing to draw: choose at least one object");
  if (objects.size() > std::numeric_limits<std::int16_t>::max())
    throw InvalidInput("cannot draw " + std::to_string(objects.size()) +
                       " objects in one picture: at most 32767");
  for (const DrawnObject& object : objects) {
    if (object.octree.universe() != objects.front().octree.universe())
      throw InvalidInput("object '" + object.name + "' has another universe than '" + objects.front().name +
                         "': combine it into that universe first");
    if (object.scalar && object.scalar->universe != object.octree.universe())
      throw std::invalid_argument(
          "the scalar that colours object '" + object.name +
          "' has another universe than the object: compute the scalar in the object's universe");
    if (object.grey && !object.moved_from_still && object.grey->universe() != object.octree.universe())
      throw std::invalid_argument(
          "the grey octree of object '" + object.name +
          "' has another universe than the object: build the grey octree in the object's universe");
  }
  if (options.cut_tones && options.cut_tones->samples.universe() != objects.front().octree.universe())
    throw std::invalid_argument(
        "the samples for cut faces are of another universe than the objects: build them in the objects' "
        "universe");
  if (options.cut_tones && !(options.cut_tones->white > options.cut_tones->black))
    throw InvalidInput("white must be a larger sample than black on cut faces");
  if (options.densities && options.densities->tones.samples.universe() != objects.front().octree.universe())
    throw std::invalid_argument(
        "the samples that colour surfaces are of another universe than the objects: build them in the "
        "objects' universe");
  if (options.shading == Shading::Density && !options.densities)
    throw InvalidInput("shading by density needs samples: draw a scan or a grey octree");
  if (options.size_px.x < 1 || options.size_px.y < 1)
    throw InvalidInput("a picture of " + std::to_string(options.size_px.x) + " x " +
                       std::to_string(options.size_px.y) + " pixels: both must be positive");
  if (options.width_mm && !(std::isfinite(*options.width_mm) && *options.width_mm > 0.0))
    throw InvalidInput("a picture " + std::to_string(*options.width_mm) +
                       " mm wide: the width must be positive");
  if (!is_frame(options.view))
    throw std::invalid_argument("a view's directions must be unit vectors, perpendicular to each other");
  if (options.eye_mm && !(std::isfinite(*options.eye_mm) && *options.eye_mm > 0.0))
    throw InvalidInput("an eye " + std::to_string(*options.eye_mm) +
                       " mm away: the distance must be positive");
  if (options.centre_mm && !(std::isfinite(options.centre_mm->x) && std::isfinite(options.centre_mm->y)))
    throw InvalidInput("the picture's centre is not finite");
}

/// Blends a translucent object over the pixels at which this object is nearer than the opaque surface.
void lay_over(const Translucent& layer, const DepthImage& opaque, std::vector<std::uint8_t>& rgb) {
  for (std::size_t i = 0; i < layer.image.pixels.size(); ++i) {
    const Seen& seen = layer.image.pixels[i];
    if (!seen.lit() || seen.depth_mm > opaque.pixels[i].depth_mm) continue;
    for (std::size_t channel = 3 * i; channel < 3 * i + 3; ++channel)
      rgb[channel] = static_cast<std::uint8_t>(std::lround(
          glm::mix(static_cast<float>(rgb[channel]), static_cast<float>(layer.rgb[channel]), layer.opacity)));
  }
}

/// The median depth of a layer. Translucent layers are sorted by it, back to front.
float middle_mm(const DepthImage& image) {
  std::vector<float> depths;
  for (const Seen& seen : image.pixels)
    if (seen.lit()) depths.push_back(seen.depth_mm);
  if (depths.empty()) return 0.0f;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

/// Overwrites the pixels at which object `number` is nearer.
void take_nearer(const DepthImage& own, std::int16_t number, DepthImage& image) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (!own.pixels[i].lit() || own.pixels[i].depth_mm >= image.pixels[i].depth_mm) continue;
    image.pixels[i] = own.pixels[i];
    image.pixels[i].object = number;
  }
}

}  // namespace

void lay_together(DepthImage opaque, std::vector<std::uint8_t> rgb, std::vector<Translucent> translucent,
                  Picture& picture) {
  std::stable_sort(translucent.begin(), translucent.end(), [](const Translucent& a, const Translucent& b) {
    return middle_mm(a.image) > middle_mm(b.image);
  });
  picture.rgb = std::move(rgb);
  const DepthImage behind = translucent.empty() ? DepthImage{} : opaque;
  for (const Translucent& layer : translucent) {
    lay_over(layer, behind, picture.rgb);
    if (layer.opacity >= 0.5f) take_nearer(layer.image, layer.number, opaque);
  }
  picture.depth_mm.resize(opaque.pixels.size());
  picture.object.resize(opaque.pixels.size());
  using Span = tbb::blocked_range<std::size_t>;
  constexpr std::size_t pixels_a_task = std::size_t{1} << 16;
  picture.lit_pixels = tbb::parallel_reduce(
      Span(0, opaque.pixels.size(), pixels_a_task), std::uint64_t{0},
      [&](const Span& range, std::uint64_t lit) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const Seen& seen = opaque.pixels[i];
          picture.depth_mm[i] = seen.depth_mm;
          picture.object[i] = seen.object;
          lit += seen.lit() ? 1 : 0;
        }
        return lit;
      },
      std::plus<>());
}

std::optional<glm::dvec3> Picture::point_mm(const glm::ivec2& pixel) const {
  const std::size_t index = pixel_index(size_px, pixel.x, pixel.y);
  if (object[index] < 0) return std::nullopt;
  return plane().lps_mm(glm::dvec2(pixel) + 0.5, depth_mm[index]);
}

Picture blank_picture(const std::vector<DrawnObject>& objects, const RenderOptions& options) {
  check(objects, options);
  const Universe& universe = objects.front().octree.universe();
  Frame frame;
  if (!options.centre_mm || !options.width_mm)
    frame = frame_about(built(objects), options.view, options.size_px);
  if (options.centre_mm) frame.centre_mm = *options.centre_mm;
  if (options.width_mm) frame.width_mm = *options.width_mm;
  ImagePlane plane = image_plane(universe, options.view, options.size_px, frame);
  if (options.eye_mm) plane = seen_from(plane, *options.eye_mm);
  const std::optional<AxisView> axes = plane.eye ? std::nullopt : axis_view(universe, options.view);

  Picture picture;
  picture.size_px = options.size_px;
  picture.pixel_mm = plane.pixel_mm;
  picture.centre_mm = plane.centre_mm;
  picture.nearest_mm = plane.nearest_mm;
  picture.eye = plane.eye;
  picture.view = options.view;
  picture.algorithm = options.algorithm.value_or(axes ? Algorithm::NodeTrace : Algorithm::RayCast);
  if (plane.eye && (picture.algorithm != Algorithm::RayCast || options.count))
    throw InvalidInput(
        "a picture from an eye at a finite distance needs ray casting and no count of visits: choose ray "
        "casting or an orthographic picture");
  if (options.count) picture.visits.emplace();
  return picture;
}

ImagePlane plane_of(const std::vector<DrawnObject>& objects, const Picture& picture) {
  ImagePlane plane = image_plane(objects.front().octree.universe(), picture.view, picture.size_px,
                                 {picture.centre_mm, picture.pixel_mm * picture.size_px.x});
  plane.pixel_mm = picture.pixel_mm;  // depth and object exactly as in the picture
  plane.eye = picture.eye;
  return plane;
}

Picture render(const std::vector<DrawnObject>& scene, const RenderOptions& options) {
  Picture picture = blank_picture(scene, options);
  const ImagePlane plane = plane_of(scene, picture);
  Visits* visits = picture.visits ? &*picture.visits : nullptr;
  const std::vector<DrawnObject> objects = to_trace(scene, options, picture.algorithm);
  std::vector<DrawnObject> opaque;
  std::vector<std::int16_t> numbers;
  std::vector<Translucent> translucent;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto number = static_cast<std::int16_t>(i);
    const DrawnObject object = as_shaded(objects[i], options.shading);
    if (object.opacity >= 1.0f) {
      opaque.push_back(object);
      numbers.push_back(number);
    } else if (object.opacity > 0.0f) {
      Layer layer = draw_layer({object}, plane, options.cuts, picture.algorithm, visits);
      std::vector<std::uint8_t> rgb = shade_layer(layer, {object}, plane, options);
      translucent.push_back({std::move(layer.image), std::move(rgb), number, object.opacity});
    }
  }
  if (opaque.empty()) {
    const Layer nothing = empty_layer(plane.size_px);
    lay_together(nothing.image, shade_layer(nothing, objects, plane, options), std::move(translucent),
                 picture);
    return picture;
  }
  Layer layer = draw_layer(opaque, plane, options.cuts, picture.algorithm, visits);
  std::vector<std::uint8_t> rgb = shade_layer(layer, opaque, plane, options);
  number_objects(layer.image, numbers);
  lay_together(std::move(layer.image), std::move(rgb), std::move(translucent), picture);
  return picture;
}

}  // namespace octotomy::voxel

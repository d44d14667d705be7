// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/ray_pictures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/light_choice.h"
#include "planner/operation/picture/ray_choice.h"
#include "planner/operation/picture/transfer_file.h"
#include "voxel/view/composite.h"
#include "voxel/view/radiograph.h"

namespace octotomy::planner {
namespace {

voxel::TransferFunction transfer_of(const Render& render) {
  if (render.transfer.empty()) return voxel::preset_transfer("bone");
  const std::vector<std::string> presets = voxel::preset_transfers();
  if (std::find(presets.begin(), presets.end(), render.transfer) == presets.end() &&
      std::filesystem::exists(render.transfer))
    return read_transfer(render.transfer);
  return voxel::preset_transfer(render.transfer);
}

voxel::CompositeOptions composite_options_of(const Render& render) {
  voxel::CompositeOptions options{transfer_of(render), cuts_of(render), lights_of(render)};
  if (render.ambient) options.ambient = static_cast<float>(*render.ambient);
  options.gradient = gradient_opacity_of(render);
  return options;
}

/// A picture with its results.
struct RayPicture {
  std::vector<std::uint8_t> rgb;
  std::uint64_t lit_pixels = 0;
  std::optional<glm::vec2> depth_range_mm;
  std::optional<glm::vec2> values;
};

/// Pixels count as lit if less than half of the light from behind passes.
RayPicture picture_of(const voxel::Composite& composite) {
  RayPicture picture;
  picture.rgb = voxel::over(composite, glm::vec3(1.0f));
  float low = 0.0f, high = 0.0f;
  for (const float depth : composite.depth_mm) {
    if (!std::isfinite(depth)) continue;
    low = picture.lit_pixels == 0 ? depth : std::min(low, depth);
    high = picture.lit_pixels == 0 ? depth : std::max(high, depth);
    ++picture.lit_pixels;
  }
  if (picture.lit_pixels > 0) picture.depth_range_mm = glm::vec2(low, high);
  return picture;
}

RayPicture picture_of(const voxel::RayImage& image) {
  const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
  RayPicture picture;
  // Bone is white, as on films.
  picture.rgb = voxel::grey_tones(image, *low, *high > *low ? *high : *low + 1.0);
  picture.lit_pixels = static_cast<std::uint64_t>(std::count_if(
      image.values.begin(), image.values.end(), [lowest = *low](float value) { return value > lowest; }));
  picture.values = glm::vec2(*low, *high);
  return picture;
}

}  // namespace

std::vector<std::string> ray_picture_names() {
  return {"mip", "radiograph", "composite"};
}

bool is_ray_picture(const Render& render) {
  const std::vector<std::string> names = ray_picture_names();
  return std::find(names.begin(), names.end(), render.shading) != names.end();
}

void check_rays(const Render& render) {
  const auto refuse = [](const std::string& option, const std::string& why) {
    throw std::runtime_error(option + ": " + why);
  };
  if (render.count || !render.algorithm.empty() || !render.picks.empty() || render.cut_face != "plain" ||
      !render.colour_by.empty())
    refuse("--shading", render.shading + " has no --algorithm, --count, --pick, --cut-face or --colour-by");
  if (!render.expression.empty())
    refuse("--expression", "an expression has no samples along rays: choose another --shading");
  if (render.eye_mm || render.stereo_deg)
    refuse(render.eye_mm ? "--eye" : "--stereo",
           "--shading " + render.shading +
               " is drawn orthographic and for one eye only: leave out --eye and --stereo");
  if (render.shading != "composite" && !render.transfer.empty())
    refuse("--transfer", "only --shading composite has a transfer function");
  if (render.shading != "composite" && !(render.cut_planes.empty() && render.cut_boxes.empty()))
    refuse("--shading", render.shading + " cannot be cut: choose composite, or leave the cuts out");
}

SampleWindow ray_window(const Render& render) {
  if (render.shading != "composite") return render.window;
  return {voxel::visible_from(transfer_of(render))};
}

RenderedPicture render_rays(const Render& render, const std::vector<voxel::DrawnObject>& objects,
                            Timings& timings, const std::stop_token& stop) {
  if (objects.size() != 1 || !objects.front().grey)
    throw std::runtime_error("--shading " + render.shading + " needs the samples of one scan or grey octree");
  const voxel::GreyOctree& grey = *objects.front().grey;
  const voxel::View view = voxel::parse_view(render.view);
  RenderedPicture made;
  made.size_px = size_of(render);
  voxel::Frame frame = voxel::frame_about(objects, view, made.size_px);
  if (render.width_mm) frame.width_mm = *render.width_mm;
  if (render.centre_mm) frame.centre_mm = view.project(*render.centre_mm);
  const voxel::ImagePlane plane = voxel::image_plane(grey.universe(), view, made.size_px, frame);
  const voxel::Progress progress{stop, {}};
  RayPicture picture;
  {
    const Stopwatch watch(timings, "render");
    if (render.shading == "composite")
      picture = picture_of(voxel::composite(grey, plane, composite_options_of(render), progress));
    else
      picture =
          picture_of(render.shading == "mip" ? voxel::maximum_intensity(grey, plane, progress)
                                             : voxel::radiograph(grey, plane, progress, weights_of(render)));
  }
  made.rgb = std::move(picture.rgb);
  made.pixel_mm = plane.pixel_mm;
  made.centre_mm = plane.centre_mm;
  const auto range = [](const glm::vec2& ends) { return Json::array({ends.x, ends.y}); };
  made.said = {{"view", render.view},
               {"shading", render.shading},
               {"size_px", {made.size_px.x, made.size_px.y}},
               {"pixel_mm", plane.pixel_mm},
               {"lit_pixels", picture.lit_pixels},
               {"depth_range_mm", picture.depth_range_mm ? range(*picture.depth_range_mm) : Json(nullptr)},
               {"objects", {{{"name", objects.front().name}, {"lit_pixels", picture.lit_pixels}}}}};
  if (picture.values) made.said["values"] = range(*picture.values);
  std::optional<voxel::Annotation> annotation;
  if (render.annotate) {
    annotation = annotation_of(render, objects);
    annotation->legend.clear();
  }
  finish(made, plane, render, annotation);
  return made;
}

}  // namespace octotomy::planner

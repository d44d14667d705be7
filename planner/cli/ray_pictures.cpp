// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/ray_pictures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "planner/measure/result_json.h"
#include "planner/report/transfer_file.h"
#include "planner/table/number_format.h"
#include "voxel/scan/image_file.h"
#include "voxel/view/composite.h"
#include "voxel/view/radiograph.h"

namespace octotomy::planner::cli {
namespace {

void refuse_what_there_is_not(const RenderText& text) {
  if (text.count || !text.algorithm.empty() || !text.picks.empty() || text.cut_face != "plain" ||
      !text.colour_by.empty())
    throw CLI::ValidationError(
        "--shading", text.shading + " has no --algorithm, --count, --pick, --cut-face or --colour-by");
  if (text.eye_mm || text.stereo_deg)
    throw CLI::ValidationError(text.eye_mm ? "--eye" : "--stereo",
                               "--shading " + text.shading + " is drawn orthographic and for one eye only");
  if (text.shading != "composite" && !text.transfer.empty())
    throw CLI::ValidationError("--transfer", "only --shading composite has a transfer function");
  if (text.shading != "composite" && !(text.cut_planes.empty() && text.cut_boxes.empty()))
    throw CLI::ValidationError("--shading", text.shading + " is not cut; composite is");
}

voxel::TransferFunction transfer_of(const RenderText& text) {
  if (text.transfer.empty()) return voxel::preset_transfer("bone");
  const std::vector<std::string> presets = voxel::preset_transfers();
  if (std::find(presets.begin(), presets.end(), text.transfer) == presets.end() &&
      std::filesystem::exists(text.transfer))
    return read_transfer(text.transfer);
  return voxel::preset_transfer(text.transfer);
}

/// A picture, and what is said of it.
struct RayPicture {
  std::vector<std::uint8_t> rgb;
  std::uint64_t lit_pixels = 0;
  std::optional<glm::vec2> depth_range_mm;
  std::optional<glm::vec2> values;
};

/// Lit pixels are those that let through less than half of the light from behind.
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
  // Bone is white on films.
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

bool is_ray_picture(const RenderText& text) {
  const std::vector<std::string> names = ray_picture_names();
  return std::find(names.begin(), names.end(), text.shading) != names.end();
}

int render_rays(const Program& program, const RenderText& text) {
  refuse_what_there_is_not(text);
  voxel::CompositeOptions composite{{}, cuts_of(text), {}};
  DrawnText drawn = text.drawn;
  if (text.shading == "composite") {
    composite.transfer = transfer_of(text);
    drawn.window = std::to_string(voxel::visible_from(composite.transfer)) + ":";
  }
  Timings timings;
  const std::vector<voxel::DrawnObject> objects = drawn_of_files(drawn, timings);
  if (objects.size() != 1 || !objects.front().grey)
    throw std::runtime_error("--shading " + text.shading +
                             " needs the samples of one scan or grey octree, and a --window LOW:");
  const voxel::GreyOctree& grey = *objects.front().grey;
  const voxel::View view = voxel::parse_view(text.view);
  const glm::ivec2 size_px = size_of(text);
  voxel::Frame frame = voxel::frame_about(objects, view, size_px);
  if (text.width_mm) frame.width_mm = *text.width_mm;
  const voxel::ImagePlane plane = voxel::image_plane(grey.universe(), view, size_px, frame);
  const voxel::Progress progress{program.stop.get_token(), {}};
  RayPicture picture;
  {
    const Stopwatch watch(timings, "render");
    if (text.shading == "composite")
      picture = picture_of(voxel::composite(grey, plane, composite, progress));
    else
      picture = picture_of(text.shading == "mip" ? voxel::maximum_intensity(grey, plane, progress)
                                                 : voxel::radiograph(grey, plane, progress));
  }
  {
    const Stopwatch watch(timings, "write");
    if (text.annotate) {
      voxel::Annotation annotation = annotation_of(text, objects);
      annotation.legend.clear();
      voxel::annotate(picture.rgb, plane, annotation);
    }
    voxel::write_image(text.out, size_px, picture.rgb);
  }
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["view"] = text.view;
  json["shading"] = text.shading;
  json["size_px"] = {size_px.x, size_px.y};
  json["pixel_mm"] = plane.pixel_mm;
  json["lit_pixels"] = picture.lit_pixels;
  const auto range = [](const glm::vec2& ends) { return Json::array({ends.x, ends.y}); };
  json["depth_range_mm"] = picture.depth_range_mm ? range(*picture.depth_range_mm) : Json(nullptr);
  json["objects"] = {{{"name", objects.front().name}, {"lit_pixels", picture.lit_pixels}}};
  if (picture.values) json["values"] = range(*picture.values);
  program.say(json, lines({{"written", text.out.string()}, {"pixel", grouped(plane.pixel_mm, 4) + " mm"}}));
  return done;
}

}  // namespace octotomy::planner::cli

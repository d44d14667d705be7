// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "planner/answer.h"
#include "planner/cli/verb.h"
#include "planner/figures.h"
#include "voxel/combine.h"
#include "voxel/image_file.h"
#include "voxel/read_scene.h"
#include "voxel/render.h"

namespace octotomy::planner::cli {
namespace {

struct RenderText {
  std::filesystem::path scan;
  std::filesystem::path out;
  std::string window = "300:";
  std::string view = "anterior";
  std::string size = "512x512";
  std::string algorithm;
  std::optional<double> voxel_mm;
};

glm::ivec2 size_of(const std::string& text) {
  int width = 0, height = 0;
  char cross = 0, rest = 0;
  const bool read =
      std::sscanf(text.c_str(), "%d%c%d%c", &width, &cross, &height, &rest) == 3 && cross == 'x';
  constexpr int most = 8192;
  if (!read || width < 1 || height < 1 || width > most || height > most)
    throw CLI::ValidationError(
        "--size", "'" + text + "' is no size: give WxH of 1 to 8192 pixels, for example 512x512");
  return {width, height};
}

/// Nearest and farthest lit depth; null where nothing is lit.
Json depth_range(const voxel::Picture& picture) {
  float low = 0.0f, high = -1.0f;
  for (const float depth : picture.depth_mm)
    if (std::isfinite(depth)) {
      low = high < low ? depth : std::min(low, depth);
      high = std::max(high, depth);
    }
  return high < low ? Json(nullptr) : Json::array({low, high});
}

int render(const Program& program, const RenderText& text) {
  if (is_mesh(text.scan))
    throw std::runtime_error(text.scan.string() + ": meshes are not drawn; give the scan and --window");
  need_folder_of(text.out);
  const WindowText window = parse_window(text.window);
  voxel::RenderOptions options;
  options.view = voxel::parse_view(text.view);
  options.size_px = size_of(text.size);
  if (!text.algorithm.empty())
    options.algorithm =
        text.algorithm == "node_trace" ? voxel::Algorithm::NodeTrace : voxel::Algorithm::RayCast;
  Timings timings;
  voxel::Scene scene;
  {
    const Stopwatch watch(timings, "read");
    scene = voxel::read_scene(text.scan);
  }
  voxel::Drawn object{text.scan.filename().string(), voxel::Octree::empty({})};
  {
    const Stopwatch watch(timings, "octree");
    const voxel::Universe universe = universe_of(scene.lattice, text.voxel_mm);
    const voxel::GreyOctree grey = voxel::grey_octree_of(universe, scene);
    voxel::Window leaf{grey, window.low};
    if (window.high) leaf.high = *window.high;
    object.octree = voxel::combine(universe, voxel::Expression(leaf));
    // Depth is interpolated at the lower bound; an upper bound inside the object breaks that.
    if (!window.high) object.grey = grey;
    object.threshold = window.low;
  }
  if (object.octree.is_empty()) {
    const voxel::Range range = voxel::range(scene);
    throw std::runtime_error(text.scan.string() + ": no voxel is in the window " + text.window +
                             "; samples are from " + std::to_string(range.low) + " to " +
                             std::to_string(range.high));
  }
  voxel::Picture picture;
  {
    const Stopwatch watch(timings, "render");
    picture = voxel::render({object}, options);
  }
  {
    const Stopwatch watch(timings, "write");
    voxel::write_image(text.out, picture.size_px, picture.rgb);
  }
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["view"] = text.view;
  json["algorithm"] = picture.algorithm == voxel::Algorithm::NodeTrace ? "node_trace" : "ray_cast";
  json["size_px"] = {picture.size_px.x, picture.size_px.y};
  json["pixel_mm"] = picture.pixel_mm;
  json["lit_pixels"] = picture.lit_pixels;
  json["depth_range_mm"] = depth_range(picture);
  program.say(json, lines({{"written", text.out.string()},
                           {"lit pixels", std::to_string(picture.lit_pixels)},
                           {"pixel", grouped(picture.pixel_mm, 4) + " mm"}}));
  return done;
}

}  // namespace

void add_picture_verbs(Program& program) {
  const auto text = std::make_shared<RenderText>();
  CLI::App& verb =
      program.verb("render", "Draws the window of a scan as a shaded surface",
                   "octotomy render head.nrrd -o skull.png --window 300: --view 35,15 --size 1024x1024",
                   [&program, text] { return render(program, *text); });
  verb.add_option("scan", text->scan, "A DICOM folder or file, NIfTI, NRRD or MetaImage")
      ->required()
      ->check(CLI::ExistingPath);
  verb.add_option("-o,--out", text->out, "A .png, .jpg or .webp file")->required();
  verb.add_option("--window", text->window, "LOW:HIGH or LOW: in sample units")->capture_default_str();
  verb.add_option("--view", text->view,
                  "anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees")
      ->capture_default_str();
  verb.add_option("--size", text->size, "WxH in pixels")->capture_default_str();
  verb.add_option("--algorithm", text->algorithm, "node_trace (views along the axes) or ray_cast")
      ->check(CLI::IsMember({"node_trace", "ray_cast"}));
  verb.add_option("--voxel", text->voxel_mm,
                  "Edge of a voxel, mm; default: as fine as the scan, at most 512 a side")
      ->check(CLI::PositiveNumber);
}

}  // namespace octotomy::planner::cli

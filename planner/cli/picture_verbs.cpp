// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "planner/answer.h"
#include "planner/cli/verb.h"
#include "planner/figures.h"
#include "voxel/combine.h"
#include "voxel/image_file.h"
#include "voxel/octree_file.h"
#include "voxel/radiograph.h"
#include "voxel/read_scene.h"
#include "voxel/render.h"

namespace octotomy::planner::cli {
namespace {

struct RenderText {
  std::vector<std::filesystem::path> files;
  std::filesystem::path out;
  std::string window = "300:";
  std::string view = "anterior";
  std::string size = "512x512";
  std::string algorithm;
  std::string shading = "partial_volume";
  std::vector<std::string> colours;
  std::vector<float> opacities;
  std::optional<double> width_mm;
  bool count = false;
  std::optional<double> voxel_mm;
};

const std::map<std::string, voxel::Algorithm> algorithms{
    {"node_trace", voxel::Algorithm::NodeTrace},
    {"ray_cast", voxel::Algorithm::RayCast},
    {"front_to_back", voxel::Algorithm::FrontToBack},
    {"back_to_front", voxel::Algorithm::BackToFront},
};
const std::map<std::string, voxel::Shading> shadings{
    {"depth", voxel::Shading::Depth},
    {"gradient", voxel::Shading::Gradient},
    {"context", voxel::Shading::Context},
    {"partial_volume", voxel::Shading::PartialVolume},
    {"grey_gradient", voxel::Shading::GreyGradient},
    {"silhouette", voxel::Shading::Silhouette},
    {"outline", voxel::Shading::Outline},
};

template <typename Value>
std::vector<std::string> names_of(const std::map<std::string, Value>& values) {
  std::vector<std::string> names;
  names.reserve(values.size());
  for (const auto& [name, value] : values) names.push_back(name);
  return names;
}

template <typename Value>
std::string name_of(const std::map<std::string, Value>& values, Value value) {
  for (const auto& [name, each] : values)
    if (each == value) return name;
  return {};
}

/// Colours of objects that were given none: bone, then colours told apart by readers with any colour vision.
glm::vec3 colour_of(std::size_t number) {
  constexpr std::array<glm::vec3, 5> colours{{{0.93f, 0.89f, 0.80f},
                                              {0.20f, 0.56f, 0.72f},
                                              {0.87f, 0.49f, 0.20f},
                                              {0.16f, 0.60f, 0.47f},
                                              {0.74f, 0.45f, 0.64f}}};
  return colours[number % colours.size()];
}

glm::vec3 parse_colour(const std::string& text) {
  unsigned value = 0;
  char rest = 0;
  if (text.size() != 7 || text[0] != '#' || std::sscanf(text.c_str() + 1, "%6x%c", &value, &rest) != 1)
    throw CLI::ValidationError("--colour", "'" + text + "' is no colour: give #RRGGBB, for example #cc7a29");
  return glm::vec3((value >> 16) & 255, (value >> 8) & 255, value & 255) / 255.0f;
}

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

/// The object that a grey octree's window is.
void set_window(voxel::Drawn& object, const voxel::GreyOctree& grey, const WindowText& window) {
  voxel::Window leaf{grey, window.low};
  if (window.high) leaf.high = *window.high;
  object.octree = voxel::combine(grey.universe(), voxel::Expression(leaf));
  // Depth is interpolated at the lower bound; an upper bound inside the object breaks that.
  if (!window.high) object.grey = grey;
  object.threshold = window.low;
}

/// What a file holds, as it is to be drawn.
voxel::Drawn drawn_of_file(const std::filesystem::path& path, const RenderText& text,
                           const std::optional<voxel::Universe>& universe, Timings& timings) {
  if (is_mesh(path)) throw std::runtime_error(path.string() + ": meshes are not drawn; voxelise it first");
  const WindowText window = parse_window(text.window);
  voxel::Drawn object{path.filename().string(), voxel::Octree::empty({})};
  if (is_octree(path)) {
    const voxel::OctreeFile file = [&] {
      const Stopwatch watch(timings, "read");
      return voxel::read_octree(path);
    }();
    const Stopwatch watch(timings, "octree");
    if (const auto* octree = std::get_if<voxel::Octree>(&file.tree)) {
      object.octree = *octree;
    } else if (const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree)) {
      set_window(object, *grey, window);
      object.counted_in_grey = object.grey.has_value();
    } else {
      const auto& partial = std::get<voxel::PartialOctree>(file.tree);
      object.octree = partial.touching;
      object.inside = partial.inside;
    }
  } else {
    voxel::Scene scene;
    {
      const Stopwatch watch(timings, "read");
      scene = voxel::read_scene(path);
    }
    const Stopwatch watch(timings, "octree");
    set_window(object,
               voxel::grey_octree_of(universe ? *universe : universe_of(scene.lattice, text.voxel_mm), scene),
               window);
    if (object.octree.is_empty()) {
      const voxel::Range range = voxel::range(scene);
      throw std::runtime_error(path.string() + ": no voxel is in the window " + text.window +
                               "; samples are from " + std::to_string(range.low) + " to " +
                               std::to_string(range.high));
    }
  }
  return object;
}

std::vector<voxel::Drawn> drawn_of_files(const RenderText& text, Timings& timings) {
  if (text.colours.size() > text.files.size() || text.opacities.size() > text.files.size())
    throw CLI::ValidationError("--colour and --opacity", "give at most one of each a file");
  std::vector<voxel::Drawn> objects;
  for (std::size_t i = 0; i < text.files.size(); ++i) {
    std::optional<voxel::Universe> universe;
    if (i > 0) universe = objects.front().octree.universe();
    objects.push_back(drawn_of_file(text.files[i], text, universe, timings));
    voxel::Drawn& object = objects.back();
    if (universe && object.octree.universe() != *universe) {
      // Samples of another lattice cannot be followed along this one's columns.
      object.octree = voxel::combine(*universe, voxel::Expression(object.octree));
      object.grey.reset();
      object.counted_in_grey = false;
      object.inside.reset();
    }
    object.colour = i < text.colours.size() ? parse_colour(text.colours[i]) : colour_of(i);
    if (i < text.opacities.size()) object.opacity = text.opacities[i];
  }
  return objects;
}

/// Average visits to the nodes of one status, level by level; null where a level has none.
Json averages(const std::vector<voxel::LevelCount>& visits, const std::vector<voxel::LevelCount>& existing,
              std::uint64_t voxel::LevelCount::*status) {
  Json list = Json::array();
  for (std::size_t i = 0; i < existing.size(); ++i)
    list.push_back(existing[i].*status == 0 ? Json(nullptr)
                                            : Json(static_cast<double>(visits[i].*status) /
                                                   static_cast<double>(existing[i].*status)));
  return list;
}

Json visits_json(const voxel::Visits& visits) {
  const auto tally = [&](const voxel::VisitTally& of) {
    return Json{{"partial", averages(of.octree, visits.existing, &voxel::LevelCount::partial)},
                {"full", averages(of.octree, visits.existing, &voxel::LevelCount::full)},
                {"empty", averages(of.octree, visits.existing, &voxel::LevelCount::empty)},
                {"per_pixel", visits.per_pixel(of)}};
  };
  return {{"direct", tally(visits.direct)}, {"all", tally(visits.all)}};
}

voxel::RenderOptions options_of(const RenderText& text) {
  voxel::RenderOptions options;
  options.view = voxel::parse_view(text.view);
  options.size_px = size_of(text.size);
  options.shading = shadings.at(text.shading);
  options.width_mm = text.width_mm;
  options.count = text.count;
  if (!text.algorithm.empty()) options.algorithm = algorithms.at(text.algorithm);
  return options;
}

/// Pictures of what lies along rays instead of the first surface.
const std::vector<std::string> ray_sums{"mip", "radiograph"};

bool is_ray_sum(const RenderText& text) {
  return std::find(ray_sums.begin(), ray_sums.end(), text.shading) != ray_sums.end();
}

int render_rays(const Program& program, const RenderText& text) {
  Timings timings;
  const std::vector<voxel::Drawn> objects = drawn_of_files(text, timings);
  if (objects.size() != 1 || !objects.front().grey)
    throw std::runtime_error("--shading " + text.shading +
                             " needs the samples of one scan or grey octree, and a --window LOW:");
  const voxel::GreyOctree& grey = *objects.front().grey;
  const voxel::View view = voxel::parse_view(text.view);
  const glm::ivec2 size_px = size_of(text.size);
  voxel::Frame frame = voxel::frame_about(objects, view, size_px);
  if (text.width_mm) frame.width_mm = *text.width_mm;
  const voxel::ImagePlane plane = voxel::image_plane(grey.universe(), view, size_px, frame);
  voxel::RayImage image;
  {
    const Stopwatch watch(timings, "render");
    image = text.shading == "mip" ? voxel::maximum_intensity(grey, plane, program.stop.get_token())
                                  : voxel::radiograph(grey, plane, program.stop.get_token());
  }
  const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
  {
    const Stopwatch watch(timings, "write");
    // Bone is white on films.
    voxel::write_image(text.out, size_px, voxel::grey_tones(image, *low, *high > *low ? *high : *low + 1.0));
  }
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["view"] = text.view;
  json["shading"] = text.shading;
  json["size_px"] = {size_px.x, size_px.y};
  json["pixel_mm"] = plane.pixel_mm;
  json["lit_pixels"] = std::count_if(image.values.begin(), image.values.end(),
                                     [lowest = *low](float value) { return value > lowest; });
  json["depth_range_mm"] = nullptr;
  json["values"] = {*low, *high};
  program.say(json, lines({{"written", text.out.string()}, {"pixel", grouped(plane.pixel_mm, 4) + " mm"}}));
  return done;
}

int render(const Program& program, const RenderText& text) {
  need_folder_of(text.out);
  if (is_ray_sum(text)) {
    if (text.count || !text.algorithm.empty())
      throw CLI::ValidationError("--shading", text.shading + " has no --algorithm and no --count");
    return render_rays(program, text);
  }
  const voxel::RenderOptions options = options_of(text);
  Timings timings;
  const std::vector<voxel::Drawn> objects = drawn_of_files(text, timings);
  voxel::Picture picture;
  {
    const Stopwatch watch(timings, "render");
    picture = voxel::render(objects, options);
  }
  {
    const Stopwatch watch(timings, "write");
    voxel::write_image(text.out, picture.size_px, picture.rgb);
  }
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["view"] = text.view;
  json["algorithm"] = name_of(algorithms, picture.algorithm);
  json["shading"] = text.shading;
  json["size_px"] = {picture.size_px.x, picture.size_px.y};
  json["pixel_mm"] = picture.pixel_mm;
  json["lit_pixels"] = picture.lit_pixels;
  json["depth_range_mm"] = depth_range(picture);
  if (picture.visits) {
    const voxel::Visits& visits = *picture.visits;
    json["visits"] = visits_json(visits);
    json["visits_per_pixel"] = visits.per_pixel(visits.all);
    const std::optional<double> unvisited = visits.unvisited_fraction();
    json["unvisited_fraction"] = unvisited ? Json(*unvisited) : Json(nullptr);
  }
  program.say(json, lines({{"written", text.out.string()},
                           {"lit pixels", std::to_string(picture.lit_pixels)},
                           {"pixel", grouped(picture.pixel_mm, 4) + " mm"}}));
  return done;
}

}  // namespace

void add_picture_verbs(Program& program) {
  const auto text = std::make_shared<RenderText>();
  CLI::App& verb = program.verb(
      "render", "Draws scans' windows and octrees as shaded surfaces",
      "octotomy render head.nrrd -o skull.png --window 300: --view 35,15 --size 1024x1024\n"
      "  octotomy render rest.octree piece.octree -o plan.png --colour \"#ede3cc\" --colour \"#cc7a29\"",
      [&program, text] { return render(program, *text); });
  std::vector<std::string> shading_names = names_of(shadings);
  shading_names.insert(shading_names.end(), ray_sums.begin(), ray_sums.end());
  verb.add_option("files", text->files,
                  "Octrees (.octree), or scans: a DICOM folder or file, NIfTI, NRRD or MetaImage")
      ->required()
      ->check(CLI::ExistingPath);
  verb.add_option("-o,--out", text->out, "A .png, .jpg or .webp file")->required();
  verb.add_option("--window", text->window, "LOW:HIGH or LOW: in sample units, for scans and grey octrees")
      ->capture_default_str();
  verb.add_option("--view", text->view,
                  "anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees")
      ->capture_default_str();
  verb.add_option("--size", text->size, "WxH in pixels")->capture_default_str();
  verb.add_option("--width", text->width_mm, "What the picture spans, mm; default: the objects' extents")
      ->check(CLI::PositiveNumber);
  verb.add_option("--algorithm", text->algorithm,
                  "node_trace (views along the axes), ray_cast, front_to_back or back_to_front; "
                  "default: the fastest for the view")
      ->check(CLI::IsMember(names_of(algorithms)));
  verb.add_option("--shading", text->shading,
                  "depth, gradient, context, partial_volume, grey_gradient, silhouette or outline; mip "
                  "(largest sample) or radiograph (X-rays, in true scale)")
      ->check(CLI::IsMember(shading_names))
      ->capture_default_str();
  verb.add_option("--colour", text->colours, "#RRGGBB, one a file in their order")->expected(1)->take_all();
  verb.add_option("--opacity", text->opacities, "0 (hidden) to 1, one a file in their order")
      ->expected(1)
      ->take_all()
      ->check(CLI::Range(0.0, 1.0));
  verb.add_flag("--count", text->count, "Counts the octree nodes that the algorithm visits");
  verb.add_option("--voxel", text->voxel_mm,
                  "Edge of a voxel, mm; default: as fine as the scan, at most 512 a side")
      ->check(CLI::PositiveNumber);
}

}  // namespace octotomy::planner::cli

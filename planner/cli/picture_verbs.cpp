// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "planner/cli/numbers.h"
#include "planner/cli/picture_json.h"
#include "planner/cli/ray_pictures.h"
#include "planner/cli/scan_in.h"
#include "planner/measure/result_json.h"
#include "planner/table/number_format.h"
#include "voxel/scan/image_file.h"
#include "voxel/view/render.h"

namespace octotomy::planner::cli {
namespace {

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

/// The samples that cut faces show, and what is black and white of them.
voxel::CutTones cut_tones_of(const RenderText& text, const std::vector<voxel::DrawnObject>& objects) {
  const auto with_samples =
      std::find_if(objects.begin(), objects.end(),
                   [](const voxel::DrawnObject& object) { return object.grey.has_value(); });
  if (with_samples == objects.end())
    throw std::runtime_error(
        "--cut-face grey: no object has samples; give a scan or grey octree first, and a --window LOW:");
  const voxel::GreyOctree& grey = *with_samples->grey;
  if (text.tones.empty()) {
    const voxel::MinMax range = grey.range(std::max(2, voxel::root_height(grey.universe().depth)), {0, 0, 0});
    return {grey, static_cast<double>(range.low), std::max<double>(range.high, range.low + 1.0)};
  }
  const auto colon = text.tones.find(':');
  std::string numbers = text.tones;
  if (colon != std::string::npos) numbers[colon] = ',';
  const auto n = numbers_of<2>("--tones", numbers, "-500:1500");
  if (!(n[1] > n[0])) throw CLI::ValidationError("--tones", "'" + text.tones + "' has no room between");
  return {grey, n[0], n[1]};
}

voxel::RenderOptions options_of(const RenderText& text) {
  voxel::RenderOptions options;
  options.view = voxel::parse_view(text.view);
  options.size_px = size_of(text);
  options.shading = shadings.at(text.shading);
  options.width_mm = text.width_mm;
  options.eye_mm = text.eye_mm;
  options.count = text.count;
  if (!text.algorithm.empty()) options.algorithm = algorithms.at(text.algorithm);
  return options;
}

/// The file of `distance:FILE`.
std::filesystem::path other_of(const std::string& text) {
  const std::string kind = "distance:";
  if (!text.starts_with(kind) || text.size() == kind.size())
    throw CLI::ValidationError("--colour-by",
                               "'" + text +
                                   "' is nothing to colour by: give distance:FILE, for example "
                                   "distance:before.octree");
  if (!std::filesystem::exists(text.substr(kind.size())))
    throw CLI::ValidationError("--colour-by", text.substr(kind.size()) + ": there is no such file");
  return text.substr(kind.size());
}

/// The objects of the files; the first one coloured by its distance to another file's, where that is asked
/// for.
struct Scene {
  std::vector<voxel::DrawnObject> objects;
  std::string coloured_by;  ///< the other one's name
};
Scene scene_of(const RenderText& text, Timings& timings) {
  if (text.colour_by.empty()) return {drawn_of_files(text.drawn, timings), {}};
  DrawnText all = text.drawn;
  all.files.push_back(other_of(text.colour_by));
  Scene scene{drawn_of_files(all, timings), {}};
  const voxel::DrawnObject other = scene.objects.back();
  scene.objects.pop_back();
  scene.coloured_by = other.name;
  const Stopwatch watch(timings, "distance");
  voxel::DrawnObject& object = scene.objects.front();
  object.scalar = std::make_shared<const voxel::SurfaceScalar>(
      voxel::distance_to(other.octree, object.octree, text.range_mm.value_or(5.0)));
  return scene;
}

glm::ivec2 pixel_of(const std::string& text, const glm::ivec2& size_px) {
  const auto numbers = numbers_of<2>("--pick", text, "256,300");
  const glm::dvec2 pixel(numbers[0], numbers[1]);
  if (pixel != glm::floor(pixel) || !glm::all(glm::greaterThanEqual(pixel, glm::dvec2(0.0))) ||
      !glm::all(glm::lessThan(pixel, glm::dvec2(size_px))))
    throw CLI::ValidationError("--pick", "'" + text + "' is no pixel of a picture of " +
                                             std::to_string(size_px.x) + " x " + std::to_string(size_px.y));
  return glm::ivec2(pixel);
}

void annotate(voxel::Picture& picture, const RenderText& text, const Scene& scene) {
  voxel::Annotation annotation = annotation_of(text, scene.objects);
  if (const auto& scalar = scene.objects.front().scalar) {
    annotation.bar = voxel::ColourBar{"mm from " + scene.coloured_by, -scalar->most, scalar->most,
                                      voxel::diverging_colours(128)};
  }
  voxel::annotate(picture.rgb, picture.plane(), annotation);
}

/// Two pictures of one size, the left eye's at the left: for parallel viewing, or a stereoscope.
std::vector<std::uint8_t> side_by_side(const voxel::Picture& left, const voxel::Picture& right) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(left.rgb.size() + right.rgb.size());
  const std::ptrdiff_t row = 3 * std::ptrdiff_t{left.size_px.x};
  for (std::ptrdiff_t y = 0; y < left.size_px.y; ++y)
    for (const voxel::Picture* eye : {&left, &right})
      rgb.insert(rgb.end(), eye->rgb.begin() + y * row, eye->rgb.begin() + (y + 1) * row);
  return rgb;
}

int render(const Program& program, const RenderText& text) {
  need_folder_of(text.out);
  if (is_ray_picture(text)) return render_rays(program, text);
  voxel::RenderOptions options = options_of(text);
  options.cuts = cuts_of(text);
  if (!text.transfer.empty())
    throw CLI::ValidationError("--transfer", "only --shading composite has a transfer function");
  if (text.cut_face == "grey" && options.cuts.empty())
    throw CLI::ValidationError("--cut-face", "there is no cut: give --cut-plane or --cut-box");
  std::vector<glm::ivec2> picks;
  for (const std::string& pick : text.picks) picks.push_back(pixel_of(pick, options.size_px));
  Timings timings;
  const Scene scene = scene_of(text, timings);
  const std::vector<voxel::DrawnObject>& objects = scene.objects;
  if (text.cut_face == "grey") options.cut_tones = cut_tones_of(text, objects);
  voxel::Picture picture, right_eye;
  {
    const Stopwatch watch(timings, "render");
    if (text.stereo_deg) {
      const auto [left, right] = voxel::stereo_pair(options.view, *text.stereo_deg);
      options.view = right;
      right_eye = voxel::render(objects, options);
      options.view = left;
    }
    picture = voxel::render(objects, options);
  }
  {
    const Stopwatch watch(timings, "write");
    if (text.annotate) annotate(picture, text, scene);
    if (!text.stereo_deg) {
      voxel::write_image(text.out, picture.size_px, picture.rgb);
    } else {
      if (text.annotate) annotate(right_eye, text, scene);
      voxel::write_image(text.out, {2 * picture.size_px.x, picture.size_px.y},
                         side_by_side(picture, right_eye));
    }
  }
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["view"] = text.view;
  json["algorithm"] = name_of(algorithms, picture.algorithm);
  json["shading"] = text.shading;
  json["size_px"] = {picture.size_px.x, picture.size_px.y};
  json["pixel_mm"] = picture.pixel_mm;
  json["lit_pixels"] = picture.lit_pixels;
  json["depth_range_mm"] = depth_range_json(picture);
  json["objects"] = objects_json(objects, picture);
  if (!text.colour_by.empty())
    json["colour_by"] = distances_json(objects.front(), scene.coloured_by, picture);
  if (!picks.empty()) json["picks"] = picks_json(picks, objects, picture);
  if (picture.visits) add_visits(json, *picture.visits);
  program.say(json, lines({{"written", text.out.string()},
                           {"lit pixels", std::to_string(picture.lit_pixels)},
                           {"pixel", grouped(picture.pixel_mm, 4) + " mm"}}));
  return done;
}

/// What objects look like.
void add_look_options(CLI::App& verb, RenderText& text) {
  verb.add_option("--colour", text.drawn.colours, "#RRGGBB, one a file in their order")
      ->expected(1)
      ->take_all();
  CLI::Option* colour_by = verb.add_option(
      "--colour-by", text.colour_by,
      "distance:FILE colours the first object by its surface's distance outside (orange) or inside "
      "(blue) another file's object");
  verb.add_option("--range", text.range_mm, "Distance of the last colours of --colour-by, mm; default 5")
      ->check(above_zero())
      ->needs(colour_by);
  verb.add_option("--opacity", text.drawn.opacities, "0 (hidden) to 1, one a file in their order")
      ->expected(1)
      ->take_all()
      ->check(between(0.0, 1.0));
  verb.add_option(
      "--transfer", text.transfer,
      "How samples look in composite pictures: bone, skin, vessels (CT in HU; default: bone), or a JSON file "
      "{\"octotomy_transfer\": 1, \"points\": [{\"sample\", \"colour\", \"per_mm\"}, ...]}");
}

void add_cut_options(CLI::App& verb, RenderText& text) {
  verb.add_option("--cut-plane", text.cut_planes,
                  "NX,NY,NZ,OFFSET_MM in LPS: takes away what lies on the normal's side of the plane; "
                  "the offset is the plane's place along the normal; may be repeated")
      ->expected(1)
      ->take_all();
  verb.add_option("--cut-box", text.cut_boxes,
                  "X0,Y0,Z0,X1,Y1,Z1 in LPS mm: takes away what lies in the box; may be repeated")
      ->expected(1)
      ->take_all();
  CLI::Option* face =
      verb.add_option("--cut-face", text.cut_face,
                      "What cut faces show: plain (the object's colour) or grey (the scan's samples)")
          ->check(CLI::IsMember({"plain", "grey"}))
          ->capture_default_str();
  verb.add_option("--tones", text.tones,
                  "BLACK:WHITE in sample units of grey cut faces; default: the samples' range")
      ->needs(face);
}

/// What is written on and said of the picture.
void add_print_options(CLI::App& verb, RenderText& text) {
  verb.add_option(
          "--pick", text.picks,
          "X,Y of a pixel, from the top left (of the left eye's picture): --json then says the object "
          "and the point it shows; may be repeated")
      ->expected(1)
      ->take_all();
  CLI::Option* annotate =
      verb.add_flag("--annotate", text.annotate,
                    "Writes a scale, the patient's sides, a legend and a title on the picture");
  verb.add_option("--title", text.title, "Of an annotated picture; default: the view")->needs(annotate);
}

}  // namespace

void add_picture_verbs(Program& program) {
  const auto text = std::make_shared<RenderText>();
  CLI::App& verb = program.verb(
      "render", "Draws scans' windows and octrees as shaded surfaces",
      "octotomy render head.nrrd -o skull.png --window 300: --view 35,15 --size 1024x1024\n"
      "  octotomy render rest.octree piece.octree -o plan.png --colour \"#ede3cc\" --colour \"#cc7a29\"",
      [&program, text] {
        text->drawn.read = read_options(program, text->scan);
        return render(program, *text);
      });
  std::vector<std::string> shading_names = names_of(shadings);
  const std::vector<std::string> ray_pictures = ray_picture_names();
  shading_names.insert(shading_names.end(), ray_pictures.begin(), ray_pictures.end());
  verb.add_option("files", text->drawn.files,
                  "Octrees (.octree), or scans: a DICOM folder or file, NIfTI, NRRD, MetaImage, images, or a "
                  "raw file")
      ->required()
      ->check(scan_path());
  verb.add_option("-o,--out", text->out, "A .png, .jpg or .webp file")->required();
  verb.add_option("--window", text->drawn.window,
                  "LOW:HIGH or LOW: in sample units, or a tissue (bone, skin, ...)")
      ->capture_default_str();
  verb.add_option("--view", text->view,
                  "anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees")
      ->capture_default_str();
  verb.add_option("--size", text->size, "WxH in pixels")->capture_default_str();
  verb.add_option("--width", text->width_mm, "What the picture spans, mm; default: the objects' extents")
      ->check(above_zero());
  verb.add_option(
          "--eye", text->eye_mm,
          "Perspective: the eye's distance from the middle of the scan, mm; default: orthographic, in "
          "true scale")
      ->check(above_zero());
  verb.add_option("--stereo", text->stereo_deg,
                  "Two pictures side by side, the left eye's at the left; the angle between them in degrees, "
                  "for example 6")
      ->check(between(0.1, 30.0));
  verb.add_option("--algorithm", text->algorithm,
                  "node_trace (views along the axes), ray_cast, front_to_back or back_to_front; "
                  "default: the fastest for the view")
      ->check(CLI::IsMember(names_of(algorithms)));
  verb.add_option("--shading", text->shading,
                  "depth, gradient, context, partial_volume, grey_gradient, silhouette or outline; mip "
                  "(largest sample), radiograph (X-rays, in true scale) or composite (--transfer)")
      ->check(CLI::IsMember(shading_names))
      ->capture_default_str();
  add_look_options(verb, *text);
  add_cut_options(verb, *text);
  add_print_options(verb, *text);
  verb.add_flag("--count", text->count, "Counts the octree nodes that the algorithm visits");
  verb.add_option("--voxel", text->drawn.voxel_mm,
                  "Edge of a voxel, mm; default: as fine as the scan, at most 512 a side")
      ->check(above_zero());
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli

// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures of objects: shaded surfaces, projections along rays, cuts, colours by distance.
#include "planner/operation/picture/render.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>

#include "planner/operation/file/octree_in.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/picture/drawn_files.h"
#include "planner/operation/picture/picture_json.h"
#include "planner/operation/picture/ray_pictures.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/image_file.h"
#include "voxel/view/grid.h"
#include "voxel/view/render.h"

namespace octotomy::planner {
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

/// The file or object of `distance:NAME`.
std::string other_of(const std::string& text) {
  const std::string kind = "distance:";
  if (!text.starts_with(kind) || text.size() == kind.size())
    throw std::runtime_error("--colour-by: '" + text +
                             "' is nothing to colour by: give distance:FILE, for example "
                             "distance:before.octree");
  return text.substr(kind.size());
}

/// The drawn objects. The first one is coloured by its distance to another object, where this is requested.
struct Scene {
  std::vector<voxel::DrawnObject> objects;
  std::string coloured_by;  ///< the other one's name
};

/// The last of `objects` is the other object, where one is requested.
Scene scene_of(const Render& render, std::vector<voxel::DrawnObject> objects, Timings& timings) {
  Scene scene{std::move(objects), {}};
  if (!render.colour_by.empty()) {
    const voxel::DrawnObject other = std::move(scene.objects.back());
    scene.objects.pop_back();
    scene.coloured_by = other.name;
    const Stopwatch watch(timings, "distance");
    voxel::DrawnObject& object = scene.objects.front();
    object.scalar = std::make_shared<const voxel::SurfaceScalar>(
        voxel::distance_to(other.octree, object.octree, render.range_mm.value_or(5.0)));
  }
  paint(render, scene.objects);
  return scene;
}

/// The samples in the tones that are asked for; by default from the smallest to the largest sample.
voxel::CutTones tones_of(const Render& render, voxel::GreyOwners samples) {
  if (render.tones.empty()) {
    double black = std::numeric_limits<double>::infinity(), white = -black;
    for (const voxel::Window& window : samples.windows()) {
      const voxel::GreyOctree& grey = window.grey;
      const voxel::MinMax range =
          grey.range(std::max(2, voxel::root_height(grey.universe().depth)), {0, 0, 0});
      black = std::min(black, range.low * grey.step());
      white = std::max(white, std::max<double>(range.high, range.low + 1.0) * grey.step());
    }
    return {std::move(samples), black, white};
  }
  const auto colon = render.tones.find(':');
  std::string numbers = render.tones;
  if (colon != std::string::npos) numbers[colon] = ',';
  const auto n = numbers_of<2>("--tones", numbers, "-500:1500");
  if (!(n[1] > n[0])) throw std::runtime_error("--tones: '" + render.tones + "' has no room between");
  return {std::move(samples), n[0], n[1]};
}

glm::ivec2 pixel_of(const std::string& text, const glm::ivec2& size_px) {
  const auto numbers = numbers_of<2>("--pick", text, "256,300");
  const glm::dvec2 pixel(numbers[0], numbers[1]);
  if (pixel != glm::floor(pixel) || !glm::all(glm::greaterThanEqual(pixel, glm::dvec2(0.0))) ||
      !glm::all(glm::lessThan(pixel, glm::dvec2(size_px))))
    throw std::runtime_error("--pick: '" + text + "' is no pixel of a picture of " +
                             std::to_string(size_px.x) + " x " + std::to_string(size_px.y));
  return glm::ivec2(pixel);
}

voxel::Annotation annotation_of(const Render& render, const Scene& scene) {
  voxel::Annotation annotation = annotation_of(render, scene.objects);
  if (const auto& scalar = scene.objects.front().scalar) {
    annotation.bar = voxel::ColourBar{"mm from " + scene.coloured_by, -scalar->most, scalar->most,
                                      voxel::diverging_colours(128)};
  }
  return annotation;
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

/// `counted` are the objects as visits to them are counted, where that is not as they are drawn; else empty.
RenderedPicture rendered(const Render& render, std::vector<voxel::DrawnObject> drawn,
                         const std::vector<voxel::DrawnObject>& counted, std::optional<voxel::CutTones> tones,
                         Timings& timings, const std::stop_token& stop) {
  if (is_ray_picture(render)) {
    paint(render, drawn);
    return render_rays(render, drawn, timings, stop);
  }
  voxel::RenderOptions options = options_of(render);
  std::vector<glm::ivec2> picks;
  for (const std::string& pick : render.picks) picks.push_back(pixel_of(pick, options.size_px));
  const Scene scene = scene_of(render, std::move(drawn), timings);
  const std::vector<voxel::DrawnObject>& objects = scene.objects;
  options.cut_tones = std::move(tones);
  voxel::Picture picture, right_eye;
  {
    const Stopwatch watch(timings, "render");
    if (render.stereo_deg) {
      const auto [left, right] = voxel::stereo_pair(options.view, *render.stereo_deg);
      options.view = right;
      right_eye = voxel::render(objects, options);
      options.view = left;
    }
    std::optional<voxel::Visits> visits;
    if (!counted.empty()) {
      visits = voxel::render(counted, options).visits;
      options.count = false;
    }
    picture = voxel::render(objects, options);
    if (visits) picture.visits = std::move(visits);
  }
  RenderedPicture made{picture.size_px, {}, picture.pixel_mm, {}, {}};
  made.said = {{"view", render.view},
               {"algorithm", name_of(algorithms, picture.algorithm)},
               {"shading", render.shading},
               {"size_px", {picture.size_px.x, picture.size_px.y}},
               {"pixel_mm", picture.pixel_mm},
               {"lit_pixels", picture.lit_pixels},
               {"depth_range_mm", depth_range_json(picture)},
               {"objects", objects_json(objects, picture)}};
  if (!render.colour_by.empty())
    made.said["colour_by"] = distances_json(objects.front(), scene.coloured_by, picture);
  if (!picks.empty()) made.said["picks"] = picks_json(picks, objects, picture);
  if (picture.visits) add_visits(made.said, *picture.visits);
  std::optional<voxel::Annotation> annotation;
  if (render.annotate) annotation = annotation_of(render, scene);
  if (render.stereo_deg) {
    for (voxel::Picture* eye : {&picture, &right_eye})
      if (annotation) voxel::annotate(eye->rgb, eye->plane(), *annotation);
    made.rgb = side_by_side(picture, right_eye);
    made.size_px.x *= 2;
  } else {
    made.rgb = std::move(picture.rgb);
    finish(made, picture.plane(), render, annotation);
  }
  return made;
}

void check(const Render& render, const FieldLocation& place) {
  const auto refuse = [&](const std::string& field, const std::string& why) { place.at(field).refuse(why); };
  if (render.colours.size() > render.objects.size() || render.opacities.size() > render.objects.size())
    refuse("colours", "and opacities: give at most one of each an object");
  if (render.grid_mm && (render.eye_mm || render.stereo_deg))
    refuse("grid_mm", "needs a picture in true scale: leave out 'eye_mm' and 'stereo_deg'");
  for (const std::string& colour : render.colours) need_colour(colour);
  for (const double opacity : render.opacities)
    if (!(opacity >= 0.0 && opacity <= 1.0)) refuse("opacities", "are from 0, hidden, to 1");
  if (is_ray_picture(render)) {
    check_rays(render);
  } else {
    if (!render.transfer.empty()) refuse("transfer", "only --shading composite has a transfer function");
    if (render.cut_face == "grey" && render.cut_planes.empty() && render.cut_boxes.empty())
      refuse("cut_face", "there is no cut: give --cut-plane or --cut-box");
  }
  if (place.scope == nullptr) return;
  check_output_path(render.path, {".png", ".jpg", ".webp"}, place.at("path"));
  try {
    voxel::parse_view(render.view);
    size_of(render);
    cuts_of(render);
  } catch (const std::exception& error) {
    if (fault_of(error) != Fault::Input) throw;
    place.refuse(error.what());
  }
  if (!render.colour_by.empty()) place.at("colour_by").need_object(other_of(render.colour_by));
}

std::vector<std::string> uses(const Render& render) {
  if (render.colour_by.empty()) return {};
  return {other_of(render.colour_by)};
}

void write(const std::filesystem::path& path, const RenderedPicture& picture) {
  voxel::write_image(path, picture.size_px, picture.rgb, image_text(picture.frame));
}

void write(const Render& render, const AnswerBench& bench, Exported& made) {
  made.path = output_path(render.path).generic_string();
  std::vector<voxel::DrawnObject> objects;
  for (const ObjectName& name : render.objects)
    objects.push_back(drawn(bench.objects.at(name.name), glm::vec3(1.0f)));
  if (!render.colour_by.empty())
    objects.push_back(drawn(bench.objects.at(other_of(render.colour_by)), glm::vec3(1.0f)));
  std::optional<voxel::CutTones> tones;
  if (render.cut_face == "grey") {
    std::vector<const Object*> cut;
    for (const ObjectName& name : render.objects) cut.push_back(&bench.objects.at(name.name));
    tones = cut_tones_of(render, {objects.begin(), objects.begin() + std::ptrdiff_t(cut.size())}, cut);
    if (!tones) throw std::runtime_error("cut_face: no object is made of a window of a scan: leave it out");
  }
  RenderedPicture picture =
      rendered(render, std::move(objects), {}, std::move(tones), bench.timings, bench.stop);
  write(output_file(bench.folder, made.path), picture);
  made.written = true;
  made.content = "a picture from " + render.view + ", " + std::to_string(picture.size_px.x) + " x " +
                 std::to_string(picture.size_px.y) + " pixels";
  made.details = std::move(picture.said);
}

FileAnswer on_files(const Render& asked, const FileBench& bench) {
  need_picture_extension(asked.out);
  need_folder_of(asked.out);
  Render render = asked;
  if (is_ray_picture(render)) render.window = ray_window(render);
  voxel::parse_view(render.view);
  size_of(render);
  std::vector<ObjectName> files = render.objects;
  if (!render.colour_by.empty()) {
    files.push_back({other_of(render.colour_by)});
    if (!std::filesystem::exists(files.back().name))
      throw std::runtime_error("--colour-by: " + files.back().name + ": there is no such file");
  }
  std::vector<voxel::DrawnObject> objects = drawn_of_files(render, files, bench);
  std::vector<voxel::DrawnObject> counted;
  if (std::any_of(objects.begin(), objects.end(),
                  [](const auto& object) { return object.inside.has_value(); })) {
    counted = std::move(objects);
    Render shown = render;
    shown.count = false;
    objects = drawn_of_files(shown, files, bench);
  }
  std::optional<voxel::CutTones> tones;
  if (render.cut_face == "grey") {
    tones =
        cut_tones_of(render, {objects.begin(), objects.begin() + std::ptrdiff_t(render.objects.size())}, {});
    if (!tones)
      throw std::runtime_error(
          "--cut-face grey: no object has samples; give a scan or grey octree first, and a --window LOW:");
  }
  const RenderedPicture picture =
      rendered(render, std::move(objects), counted, std::move(tones), bench.timings, bench.stop);
  {
    const Stopwatch watch(bench.timings, "write");
    write(render.out, picture);
  }
  FileAnswer answer{{{"path", render.out.string()}}};
  answer.json.update(picture.said);
  answer.rows = {{"written", render.out.string()}};
  if (!is_ray_picture(render))
    answer.rows.emplace_back("lit pixels", std::to_string(picture.said["lit_pixels"].get<std::uint64_t>()));
  answer.rows.emplace_back("pixel", grouped(picture.pixel_mm, 4) + " mm");
  return answer;
}

// Conditions of fields.
constexpr const char* along_rays = "pictures along rays read all samples alike: leave it out";

bool draws_surfaces(const Render& render) {
  return !is_ray_picture(render);
}

bool draws_samples(const Render& render) {
  std::vector<ObjectName> files = render.objects;
  if (!render.colour_by.empty()) files.push_back({other_of(render.colour_by)});
  return std::any_of(files.begin(), files.end(), [](const ObjectName& file) {
    return !is_mesh(file.name) && octree_kind(file.name).value_or(OctreeKind::Grey) == OctreeKind::Grey;
  });
}

std::vector<std::string> all_shadings() {
  std::vector<std::string> names = names_of(shadings);
  const std::vector<std::string> rays = ray_picture_names();
  names.insert(names.end(), rays.begin(), rays.end());
  return names;
}

}  // namespace

std::optional<voxel::CutTones> cut_tones_of(const Render& render,
                                            const std::vector<voxel::DrawnObject>& objects,
                                            const std::vector<const Object*>& made) {
  std::vector<voxel::SampleSource> sources;
  for (const Object* object : made)
    if (object->voxel.symbol) sources.push_back({*object->voxel.symbol, object->voxel.octree});
  // What was filled or grown in an object of one scan lies in that scan, too, and moved with it.
  const auto first = std::find_if(objects.begin(), objects.end(),
                                  [](const voxel::DrawnObject& object) { return object.grey.has_value(); });
  for (const voxel::DrawnObject& object : objects)
    if (object.grey)
      sources.push_back({voxel::all_samples(*object.grey, object.moved_from_still.value_or(glm::dmat4(1.0))),
                         object.octree});
    else if (made.empty() && first != objects.end())
      sources.push_back({voxel::all_samples(*first->grey, first->moved_from_still.value_or(glm::dmat4(1.0))),
                         object.octree});
  voxel::GreyOwners samples(objects.front().octree.universe(), sources);
  if (samples.windows().empty()) return std::nullopt;
  return tones_of(render, std::move(samples));
}

voxel::RenderOptions options_of(const Render& render) {
  voxel::RenderOptions options;
  options.view = voxel::parse_view(render.view);
  options.size_px = size_of(render);
  options.shading = shadings.at(render.shading);
  options.width_mm = render.width_mm;
  if (render.centre_mm) options.centre_mm = options.view.project(*render.centre_mm);
  options.eye_mm = render.eye_mm;
  options.cuts = cuts_of(render);
  options.count = render.count;
  if (!render.algorithm.empty()) options.algorithm = algorithms.at(render.algorithm);
  return options;
}

void finish(RenderedPicture& picture, const voxel::ImagePlane& plane, const Render& render,
            const std::optional<voxel::Annotation>& annotation) {
  std::optional<voxel::Grid> grid;
  if (render.grid_mm) grid = voxel::grid_of(plane, *render.grid_mm);
  if (grid) voxel::draw_grid({plane.size_px, &picture.rgb}, *grid);
  if (annotation) voxel::annotate(picture.rgb, plane, *annotation);
  if (grid) picture.size_px = voxel::add_grid_margin(picture.rgb, plane.size_px, *grid);
  picture.said["size_px"] = {picture.size_px.x, picture.size_px.y};
  picture.said["lps_from_pixel"] = nullptr;
  if (plane.eye) return;
  picture.frame = frame_of(plane);
  picture.frame->size_px = picture.size_px;
  picture.said["lps_from_pixel"] = to_json(picture.frame->lps_from_pixel);
}

glm::ivec2 size_of(const Render& render) {
  const std::string& text = render.size;
  int width = 0, height = 0;
  char cross = 0, rest = 0;
  const bool read =
      std::sscanf(text.c_str(), "%d%c%d%c", &width, &cross, &height, &rest) == 3 && cross == 'x';
  constexpr int most = 8192;
  if (!read || width < 1 || height < 1 || width > most || height > most)
    throw std::runtime_error("--size: '" + text +
                             "' is no size: give WxH of 1 to 8192 pixels, for example 512x512");
  return {width, height};
}

std::vector<voxel::Cutaway> cuts_of(const Render& render) {
  std::vector<voxel::Cutaway> cuts;
  for (const std::string& plane : render.cut_planes) {
    const auto n = numbers_of<4>("--cut-plane", plane, "1,0,0,12.5");
    const glm::dvec3 normal(n[0], n[1], n[2]);
    if (!(glm::length(normal) > 0.0))
      throw std::runtime_error(std::string("--cut-plane: '") + plane + "' has a normal without length");
    cuts.emplace_back(voxel::HalfSpace{glm::normalize(normal), n[3]});
  }
  for (const std::string& box : render.cut_boxes) {
    const auto n = numbers_of<6>("--cut-box", box, "0,-100,0,80,0,90");
    const voxel::Box removed{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    if (!glm::all(glm::lessThan(removed.low_mm, removed.high_mm)))
      throw std::runtime_error(std::string("--cut-box: '") + box +
                               "' holds nothing: give the lower corner first");
    cuts.emplace_back(removed);
  }
  return cuts;
}

voxel::Annotation annotation_of(const Render& render, const std::vector<voxel::DrawnObject>& objects) {
  voxel::Annotation annotation;
  annotation.title = render.title.empty() ? render.view : render.title;
  for (const voxel::DrawnObject& object : objects)
    if (object.opacity > 0.0f && !object.scalar) annotation.legend.push_back({object.name, object.colour});
  return annotation;
}

Operation render_operation() {
  return Describe<Render>("render", "Draws scans' windows and octrees as shaded surfaces.", Makes::File)
      .takes(
          field(
              "objects", &Render::objects,
              "What is drawn; of the verb octrees (.octree), or scans: a DICOM folder or file, NIfTI, NRRD, "
              "MetaImage, images, or a raw file.")
              .required()
              .from(1)
              .positional("files"))
      .takes(field("path", &Render::path, "The .png, .jpg or .webp file within the result's folder.")
                 .in_plans_only())
      .takes(field("view", &Render::view,
                   "anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees."))
      .takes(field("size", &Render::size, "WxH in pixels."))
      .takes(field("width_mm", &Render::width_mm, "What the picture spans. Default: the objects' extents.")
                 .greater_than(0.0))
      .takes(field("centre_mm", &Render::centre_mm,
                   "X,Y,Z in LPS of a point in the picture's middle. Default: the objects' middle.")
                 .called("centre"))
      .takes(
          field("eye_mm", &Render::eye_mm,
                "Perspective: the eye's distance from the middle of the scan. Default: orthographic, in true "
                "scale.")
              .greater_than(0.0))
      .takes(field("stereo_deg", &Render::stereo_deg,
                   "Two pictures side by side, the left eye's at the left, and the angle between them.")
                 .from(0.1)
                 .to(30.0))
      .takes(
          field("algorithm", &Render::algorithm,
                "node_trace (views along the axes), ray_cast, front_to_back or back_to_front. Default: the "
                "fastest for the view.")
              .one_of(names_of(algorithms)))
      .takes(
          field(
              "shading", &Render::shading,
              "depth, gradient, context, partial_volume, grey_gradient, silhouette or outline; mip (largest "
              "sample), radiograph (X-rays, in true scale) or composite (by a transfer function).")
              .one_of(all_shadings()))
      .takes(field("colours", &Render::colours, "#RRGGBB, one an object in their order.")
                 .repeated()
                 .called("colour")
                 .read_if<Render>(draws_surfaces, along_rays))
      .takes(field("opacities", &Render::opacities, "0 (hidden) to 1, one an object in their order.")
                 .repeated()
                 .called("opacity")
                 .read_if<Render>(draws_surfaces, along_rays))
      .takes(
          field("colour_by", &Render::colour_by,
                "distance:NAME colours the first object by its surface's distance outside (orange) or inside "
                "(blue) another one; of the verb a file."))
      .takes(field("range_mm", &Render::range_mm, "Distance of the last colours by distance. Default: 5.")
                 .greater_than(0.0)
                 .read_if<Render>([](const Render& render) { return !render.colour_by.empty(); },
                                  "is of 'colour_by': add it"))
      .takes(
          field("transfer", &Render::transfer,
                "How samples look in composite pictures: bone, skin, vessels (CT in HU; default: bone), or a "
                "JSON file of points with sample, colour and per_mm."))
      .takes(
          field(
              "cut_planes", &Render::cut_planes,
              "NX,NY,NZ,OFFSET_MM in LPS: takes away what lies on the normal's side of the plane; the offset "
              "is the plane's place along the normal; may be repeated.")
              .repeated()
              .called("cut-plane"))
      .takes(field("cut_boxes", &Render::cut_boxes,
                   "X0,Y0,Z0,X1,Y1,Z1 in LPS mm: takes away what lies in the box; may be repeated.")
                 .repeated()
                 .called("cut-box"))
      .takes(field("cut_face", &Render::cut_face,
                   "What cut faces show: plain (the object's colour) or grey (the scan's samples).")
                 .one_of({"plain", "grey"}))
      .takes(field("tones", &Render::tones,
                   "BLACK:WHITE in sample units of grey cut faces. Default: the samples' range.")
                 .read_if<Render>([](const Render& render) { return render.cut_face == "grey"; },
                                  "is of grey cut faces: add 'cut_face'"))
      .takes(field("picks", &Render::picks,
                   "X,Y of a pixel, from the top left (of the left eye's picture), whose object and point "
                   "are told; "
                   "may be repeated.")
                 .repeated()
                 .called("pick"))
      .takes(field("annotate", &Render::annotate,
                   "Writes a scale, the patient's sides, a legend and a title on the picture."))
      .takes(field("title", &Render::title, "Of an annotated picture. Default: the view.")
                 .read_if<Render>([](const Render& render) { return render.annotate; },
                                  "is of annotated pictures: add 'annotate'"))
      .takes(field("grid_mm", &Render::grid_mm,
                   "Draws lines at multiples of this distance, mm; a margin that is added at the right and "
                   "below tells their places in the view.")
                 .from(0.1)
                 .to(1000.0)
                 .called("grid"))
      .takes(field("count", &Render::count, "Counts the octree nodes that the algorithm visits."))
      .verb_takes(field("out", &Render::out, "A .png, .jpg or .webp file.").required())
      .verb_takes(field("window", &Render::window, "LOW:HIGH or LOW: in sample units, or a tissue.")
                      .read_if<Render>(draws_surfaces, along_rays)
                      .read_if<Render>(draws_samples, "only scans and grey octrees have one: leave it out"))
      .verb_takes(
          field("voxel_mm", &Render::voxel_mm,
                "Edge of a voxel. Default: as fine as the scan, at most 512 a side.")
              .greater_than(0.0)
              .read_if<Render>([](const Render& render) { return !is_octree(render.objects.front().name); },
                               "the first file is an octree, whose voxels all are drawn in: leave it out"))
      .reads_scans()
      .uses(uses)
      .example(R"({"id": "front", "do": "render", "objects": ["rest", "advanced"], "path": "front.png",
        "view": "35,15"})")
      .on_files(
          "octotomy render head.nrrd -o skull.png --window 300: --view 35,15 --size 1024x1024\n"
          "  octotomy render rest.octree piece.octree -o plan.png --colour \"#ede3cc\" --colour \"#cc7a29\"",
          on_files)
      .check(check)
      .write(write);
}

}  // namespace octotomy::planner

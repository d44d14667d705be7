// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures of objects: shaded surfaces, projections along rays, cuts, colours by distance.
#include "planner/operation/picture/render.h"

#include <algorithm>
#include <limits>
#include <map>

#include "planner/operation/file/octree_in.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/picture/drawn_files.h"
#include "planner/operation/picture/light_choice.h"
#include "planner/operation/picture/picture_json.h"
#include "planner/operation/picture/ray_choice.h"
#include "planner/operation/picture/ray_pictures.h"
#include "planner/operation/picture/relief.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/error.h"
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
    {"density", voxel::Shading::Density},
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

/// The file or object NAME in a text distance:NAME.
std::string other_of(const std::string& text) {
  const std::string kind = "distance:";
  if (!text.starts_with(kind) || text.size() == kind.size())
    throw std::runtime_error(
        "--colour-by: '" + text +
        "' cannot colour a surface: write distance:FILE, for example distance:before.octree");
  return text.substr(kind.size());
}

/// The objects to draw. The first one is coloured by its distance to another object if this is requested.
struct Scene {
  std::vector<voxel::DrawnObject> objects;
  std::string coloured_by;  ///< the other one's name
};

/// Makes the scene. If a distance is requested, the last of `objects` is the other object and is not drawn.
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

glm::ivec2 pixel_of(const std::string& text, const glm::ivec2& size_px) {
  const auto numbers = numbers_of<2>("--pick", text, "256,300");
  const glm::dvec2 pixel(numbers[0], numbers[1]);
  if (pixel != glm::floor(pixel) || !glm::all(glm::greaterThanEqual(pixel, glm::dvec2(0.0))) ||
      !glm::all(glm::lessThan(pixel, glm::dvec2(size_px))))
    throw std::runtime_error("--pick: '" + text + "' lies outside of a picture of " +
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

/// Combines two pictures of one size side by side, with that of the left eye on the left, for parallel
/// viewing or a stereoscope.
std::vector<std::uint8_t> side_by_side(const voxel::Picture& left, const voxel::Picture& right) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(left.rgb.size() + right.rgb.size());
  const std::ptrdiff_t row = 3 * std::ptrdiff_t{left.size_px.x};
  for (std::ptrdiff_t y = 0; y < left.size_px.y; ++y)
    for (const voxel::Picture* eye : {&left, &right})
      rgb.insert(rgb.end(), eye->rgb.begin() + y * row, eye->rgb.begin() + (y + 1) * row);
  return rgb;
}

/// Whether the picture shows samples on cut faces or surfaces, and not only colours.
struct Samples {
  std::optional<voxel::CutTones> on_cuts;
  std::optional<voxel::CutTones> on_surfaces;
  /// The highest sample of the object whose samples end the rays.
  double highest = std::numeric_limits<double>::infinity();
};

/// The samples that the picture reads. Throws std::runtime_error if no object has samples.
Samples samples_of(const Render& render, const std::vector<voxel::DrawnObject>& objects,
                   const std::vector<const Object*>& made) {
  Samples samples;
  const bool on_cuts = render.cut_face == "grey", on_surfaces = shows_densities(render);
  if (!on_cuts && !on_surfaces) return samples;
  const std::optional<voxel::CutTones> tones = cut_tones_of(render, objects, made);
  if (!tones)
    throw std::runtime_error(
        std::string(on_cuts                       ? "--cut-face grey"
                    : render.shading == "density" ? "--shading density"
                                                  : "--density-colour") +
        ": no object has samples: name a scan or grey octree first, with a --window LOW:");
  if (on_cuts) samples.on_cuts = tones;
  if (on_surfaces) samples.on_surfaces = tones;
  return samples;
}

/// Draws the objects. With a decision function, draws the surface that the function finds in the samples of
/// the only object.
voxel::Picture drawn_picture(const Render& render, const std::vector<voxel::DrawnObject>& objects,
                             double highest, const voxel::RenderOptions& options) {
  if (!is_decided(render)) return voxel::render(objects, options);
  if (objects.size() != 1 || !objects.front().grey || objects.front().moved_from_still)
    throw std::runtime_error((render.decide.empty() ? std::string("--peel") : "--decide " + render.decide) +
                             ": needs the samples of one scan or grey octree, which was not moved");
  voxel::DrawnObject object = objects.front();
  const voxel::Decision decision = decision_of(render, object.threshold, highest);
  // A change of samples may lie anywhere in the scan, not only at the window's surface.
  if (decision.by != voxel::Criterion::Range) object.octree = object.grey->scan();
  return voxel::decide(object, options, decision);
}

/// Draws the objects. `counted` are the objects in which visits are counted, if they are not those that are
/// drawn; else empty.
RenderedPicture rendered(const Render& render, std::vector<voxel::DrawnObject> drawn,
                         const std::vector<voxel::DrawnObject>& counted, Samples samples, Timings& timings,
                         const std::stop_token& stop) {
  if (is_ray_picture(render)) {
    paint(render, drawn);
    return render_rays(render, drawn, timings, stop);
  }
  voxel::RenderOptions options = options_of(render);
  std::vector<glm::ivec2> picks;
  for (const std::string& pick : render.picks) picks.push_back(pixel_of(pick, options.size_px));
  if (!render.expression.empty()) {
    // The frame is that of the operands, because the frame of the expression would require its evaluation.
    const voxel::Frame frame = voxel::frame_about(drawn, options.view, options.size_px);
    if (!options.centre_mm) options.centre_mm = frame.centre_mm;
    if (!options.width_mm) options.width_mm = frame.width_mm;
  }
  const Scene scene = scene_of(render, with_expression(render, std::move(drawn)), timings);
  const std::vector<voxel::DrawnObject>& objects = scene.objects;
  options.cut_tones = std::move(samples.on_cuts);
  if (samples.on_surfaces)
    options.densities = voxel::Densities{std::move(*samples.on_surfaces), density_colours_of(render)};
  voxel::Picture picture, right_eye;
  {
    const Stopwatch watch(timings, "render");
    if (render.stereo_deg) {
      const auto [left, right] = voxel::stereo_pair(options.view, *render.stereo_deg);
      options.view = right;
      right_eye = drawn_picture(render, objects, samples.highest, options);
      options.view = left;
    }
    std::optional<voxel::Visits> visits;
    if (!counted.empty()) {
      visits = voxel::render(counted, options).visits;
      options.count = false;
    }
    picture = drawn_picture(render, objects, samples.highest, options);
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
  if (!render.expression.empty()) made.said["expression"] = render.expression;
  if (is_decided(render)) {
    made.said["decide"] = render.decide.empty() ? "range" : render.decide;
    made.said["peel"] = render.peel.value_or(0);
  }
  if (render.relief) {
    Relief relief = relief_of(picture, *render.relief);
    made.said["relief"] = {{"corners", relief.corners}, {"levels", relief.levels}};
    made.rgb = std::move(relief.rgb);
    return made;
  }
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

/// Checks the grammar of an expression, and that its names are objects of the plan.
void check_expression(const Render& render, const FieldLocation& place) {
  try {
    // Every name stands for the same object here, because only the grammar and the names are checked.
    voxel::parse_expression(render.expression, {[&](std::string_view name) -> voxel::Expression {
                                                  place.need_object(std::string(name));
                                                  return voxel::Sphere{};
                                                },
                                                {}});
  } catch (const voxel::InvalidInput& error) {
    place.refuse(error.what());
  }
}

void check(const Render& render, const FieldLocation& place) {
  const auto refuse = [&](const std::string& field, const std::string& why) { place.at(field).refuse(why); };
  const std::size_t drawn = render.objects.size() + (render.expression.empty() ? 0 : 1);
  if (drawn == 0) throw std::runtime_error("there is nothing to draw: name objects or state an expression");
  check_lights(render);
  check_ray_choices(render);
  if (!render.expression.empty() &&
      (!render.colour_by.empty() || render.cut_face != "plain" || shows_densities(render)))
    refuse("expression",
           "has no surface that distance or samples could colour: leave out 'colour_by', 'cut_face', "
           "'density_colours' and the shading density");
  if (render.colours.size() > drawn || render.opacities.size() > drawn)
    refuse("colours", "and opacities: state at most one of each for an object");
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
      refuse("cut_face", "there is no cut: add --cut-plane or --cut-box");
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
  if (!render.expression.empty()) check_expression(render, place.at("expression"));
}

std::vector<std::string> uses(const Render& render) {
  std::vector<std::string> names;
  if (!render.colour_by.empty()) names.push_back(other_of(render.colour_by));
  if (!render.expression.empty())
    for (std::string& name : voxel::names_in(render.expression)) names.push_back(std::move(name));
  return names;
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
  if (!render.expression.empty())
    for (const std::string& name : voxel::names_in(render.expression))
      objects.push_back(drawn(bench.objects.at(name), glm::vec3(1.0f)));
  std::vector<const Object*> sources;
  for (const ObjectName& name : render.objects) sources.push_back(&bench.objects.at(name.name));
  Samples samples =
      samples_of(render, {objects.begin(), objects.begin() + std::ptrdiff_t(sources.size())}, sources);
  if (!sources.empty() && sources.front()->shown) samples.highest = sources.front()->shown->high;
  RenderedPicture picture =
      rendered(render, std::move(objects), {}, std::move(samples), bench.timings, bench.stop);
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
  // A change of samples ends rays at any sample value, so the window covers all values.
  if (is_decided(render) && render.steeper_per_mm) render.window = {std::numeric_limits<std::int16_t>::min()};
  std::vector<ObjectName> files = files_of(render);
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
  Samples samples =
      samples_of(render, {objects.begin(), objects.begin() + std::ptrdiff_t(render.objects.size())}, {});
  samples.highest = render.window.high_or_infinity();
  const RenderedPicture picture =
      rendered(render, std::move(objects), counted, std::move(samples), bench.timings, bench.stop);
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
constexpr const char* along_rays =
    "does not apply to pictures along rays, which read all samples: leave it out";

bool draws_surfaces(const Render& render) {
  return !is_ray_picture(render);
}

/// The file in a text NAME=FILE.
std::string bound_file(const std::string& text) {
  return text.substr(std::min(text.size(), text.find('=') + 1));
}

/// The file that determines the voxels of all objects; empty if there is none.
std::string first_file(const Render& render) {
  if (!render.objects.empty()) return render.objects.front().name;
  return render.lets.empty() ? "" : bound_file(render.lets.front());
}

bool draws_samples(const Render& render) {
  std::vector<ObjectName> files = render.objects;
  for (const std::string& text : render.lets) files.push_back({bound_file(text)});
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

voxel::RenderOptions options_of(const Render& render) {
  voxel::RenderOptions options;
  options.view = voxel::parse_view(render.view);
  options.size_px = size_of(render);
  options.shading = shadings.at(render.shading);
  options.width_mm = render.width_mm;
  if (render.centre_mm) options.centre_mm = options.view.project(*render.centre_mm);
  options.eye_mm = render.eye_mm;
  options.lights = lights_of(render);
  const auto share = [](const std::optional<double>& typed) {
    return typed ? std::optional(static_cast<float>(*typed)) : std::nullopt;
  };
  options.ambient = share(render.ambient);
  options.gloss = share(render.specular);
  options.exponent = share(render.specular_exponent);
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

voxel::Annotation annotation_of(const Render& render, const std::vector<voxel::DrawnObject>& objects) {
  voxel::Annotation annotation;
  annotation.title = render.title.empty() ? render.view : render.title;
  for (const voxel::DrawnObject& object : objects)
    if (object.opacity > 0.0f && !object.scalar) annotation.legend.push_back({object.name, object.colour});
  return annotation;
}

Operation render_operation() {
  return Describe<Render>("render", "Draws scans' windows and octrees as shaded surfaces.", Makes::File)
      .takes(field("objects", &Render::objects,
                   "Objects to draw; on the command line octrees (.octree) or scans: DICOM folders or files, "
                   "NIfTI, NRRD, MetaImage, images, raw files. May be left out if there is an expression.")
                 .from(1)
                 .positional("files"))
      .takes(field("expression", &Render::expression,
                   "A Boolean expression of objects with & | - ^ ~ and parentheses, for example \"skull - "
                   "cut\". It is drawn after the objects and needs no step or file. On the command line, "
                   "'let' states the files of its names. In views along an axis it is evaluated only where "
                   "it is visible. The picture spans the objects that it names."))
      .takes(field("path", &Render::path, "Path of the .png, .jpg or .webp file within the result's folder.")
                 .in_plans_only())
      .takes(field("view", &Render::view,
                   "The view: anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees."))
      .takes(field("size", &Render::size, "WxH in pixels."))
      .takes(field("width_mm", &Render::width_mm,
                   "Width in mm of the field that the picture shows. Default: the extent of the objects.")
                 .greater_than(0.0))
      .takes(field("centre_mm", &Render::centre_mm,
                   "X,Y,Z in LPS of the point at the picture's middle. Default: the middle of the objects.")
                 .called("centre"))
      .takes(field("eye_mm", &Render::eye_mm,
                   "For a perspective picture: the distance of the eye from the middle of the scan. Default: "
                   "an orthographic picture in true scale.")
                 .greater_than(0.0))
      .takes(field("stereo_deg", &Render::stereo_deg,
                   "Draws two pictures side by side for both eyes, that of the left eye on the left. The "
                   "number is the angle between them.")
                 .from(0.1)
                 .to(30.0))
      .takes(field("algorithm", &Render::algorithm,
                   "Algorithm: node_trace, ray_cast, front_to_back or back_to_front. Default: the fastest "
                   "for the view.")
                 .one_of(names_of(algorithms)))
      .takes(field("shading", &Render::shading,
                   "Shading of surfaces: depth, gradient, context, partial_volume, grey_gradient, "
                   "silhouette, outline or density (the samples of visible voxels, darker with depth). "
                   "Pictures along rays: mip (largest sample), radiograph (X-rays, in true scale) or "
                   "composite (by a transfer function).")
                 .one_of(all_shadings()))
      .takes(field("colours", &Render::colours, "Colours #RRGGBB, one for each object in their order.")
                 .repeated()
                 .called("colour")
                 .read_if<Render>(draws_surfaces, along_rays)
                 .read_if<Render>([](const Render& render) { return render.shading != "density"; },
                                  "does not apply to the shading density, which shows samples: leave it out"))
      .takes(field("opacities", &Render::opacities,
                   "Opacities from 0 (hidden) to 1, one for each object in their order.")
                 .repeated()
                 .called("opacity")
                 .read_if<Render>(draws_surfaces, along_rays))
      .takes(field("colour_by", &Render::colour_by,
                   "distance:NAME colours the surface of the first object by its distance to another object "
                   "NAME: orange outside, blue inside. On the command line NAME is a file."))
      .takes(field("range_mm", &Render::range_mm,
                   "The distance at which the scale of 'colour_by' ends. Default: 5.")
                 .greater_than(0.0)
                 .read_if<Render>([](const Render& render) { return !render.colour_by.empty(); },
                                  "needs 'colour_by': add it"))
      .takes(field("transfer", &Render::transfer,
                   "The transfer function of composite pictures: bone, skin or vessels (CT in HU; default: "
                   "bone), or a JSON file of points with sample, colour and per_mm."))
      .takes(field("cut_planes", &Render::cut_planes,
                   "NX,NY,NZ,OFFSET_MM in LPS: removes everything on the normal's side of a plane; OFFSET_MM "
                   "is the plane's position along the normal; may be repeated.")
                 .repeated()
                 .called("cut-plane"))
      .takes(field("cut_boxes", &Render::cut_boxes,
                   "X0,Y0,Z0,X1,Y1,Z1 in LPS mm: removes everything in a box; may be repeated.")
                 .repeated()
                 .called("cut-box"))
      .takes(field("cut_face", &Render::cut_face,
                   "Appearance of cut faces: plain (the object's colour) or grey (the scan's samples).")
                 .one_of({"plain", "grey"}))
      .takes(
          field("tones", &Render::tones,
                "BLACK:WHITE: the samples that are black and white on grey cut faces and in the shading "
                "density. Default: the samples' range.")
              .read_if<Render>(
                  [](const Render& render) {
                    return render.cut_face == "grey" || render.shading == "density";
                  },
                  "applies only to grey cut faces and to the shading density: add 'cut_face' or 'shading'"))
      .takes(field("picks", &Render::picks,
                   "X,Y of a pixel, counted from the top left (of the left eye's picture). The object and "
                   "point there are reported; may be repeated.")
                 .repeated()
                 .called("pick"))
      .takes(field("annotate", &Render::annotate,
                   "Writes a scale, the patient's sides, a legend and a title on the picture."))
      .takes(field("title", &Render::title, "Title of an annotated picture. Default: the view.")
                 .read_if<Render>([](const Render& render) { return render.annotate; },
                                  "applies only to annotated pictures: add 'annotate'"))
      .takes(field("grid_mm", &Render::grid_mm,
                   "Draws lines at multiples of this distance, mm. An added margin at the right and below "
                   "shows their positions in the view.")
                 .from(0.1)
                 .to(1000.0)
                 .called("grid"))
      .takes(field("count", &Render::count, "Counts the octree's nodes that the algorithm visits."))
      .takes(light_fields())
      .takes(ray_fields())
      .takes(field("relief", &Render::relief,
                   "Instead of the picture, draws its depths as a surface in black lines, seen "
                   "isometrically. The number is the cells along the longer side.")
                 .from(4)
                 .to(512)
                 .read_if<Render>(draws_surfaces,
                                  "applies only to pictures with depths: choose another 'shading'"))
      .verb_takes(
          field("lets", &Render::lets, "NAME=FILE: the file for a name in the expression; may be repeated.")
              .repeated()
              .called("let")
              .read_if<Render>([](const Render& render) { return !render.expression.empty(); },
                               "needs 'expression': add it"))
      .verb_takes(field("out", &Render::out, "The picture: a .png, .jpg or .webp file.").required())
      .verb_takes(
          field("window", &Render::window,
                "The samples of drawn objects: LOW:HIGH or LOW: in sample units, or a tissue.")
              .read_if<Render>(draws_surfaces, along_rays)
              .read_if<Render>(draws_samples, "applies only to scans and grey octrees: leave it out")
              .read_if<Render>(
                  [](const Render& render) { return !render.steeper_per_mm; },
                  "has no effect, because a change of samples ends rays at any sample value: leave it out"))
      .verb_takes(
          field("voxel_mm", &Render::voxel_mm,
                "Edge of a voxel. Default: the scan's finest spacing, with at most 512 voxels a side.")
              .greater_than(0.0)
              .read_if<Render>([](const Render& render) { return !is_octree(first_file(render)); },
                               "does not apply, because the first file is an octree and determines the "
                               "voxels: leave it out"))
      .reads_scans()
      .uses(uses)
      .example(R"({"id": "front", "do": "render", "objects": ["rest", "advanced"], "path": "front.png",
        "view": "35,15"})")
      .on_files(
          "octotomy render head.nrrd -o skull.png --window 300: --view 35,15 --size 1024x1024\n"
          "  octotomy render -o rest.png --expression \"skull - cut\" --let skull=skull.octree --let "
          "cut=cut.octree\n"
          "  octotomy render rest.octree piece.octree -o plan.png --colour \"#ede3cc\" --colour \"#cc7a29\"",
          on_files)
      .check(check)
      .write(write);
}

}  // namespace octotomy::planner

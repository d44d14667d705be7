// SPDX-License-Identifier: AGPL-3.0-or-later
// Surfaces as triangles, contours as lines, and slices at their places in space, in one picture.
#include "brep/view/draw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>

#include "brep/contour/cross_section.h"
#include "brep/mesh/split_fans.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/region_file.h"
#include "planner/operation/file/step_on_files.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/picture/mesh_voxels.h"
#include "planner/operation/picture/render.h"
#include "planner/operation/picture/slice.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/scene.h"
#include "voxel/view/grid.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// More sections of one surface than this are refused as a typing error.
constexpr double most_sections = 2000.0;

const std::map<std::string, brep::FacetShading> facet_shadings{{"flat", brep::FacetShading::Flat},
                                                               {"gouraud", brep::FacetShading::Gouraud},
                                                               {"phong", brep::FacetShading::Phong},
                                                               {"wire", brep::FacetShading::Wire}};

struct Draw {
  std::vector<ObjectName> objects, contours;
  fs::path out;
  std::string view = "anterior", size = "512x512", shading = "phong";
  std::optional<double> width_mm, eye_mm;
  std::optional<glm::dvec3> centre_mm, light;
  double ambient = 0.06, gloss = 0.06;  ///< as brep::Lighting has them
  bool cull = false, hide = false, box = false;
  double apart_mm = 5.0;
  ScanName scan;
  std::vector<double> axial, coronal, sagittal;
  std::optional<SampleWindow> window;
  std::vector<double> level;
  std::optional<ObjectName> within;
  std::vector<std::string> colours, picks;
  bool annotate = false;
  std::string title;
  std::optional<double> grid_mm;

  std::vector<std::string> inputs() const {
    std::vector<std::string> names;
    for (const std::vector<ObjectName>* list : {&objects, &contours})
      for (const ObjectName& object : *list) names.push_back(object.name);
    return names;
  }
};

bool is_contour_file(const std::string& name) {
  return fs::path(name).extension() == ".json";
}

std::string name_of(const std::string& name) {
  return fs::path(name).stem().string();
}

/// An entry in the answer and the legend: a drawn surface, set of lines, or slice.
struct Item {
  std::string name, kind;
  std::optional<glm::vec3> colour;  ///< none: its own tones
  Json said = Json::object();
};

/// A scene, with the triangles that it draws.
struct DrawnItems {
  std::deque<brep::Triangles> triangles;
  brep::DrawnScene scene;
  std::vector<Item> items;  ///< in the scene's numbers
};

/// Lines begin with the second default colour, because the first one, that of bone, is too pale for lines.
glm::vec3 colour_of_item(const Draw& asked, std::size_t number, bool is_of_lines) {
  return number < asked.colours.size() ? need_colour(asked.colours[number])
                                       : colour_of(is_of_lines ? number + 1 : number);
}

void add_surfaces(const Draw& asked, const FileBench& bench, DrawnItems& drawing) {
  for (const ObjectName& object : asked.objects) {
    const Stopwatch watch(bench.timings, "read");
    drawing.triangles.push_back(triangles_named(object.name, bench));
    const brep::Triangles& triangles = drawing.triangles.back();
    if (triangles.faces.empty()) throw std::runtime_error(object.name + ": has no triangles to draw");
    const glm::vec3 colour = colour_of_item(asked, drawing.items.size(), asked.shading == "wire");
    drawing.scene.surfaces.push_back({&triangles, colour});
    drawing.items.push_back(
        {name_of(object.name), "surface", colour, {{"triangles", triangles.faces.size()}}});
  }
}

std::vector<glm::dvec3> closed(std::vector<glm::dvec3> line) {
  if (!line.empty()) line.push_back(line.front());
  return line;
}

/// The contours of a file, in the planes on which they were drawn.
brep::DrawnLines lines_of_file(const std::string& path, std::vector<std::string>& findings) {
  const voxel::SliceMask mask = read_slices(path, {}, findings);
  brep::DrawnLines lines;
  for (const auto& slice : mask.slices)
    for (const auto& polygon : slice.polygons_mm) {
      std::vector<glm::dvec3> line;
      for (const glm::dvec2& p : polygon)
        line.push_back(mask.view.right * p.x + mask.view.up * p.y + mask.view.look * slice.position_mm);
      lines.lines_mm.push_back(closed(std::move(line)));
    }
  return lines;
}

/// The sections of a surface with horizontal planes, at multiples of a distance.
brep::DrawnLines lines_of_surface(const Draw& asked, const std::string& name, const FileBench& bench) {
  const brep::Mesh mesh = brep::mesh_of(brep::joined_surface(triangles_named(name, bench)).surface);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto v : mesh.vertices()) {
    low = std::min<double>(low, mesh.point(v)[2]);
    high = std::max<double>(high, mesh.point(v)[2]);
  }
  if (!((high - low) / asked.apart_mm <= most_sections))
    throw std::runtime_error(name + ": has more than " + std::to_string(static_cast<int>(most_sections)) +
                             " sections that are " + three_figures(asked.apart_mm) +
                             " mm apart: choose a larger --apart");
  brep::DrawnLines lines;
  for (double step = std::ceil(low / asked.apart_mm); step * asked.apart_mm <= high; step += 1.0) {
    const brep::Plane plane = brep::plane_through({0, 0, step * asked.apart_mm}, {0, 0, 1});
    for (const brep::Contour& contour : brep::cross_section(mesh, plane).contours) {
      std::vector<glm::dvec3> line;
      for (const glm::dvec2& p : contour.points_mm)
        line.push_back(plane.origin_mm + plane.right * p.x + plane.up * p.y);
      lines.lines_mm.push_back(contour.closed ? closed(std::move(line)) : std::move(line));
    }
  }
  return lines;
}

double length_mm(const brep::DrawnLines& lines) {
  double length = 0.0;
  for (const auto& line : lines.lines_mm)
    for (std::size_t i = 0; i + 1 < line.size(); ++i) length += glm::distance(line[i], line[i + 1]);
  return length;
}

void add_contours(const Draw& asked, const FileBench& bench, DrawnItems& drawing,
                  std::vector<std::string>& findings) {
  for (const ObjectName& object : asked.contours) {
    const Stopwatch watch(bench.timings, "contours");
    brep::DrawnLines lines = is_contour_file(object.name) ? lines_of_file(object.name, findings)
                                                          : lines_of_surface(asked, object.name, bench);
    if (lines.lines_mm.empty())
      throw std::runtime_error(object.name +
                               ": no plane at a multiple of --apart cuts it: choose a smaller distance");
    lines.colour = colour_of_item(asked, drawing.items.size(), true);
    drawing.items.push_back({name_of(object.name),
                             "contours",
                             lines.colour,
                             {{"contours", lines.lines_mm.size()}, {"length_mm", length_mm(lines)}}});
    drawing.scene.lines.push_back(std::move(lines));
  }
}

/// The twelve edges of a box.
brep::DrawnLines edges_of(const voxel::Box& box) {
  brep::DrawnLines lines;
  lines.colour = glm::vec3(0.25f);
  lines.width_px = 1.0;
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) {
      if ((corner >> axis) & 1) continue;
      const auto at = [&](int number) {
        return glm::dvec3((number & 1) ? box.high_mm.x : box.low_mm.x,
                          (number & 2) ? box.high_mm.y : box.low_mm.y,
                          (number & 4) ? box.high_mm.z : box.low_mm.z);
      };
      lines.lines_mm.push_back({at(corner), at(corner | (1 << axis))});
    }
  return lines;
}

/// The bounding box of everything that is drawn, and of the whole scan.
void add_box(const std::optional<voxel::Scene>& scene, DrawnItems& drawing, std::size_t number) {
  const brep::ViewExtent drawn = brep::extent(drawing.scene, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  voxel::Box box{drawn.low_mm, drawn.high_mm};
  if (scene) {
    const voxel::Box scanned = voxel::bounds(scene->lattice);
    box = {glm::min(box.low_mm, scanned.low_mm), glm::max(box.high_mm, scanned.high_mm)};
  }
  drawing.scene.lines.push_back(edges_of(box));
  drawing.items.insert(drawing.items.begin() + static_cast<std::ptrdiff_t>(number),
                       {"box",
                        "box",
                        drawing.scene.lines.back().colour,
                        {{"low_mm", to_json(box.low_mm)}, {"high_mm", to_json(box.high_mm)}}});
}

/// The voxels of the object `name`, which limits where slices show samples. A mesh file is voxelised. Throws
/// std::runtime_error if the octree is not binary.
voxel::Octree shown_inside(const std::string& name, const voxel::Lattice& lattice, const FileBench& bench) {
  if (bench.step == nullptr && is_mesh(name)) {
    const glm::dvec3 spacing = lattice.spacing_mm();
    return voxels_of_mesh(name, std::nullopt, std::min({spacing.x, spacing.y, spacing.z}), bench);
  }
  const voxel::OctreeFile file = octree_named(name, bench);
  const auto* octree = std::get_if<voxel::Octree>(&file.tree);
  if (octree == nullptr)
    throw std::runtime_error(name +
                             ": is not a binary octree: make one by octotomy octree --window LOW:HIGH");
  return *octree;
}

void add_slices(const Draw& asked, const voxel::Scene& scene, const FileBench& bench, DrawnItems& drawing) {
  if (asked.window) need_hounsfield(*asked.window, scene);
  std::optional<voxel::Octree> within;
  if (asked.within) within = shown_inside(asked.within->name, scene.lattice, bench);
  const std::array<std::pair<std::string Slice::*, const std::vector<double>*>, 3> planes{
      {{&Slice::axial, &asked.axial},
       {&Slice::coronal, &asked.coronal},
       {&Slice::sagittal, &asked.sagittal}}};
  for (const auto& [plane, positions] : planes)
    for (const double position_mm : *positions) {
      Slice slice;
      slice.*plane = Json(position_mm).dump();
      slice.plain = true;
      slice.level = asked.level;
      const SlicePicture cut = slice_of(slice, scene, {}, bench.timings, bench.stop);
      brep::DrawnSheet sheet;
      sheet.size_px = cut.size_px;
      sheet.rgb = cut.rgb;
      sheet.first_mm = cut.sheet.lps_mm(0, 0);
      sheet.per_row = cut.sheet.down * cut.sheet.pixel_mm;
      if (cut.size_px.x > 1) sheet.per_column = cut.sheet.columns_mm[1] - cut.sheet.columns_mm[0];
      sheet.is_shown = cut.samples.inside;
      if (asked.window)
        for (std::size_t i = 0; i < sheet.is_shown.size(); ++i) {
          const double value = cut.samples.image.values[i];
          if (value < asked.window->low || (asked.window->high && value > *asked.window->high))
            sheet.is_shown[i] = 0;
        }
      if (within) {
        const std::vector<std::uint8_t> inside = voxel::cut(*within, cut.sheet);
        for (std::size_t i = 0; i < inside.size(); ++i)
          if (inside[i] == 0) sheet.is_shown[i] = 0;
      }
      drawing.items.push_back(
          {cut.said["plane"].get<std::string>() + " " + Json(position_mm).dump(),
           "slice",
           std::nullopt,
           {{"position_mm", position_mm},
            {"shown_pixels", std::count(sheet.is_shown.begin(), sheet.is_shown.end(), 1)}}});
      drawing.scene.sheets.push_back(std::move(sheet));
    }
}

glm::ivec2 size_of(const Draw& asked) {
  Render said;
  said.size = asked.size;
  return size_of(said);
}

/// A camera with the directions, margin and millimetres of the operation `render`.
brep::Camera camera_of(const Draw& asked, const brep::DrawnScene& scene) {
  const voxel::View view = voxel::parse_view(asked.view);
  brep::Camera camera;
  camera.right = view.right;
  camera.up = view.up;
  camera.look = view.look;
  camera.size_px = size_of(asked);
  const brep::ViewExtent whole = brep::extent(scene, view.right, view.up, view.look);
  const glm::dvec2 low(whole.low_mm), high(whole.high_mm);
  camera.centre_mm = asked.centre_mm ? view.project(*asked.centre_mm) : 0.5 * (low + high);
  // The margin is a twentieth, as in voxel::frame_about(). A flat scene that is seen edge-on has no extent in
  // one direction.
  const double extent_mm =
      std::max({high.x - low.x, high.y - low.y, 1e-3 * (whole.high_mm.z - whole.low_mm.z), 1e-3});
  const double across_mm = 1.05 * extent_mm * camera.size_px.x / std::min(camera.size_px.x, camera.size_px.y);
  camera.pixel_mm = asked.width_mm.value_or(across_mm) / camera.size_px.x;
  camera.nearest_mm = whole.low_mm.z;
  if (asked.eye_mm) camera.observer = brep::Observer{*asked.eye_mm, 0.5 * (whole.high_mm.z - whole.low_mm.z)};
  return camera;
}

brep::DrawOptions options_of(const Draw& asked, const brep::DrawnScene& scene) {
  brep::DrawOptions options;
  options.camera = camera_of(asked, scene);
  options.shading = facet_shadings.at(asked.shading);
  options.cull = asked.cull;
  options.hide = asked.hide;
  options.lighting.ambient = static_cast<float>(asked.ambient);
  options.lighting.gloss = static_cast<float>(asked.gloss);
  if (asked.light)
    options.lighting.lamps = {
        {glm::vec3(asked.light->x, asked.light->y, -asked.light->z), brep::Lamp{}.strength}};
  return options;
}

/// The pixels of --pick, counted from the top left.
glm::ivec2 picked_pixel(const std::string& text, const glm::ivec2& size_px) {
  const auto n = numbers_of<2>("--pick", text, "256,300");
  const glm::dvec2 pixel(n[0], n[1]);
  if (pixel != glm::floor(pixel) || !glm::all(glm::greaterThanEqual(pixel, glm::dvec2(0.0))) ||
      !glm::all(glm::lessThan(pixel, glm::dvec2(size_px))))
    throw std::runtime_error("--pick: '" + text + "' is not a pixel of a picture of " +
                             std::to_string(size_px.x) + " x " + std::to_string(size_px.y));
  return glm::ivec2(pixel);
}

Json picks_of(const Draw& asked, const DrawnItems& drawing, const brep::Camera& camera,
              const brep::DrawnPicture& picture) {
  Json list = Json::array();
  for (const std::string& text : asked.picks) {
    const glm::ivec2 pixel = picked_pixel(text, camera.size_px);
    const auto i = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(camera.size_px.x) +
                   static_cast<std::size_t>(pixel.x);
    const bool is_lit = picture.item[i] >= 0;
    Json pick{{"pixel", {pixel.x, pixel.y}}};
    pick["object"] =
        is_lit ? Json(drawing.items[static_cast<std::size_t>(picture.item[i])].name) : Json(nullptr);
    pick["point_mm"] =
        is_lit ? to_json(camera.lps_mm(glm::dvec2(pixel) + 0.5, picture.depth_mm[i])) : Json(nullptr);
    pick["depth_mm"] = is_lit ? Json(picture.depth_mm[i]) : Json(nullptr);
    list.push_back(std::move(pick));
  }
  return list;
}

Json items_json(const DrawnItems& drawing, const brep::DrawnPicture& picture, bool is_culled) {
  std::vector<std::uint64_t> lit(drawing.items.size(), 0);
  for (const std::int32_t item : picture.item)
    if (item >= 0) ++lit[static_cast<std::size_t>(item)];
  Json list = Json::array();
  for (std::size_t i = 0; i < drawing.items.size(); ++i) {
    const Item& item = drawing.items[i];
    Json said{{"name", item.name}, {"kind", item.kind}};
    if (item.colour) said["colour"] = text_of_colour(*item.colour);
    said.update(item.said);
    if (is_culled && i < picture.culled.size()) said["culled_triangles"] = picture.culled[i];
    said["lit_pixels"] = lit[i];
    list.push_back(std::move(said));
  }
  return list;
}

Json depth_range_of(const brep::DrawnPicture& picture) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const float depth : picture.depth_mm)
    if (std::isfinite(depth)) {
      low = std::min<double>(low, depth);
      high = std::max<double>(high, depth);
    }
  return low > high ? Json(nullptr) : Json::array({low, high});
}

DrawnItems drawing_of(const Draw& asked, const FileBench& bench, std::vector<std::string>& findings) {
  DrawnItems drawing;
  add_surfaces(asked, bench, drawing);
  add_contours(asked, bench, drawing, findings);
  const std::size_t before_slices = drawing.items.size();
  std::optional<voxel::Scene> scene;
  if (!asked.scan.name.empty()) {
    scene = bench.read_scan(asked.scan.name);
    add_slices(asked, *scene, bench, drawing);
  }
  if (asked.box) add_box(scene, drawing, before_slices);
  return drawing;
}

FileAnswer on_files(const Draw& asked, const FileBench& bench) {
  if (bench.step == nullptr) {
    need_picture_extension(asked.out);
    need_folder_of(asked.out);
  }
  voxel::parse_view(asked.view);
  for (const std::string& pick : asked.picks) picked_pixel(pick, size_of(asked));
  FileAnswer answer{{{"path", asked.out.string()}}};
  const DrawnItems drawing = drawing_of(asked, bench, answer.findings);
  const brep::DrawOptions options = options_of(asked, drawing.scene);
  const brep::Camera& camera = options.camera;
  brep::DrawnPicture picture;
  {
    const Stopwatch watch(bench.timings, "draw");
    const voxel::Progress progress = bench.progress("draw");
    picture = brep::draw(drawing.scene, options, {progress.stop, progress.report});
  }
  RenderedPicture made{camera.size_px, std::move(picture.rgb), camera.pixel_mm, {}, {}};
  made.said = {{"view", asked.view},
               {"shading", asked.objects.empty() ? Json(nullptr) : Json(asked.shading)},
               {"size_px", {camera.size_px.x, camera.size_px.y}},
               {"pixel_mm", camera.pixel_mm},
               {"lit_pixels", picture.lit_pixels},
               {"depth_range_mm", depth_range_of(picture)},
               {"objects", items_json(drawing, picture, asked.cull)}};
  if (!asked.picks.empty()) made.said["picks"] = picks_of(asked, drawing, camera, picture);
  voxel::ImagePlane plane{voxel::parse_view(asked.view),
                          camera.size_px,
                          camera.centre_mm,
                          camera.pixel_mm,
                          camera.nearest_mm,
                          0.0,
                          {}};
  if (camera.observer) plane.eye = voxel::Eye{camera.observer->distance_mm, camera.observer->plane_mm};
  std::optional<voxel::Annotation> annotation;
  if (asked.annotate) {
    annotation.emplace();
    annotation->title = asked.title.empty() ? asked.view : asked.title;
    for (const Item& item : drawing.items)
      if (item.colour && item.kind != "box") annotation->legend.push_back({item.name, *item.colour});
  }
  Render grid;
  grid.grid_mm = asked.grid_mm;
  finish(made, plane, grid, annotation);
  {
    const Stopwatch watch(bench.timings, "write");
    voxel::write_image(asked.out, made.size_px, made.rgb, image_text(made.frame));
  }
  answer.json.update(made.said);
  if (!answer.findings.empty()) answer.json["findings"] = answer.findings;
  answer.rows = {{"written", asked.out.string()},
                 {"drawn", std::to_string(drawing.items.size()) + " of surfaces, contours and slices"},
                 {"lit pixels", std::to_string(picture.lit_pixels)},
                 {"pixel", grouped(camera.pixel_mm, 4) + " mm"}};
  return answer;
}

void check(const Draw& asked, const FieldLocation& place) {
  const auto refuse = [&](const std::string& field, const std::string& why) { place.at(field).refuse(why); };
  const bool has_places = !asked.axial.empty() || !asked.coronal.empty() || !asked.sagittal.empty();
  if (asked.objects.empty() && asked.contours.empty() && asked.scan.name.empty())
    place.refuse("there is nothing to draw: name surfaces, 'contours', or a 'scan' with positions of slices");
  if (!asked.scan.name.empty() && !has_places)
    refuse("scan", "is drawn only as slices: state their positions by 'axial', 'coronal' or 'sagittal'");
  if (asked.colours.size() > asked.objects.size() + asked.contours.size())
    refuse("colours", "has more colours than there are surfaces and contours");
  for (const std::string& colour : asked.colours) need_colour(colour);
  if (asked.grid_mm && asked.eye_mm) refuse("grid_mm", "needs a picture in true scale: leave out 'eye_mm'");
  if (!asked.level.empty() && !(asked.level[1] > 0.0))
    refuse("level", "must be CENTRE and WIDTH, with a width above zero");
  if (asked.light && !(glm::length(*asked.light) > 0.0))
    refuse("light", "has no direction: write numbers that are not all zero, for example -1,1,2");
  if (place.scope == nullptr) return;
  check_output_path(asked.out, {".png", ".jpg", ".webp"}, place.at("path"));
  try {
    voxel::parse_view(asked.view);
    size_of(asked);
  } catch (const std::exception& error) {
    if (fault_of(error) != Fault::Input) throw;
    place.refuse(error.what());
  }
}

// Conditions of fields.
bool draws_facets(const Draw& asked) {
  return !asked.objects.empty();
}
bool shades(const Draw& asked) {
  return !asked.objects.empty() && asked.shading != "wire";
}
bool has_scan(const Draw& asked) {
  return !asked.scan.name.empty();
}
constexpr const char* of_shaded = "applies only to shaded surfaces: leave it out";
constexpr const char* of_scan = "applies only to a scan's slices: add 'scan'";

}  // namespace

Operation draw_operation() {
  return Describe<Draw>("draw",
                        "Draws surfaces as facets or wire frames, contours as lines, and slices at their "
                        "positions in space.",
                        Makes::File)
      .takes(
          field("objects", &Draw::objects,
                "Surfaces, drawn triangle by triangle. On the command line: mesh files, which may be open.")
              .positional("files"))
      .takes(field("path", &Draw::out, "The picture: a .png, .jpg or .webp file.").required().called("out"))
      .takes(field("contours", &Draw::contours,
                   "Objects drawn as lines: horizontal sections of surfaces. On the command line also a "
                   ".json file of contours.")
                 .repeated())
      .takes(field("apart_mm", &Draw::apart_mm, "Distance between the horizontal sections of surfaces.")
                 .greater_than(0.0)
                 .read_if<Draw>(
                     [](const Draw& asked) {
                       return std::any_of(asked.contours.begin(), asked.contours.end(),
                                          [](const ObjectName& of) { return !is_contour_file(of.name); });
                     },
                     "applies only to sections of surfaces: add surfaces to 'contours'"))
      .takes(field("scan", &Draw::scan, "A scan whose slices are drawn at their positions in space."))
      .takes(field("axial", &Draw::axial, "Positions z of one or more axial slices, mm.")
                 .comma_separated()
                 .read_if<Draw>(has_scan, of_scan))
      .takes(field("coronal", &Draw::coronal, "Positions y of one or more coronal slices, mm.")
                 .comma_separated()
                 .read_if<Draw>(has_scan, of_scan))
      .takes(field("sagittal", &Draw::sagittal, "Positions x of one or more sagittal slices, mm.")
                 .comma_separated()
                 .read_if<Draw>(has_scan, of_scan))
      .takes(field("window", &Draw::window,
                   "Samples that slices show: LOW:HIGH or LOW: in sample units, or a tissue. Default: all.")
                 .read_if<Draw>(has_scan, of_scan))
      .takes(field("level", &Draw::level,
                   "Grey tones of slices as a centre and a width in sample units. Default: 500 and 2000 for "
                   "Hounsfield units.")
                 .from(2)
                 .to(2)
                 .comma_separated()
                 .for_example("CENTRE,WIDTH, for example 500,2000")
                 .read_if<Draw>(has_scan, of_scan))
      .takes(field("within", &Draw::within,
                   "An object: slices show only the samples inside it. On the command line a binary octree "
                   "or a mesh. Default: all samples.")
                 .read_if<Draw>(has_scan, of_scan))
      .takes(field("box", &Draw::box,
                   "Draws the edges of the bounding box of everything drawn and the whole scan."))
      .takes(field("view", &Draw::view,
                   "The view: anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees."))
      .takes(field("size", &Draw::size, "WxH in pixels."))
      .takes(
          field("width_mm", &Draw::width_mm,
                "Width in mm of the field that the picture shows. Default: the extent of the drawn objects.")
              .greater_than(0.0))
      .takes(
          field(
              "centre_mm", &Draw::centre_mm,
              "X,Y,Z in LPS of the point at the picture's middle. Default: the middle of the drawn objects.")
              .called("centre"))
      .takes(field("eye_mm", &Draw::eye_mm,
                   "For a perspective picture: the distance of the eye from the middle of the drawn objects. "
                   "Default: an orthographic picture in true scale.")
                 .greater_than(0.0))
      .takes(field("shading", &Draw::shading,
                   "Shading: flat (one tone for each triangle), gouraud (interpolates the tones of corners), "
                   "phong (interpolates the normals of corners) or wire (edges only).")
                 .one_of({"flat", "gouraud", "phong", "wire"})
                 .read_if<Draw>(draws_facets, "applies only to surfaces: add a surface"))
      .takes(field("light", &Draw::light,
                   "RIGHT,UP,FRONT in the picture: the direction from the surface to a single lamp. Default: "
                   "a lamp at the upper left and a weaker one at the lower right.")
                 .read_if<Draw>(shades, of_shaded))
      .takes(field("ambient", &Draw::ambient, "Ambient light, as a share of white.")
                 .from(0.0)
                 .to(1.0)
                 .read_if<Draw>(shades, of_shaded))
      .takes(field("gloss", &Draw::gloss, "Strength of the highlight, in which surfaces mirror the lamp.")
                 .from(0.0)
                 .to(1.0)
                 .read_if<Draw>(shades, of_shaded))
      .takes(field("cull", &Draw::cull, "Leaves out triangles that face away from the viewer.")
                 .read_if<Draw>([](const Draw& asked) { return shades(asked) || asked.hide; },
                                "applies only to shaded surfaces, and to wire frames with 'hide'"))
      .takes(
          field("hide", &Draw::hide, "Triangles of a wire frame hide the edges behind them.")
              .read_if<Draw>([](const Draw& asked) { return asked.shading == "wire" && draws_facets(asked); },
                             "applies only to wire frames: add 'shading' wire"))
      .takes(field("colours", &Draw::colours,
                   "Colours #RRGGBB of the surfaces in their order, then of the contours.")
                 .repeated()
                 .called("colour"))
      .takes(field("picks", &Draw::picks,
                   "X,Y of a pixel, counted from the top left. The object and point there are reported; may "
                   "be repeated.")
                 .repeated()
                 .called("pick"))
      .takes(field("annotate", &Draw::annotate,
                   "Writes a scale, the patient's sides, a legend and a title on the picture."))
      .takes(field("title", &Draw::title, "Title of an annotated picture. Default: the view.")
                 .read_if<Draw>([](const Draw& asked) { return asked.annotate; },
                                "applies only to annotated pictures: add 'annotate'"))
      .takes(field("grid_mm", &Draw::grid_mm,
                   "Draws lines at multiples of this distance, mm. An added margin at the right and below "
                   "shows their positions in the view.")
                 .from(0.1)
                 .to(1000.0)
                 .called("grid"))
      .reads_scans()
      .example(
          R"({"id": "facets", "do": "draw", "objects": ["rest"], "contours": ["advanced"], "path": "facets.png",
        "view": "35,15", "shading": "gouraud"})")
      .on_files(
          "octotomy draw skull.stl -o facets.png --view 35,15 --shading gouraud\n"
          "  octotomy draw skull.stl -o wire.png --shading wire --hide --contours outlines.json\n"
          "  octotomy draw --scan head.nrrd --axial -60,-40,-20,0,20,40 --window 300: --box --view 35,25 -o "
          "slices.png",
          on_files)
      .check(check)
      .write(write_step<Draw, on_files>);
}

}  // namespace octotomy::planner

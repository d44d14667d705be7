// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fstream>

#include "planner/cli/numbers.h"
#include "planner/cli/octree_out.h"
#include "planner/cli/scan_in.h"
#include "planner/cli/scan_verbs.h"
#include "planner/table/number_format.h"
#include "voxel/scan/image_file.h"
#include "voxel/view/reformat.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct SliceText {
  fs::path file, out;
  std::string axial, coronal, sagittal, up;
  std::vector<std::string> oblique, curve;
  std::string window, level;
  std::vector<fs::path> octrees;
  std::vector<std::string> colours;
  std::optional<double> pixel_mm;
  double height_mm = 60.0;
  std::string interpolate = "linear";
  bool plain = false;
  ScanIn scan;
};

/// What is cut: a scan, or a tree of any kind.
struct Subject {
  std::variant<voxel::Scene, voxel::GreyOctree, voxel::Octree> samples;
  voxel::Lattice lattice;
  std::string unit = "1";
};

Subject subject_of(const Program& program, const SliceText& text, Timings& timings) {
  if (is_mesh(text.file))
    throw std::runtime_error(text.file.string() + ": is a mesh: octotomy voxelise makes an octree of one");
  if (!is_octree(text.file)) {
    voxel::Scene scene = read_scan(program, text.file, text.scan, timings);
    if (!text.window.empty()) need_hounsfield(text.window, scene);
    const voxel::Lattice lattice = scene.lattice;
    const std::string unit = voxel::unit(scene);
    return {std::move(scene), lattice, unit};
  }
  const voxel::OctreeFile file = read_timed(text.file, timings);
  Subject subject{voxel::Octree::empty({}), voxel::universe(file).lattice(), "1"};
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree)) {
    subject.samples = *grey;
    const Json made = Json::parse(file.metadata, nullptr, false);
    if (made.is_object() && made.value("unit", "") == "HU") subject.unit = "HU";
  } else if (const auto* octree = std::get_if<voxel::Octree>(&file.tree)) {
    subject.samples = *octree;
  } else {
    subject.samples = voxel::at_least_half(std::get<voxel::PartialOctree>(file.tree));
  }
  return subject;
}

/// Which sheet is drawn, in words and in millimetres.
struct CutSheet {
  std::string plane;
  std::optional<double> position_mm;  ///< none for a curve
  voxel::Sheet sheet;
};

/// A position along an axis, or the scan's middle there.
double position_of(const std::string& option, const std::string& text, const voxel::Lattice& lattice,
                   int axis) {
  if (text == "middle") {
    const glm::dvec3 middle = lattice.lps_mm(0.5 * glm::dvec3(lattice.dims - 1));
    return middle[axis];
  }
  const std::optional<double> position_mm = parse_number(text);
  if (!position_mm)
    throw CLI::ValidationError(option, "'" + text + "' is no position: give millimetres, or middle");
  return *position_mm;
}

/// The view that looks along a direction with `up` as near upwards as it can be.
voxel::View view_along(const glm::dvec3& direction, const std::optional<glm::dvec3>& wanted_up) {
  if (!(glm::length(direction) > 0.0))
    throw CLI::ValidationError("--oblique", "the direction has no length: give X,Y,Z, for example 0,1,1");
  voxel::View view;
  view.look = glm::normalize(direction);
  const auto across = [&](const glm::dvec3& up) { return up - view.look * glm::dot(up, view.look); };
  glm::dvec3 up = across(wanted_up.value_or(glm::dvec3(0, 0, 1)));
  // The head's direction shows how a plane stands unless the plane lies: then the face is up, as in axial
  // slices. A plane lies where it leans by less than a degree.
  if (!wanted_up && glm::length(up) < std::sin(glm::radians(1.0))) up = across(glm::dvec3(0, -1, 0));
  if (!(glm::length(up) > 0.0))
    throw CLI::ValidationError("--up", "points along the direction that is looked in: choose another");
  view.up = glm::normalize(up);
  view.right = glm::cross(view.look, view.up);
  return view;
}

std::vector<glm::dvec3> curve_points(const std::vector<std::string>& texts) {
  std::vector<glm::dvec3> points;
  if (texts.size() != 1) {
    for (const std::string& text : texts) points.push_back(parse_point("--curve", text));
    return points;
  }
  std::ifstream stream(texts.front());
  if (!stream)
    throw CLI::ValidationError(
        "--curve", "'" + texts.front() + "' is no file; give one, or two and more points X,Y,Z in mm");
  const Json json = Json::parse(stream, nullptr, false);
  const Json list = json.is_object() ? json.value("points_mm", Json()) : json;
  const bool fits =
      list.is_array() && std::all_of(list.begin(), list.end(), [](const Json& point) {
        return point.is_array() && point.size() == 3 &&
               std::all_of(point.begin(), point.end(), [](const Json& x) { return x.is_number(); });
      });
  if (!fits)
    throw std::runtime_error(texts.front() + ": is no curve: {\"points_mm\": [[x, y, z], ...]} is expected");
  for (const Json& point : list) points.emplace_back(point[0], point[1], point[2]);
  return points;
}

CutSheet cut_of(const SliceText& text, const voxel::Lattice& lattice) {
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  const double pixel_mm = text.pixel_mm.value_or(std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z}));
  std::optional<glm::dvec3> up;
  if (!text.up.empty()) up = parse_point("--up", text.up);
  struct Named {
    const char* plane;
    const char* view;
    const std::string& position;
    int axis;
  };
  const std::array<Named, 3> named{{{"axial", "inferior", text.axial, 2},
                                    {"coronal", "anterior", text.coronal, 1},
                                    {"sagittal", "left", text.sagittal, 0}}};
  const auto asked =
      std::count_if(named.begin(), named.end(), [](const Named& each) { return !each.position.empty(); }) +
      (text.oblique.empty() ? 0 : 1) + (text.curve.empty() ? 0 : 1);
  if (asked > 1)
    throw CLI::ValidationError("--axial", "give one of --axial, --coronal, --sagittal, --oblique, --curve");
  if (!text.curve.empty()) {
    voxel::CurveOptions options;
    options.points_mm = curve_points(text.curve);
    if (up) options.up = *up;
    options.height_mm = text.height_mm;
    options.pixel_mm = pixel_mm;
    return {"curved", std::nullopt, voxel::curved_sheet(options)};
  }
  if (!text.oblique.empty()) {
    const voxel::View view = view_along(parse_point("--oblique", text.oblique[1]), up);
    const double position_mm = glm::dot(parse_point("--oblique", text.oblique[0]), view.look);
    return {"oblique", position_mm, voxel::plane_sheet(lattice, view, position_mm, pixel_mm)};
  }
  const auto* chosen =
      std::find_if(named.begin(), named.end(), [](const Named& each) { return !each.position.empty(); });
  if (chosen == named.end()) chosen = named.begin();
  const double position_mm =
      position_of(std::string("--") + chosen->plane, chosen->position.empty() ? "middle" : chosen->position,
                  lattice, chosen->axis);
  const voxel::View view = voxel::parse_view(chosen->view);
  return {chosen->plane, position_mm,
          voxel::plane_sheet(lattice, view, position_mm * view.look[chosen->axis], pixel_mm)};
}

voxel::Interpolation interpolation_of(const std::string& name) {
  if (name == "nearest") return voxel::Interpolation::Nearest;
  return name == "cubic" ? voxel::Interpolation::Cubic : voxel::Interpolation::Linear;
}

voxel::SheetSamples samples_of(const Program& program, const SliceText& text, const Subject& subject,
                               const voxel::Sheet& sheet) {
  const voxel::Interpolation interpolation = interpolation_of(text.interpolate);
  if (const auto* octree = std::get_if<voxel::Octree>(&subject.samples)) {
    const std::vector<std::uint8_t> inside = voxel::cut(*octree, sheet);
    voxel::SheetSamples samples;
    samples.image = {sheet.size_px(), {inside.begin(), inside.end()}};
    samples.inside.assign(inside.size(), 1);
    return samples;
  }
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&subject.samples))
    return voxel::sample(*grey, sheet, interpolation, {program.stop.get_token(), {}});
  return voxel::sample(std::get<voxel::Scene>(subject.samples), sheet, interpolation,
                       {program.stop.get_token(), {}});
}

/// Black and white, in sample units.
voxel::Range shown_range(const SliceText& text, const Subject& subject, const voxel::SheetSamples& samples) {
  if (!text.window.empty() && !text.level.empty())
    throw CLI::ValidationError("--level", "give --window LOW:HIGH or --level CENTRE,WIDTH, not both");
  if (!text.level.empty()) {
    double centre = 0.0, width = 0.0;
    char rest = 0;
    if (std::sscanf(text.level.c_str(), "%lf,%lf%c", &centre, &width, &rest) != 2 || !(width > 0.0) ||
        !std::isfinite(centre) || !std::isfinite(width))
      throw CLI::ValidationError("--level", "'" + text.level + "' is none: give CENTRE,WIDTH, as 500,2000");
    return {centre - 0.5 * width, centre + 0.5 * width};
  }
  if (std::holds_alternative<voxel::Octree>(subject.samples)) return {0.0, 1.0};
  std::vector<float> values;
  for (std::size_t i = 0; i < samples.inside.size(); ++i)
    if (samples.inside[i] != 0) values.push_back(samples.image.values[i]);
  std::sort(values.begin(), values.end());
  const auto percentile = [&](double part) {
    return values.empty()
               ? 0.0
               : static_cast<double>(
                     values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))]);
  };
  voxel::Range shown;
  if (!text.window.empty()) {
    const WindowText window = parse_window(text.window);
    shown = {window.low, window.high.value_or(percentile(1.0))};
  } else if (subject.unit == "HU") {
    shown = {-500.0, 1500.0};  // bone and, darker, soft tissue: level 500, width 2000
  } else {
    shown = {percentile(0.01), percentile(0.99)};
  }
  if (!(shown.low < shown.high)) shown.high = shown.low + 1.0;
  return shown;
}

glm::vec3 outline_colour(const SliceText& text, std::size_t i) {
  // Bone's own colour is that of the picture's greys: outlines begin with the next.
  return i < text.colours.size() ? parse_colour(text.colours[i]) : colour_of(i + 1);
}

/// Draws the octrees' outlines; what was drawn.
Json draw_outlines(const SliceText& text, const voxel::Sheet& sheet, std::vector<std::uint8_t>& rgb,
                   Timings& timings) {
  if (text.colours.size() > text.octrees.size())
    throw CLI::ValidationError("--colour", "give at most one an --octree");
  Json list = Json::array();
  for (std::size_t i = 0; i < text.octrees.size(); ++i) {
    const voxel::OctreeFile file = read_timed(text.octrees[i], timings);
    const auto* octree = std::get_if<voxel::Octree>(&file.tree);
    if (octree == nullptr)
      throw std::runtime_error(text.octrees[i].string() +
                               ": only a binary octree has an outline: choose an object with octotomy octree "
                               "--window LOW:HIGH");
    const glm::vec3 colour = outline_colour(text, i);
    const Stopwatch watch(timings, "outlines");
    const std::vector<std::uint8_t> inside = voxel::cut(*octree, sheet);
    const std::vector<std::uint8_t> edge = voxel::outline(inside, sheet.size_px());
    for (std::size_t at = 0; at < edge.size(); ++at)
      if (edge[at] != 0)
        for (int channel = 0; channel < 3; ++channel)
          rgb[3 * at + static_cast<std::size_t>(channel)] =
              static_cast<std::uint8_t>(std::lround(255.0f * colour[channel]));
    const auto pixels = std::count(inside.begin(), inside.end(), 1);
    list.push_back({{"path", text.octrees[i].string()},
                    {"pixels", pixels},
                    {"outline_pixels", std::count(edge.begin(), edge.end(), 1)},
                    {"area_mm2", static_cast<double>(pixels) * sheet.pixel_mm * sheet.pixel_mm}});
  }
  return list;
}

/// From (column, row, 0, 1) to LPS; null for a curve.
Json lps_from_pixel(const CutSheet& cut) {
  if (!cut.position_mm) return nullptr;
  const voxel::Sheet& sheet = cut.sheet;
  const glm::dvec3 right = sheet.columns_mm.size() > 1
                               ? (sheet.columns_mm.back() - sheet.columns_mm.front()) /
                                     static_cast<double>(sheet.columns_mm.size() - 1)
                               : glm::dvec3(0.0);
  const glm::dvec3 down = sheet.down * sheet.pixel_mm;
  const glm::dvec3 across =
      sheet.columns_mm.size() > 1 ? glm::normalize(glm::cross(right, down)) : glm::dvec3(0.0);
  glm::dmat4 matrix(glm::dvec4(right, 0), glm::dvec4(down, 0), glm::dvec4(across, 0),
                    glm::dvec4(sheet.columns_mm.front(), 1));
  for (int column = 0; column < 4; ++column) matrix[column] += 0.0;  // takes the sign from -0
  return to_json(matrix);
}

Json said_of(const SliceText& text, const Subject& subject, const CutSheet& cut,
             const voxel::SheetSamples& samples, const voxel::Range& shown) {
  Json json{{"path", text.out.string()}, {"source", text.file.string()}, {"plane", cut.plane}};
  json["position_mm"] = cut.position_mm ? Json(*cut.position_mm) : Json(nullptr);
  json["pixel_mm"] = cut.sheet.pixel_mm;
  json["size_px"] = {samples.image.size_px.x, samples.image.size_px.y};
  json["lps_from_pixel"] = lps_from_pixel(cut);
  const voxel::EdgeLetters letters = voxel::edge_letters(cut.sheet);
  json["letters"] = {
      {"left", letters.left}, {"right", letters.right}, {"top", letters.top}, {"bottom", letters.bottom}};
  json["window"] = {shown.low, shown.high};
  json["unit"] = subject.unit;
  json["interpolation"] = text.interpolate;
  json["inside_pixels"] = std::count(samples.inside.begin(), samples.inside.end(), 1);
  std::optional<voxel::Range> values;
  for (std::size_t i = 0; i < samples.inside.size(); ++i)
    if (const double value = samples.image.values[i]; samples.inside[i] != 0) {
      if (!values) values = voxel::Range{value, value};
      values = voxel::Range{std::min(values->low, value), std::max(values->high, value)};
    }
  json["values"] = values ? Json::array({values->low, values->high}) : Json(nullptr);
  if (!values) json["findings"] = {"no pixel lies in the scan: the curve passes beside it"};
  return json;
}

int slice(const Program& program, const SliceText& text) {
  need_folder_of(text.out);
  if (!text.window.empty()) parse_window(text.window);
  Timings timings;
  const Subject subject = subject_of(program, text, timings);
  const CutSheet cut = cut_of(text, subject.lattice);
  voxel::SheetSamples samples;
  {
    const Stopwatch watch(timings, "slice");
    samples = samples_of(program, text, subject, cut.sheet);
  }
  const voxel::Range shown = shown_range(text, subject, samples);
  const glm::ivec2 size_px = cut.sheet.size_px();
  std::vector<std::uint8_t> rgb = voxel::grey_tones(samples.image, shown.low, shown.high);
  // What lies beside the scan is black, not the border's grey.
  for (std::size_t i = 0; i < samples.inside.size(); ++i)
    if (samples.inside[i] == 0) std::fill_n(rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, 0);
  Json json = said_of(text, subject, cut, samples, shown);
  json["outlines"] = draw_outlines(text, cut.sheet, rgb, timings);
  json["scale_bar_mm"] = nullptr;
  if (!text.plain) {
    voxel::ImagePlane plane;
    plane.size_px = size_px;
    plane.pixel_mm = cut.sheet.pixel_mm;
    voxel::Annotation annotation;
    annotation.letters = voxel::edge_letters(cut.sheet);
    for (std::size_t i = 0; i < text.octrees.size(); ++i)
      annotation.legend.push_back({text.octrees[i].stem().string(), outline_colour(text, i)});
    voxel::annotate(rgb, plane, annotation);
    json["scale_bar_mm"] = voxel::round_length(0.25 * size_px.x * cut.sheet.pixel_mm);
  }
  {
    const Stopwatch watch(timings, "write");
    voxel::write_image(text.out, size_px, rgb);
  }
  Json whole = answer(timings);
  whole.update(json);
  program.say(
      whole,
      lines({{"written", text.out.string()},
             {"plane", cut.plane + (cut.position_mm ? " at " + grouped(*cut.position_mm, 2) + " mm" : "")},
             {"pixel", grouped(cut.sheet.pixel_mm, 4) + " mm"},
             {"window", grouped(shown.low, 0) + " to " + grouped(shown.high, 0)}}));
  return done;
}

}  // namespace

void add_slice(Program& program) {
  const auto text = std::make_shared<SliceText>();
  CLI::App& verb = program.verb(
      "slice", "Draws a plane or a curved sheet of a scan in true scale, with octrees' outlines",
      "octotomy slice head.nrrd -o axial.png --axial 40 --level 500,2000 --octree maxilla.octree\n"
      "  octotomy slice head.nrrd -o oblique.png --oblique 0,0,30 0,1,0.5\n"
      "  octotomy slice head.nrrd -o arch.png --curve -30,10,5 -15,-25,5 15,-25,5 30,10,5 --height 70",
      [&program, text] { return slice(program, *text); });
  verb.add_option("file", text->file, "A scan, or an .octree file")->required()->check(scan_path());
  verb.add_option("-o,--out", text->out, "A .png, .jpg or .webp file")->required();
  verb.add_option("--axial", text->axial,
                  "z in mm, or middle (which it is if no plane is said); from below, "
                  "the patient's left is on the right");
  verb.add_option("--coronal", text->coronal, "y in mm, or middle; from the front");
  verb.add_option("--sagittal", text->sagittal, "x in mm, or middle; from the patient's left");
  verb.add_option("--oblique", text->oblique, "X,Y,Z in mm of a point, and X,Y,Z of the direction looked in")
      ->expected(2);
  verb.add_option("--curve", text->curve,
                  "X,Y,Z in mm of two or more points, left to right, or a JSON file with them as points_mm")
      ->expected(1, -1);
  verb.add_option("--height", text->height_mm, "Of a curved sheet, mm")
      ->check(above_zero())
      ->capture_default_str();
  verb.add_option("--up", text->up,
                  "X,Y,Z that is upwards in an oblique or curved picture; default: the head");
  verb.add_option("--window", text->window,
                  "Black and white as LOW:HIGH, or a tissue (bone, soft_tissue, ...)");
  verb.add_option("--level", text->level, "The same as CENTRE,WIDTH; default: 500,2000 for Hounsfield units");
  verb.add_option("--octree", text->octrees, "Binary octrees whose outlines are drawn")
      ->expected(1)
      ->take_all()
      ->check(CLI::ExistingFile);
  verb.add_option("--colour", text->colours, "#RRGGBB, one an --octree in their order")
      ->expected(1)
      ->take_all();
  verb.add_option("--pixel", text->pixel_mm, "Edge of a pixel, mm; default: the scan's smallest spacing")
      ->check(above_zero());
  verb.add_option("--interpolate", text->interpolate, "Between samples")
      ->check(CLI::IsMember({"nearest", "linear", "cubic"}))
      ->capture_default_str();
  verb.add_flag("--plain", text->plain, "No letters and no scale bar");
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli

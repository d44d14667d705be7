// SPDX-License-Identifier: AGPL-3.0-or-later
// A plane or a curved sheet of samples in true scale, with the outlines of objects.
#include "planner/operation/picture/slice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/operation/file/octree_in.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/picture/mesh_voxels.h"
#include "planner/operation/picture/render.h"
#include "planner/operation/table/comma_numbers.h"
#include "planner/operation/table/field_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/image_file.h"
#include "voxel/view/grid.h"
#include "voxel/view/reformat.h"

namespace octotomy::planner {
namespace {

/// The least width in pixels of a curved picture if no size of a pixel is stated. A dental arch then fills
/// the width of a screen.
constexpr int least_curve_px = 800;

namespace fs = std::filesystem;

/// The samples that are drawn: those of a scan, or of an octree of any kind.
struct Subject {
  std::variant<const voxel::Scene*, voxel::GreyOctree, voxel::Octree> samples;
  voxel::Lattice lattice;
  std::string unit = "1";
  bool is_share = false;  ///< filled shares of voxels, from 0 to 1
};

Subject subject_of(const voxel::Scene& scene, const Slice& slice) {
  if (slice.window) need_hounsfield(*slice.window, scene);
  return {&scene, scene.lattice, voxel::unit(scene)};
}

Subject subject_of(const fs::path& path, Timings& timings) {
  const voxel::OctreeFile file = read_timed(path, timings);
  Subject subject{voxel::Octree::empty({}), voxel::universe(file).lattice(), "1"};
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree)) {
    subject.samples = *grey;
    const Json made = Json::parse(file.metadata, nullptr, false);
    if (made.is_object() && made.value("unit", "") == "HU") subject.unit = "HU";
  } else if (const auto* octree = std::get_if<voxel::Octree>(&file.tree)) {
    subject.samples = *octree;
  } else {
    subject.samples = voxel::share_samples(std::get<voxel::PartialOctree>(file.tree));
    subject.is_share = true;
  }
  return subject;
}

double finest_mm(const voxel::Lattice& lattice) {
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  return std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
}

/// The inside of a mesh as voxels, which are as wide as a pixel if that width is stated.
Subject subject_of_mesh(const fs::path& path, const Slice& slice, const FileBench& bench) {
  Subject subject{voxels_of_mesh(path, std::nullopt, slice.pixel_mm, bench), {}, "1"};
  subject.lattice = std::get<voxel::Octree>(subject.samples).universe().lattice();
  return subject;
}

/// The plane or curve that is drawn, in words and in millimetres.
struct CutSheet {
  std::string plane;
  std::optional<double> position_mm;  ///< none for a curve
  voxel::Sheet sheet;
};

/// A position along an axis: the stated one, or the scan's middle.
double position_of(const std::string& plane, const std::string& text, const voxel::Lattice& lattice,
                   int axis) {
  if (text == "middle") return lattice.lps_mm(0.5 * glm::dvec3(lattice.dims - 1))[axis];
  const std::optional<double> position_mm = number_in(text);
  if (!position_mm)
    throw std::runtime_error(plane + ": '" + text + "' is not a position: write millimetres, or middle");
  return *position_mm;
}

/// The view that looks along a direction, with an up direction as near to `up` as possible.
voxel::View view_along(const glm::dvec3& direction, const std::optional<glm::dvec3>& wanted_up) {
  if (!(glm::length(direction) > 0.0))
    throw std::runtime_error("oblique: the direction has no length: write X,Y,Z, for example 0,1,1");
  voxel::View view;
  view.look = glm::normalize(direction);
  const auto across = [&](const glm::dvec3& up) { return up - view.look * glm::dot(up, view.look); };
  glm::dvec3 up = across(wanted_up.value_or(glm::dvec3(0, 0, 1)));
  // The head's up direction is up in the picture. If the plane is within a degree of horizontal, the face is
  // up instead, as in axial slices.
  if (!wanted_up && glm::length(up) < std::sin(glm::radians(1.0))) up = across(glm::dvec3(0, -1, 0));
  if (!(glm::length(up) > 0.0))
    throw std::runtime_error("up: points along the viewing direction: choose another direction");
  view.up = glm::normalize(up);
  view.right = glm::cross(view.look, view.up);
  return view;
}

/// Points from the words of the command line, or from the file if the only word names one.
std::vector<glm::dvec3> curve_points(const std::vector<std::string>& words) {
  std::vector<glm::dvec3> points;
  if (words.size() != 1) {
    Field field{"curve_mm", "", [&points](void*) -> Slot { return &points; }};
    for (const nlohmann::json& p : json_of_words(field, nullptr, words))
      points.emplace_back(p[0], p[1], p[2]);
    return points;
  }
  if (!fs::exists(words.front()))
    throw std::runtime_error("--curve: '" + words.front() +
                             "' is not a file: name a file, or write at least two points X,Y,Z in mm");
  const nlohmann::json json = read_json(words.front());
  const nlohmann::json list = json.is_object() ? json.value("points_mm", nlohmann::json()) : json;
  const bool fits =
      list.is_array() && std::all_of(list.begin(), list.end(), [](const auto& point) {
        return point.is_array() && point.size() == 3 &&
               std::all_of(point.begin(), point.end(), [](const auto& x) { return x.is_number(); });
      });
  if (!fits)
    throw std::runtime_error(words.front() +
                             ": is not a curve: it must be {\"points_mm\": [[x, y, z], ...]}");
  for (const nlohmann::json& point : list) points.emplace_back(point[0], point[1], point[2]);
  return points;
}

/// A rectangle in a plane, around the projection of `slice.centre_mm` onto the plane; by default around the
/// projection of the lattice's middle.
voxel::Sheet rectangle_of(const Slice& slice, const voxel::Lattice& lattice, const voxel::View& view,
                          double position_mm, double pixel_mm) {
  Render said;
  said.size = slice.size;
  const glm::ivec2 size_px = size_of(said);
  const glm::dvec3 asked_mm = slice.centre_mm.value_or(lattice.lps_mm(0.5 * glm::dvec3(lattice.dims - 1)));
  const glm::dvec3 centre_mm = asked_mm + view.look * (position_mm - glm::dot(asked_mm, view.look));
  voxel::Sheet sheet;
  sheet.down = -view.up;
  sheet.pixel_mm = pixel_mm;
  sheet.height_px = size_px.y;
  const glm::dvec3 top_mm = centre_mm + view.up * (0.5 * (size_px.y - 1) * pixel_mm);
  for (int column = 0; column < size_px.x; ++column)
    sheet.columns_mm.push_back(top_mm + view.right * ((column - 0.5 * (size_px.x - 1)) * pixel_mm));
  return sheet;
}

voxel::Sheet sheet_of(const Slice& slice, const voxel::Lattice& lattice, const voxel::View& view,
                      double position_mm, double pixel_mm) {
  return slice.size.empty() ? voxel::plane_sheet(lattice, view, position_mm, pixel_mm)
                            : rectangle_of(slice, lattice, view, position_mm, pixel_mm);
}

CutSheet cut_of(const Slice& slice, const voxel::Lattice& lattice) {
  const double pixel_mm = slice.pixel_mm.value_or(finest_mm(lattice));
  struct Named {
    const char* plane;
    const char* view;
    const std::string& position;
    int axis;
  };
  const std::array<Named, 3> named{{{"axial", "inferior", slice.axial, 2},
                                    {"coronal", "anterior", slice.coronal, 1},
                                    {"sagittal", "left", slice.sagittal, 0}}};
  const auto asked =
      std::count_if(named.begin(), named.end(), [](const Named& each) { return !each.position.empty(); }) +
      (slice.oblique.empty() ? 0 : 1) + (slice.curve_mm.empty() ? 0 : 1);
  if (asked > 1) throw std::runtime_error("state only one of axial, coronal, sagittal, oblique and curve");
  if (!slice.curve_mm.empty()) {
    voxel::CurveOptions options;
    options.points_mm = slice.curve_mm;
    if (slice.up) options.up = *slice.up;
    options.height_mm = slice.height_mm;
    options.pixel_mm = pixel_mm;
    voxel::Sheet sheet = voxel::curved_sheet(options);
    if (!slice.pixel_mm && sheet.size_px().x < least_curve_px) {
      options.pixel_mm *= static_cast<double>(sheet.size_px().x) / least_curve_px;
      sheet = voxel::curved_sheet(options);
    }
    return {"curved", std::nullopt, std::move(sheet)};
  }
  if (!slice.oblique.empty()) {
    const voxel::View view = view_along(slice.oblique[1], slice.up);
    const double position_mm = glm::dot(slice.oblique[0], view.look);
    return {"oblique", position_mm, sheet_of(slice, lattice, view, position_mm, pixel_mm)};
  }
  const auto* chosen =
      std::find_if(named.begin(), named.end(), [](const Named& each) { return !each.position.empty(); });
  if (chosen == named.end()) chosen = named.begin();
  const double position_mm = position_of(
      chosen->plane, chosen->position.empty() ? "middle" : chosen->position, lattice, chosen->axis);
  const voxel::View view = voxel::parse_view(chosen->view);
  return {chosen->plane, position_mm,
          sheet_of(slice, lattice, view, position_mm * view.look[chosen->axis], pixel_mm)};
}

voxel::Interpolation interpolation_of(const std::string& name) {
  if (name == "nearest") return voxel::Interpolation::Nearest;
  return name == "cubic" ? voxel::Interpolation::Cubic : voxel::Interpolation::Linear;
}

voxel::SheetSamples samples_of(const Slice& slice, const Subject& subject, const voxel::Sheet& sheet,
                               const std::stop_token& stop) {
  const voxel::Interpolation interpolation = interpolation_of(slice.interpolate);
  if (const auto* octree = std::get_if<voxel::Octree>(&subject.samples)) {
    const std::vector<std::uint8_t> inside = voxel::cut(*octree, sheet);
    voxel::SheetSamples samples;
    samples.image = {sheet.size_px(), {inside.begin(), inside.end()}};
    samples.inside.assign(inside.size(), 1);
    return samples;
  }
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&subject.samples))
    return voxel::sample(*grey, sheet, interpolation, {stop, {}});
  return voxel::sample(*std::get<const voxel::Scene*>(subject.samples), sheet, interpolation, {stop, {}});
}

/// The samples that are black and white.
voxel::Range shown_range(const Slice& slice, const Subject& subject, const voxel::SheetSamples& samples) {
  if (!slice.level.empty()) {
    const double centre = slice.level[0], width = slice.level[1];
    return {centre - 0.5 * width, centre + 0.5 * width};
  }
  if (subject.is_share || std::holds_alternative<voxel::Octree>(subject.samples)) return {0.0, 1.0};
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
  if (slice.window) {
    shown = {slice.window->low, slice.window->high.value_or(percentile(1.0))};
  } else if (subject.unit == "HU") {
    shown = {-500.0, 1500.0};  // shows bone and, darker, soft tissue: level 500, width 2000
  } else {
    shown = {percentile(0.01), percentile(0.99)};
  }
  if (!(shown.low < shown.high)) shown.high = shown.low + 1.0;
  return shown;
}

glm::vec3 outline_colour(const Slice& slice, const std::vector<Outlined>& objects, std::size_t i) {
  if (i < slice.colours.size()) return need_colour(slice.colours[i]);
  // Outlines begin with the second default colour, because that of bone resembles the greys of the picture.
  return objects[i].is_hatched ? interference_colour() : colour_of(i + 1);
}

/// Whether a pixel lies on a line of the hatching. The lines are diagonals, 2 pixels wide and 8 pixels apart
/// along a row.
bool is_hatch(std::size_t pixel, const glm::ivec2& size_px) {
  const std::size_t width = static_cast<std::size_t>(size_px.x);
  return (pixel % width + pixel / width) % 8 < 2;
}

/// Draws the outlines and hatching of objects. Returns descriptions of what was drawn.
Json draw_outlines(const Slice& slice, const std::vector<Outlined>& objects, const voxel::Sheet& sheet,
                   std::vector<std::uint8_t>& rgb, Timings& timings) {
  Json list = Json::array();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const glm::vec3 colour = outline_colour(slice, objects, i);
    const Stopwatch watch(timings, "outlines");
    const std::vector<std::uint8_t> inside = voxel::cut(objects[i].octree, sheet);
    const std::vector<std::uint8_t> edge = voxel::outline(inside, sheet.size_px());
    for (std::size_t at = 0; at < edge.size(); ++at) {
      const bool is_drawn =
          edge[at] != 0 || (objects[i].is_hatched && inside[at] != 0 && is_hatch(at, sheet.size_px()));
      for (int channel = 0; is_drawn && channel < 3; ++channel)
        rgb[3 * at + static_cast<std::size_t>(channel)] =
            static_cast<std::uint8_t>(std::lround(255.0f * colour[channel]));
    }
    const auto pixels = std::count(inside.begin(), inside.end(), 1);
    list.push_back({{"path", objects[i].name},
                    {"pixels", pixels},
                    {"outline_pixels", std::count(edge.begin(), edge.end(), 1)},
                    {"area_mm2", static_cast<double>(pixels) * sheet.pixel_mm * sheet.pixel_mm}});
  }
  return list;
}

/// The map from (column, row, 0, 1) to LPS; none for a curve.
std::optional<glm::dmat4> lps_from_pixel(const CutSheet& cut) {
  if (!cut.position_mm) return std::nullopt;
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
  for (int column = 0; column < 4; ++column) matrix[column] += 0.0;  // turns -0 into 0
  return matrix;
}

/// The facts about the picture of a slice, for SlicePicture::said.
struct SliceRecord {
  std::string plane;
  std::optional<double> position_mm;  ///< none for a curve
  double pixel_mm = 1.0;
  std::vector<int> size_px;
  Json lps_from_pixel;
  Json letters;  ///< of the four edges
  std::vector<double> window;
  std::string unit, interpolation;
  std::int64_t inside_pixels = 0;
  std::optional<std::vector<double>> values;  ///< least and greatest sample; none if no pixel lies inside
  std::vector<std::string> findings;
  Json outlines;
  std::optional<double> scale_bar_mm;
};
constexpr auto members_of(const SliceRecord&) {
  using S = SliceRecord;
  return std::tuple(member("plane", &S::plane), member("position_mm", &S::position_mm),
                    member("pixel_mm", &S::pixel_mm), member("size_px", &S::size_px),
                    member("lps_from_pixel", &S::lps_from_pixel), member("letters", &S::letters),
                    member("window", &S::window), member("unit", &S::unit),
                    member("interpolation", &S::interpolation), member("inside_pixels", &S::inside_pixels),
                    member("values", &S::values), member_if_any("findings", &S::findings),
                    member("outlines", &S::outlines), member("scale_bar_mm", &S::scale_bar_mm));
}

SliceRecord record_of_slice(const Slice& slice, const Subject& subject, const CutSheet& cut,
                            const voxel::SheetSamples& samples, const voxel::Range& shown) {
  SliceRecord made;
  made.plane = cut.plane;
  made.position_mm = cut.position_mm;
  made.pixel_mm = cut.sheet.pixel_mm;
  const std::optional<glm::dmat4> matrix = lps_from_pixel(cut);
  made.lps_from_pixel = matrix ? to_json(*matrix) : Json(nullptr);
  const voxel::EdgeLetters letters = voxel::edge_letters(cut.sheet);
  made.letters = {
      {"left", letters.left}, {"right", letters.right}, {"top", letters.top}, {"bottom", letters.bottom}};
  made.window = {shown.low, shown.high};
  made.unit = subject.unit;
  made.interpolation = slice.interpolate;
  made.inside_pixels = std::count(samples.inside.begin(), samples.inside.end(), 1);
  std::optional<voxel::Range> values;
  for (std::size_t i = 0; i < samples.inside.size(); ++i)
    if (const double value = samples.image.values[i]; samples.inside[i] != 0) {
      if (!values) values = voxel::Range{value, value};
      values = voxel::Range{std::min(values->low, value), std::max(values->high, value)};
    }
  if (values)
    made.values = {values->low, values->high};
  else
    made.findings.emplace_back(
        "no pixel lies in the scan, because the curve passes beside it: choose points in the scan");
  return made;
}

/// The grid of a plane, in the millimetres of the view that looks at the plane.
voxel::Grid grid_of(const CutSheet& cut, double spacing_mm) {
  const std::optional<glm::dmat4> matrix = lps_from_pixel(cut);
  if (!matrix || cut.sheet.columns_mm.size() < 2)
    throw std::runtime_error("--grid applies only to planes: leave it out for a curved picture");
  const glm::dmat3 mm_from_pixel = PictureFrame{cut.sheet.size_px(), *matrix}.view_mm_from_pixel();
  return {spacing_mm, glm::dvec2(mm_from_pixel * glm::dvec3(-0.5, -0.5, 1.0)), cut.sheet.pixel_mm};
}

/// The letters, scale and legend of a picture.
void annotate(SlicePicture& picture, SliceRecord& record, const Slice& slice, const CutSheet& cut,
              const std::vector<Outlined>& objects) {
  voxel::ImagePlane plane;
  plane.size_px = picture.sheet.size_px();
  plane.pixel_mm = cut.sheet.pixel_mm;
  voxel::Annotation annotation;
  annotation.letters = voxel::edge_letters(cut.sheet);
  for (std::size_t i = 0; i < objects.size(); ++i)
    annotation.legend.push_back(
        {fs::path(objects[i].name).stem().string(), outline_colour(slice, objects, i)});
  voxel::annotate(picture.rgb, plane, annotation);
  record.scale_bar_mm = voxel::round_length(0.25 * plane.size_px.x * cut.sheet.pixel_mm);
}

SlicePicture drawn(const Slice& slice, const Subject& subject, const std::vector<Outlined>& objects,
                   Timings& timings, const std::stop_token& stop) {
  const CutSheet cut = cut_of(slice, subject.lattice);
  SlicePicture picture{cut.sheet, {}, cut.sheet.size_px(), {}, {}, {}};
  voxel::SheetSamples& samples = picture.samples;
  {
    const Stopwatch watch(timings, "slice");
    samples = samples_of(slice, subject, cut.sheet, stop);
  }
  const voxel::Range shown = shown_range(slice, subject, samples);
  picture.rgb = voxel::grey_tones(samples.image, shown.low, shown.high);
  SliceRecord record = record_of_slice(slice, subject, cut, samples, shown);
  // Pixels outside of the scan are black, instead of having the grey of the border.
  for (std::size_t i = 0; i < samples.inside.size(); ++i)
    if (samples.inside[i] == 0) std::fill_n(picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, 0);
  record.outlines = draw_outlines(slice, objects, cut.sheet, picture.rgb, timings);
  std::optional<voxel::Grid> grid;
  if (slice.grid_mm) grid = grid_of(cut, *slice.grid_mm);
  if (grid) voxel::draw_grid({picture.size_px, &picture.rgb}, *grid);
  if (!slice.plain) annotate(picture, record, slice, cut, objects);
  if (grid) picture.size_px = voxel::add_grid_margin(picture.rgb, picture.size_px, *grid);
  record.size_px = {picture.size_px.x, picture.size_px.y};
  picture.said = print_record(record);
  if (const auto matrix = lps_from_pixel(cut); matrix && cut.sheet.columns_mm.size() > 1)
    picture.frame = PictureFrame{picture.size_px, *matrix};
  return picture;
}

// Conditions of fields.
constexpr const char* no_samples =
    "does not apply to a binary octree or a mesh, which have no samples: leave it out";

bool is_curved(const Slice& slice) {
  return !slice.curve_mm.empty() || !slice.curve.empty();
}

bool cuts_samples(const Slice& slice) {
  return !is_mesh(slice.scan.name) && octree_kind(slice.scan.name) != OctreeKind::Binary;
}

void check(const Slice& slice, const FieldLocation& place) {
  if (slice.window && !slice.level.empty())
    place.at("level").refuse("states the same as 'window': leave out one of them");
  if (slice.grid_mm && !slice.curve_mm.empty())
    place.at("grid_mm").refuse("applies only to planes: leave it out for a curved picture");
  if (slice.colours.size() > slice.objects.size() + slice.hatched.size())
    place.at("colours").refuse("has more colours than there are objects and hatched objects");
  if (!slice.level.empty() && !(slice.level[1] > 0.0))
    place.at("level").refuse("must be CENTRE and WIDTH, with a width above zero");
  for (const std::string& colour : slice.colours) need_colour(colour);
  if (place.scope != nullptr) check_output_path(slice.path, {".png", ".jpg", ".webp"}, place.at("path"));
}

void write(const fs::path& path, const SlicePicture& picture) {
  voxel::write_image(path, picture.size_px, picture.rgb, image_text(picture.frame));
}

void write(const Slice& slice, const AnswerBench& bench, Exported& made) {
  made.path = output_path(slice.path).generic_string();
  std::vector<Outlined> objects;
  for (const ObjectName& name : slice.objects)
    objects.push_back({name.name, bench.objects.at(name.name).voxel.octree});
  for (const ObjectName& name : slice.hatched)
    objects.push_back({name.name, bench.objects.at(name.name).voxel.octree, true});
  SlicePicture picture =
      drawn(slice, subject_of(bench.samples(slice.scan.name), slice), objects, bench.timings, bench.stop);
  write(output_file(bench.folder, made.path), picture);
  made.written = true;
  made.content = "a " + record_of<SliceRecord>(picture.said).plane + " picture, " +
                 std::to_string(picture.size_px.x) + " x " + std::to_string(picture.size_px.y) + " pixels";
  made.details = std::move(picture.said);
}

/// The voxels in a file of a binary octree or a mesh.
voxel::Octree octree_on_file(const fs::path& path, const Subject& subject, const FileBench& bench) {
  if (is_mesh(path)) return voxels_of_mesh(path, std::nullopt, finest_mm(subject.lattice), bench);
  const voxel::OctreeFile file = read_timed(path, bench.timings);
  const auto* octree = std::get_if<voxel::Octree>(&file.tree);
  if (octree == nullptr)
    throw std::runtime_error(
        path.string() +
        ": only a binary octree has an outline: choose an object by octotomy octree --window LOW:HIGH");
  return *octree;
}

FileAnswer on_files(const Slice& asked, const FileBench& bench) {
  need_picture_extension(asked.out);
  need_folder_of(asked.out);
  Slice slice = asked;
  if (!asked.curve.empty()) slice.curve_mm = curve_points(asked.curve);
  const fs::path file = asked.scan.name;
  std::optional<voxel::Scene> scene;
  if (!is_octree(file) && !is_mesh(file)) scene = bench.read_scan(file);
  const Subject subject = scene           ? subject_of(*scene, slice)
                          : is_mesh(file) ? subject_of_mesh(file, slice, bench)
                                          : subject_of(file, bench.timings);
  std::vector<Outlined> objects;
  for (const ObjectName& name : asked.objects)
    objects.push_back({name.name, octree_on_file(name.name, subject, bench)});
  for (const ObjectName& name : asked.hatched)
    objects.push_back({name.name, octree_on_file(name.name, subject, bench), true});
  const SlicePicture picture = drawn(slice, subject, objects, bench.timings, bench.stop);
  {
    const Stopwatch watch(bench.timings, "write");
    write(asked.out, picture);
  }
  FileAnswer answer{{{"path", asked.out.string()}, {"source", file.string()}}};
  answer.json.update(picture.said);
  const auto record = record_of<SliceRecord>(picture.said);
  answer.rows = {
      {"written", asked.out.string()},
      {"plane", record.plane + (record.position_mm ? " at " + grouped(*record.position_mm, 2) + " mm" : "")},
      {"pixel", grouped(record.pixel_mm, 4) + " mm"},
      {"window", grouped(record.window.at(0), 0) + " to " + grouped(record.window.at(1), 0)}};
  return answer;
}

}  // namespace

SlicePicture slice_of(const Slice& slice, const voxel::Scene& scene, const std::vector<Outlined>& objects,
                      Timings& timings, const std::stop_token& stop) {
  return drawn(slice, subject_of(scene, slice), objects, timings, stop);
}

Operation slice_operation() {
  return Describe<Slice>("slice",
                         "Draws a plane or a curved sheet of a scan in true scale, with outlines of objects.",
                         Makes::File)
      .takes(field("scan", &Slice::scan, "The scan; on the command line also an .octree file or a mesh.")
                 .required()
                 .positional("file"))
      .takes(field("path", &Slice::path, "Path of the .png, .jpg or .webp file within the result's folder.")
                 .in_plans_only())
      .takes(field("axial", &Slice::axial,
                   "An axial plane: z in mm, or middle, which is the default if no plane is stated. It is "
                   "seen from below, with the patient's left on the right."))
      .takes(field("coronal", &Slice::coronal,
                   "A coronal plane: y in mm, or middle. It is seen from the front."))
      .takes(field("sagittal", &Slice::sagittal,
                   "A sagittal plane: x in mm, or middle. It is seen from the patient's left."))
      .takes(
          field("oblique", &Slice::oblique, "An oblique plane: a point in LPS mm, and the viewing direction.")
              .from(2)
              .to(2))
      .takes(field("curve_mm", &Slice::curve_mm,
                   "A curved sheet: two or more of its points, from left to right.")
                 .from(2)
                 .in_plans_only())
      .takes(field("height_mm", &Slice::height_mm, "Height of a curved sheet, mm.")
                 .greater_than(0.0)
                 .read_if<Slice>(is_curved, "applies only to curved sheets: add 'curve'"))
      .takes(
          field("up", &Slice::up,
                "The direction that is up in an oblique or curved picture. Default: towards the head.")
              .direction()
              .read_if<Slice>([](const Slice& slice) { return is_curved(slice) || !slice.oblique.empty(); },
                              "applies only to oblique and curved pictures, because axial, coronal and "
                              "sagittal pictures have a fixed up direction: leave it out"))
      .takes(field("window", &Slice::window,
                   "The samples that are black and white: LOW:HIGH in sample units, or a tissue.")
                 .read_if<Slice>(cuts_samples, no_samples))
      .takes(field("level", &Slice::level,
                   "Grey tones as a centre and a width in sample units. Default: 500 and 2000 for Hounsfield "
                   "units.")
                 .from(2)
                 .to(2)
                 .comma_separated()
                 .for_example("CENTRE,WIDTH as 500,2000"))
      .takes(field("objects", &Slice::objects,
                   "Objects whose outlines are drawn; on the command line binary octrees and meshes.")
                 .repeated()
                 .called("octree"))
      .takes(field("hatched", &Slice::hatched,
                   "Objects that are drawn with a hatched inside, by default in red: for example the "
                   "interference of pieces.")
                 .repeated())
      .takes(field("colours", &Slice::colours,
                   "Colours #RRGGBB of the outlines in their order, then of the hatched objects.")
                 .repeated()
                 .called("colour"))
      .takes(field("pixel_mm", &Slice::pixel_mm,
                   "Edge of a pixel, mm. Default: the scan's smallest spacing; finer in a curved picture "
                   "with fewer than 800 columns.")
                 .greater_than(0.0))
      .takes(
          field("size", &Slice::size, "Size of the picture, WxH in pixels. Default: the whole scan.")
              .read_if<Slice>(
                  [](const Slice& slice) { return !is_curved(slice); },
                  "applies only to planes, because a curve's picture is as long as the curve: leave it out"))
      .takes(field("centre_mm", &Slice::centre_mm,
                   "X,Y,Z in LPS of a point whose projection onto the plane is the picture's middle. "
                   "Default: the scan's middle.")
                 .called("centre")
                 .read_if<Slice>([](const Slice& slice) { return !slice.size.empty(); },
                                 "applies only with 'size': add 'size'"))
      .takes(field("interpolate", &Slice::interpolate, "Interpolation between samples.")
                 .one_of({"nearest", "linear", "cubic"})
                 .read_if<Slice>(cuts_samples, no_samples))
      .takes(field("plain", &Slice::plain, "Leaves out the letters and the scale bar."))
      .takes(field("grid_mm", &Slice::grid_mm,
                   "Draws lines at multiples of this distance, mm. An added margin at the right and below "
                   "shows their positions in the view of the plane.")
                 .from(0.1)
                 .to(1000.0)
                 .called("grid"))
      .verb_takes(field("out", &Slice::out, "The picture: a .png, .jpg or .webp file.").required())
      .verb_takes(field("curve", &Slice::curve,
                        "A curved sheet: X,Y,Z in mm of two or more points, from left to right, or a JSON "
                        "file with these as points_mm."))
      .reads_scans()
      .example(R"({"id": "axial", "do": "slice", "scan": "ct", "path": "axial.png", "axial": "40",
        "objects": ["maxilla"]})")
      .on_files(
          "octotomy slice head.nrrd -o axial.png --axial 40 --level 500,2000 --octree maxilla.octree\n"
          "  octotomy slice head.nrrd -o oblique.png --oblique 0,0,30 0,1,0.5\n"
          "  octotomy slice head.nrrd -o arch.png --curve -30,10,5 -15,-25,5 15,-25,5 30,10,5 --height 70",
          on_files)
      .check(check)
      .write(write);
}

}  // namespace octotomy::planner

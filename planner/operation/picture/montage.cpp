// SPDX-License-Identifier: AGPL-3.0-or-later
// Consecutive slices of a scan side by side, in true scale and one range of tones (thesis, figure 1.2).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/step_on_files.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/slice.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/image_file.h"
#include "voxel/view/annotation.h"

namespace octotomy::planner {
namespace {

constexpr int gap_px = 2;
constexpr std::uint8_t gap_tone = 96;

struct Montage {
  ScanName scan;
  std::filesystem::path out;
  std::string plane = "axial";
  int count = 9;
  std::optional<int> columns;
  std::optional<double> first_mm, apart_mm, pixel_mm;
  std::vector<double> level;
  bool plain = false;

  std::vector<std::string> inputs() const { return {}; }
};

/// A position to a tenth of a millimetre as text, such as "-19" or "2.5", in characters that pictures can
/// show.
std::string rounded_text(double position_mm) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", std::round(10.0 * position_mm) / 10.0 + 0.0);
  return text;
}

/// An axis of the patient, and the ascending positions along it of the scan's own slices.
struct Stack {
  int axis = 2;
  double first_mm = 0.0, spacing_mm = 1.0;
  int count = 1;
};

Stack stack_of(const voxel::Lattice& lattice, const std::string& plane) {
  Stack stack;
  stack.axis = plane == "axial" ? 2 : plane == "coronal" ? 1 : 0;
  // The axis of the lattice that is most nearly parallel to an axis of the patient.
  int along = 0;
  const glm::dmat3 steps(lattice.lps_from_voxel);
  for (int k = 1; k < 3; ++k)
    if (std::abs(steps[k][stack.axis]) > std::abs(steps[along][stack.axis])) along = k;
  stack.count = lattice.dims[along];
  stack.spacing_mm = std::abs(steps[along][stack.axis]);
  glm::dvec3 end = 0.5 * glm::dvec3(lattice.dims - 1);
  end[along] = steps[along][stack.axis] > 0.0 ? 0.0 : lattice.dims[along] - 1.0;
  stack.first_mm = lattice.lps_mm(end)[stack.axis];
  return stack;
}

/// The positions of the slices: the middle ones of the scan's own slices, or equally spaced positions that
/// begin at --first.
std::vector<double> positions_of(const Montage& asked, const Stack& stack) {
  const double step_mm = asked.apart_mm.value_or(stack.spacing_mm);
  double first_mm = 0.0;
  if (asked.first_mm) {
    first_mm = *asked.first_mm;
  } else if (asked.apart_mm) {
    first_mm = stack.first_mm + 0.5 * ((stack.count - 1) * stack.spacing_mm - (asked.count - 1) * step_mm);
  } else {
    first_mm = stack.first_mm + std::floor(0.5 * (stack.count - asked.count)) * stack.spacing_mm;
  }
  const double low_mm = stack.first_mm - 0.5 * stack.spacing_mm;
  const double high_mm = low_mm + stack.count * stack.spacing_mm;
  std::vector<double> positions;
  for (int i = 0; i < asked.count; ++i) {
    positions.push_back(first_mm + i * step_mm);
    if (positions.back() < low_mm || positions.back() > high_mm)
      throw std::runtime_error("slice " + std::to_string(i + 1) + " of " + std::to_string(asked.count) +
                               " at " + grouped(positions.back(), 1) +
                               " mm lies outside of the scan, which " + "reaches from " + grouped(low_mm, 1) +
                               " to " + grouped(high_mm, 1) +
                               " mm: choose a smaller --count, another --first or a smaller --apart");
  }
  return positions;
}

SlicePicture tile_of(const Montage& asked, const voxel::Scene& scene, double position_mm,
                     const std::vector<double>& level, const FileBench& bench) {
  Slice slice;
  (asked.plane == "axial"     ? slice.axial
   : asked.plane == "coronal" ? slice.coronal
                              : slice.sagittal) = Json(position_mm).dump();
  slice.plain = true;
  slice.level = level;
  slice.pixel_mm = asked.pixel_mm;
  return slice_of(slice, scene, {}, bench.timings, bench.stop);
}

FileAnswer on_files(const Montage& asked, const FileBench& bench) {
  if (bench.step == nullptr) {
    need_picture_extension(asked.out);
    need_folder_of(asked.out);
  }
  const voxel::Scene scene = bench.read_scan(asked.scan.name);
  const std::vector<double> positions = positions_of(asked, stack_of(scene.lattice, asked.plane));
  std::vector<double> level = asked.level;
  std::vector<SlicePicture> tiles;
  Json inside = Json::array();
  for (const double position_mm : positions) {
    tiles.push_back(tile_of(asked, scene, position_mm, level, bench));
    const nlohmann::ordered_json& said = tiles.back().said;
    // All slices have the grey tones of the first slice, so that they can be compared.
    const double black = said["window"][0], white = said["window"][1];
    if (level.empty()) level = {0.5 * (black + white), white - black};
    inside.push_back(said["inside_pixels"]);
  }
  glm::ivec2 tile_px(0);
  for (const SlicePicture& tile : tiles) tile_px = glm::max(tile_px, tile.size_px);
  const int columns = std::min(
      asked.count,
      asked.columns.value_or(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(asked.count))))));
  const int rows = (asked.count + columns - 1) / columns;
  const glm::ivec2 size_px = glm::ivec2(columns, rows) * (tile_px + gap_px) - gap_px;
  if (size_px.x > voxel::most_sheet_px || size_px.y > voxel::most_sheet_px)
    throw std::runtime_error("a picture of " + std::to_string(size_px.x) + " x " + std::to_string(size_px.y) +
                             " pixels is larger than " + std::to_string(voxel::most_sheet_px) +
                             " a side: choose fewer slices by --count, or a larger --pixel");
  std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y),
                                gap_tone);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    SlicePicture& tile = tiles[i];
    if (!asked.plain) {
      voxel::ImagePlane plane;
      plane.size_px = tile.size_px;
      plane.pixel_mm = tile.sheet.pixel_mm;
      voxel::Annotation annotation;
      annotation.title = rounded_text(positions[i]);
      annotation.letters = voxel::edge_letters(tile.sheet);
      annotation.sides = annotation.scale = i == 0;
      voxel::annotate(tile.rgb, plane, annotation);
    }
    const glm::ivec2 at =
        glm::ivec2(static_cast<int>(i) % columns, static_cast<int>(i) / columns) * (tile_px + gap_px);
    for (int y = 0; y < tile.size_px.y; ++y)
      std::copy_n(tile.rgb.begin() + 3 * std::ptrdiff_t{y} * tile.size_px.x, 3 * tile.size_px.x,
                  rgb.begin() + 3 * (std::ptrdiff_t{at.y + y} * size_px.x + at.x));
  }
  {
    const Stopwatch watch(bench.timings, "write");
    voxel::write_image(asked.out, size_px, rgb);
  }
  FileAnswer answer;
  answer.json = {{"path", asked.out.string()},
                 {"plane", asked.plane},
                 {"positions_mm", positions},
                 {"columns", columns},
                 {"rows", rows},
                 {"tile_px", {tile_px.x, tile_px.y}},
                 {"size_px", {size_px.x, size_px.y}},
                 {"pixel_mm", tiles.front().sheet.pixel_mm},
                 {"window", {level[0] - 0.5 * level[1], level[0] + 0.5 * level[1]}},
                 {"unit", voxel::unit(scene)},
                 {"inside_pixels", inside}};
  answer.rows = {
      {"written", asked.out.string()},
      {"slices", std::to_string(positions.size()) + " " + asked.plane + " from " +
                     grouped(positions.front(), 1) + " to " + grouped(positions.back(), 1) + " mm"},
      {"size", std::to_string(size_px.x) + " x " + std::to_string(size_px.y) + " pixels"}};
  return answer;
}

void check(const Montage& asked, const FieldLocation& place) {
  if (!asked.level.empty() && !(asked.level[1] > 0.0))
    place.at("level").refuse("must be CENTRE and WIDTH, with a width above zero");
  if (place.scope != nullptr) check_output_path(asked.out, {".png", ".jpg", ".webp"}, place.at("path"));
}

}  // namespace

Operation montage_operation() {
  return Describe<Montage>("montage", "Draws consecutive slices of a scan side by side.", Makes::File)
      .takes(field("scan", &Montage::scan, "The scan.").required().positional("file"))
      .takes(
          field("path", &Montage::out, "The picture: a .png, .jpg or .webp file.").required().called("out"))
      .takes(
          field("plane", &Montage::plane, "Plane of the slices. They are drawn as by the operation 'slice'.")
              .one_of({"axial", "coronal", "sagittal"}))
      .takes(field("count", &Montage::count, "Number of slices.").from(1).to(400))
      .takes(
          field("columns", &Montage::columns, "Number of slices in a row. Default: about the number of rows.")
              .from(1)
              .to(400))
      .takes(field("first_mm", &Montage::first_mm,
                   "Position z, y or x of the first slice, mm. Default: the slices are centred in the scan."))
      .takes(field("apart_mm", &Montage::apart_mm,
                   "Distance from one slice to the next. Default: the spacing of the scan's samples.")
                 .greater_than(0.0))
      .takes(field("level", &Montage::level,
                   "Grey tones as a centre and a width in sample units. Default: those that 'slice' chooses "
                   "for the first slice.")
                 .from(2)
                 .to(2)
                 .comma_separated()
                 .for_example("CENTRE,WIDTH, for example 500,2000"))
      .takes(
          field("pixel_mm", &Montage::pixel_mm, "Edge of a pixel, mm. Default: the scan's smallest spacing.")
              .greater_than(0.0))
      .takes(field("plain", &Montage::plain, "Leaves out the positions, letters and scale bar."))
      .reads_scans()
      .example(R"({"id": "series", "do": "montage", "scan": "ct", "path": "series.png", "count": 9})")
      .on_files(
          "octotomy montage head.nrrd -o series.png --count 9\n"
          "  octotomy montage head.nrrd -o coronal.png --plane coronal --first -60 --apart 10 --count 8 "
          "--columns 4",
          on_files)
      .check(check)
      .write(write_step<Montage, on_files>);
}

}  // namespace octotomy::planner

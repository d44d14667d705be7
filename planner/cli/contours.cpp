// SPDX-License-Identifier: AGPL-3.0-or-later
#include <limits>

#include "brep/contour/contour.h"
#include "planner/cli/numbers.h"
#include "planner/cli/scan_in.h"
#include "planner/cli/scan_verbs.h"
#include "planner/measure/result_json.h"
#include "planner/plan/region_file.h"
#include "planner/plan/slice_contours.h"
#include "planner/table/json_file.h"
#include "planner/table/number_format.h"

namespace octotomy::planner::cli {
namespace {

struct ContoursText {
  std::filesystem::path in, out, edits, codes;
  std::string window;
  ScanIn scan;
  Refinement refinement;
  double code_spacing_mm = 1.0;
};

bool is_json(const std::filesystem::path& path) {
  return path.extension() == ".json";
}

voxel::SliceMask drawn_or_followed(const Program& program, const ContoursText& text, Timings& timings) {
  if (is_json(text.in)) {
    if (!text.window.empty())
      throw std::runtime_error(text.in.string() + ": holds contours already: leave --window out");
    return read_slices(text.in);
  }
  if (text.window.empty())
    throw CLI::ValidationError("--window",
                               "what are the contours of? for example --window 300: or --window skin");
  const WindowText window = parse_window(text.window);
  const voxel::Scene scene = read_scan(program, text.in, text.scan, timings);
  need_hounsfield(text.window, scene);
  const Stopwatch watch(timings, "follow");
  return slice_contours(scene, window.low, window.high.value_or(std::numeric_limits<double>::infinity()));
}

/// Per slice, and sums for people; holes count against areas.
struct Sizes {
  Json slices = Json::array();
  std::size_t contours = 0, points = 0;
  double area_mm2 = 0.0, perimeter_mm = 0.0;
};

Sizes sizes_of(const voxel::SliceMask& mask) {
  Sizes sizes;
  for (const auto& slice : mask.slices) {
    std::vector<brep::Contour> contours;
    for (const auto& polygon : slice.polygons_mm) contours.push_back({polygon});
    const std::vector<std::size_t> depth = brep::depths(brep::nest(contours));
    double area_mm2 = 0.0, perimeter_mm = 0.0;
    for (std::size_t i = 0; i < contours.size(); ++i) {
      area_mm2 += (depth[i] % 2 == 1 ? -1.0 : 1.0) * std::abs(brep::signed_area_mm2(contours[i]));
      perimeter_mm += brep::perimeter_mm(contours[i]);
      sizes.points += contours[i].points_mm.size();
    }
    sizes.contours += contours.size();
    sizes.area_mm2 += area_mm2;
    sizes.perimeter_mm += perimeter_mm;
    sizes.slices.push_back({{"position_mm", slice.position_mm},
                            {"contours", contours.size()},
                            {"area_mm2", area_mm2},
                            {"perimeter_mm", perimeter_mm}});
  }
  return sizes;
}

int contours(const Program& program, const ContoursText& text) {
  need_folder_of(text.out);
  if (!is_json(text.out)) throw std::runtime_error(text.out.string() + ": contours are written as .json");
  if (!text.codes.empty()) need_folder_of(text.codes);
  Timings timings;
  voxel::SliceMask mask = drawn_or_followed(program, text, timings);
  {
    const Stopwatch watch(timings, "refine");
    mask = refined(mask, text.refinement);
    if (!text.edits.empty()) mask = edited(mask, text.edits);
    voxel::check(mask);
  }
  write_json(to_json(mask), text.out);
  if (!text.codes.empty()) write_json(chain_codes(mask, text.code_spacing_mm), text.codes);
  const Sizes sizes = sizes_of(mask);
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["contours"] = sizes.contours;
  json["points"] = sizes.points;
  json["slices"] = sizes.slices;
  program.say(json, lines({{"written", text.out.string()},
                           {"slices", grouped(static_cast<double>(mask.slices.size()), 0)},
                           {"contours", grouped(static_cast<double>(sizes.contours), 0)},
                           {"points", grouped(static_cast<double>(sizes.points), 0)},
                           {"area of all", grouped(sizes.area_mm2, 1) + " mm\u00b2"},
                           {"length of all", grouped(sizes.perimeter_mm, 1) + " mm"}}));
  return done;
}

}  // namespace

void add_contours(Program& program) {
  const auto text = std::make_shared<ContoursText>();
  CLI::App& verb = program.verb(
      "contours",
      "Contours on a scan's slices: followed, thinned, smoothed, offset, edited; for mask --slices",
      "octotomy contours head.nrrd --window 300: --least-area 20 --thin 0.2 -o bone.json\n"
      "  octotomy contours bone.json --by 2 --edits mine.json -o margin.json\n"
      "  octotomy mask --slices margin.json --like head.nrrd -o margin.octree\n"
      "Edits: {\"edits\": [{\"slice\": 3, \"contour\": 0, \"do\": \"move\", \"point\": 7, \"to_mm\": [-12.5, "
      "40]}]}, and "
      "insert (piece, at_mm), delete (point), split (first, second), join (piece, with, its_piece), remove, "
      "add "
      "(points_mm)",
      [&program, text] { return contours(program, *text); });
  verb.add_option("file", text->in, "A scan, or a .json of regions on slices")
      ->required()
      ->check(scan_path());
  verb.add_option("-o,--out", text->out, "A .json of regions on slices, as mask --slices reads it")
      ->required();
  verb.add_option("--window", text->window, "Of a scan: LOW:HIGH or LOW: in sample units, or a tissue");
  verb.add_option("--least-area", text->refinement.least_area_mm2,
                  "Leave contours out that enclose less, mm2")
      ->check(between(0.0, 1e9));
  verb.add_option("--thin", text->refinement.thin_mm, "Take out points within this of a straight piece, mm")
      ->check(between(0.0, 1e6));
  verb.add_option("--harmonics", text->refinement.harmonics, "Smooth each by so many Fourier harmonics")
      ->check(CLI::Range(1, 10000));
  verb.add_option("--by", text->refinement.offset_mm, "Move them out by this, mm; in where it is below 0")
      ->check(between(-1e6, 1e6));
  verb.add_option("--edits", text->edits, "FILE.json of edits by hand, made after all else, in order")
      ->check(CLI::ExistingFile);
  verb.add_option("--codes", text->codes, "Write Freeman's chain codes too, to this .json");
  verb.add_option("--code-spacing", text->code_spacing_mm, "Of the samples that the codes step on, mm")
      ->check(above_zero())
      ->capture_default_str();
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli

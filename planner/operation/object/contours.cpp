// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes contours on a scan's slices as a file that masks read: traced, thinned, smoothed, moved outwards or
// inwards, edited.
#include <cmath>
#include <functional>

#include "brep/contour/contour.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/region_file.h"
#include "planner/operation/file/seed_contours.h"
#include "planner/operation/file/slice_contours.h"
#include "planner/operation/file/step_on_files.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Contours {
  ScanName scan;
  std::filesystem::path out;
  std::optional<SampleWindow> window;
  std::vector<std::string> slice_windows;
  std::vector<glm::dvec3> seeds_mm, around_mm;
  std::optional<double> tolerance;
  double least_area_mm2 = 0.0, thin_mm = 0.0, by_mm = 0.0;
  std::optional<int> harmonics;
  // Only the verb has the following options.
  std::filesystem::path edits, codes;
  double code_spacing_mm = 1.0;

  std::vector<std::string> inputs() const { return {}; }
};

bool is_json(const std::filesystem::path& path) {
  return path.extension() == ".json";
}

bool has_windows(const Contours& contours) {
  return contours.window || !contours.slice_windows.empty();
}

std::vector<SliceWindow> own_windows(const Contours& contours) {
  std::vector<SliceWindow> own;
  for (const std::string& text : contours.slice_windows) own.push_back(parse_slice_window(text));
  return own;
}

/// The reason why options contradict each other; empty if they do not. `name` returns an option's name for
/// the message.
std::string conflict_of(const Contours& contours, const std::function<std::string(const char*)>& name) {
  if (!contours.seeds_mm.empty() && has_windows(contours))
    return name("seeds_mm") + ": determine the thresholds: leave " + name("window") + " out";
  if (!contours.seeds_mm.empty() && !contours.around_mm.empty())
    return name("around_mm") + ": cannot be combined with seeds on edges: leave " + name("seeds_mm") + " out";
  if (contours.tolerance && contours.around_mm.empty())
    return name("tolerance") + ": applies only to a region around a seed: add " + name("around_mm");
  if (contours.tolerance && has_windows(contours))
    return name("tolerance") + ": replaces the window: leave " + name("window") + " out";
  if (!contours.around_mm.empty() && !contours.slice_windows.empty())
    return name("slice_windows") + ": cannot be combined with regions around pixels: leave " +
           name("around_mm") + " out";
  if (!contours.around_mm.empty() && !contours.window && !contours.tolerance)
    return name("around_mm") + ": add " + name("window") + " or " + name("tolerance") +
           ", which limits the samples of the region";
  return "";
}

void check(const Contours& contours, const FieldLocation& place) {
  try {
    own_windows(contours);
  } catch (const std::runtime_error& error) {
    place.at("slice_windows").refuse(error.what());
  }
  if (place.scope == nullptr) return;
  check_output_path(contours.out, {".json"}, place.at("path"));
  const std::string conflict =
      conflict_of(contours, [](const char* key) { return "'" + std::string(key) + "'"; });
  if (!conflict.empty()) place.refuse(conflict);
  if (!has_windows(contours) && contours.seeds_mm.empty() && contours.around_mm.empty())
    place.refuse("'window' is missing: add it, for example \"bone\", or 'seeds_mm'");
}

/// Computes the contours in a scan. Adds the contour that was found for each seed to `of_seeds`.
voxel::SliceMask followed(const Contours& asked, const voxel::Scene& scene, Timings& timings, Json& of_seeds,
                          std::vector<std::string>& findings) {
  const Stopwatch watch(timings, "follow");
  if (asked.window) need_hounsfield(*asked.window, scene);
  if (!asked.seeds_mm.empty() || !asked.around_mm.empty()) {
    SeedContours made = asked.around_mm.empty()
                            ? contours_at_seeds(scene, asked.seeds_mm)
                            : contours_around_seeds(scene, asked.around_mm, {asked.window, asked.tolerance});
    for (const SeedContour& seed : made.seeds) {
      of_seeds.push_back({{"seed_mm", {seed.seed_mm.x, seed.seed_mm.y, seed.seed_mm.z}},
                          {"threshold", seed.threshold},
                          {"position_mm", seed.position_mm},
                          {"away_mm", seed.away_mm}});
      if (seed.is_far)
        findings.push_back("a seed lies " + plain(std::round(100.0 * seed.away_mm) / 100.0) +
                           " mm away from the nearest contour at its threshold of " + plain(seed.threshold) +
                           ", so it lies on no edge and this contour is a guess: choose a seed on the edge");
    }
    return std::move(made.mask);
  }
  const std::vector<SliceWindow> own = own_windows(asked);
  for (const SliceWindow& slice : own) need_hounsfield(slice.window, scene);
  return slice_contours(scene, asked.window, own);
}

voxel::SliceMask finished(const Contours& asked, const voxel::SliceMask& mask, Timings& timings,
                          std::vector<std::string>& findings) {
  const Stopwatch watch(timings, "refine");
  Refinement refinement{asked.least_area_mm2, asked.thin_mm, std::nullopt, asked.by_mm};
  if (asked.harmonics) refinement.harmonics = static_cast<std::size_t>(*asked.harmonics);
  voxel::SliceMask done = refined(mask, refinement, findings);
  if (!asked.edits.empty()) done = edited(done, asked.edits);
  voxel::check(done);
  return done;
}

/// The sizes of the contours in each slice, and their sums for the printed text. The areas of holes are
/// subtracted.
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

std::string option_named(const char* key) {
  const std::string name = key;
  return name == "seeds_mm"        ? "--seed"
         : name == "around_mm"     ? "--around"
         : name == "slice_windows" ? "--slice-window"
                                   : "--" + name;
}

FileAnswer on_files(const Contours& asked, const FileBench& bench) {
  const std::filesystem::path file = asked.scan.name;
  need_extension(asked.out, {".json"}, "contours are");
  if (!asked.codes.empty()) need_extension(asked.codes, {".json"}, "chain codes are");
  need_outputs({asked.out, asked.codes}, {file, asked.edits});
  const std::string conflict = conflict_of(asked, option_named);
  if (!conflict.empty()) throw std::runtime_error(conflict);
  if (is_json(file) && (!asked.seeds_mm.empty() || !asked.around_mm.empty()))
    throw std::runtime_error(file.string() + ": already contains contours: leave " +
                             (asked.seeds_mm.empty() ? "--around" : "--seed") + " out");
  if (is_json(file) && has_windows(asked))
    throw std::runtime_error(file.string() + ": already contains contours: leave " +
                             (asked.window ? "--window" : "--slice-window") + " out");
  if (!is_json(file) && !has_windows(asked) && asked.seeds_mm.empty() && asked.around_mm.empty())
    throw std::runtime_error(
        "--window: choose the samples that the contours outline, for example --window 300: or --window skin, "
        "or --seed X,Y,Z on an "
        "edge");
  std::vector<std::string> findings;
  Json of_seeds = Json::array();
  const voxel::SliceMask mask =
      finished(asked,
               is_json(file) ? read_slices(file, {}, findings)
                             : followed(asked, bench.read_scan(file), bench.timings, of_seeds, findings),
               bench.timings, findings);
  Outputs outputs;
  const auto put = [&](const Json& json, const std::filesystem::path& out) {
    outputs.write(out, [&](const std::filesystem::path& hidden) { write_json(json, hidden); });
  };
  put(to_json(mask), asked.out);
  if (!asked.codes.empty()) put(chain_codes(mask, asked.code_spacing_mm), asked.codes);
  outputs.commit();
  const Sizes sizes = sizes_of(mask);
  FileAnswer answer{{{"path", asked.out.string()},
                     {"contours", sizes.contours},
                     {"points", sizes.points},
                     {"slices", sizes.slices},
                     {"findings", findings}},
                    {{"written", asked.out.string()},
                     {"slices", grouped(static_cast<double>(mask.slices.size()), 0)},
                     {"contours", grouped(static_cast<double>(sizes.contours), 0)},
                     {"points", grouped(static_cast<double>(sizes.points), 0)},
                     {"area of all", grouped(sizes.area_mm2, 1) + " mm\u00b2"},
                     {"length of all", grouped(sizes.perimeter_mm, 1) + " mm"}},
                    findings};
  for (const Json& seed : of_seeds)
    answer.rows.emplace_back("threshold", plain(seed["threshold"].get<double>()) + " at " +
                                              plain(seed["position_mm"].get<double>()) + " mm");
  if (!of_seeds.empty()) answer.json["seeds"] = std::move(of_seeds);
  return answer;
}

}  // namespace

Operation contours_operation() {
  return Describe<Contours>(
             "contours",
             "Writes the contours on a scan's slices, and can thin, smooth, offset and edit them.",
             Makes::File)
      .takes(field("scan", &Contours::scan, "The scan; for the verb also a .json of regions on slices.")
                 .required()
                 .positional("file"))
      .takes(field("path", &Contours::out, "A .json file of regions on slices, in the form that masks read.")
                 .required()
                 .called("out"))
      .takes(field("window", &Contours::window,
                   "For a scan: the samples that the contours outline, LOW:HIGH or LOW: in sample units, or "
                   "a tissue."))
      .takes(field("seeds_mm", &Contours::seeds_mm,
                   "For a scan, instead of a window: pixels on edges, LPS. The pixel's sample is the "
                   "threshold in its slice, and the contour nearest to the pixel is written.")
                 .repeated()
                 .called("seed"))
      .takes(field("slice_windows", &Contours::slice_windows,
                   "For a scan: separate windows for single slices, POSITION=LOW:HIGH, with the position in "
                   "mm along the contours' view. Other slices use 'window' if it is set; otherwise they have "
                   "no contours.")
                 .repeated()
                 .called("slice-window"))
      .takes(field("around_mm", &Contours::around_mm,
                   "For a scan: pixels within regions, LPS. For each, the connected region of the window "
                   "around it in its slice is written, with the region's holes.")
                 .repeated()
                 .called("around"))
      .takes(field("tolerance", &Contours::tolerance,
                   "For regions around pixels, instead of a window: the largest difference of samples from "
                   "the pixel's sample.")
                 .from(0.0))
      .takes(field("least_area_mm2", &Contours::least_area_mm2,
                   "Leaves out contours that enclose less than this area.")
                 .from(0.0)
                 .to(1e9))
      .takes(field("thin_mm", &Contours::thin_mm, "Removes points within this distance of a straight piece.")
                 .from(0.0)
                 .to(1e6))
      .takes(field("harmonics", &Contours::harmonics, "Number of Fourier harmonics that smooth each contour.")
                 .from(1)
                 .to(10000))
      .takes(field("by_mm", &Contours::by_mm,
                   "Moves contours outward by this distance, or inward if it is negative.")
                 .from(-1e6)
                 .to(1e6))
      .verb_takes(field("edits", &Contours::edits,
                        "A .json file of manual edits. They are made last, in their order.")
                      .a_file())
      .verb_takes(
          field("codes", &Contours::codes, "A .json file to which Freeman's chain codes are also written."))
      .verb_takes(
          field("code_spacing_mm", &Contours::code_spacing_mm, "The spacing of the grid of chain codes.")
              .greater_than(0.0)
              .read_if<Contours>([](const Contours& contours) { return !contours.codes.empty(); },
                                 "needs 'codes': add it"))
      .reads_scans()
      .example(
          R"({"id": "lines", "do": "contours", "scan": "ct", "path": "bone.json",
        "window": "300:", "by_mm": 2})")
      .on_files(
          "octotomy contours head.nrrd --window 300: --least-area 20 --thin 0.2 -o bone.json\n"
          "  octotomy contours head.nrrd --seed 0,-62,10 --seed 0,-60,30 -o profile.json\n"
          "  octotomy contours head.nrrd --window 300: --slice-window 30=250: --slice-window 32=260: -o "
          "bone.json\n"
          "  octotomy contours head.nrrd --around 12,-20,10 --tolerance 60 -o cyst.json\n"
          "  octotomy contours bone.json --by 2 --edits mine.json -o margin.json\n"
          "  octotomy mask --slices margin.json --like head.nrrd -o margin.octree\n"
          "Edits: {\"edits\": [{\"slice\": 3, \"contour\": 0, \"do\": \"move\", \"point\": 7, \"to_mm\": "
          "[-12.5, 40]}]}, and insert (piece, at_mm), delete (point), split (first, second), join (piece, "
          "with, "
          "its_piece), remove, add (points_mm)",
          on_files)
      .check(check)
      .write(write_step<Contours, on_files>);
}

}  // namespace octotomy::planner

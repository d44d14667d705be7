// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/measure/compare_labels.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "brep/measure/difference.h"
#include "convert/surface/label_surfaces.h"
#include "planner/file/label_table.h"
#include "planner/table/json.h"
#include "planner/table/number_format.h"
#include "planner/table/same_patient.h"
#include "voxel/filter/label_map.h"
#include "voxel/solid/combine.h"
#include "voxel/space/file_text.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// A label map with what is asked of it label by label.
struct Side {
  fs::path path;
  voxel::Scene scene;
  std::map<int, std::uint64_t> samples;
  brep::PartedSurface surfaces = {};

  double volume_mm3(int label) const {
    const auto found = samples.find(label);
    return found == samples.end() ? 0.0 : static_cast<double>(found->second) * scene.lattice.voxel_mm3();
  }
};

Side side_of(const fs::path& path, const FileBench& bench, std::vector<std::string>& findings) {
  Side side{path, bench.read_scan(path), {}};
  try {
    const std::vector<voxel::Label> labels = voxel::labels(side.scene);
    for (const voxel::Label& label : labels) side.samples[label.number] = label.samples;
    for (const std::string& finding : findings_of_labels(labels))
      findings.push_back(path.string() + ": " + finding);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path.string() + ": is no label map: " + error.what());
  }
  if (side.samples.empty())
    throw std::runtime_error(path.string() + ": every sample is 0, so there are no labels");
  const Stopwatch watch(bench.timings, "surfaces");
  side.surfaces = convert::label_surfaces(side.scene, {{}, 0, {bench.stop, {}}});
  return side;
}

/// The first lattice, continued until it covers the second one's samples.
voxel::Lattice covering(const voxel::Lattice& a, const voxel::Lattice& b) {
  glm::dvec3 low(0.0), high = glm::dvec3(a.dims) - 1.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p_voxel =
        glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2) * glm::dvec3(b.dims - 1);
    low = glm::min(low, a.voxel(b.lps_mm(p_voxel)));
    high = glm::max(high, a.voxel(b.lps_mm(p_voxel)));
  }
  // Rounding of coordinates adds no row.
  constexpr double rounding = 1e-6;
  low = glm::floor(low + rounding);
  high = glm::ceil(high - rounding);
  voxel::Lattice whole{glm::ivec3(high - low) + 1, a.lps_from_voxel};
  whole.lps_from_voxel[3] = glm::dvec4(a.lps_mm(low), 1.0);
  return whole;
}

/// Sums over all labels that both maps have.
struct Totals {
  double common_mm3 = 0.0, both_mm3 = 0.0;  ///< both_mm3 of all labels of either map
  double hausdorff_mm = 0.0, hausdorff95_mm = 0.0, mean_mm = 0.0;
  std::size_t compared = 0;
};

Json label_json(int label, const std::string& name, const Side& a, const Side& b,
                const voxel::Universe& universe, Totals& totals) {
  const voxel::Octree of_a = voxel::octree_of_label(universe, a.scene, label),
                      of_b = voxel::octree_of_label(universe, b.scene, label);
  const auto count_a = static_cast<double>(of_a.voxel_count()),
             count_b = static_cast<double>(of_b.voxel_count());
  const auto common = static_cast<double>(
      voxel::combine(universe, voxel::Expression(of_a) & voxel::Expression(of_b)).voxel_count());
  const double voxel_mm3 = universe.lattice().voxel_mm3();
  totals.common_mm3 += common * voxel_mm3;
  totals.both_mm3 += (count_a + count_b) * voxel_mm3;
  Json json{{"label", label},
            {"name", name},
            {"volume_a_mm3", a.volume_mm3(label)},
            {"volume_b_mm3", b.volume_mm3(label)},
            {"dice", count_a + count_b > 0.0 ? Json(2.0 * common / (count_a + count_b)) : Json(nullptr)}};
  for (const char* key : {"hausdorff_mm", "hausdorff95_mm", "mean_mm"}) json[key] = nullptr;
  if (!a.samples.contains(label) || !b.samples.contains(label)) return json;
  const brep::Difference difference =
      brep::difference(brep::linked(brep::surface_of_part(a.surfaces, label)),
                       brep::linked(brep::surface_of_part(b.surfaces, label)));
  json["hausdorff_mm"] = difference.hausdorff_mm;
  json["hausdorff95_mm"] = difference.hausdorff95_mm;
  json["mean_mm"] = difference.mean_mm;
  totals.hausdorff_mm = std::max(totals.hausdorff_mm, difference.hausdorff_mm);
  totals.hausdorff95_mm = std::max(totals.hausdorff95_mm, difference.hausdorff95_mm);
  totals.mean_mm += difference.mean_mm;
  ++totals.compared;
  return json;
}

Json definitions() {
  return {{"hausdorff_mm",
           "of a label: largest distance of a point of either surface, half-way between samples, to the "
           "other's nearest triangle; of all: the largest"},
          {"hausdorff95_mm",
           "of a label: larger of the two directed, area-weighted 95th percentiles, point to triangle; of "
           "all: the largest"},
          {"mean_mm",
           "of a label: area-weighted mean of absolute distances, point to triangle, over both surfaces; of "
           "all: the mean of the labels"},
          {"dice", "twice the common samples by the sum of both, at A's samples; of all: of all labels"}};
}

}  // namespace

bool is_label_map(const fs::path& path) {
  return voxel::volume_format(path).has_value() || voxel::extension_of(path) == ".dcm";
}

FileAnswer compare_label_maps(const fs::path& path_a, const fs::path& path_b, bool other_identity,
                              const FileBench& bench) {
  FileAnswer answer;
  const Side a = side_of(path_a, bench, answer.findings), b = side_of(path_b, bench, answer.findings);
  for (std::string& finding :
       need_same_patient({path_a.string(), a.scene.identity}, {path_b.string(), b.scene.identity},
                         other_identity, "--other-identity"))
    answer.findings.push_back(std::move(finding));
  std::set<int> all, of_a, of_b;
  for (const auto& [label, samples] : a.samples) of_a.insert(label);
  for (const auto& [label, samples] : b.samples) of_b.insert(label);
  std::set_union(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::inserter(all, all.end()));
  std::map<int, std::string> names = label_table_of(path_b, of_b).names;
  for (const auto& [label, name] : label_table_of(path_a, of_a).names) names[label] = name;
  const voxel::Lattice lattice = covering(a.scene.lattice, b.scene.lattice);
  const bool is_one_lattice =
      lattice.dims == a.scene.lattice.dims && lattice.dims == b.scene.lattice.dims &&
      glm::distance(lattice.lps_mm(lattice.dims - 1), b.scene.lattice.lps_mm(lattice.dims - 1)) < 1e-3;
  if (!is_one_lattice)
    answer.findings.emplace_back("the maps have different lattices: Dice is taken at the samples of " +
                                 path_a.string());
  const voxel::Universe universe = voxel::universe_on(lattice);
  const Stopwatch watch(bench.timings, "compare");
  Totals totals;
  answer.json["labels"] = Json::array();
  for (const int label : all) {
    if (bench.stop.stop_requested()) throw voxel::Stopped("stopped while labels were compared");
    const std::string name = names.contains(label) ? names[label] : "label " + std::to_string(label);
    const Json json = label_json(label, name, a, b, universe, totals);
    answer.rows.emplace_back(
        name, "Dice " + grouped(json["dice"].is_null() ? 0.0 : json["dice"].get<double>(), 5) +
                  (json["mean_mm"].is_null()
                       ? std::string()
                       : ", mean " + grouped(json["mean_mm"].get<double>(), 3) + " mm, Hausdorff 95 " +
                             grouped(json["hausdorff95_mm"].get<double>(), 3) + " mm"));
    if (json["mean_mm"].is_null())
      answer.findings.push_back("'" + name + "' (" + std::to_string(label) + ") is only in " +
                                (of_a.contains(label) ? path_a : path_b).string() + ": it has no distances");
    answer.json["labels"].push_back(json);
  }
  const bool has_any = totals.compared > 0;
  answer.json["hausdorff_mm"] = has_any ? Json(totals.hausdorff_mm) : Json(nullptr);
  answer.json["hausdorff95_mm"] = has_any ? Json(totals.hausdorff95_mm) : Json(nullptr);
  answer.json["mean_mm"] =
      has_any ? Json(totals.mean_mm / static_cast<double>(totals.compared)) : Json(nullptr);
  answer.json["dice"] =
      totals.both_mm3 > 0.0 ? Json(2.0 * totals.common_mm3 / totals.both_mm3) : Json(nullptr);
  answer.json["definition"] = definitions();
  answer.json["findings"] = answer.findings;
  return answer;
}

}  // namespace octotomy::planner

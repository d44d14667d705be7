// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/compare_labels.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "brep/measure/difference.h"
#include "convert/surface/label_surfaces.h"
#include "planner/operation/file/label_table.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/record.h"
#include "planner/operation/table/same_patient.h"
#include "voxel/filter/label_map.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// One of the two label maps: its samples, and the number of samples and the surface of each label.
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

/// Whether two lattices cover the same field but differ in the order or direction of their axes.
bool is_stored_otherwise(const voxel::Lattice& a, const voxel::Lattice& b) {
  constexpr double nearly = 1e-3;
  if (a == b || a.sample_count() != b.sample_count()) return false;
  for (const glm::dvec3& corner : {glm::dvec3(0.0), glm::dvec3(b.dims - 1)}) {
    const glm::dvec3 at = a.voxel(b.lps_mm(corner));
    if (glm::any(glm::lessThan(at, glm::dvec3(-nearly))) ||
        glm::any(glm::greaterThan(at, glm::dvec3(a.dims - 1) + nearly)))
      return false;
  }
  return true;
}

/// Reads a label map. If it covers the same field as `onto` in another order of axes, its samples are stored
/// in the order of `onto`. The objects stay the same, but an octree's triangles follow the order of the axes.
Side side_of(const fs::path& path, const FileBench& bench, std::vector<std::string>& findings,
             const voxel::Lattice* onto = nullptr) {
  Side side{path, bench.read_scan(path), {}};
  if (onto != nullptr && is_stored_otherwise(*onto, side.scene.lattice))
    if (std::optional<voxel::Scene> laid = voxel::laid_on(side.scene, *onto)) side.scene = std::move(*laid);
  try {
    const std::vector<voxel::Label> labels = voxel::labels(side.scene);
    for (const voxel::Label& label : labels) side.samples[label.number] = label.samples;
    for (const std::string& finding : findings_of_labels(labels))
      findings.push_back(path.string() + ": " + finding);
  } catch (const voxel::InvalidInput& error) {
    throw std::runtime_error(path.string() + ": is not a label map: " + error.what());
  }
  if (side.samples.empty())
    throw std::runtime_error(path.string() + ": contains no labels, because every sample is 0");
  const Stopwatch watch(bench.timings, "surfaces");
  side.surfaces = convert::label_surfaces(side.scene, {{}, 0, {bench.stop, {}}});
  return side;
}

/// The first lattice, extended by whole samples until it covers the samples of the second.
voxel::Lattice covering(const voxel::Lattice& a, const voxel::Lattice& b) {
  glm::dvec3 low(0.0), high = glm::dvec3(a.dims) - 1.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p_voxel =
        glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2) * glm::dvec3(b.dims - 1);
    low = glm::min(low, a.voxel(b.lps_mm(p_voxel)));
    high = glm::max(high, a.voxel(b.lps_mm(p_voxel)));
  }
  // With this tolerance, rounding of coordinates adds no row of samples.
  constexpr double rounding = 1e-6;
  low = glm::floor(low + rounding);
  high = glm::ceil(high - rounding);
  voxel::Lattice whole{glm::ivec3(high - low) + 1, a.lps_from_voxel};
  whole.lps_from_voxel[3] = glm::dvec4(a.lps_mm(low), 1.0);
  return whole;
}

/// Sums over the labels of two maps.
struct Totals {
  double common_mm3 = 0.0, both_mm3 = 0.0;  ///< sum of the volumes of all labels in both maps
  double hausdorff_mm = 0.0, hausdorff95_mm = 0.0, mean_mm = 0.0;
  std::size_t compared = 0;
};

/// A label that both maps or only one of them contain, with its number in each.
struct Pair {
  std::optional<int> a, b;
  std::string name;

  int number() const { return a ? *a : *b; }
};

voxel::Octree object_of(const voxel::Universe& universe, const Side& side, const std::optional<int>& label) {
  return label ? voxel::octree_of_label(universe, side.scene, *label) : voxel::Octree::empty(universe);
}

/// The agreement of two maps on a label. Distances are none if only one map contains it.
struct LabelComparison {
  int label = 0;
  std::string name;
  double volume_a_mm3 = 0.0, volume_b_mm3 = 0.0;
  std::optional<double> dice, hausdorff_mm, hausdorff95_mm, mean_mm;
};
constexpr auto members_of(const LabelComparison&) {
  using L = LabelComparison;
  return std::tuple(member("label", &L::label), member("name", &L::name),
                    member("volume_a_mm3", &L::volume_a_mm3), member("volume_b_mm3", &L::volume_b_mm3),
                    member("dice", &L::dice), member("hausdorff_mm", &L::hausdorff_mm),
                    member("hausdorff95_mm", &L::hausdorff95_mm), member("mean_mm", &L::mean_mm));
}

struct MapComparison {
  std::vector<LabelComparison> labels;
  std::optional<double> hausdorff_mm, hausdorff95_mm, mean_mm, dice;  ///< over all labels in both maps
  Json definition;
  std::vector<std::string> findings;
};
constexpr auto members_of(const MapComparison&) {
  using M = MapComparison;
  return std::tuple(member("labels", &M::labels), member("hausdorff_mm", &M::hausdorff_mm),
                    member("hausdorff95_mm", &M::hausdorff95_mm), member("mean_mm", &M::mean_mm),
                    member("dice", &M::dice), member("definition", &M::definition),
                    member("findings", &M::findings));
}

LabelComparison compared(const Pair& pair, const Side& a, const Side& b, const voxel::Universe& universe,
                         Totals& totals) {
  const voxel::Octree of_a = object_of(universe, a, pair.a), of_b = object_of(universe, b, pair.b);
  const auto count_a = static_cast<double>(of_a.voxel_count()),
             count_b = static_cast<double>(of_b.voxel_count());
  const auto common = static_cast<double>(
      voxel::combine(universe, voxel::Expression(of_a) & voxel::Expression(of_b)).voxel_count());
  const double voxel_mm3 = universe.lattice().voxel_mm3();
  totals.common_mm3 += common * voxel_mm3;
  totals.both_mm3 += (count_a + count_b) * voxel_mm3;
  LabelComparison made;
  made.label = pair.number();
  made.name = pair.name;
  if (pair.a) made.volume_a_mm3 = a.volume_mm3(*pair.a);
  if (pair.b) made.volume_b_mm3 = b.volume_mm3(*pair.b);
  if (count_a + count_b > 0.0) made.dice = 2.0 * common / (count_a + count_b);
  if (!pair.a || !pair.b) return made;
  const brep::Difference difference =
      brep::difference(brep::linked(brep::surface_of_part(a.surfaces, *pair.a)),
                       brep::linked(brep::surface_of_part(b.surfaces, *pair.b)));
  made.hausdorff_mm = difference.hausdorff_mm;
  made.hausdorff95_mm = difference.hausdorff95_mm;
  made.mean_mm = difference.mean_mm;
  totals.hausdorff_mm = std::max(totals.hausdorff_mm, difference.hausdorff_mm);
  totals.hausdorff95_mm = std::max(totals.hausdorff95_mm, difference.hausdorff95_mm);
  totals.mean_mm += difference.mean_mm;
  ++totals.compared;
  return made;
}

Json definitions() {
  return {{"hausdorff_mm",
           "of a label: largest distance from a point of either surface, which lies half-way between "
           "samples, to the nearest triangle of the other surface; of all: the largest"},
          {"hausdorff95_mm",
           "of a label: larger of the two directed, area-weighted 95th percentiles, point to triangle; of "
           "all: the largest"},
          {"mean_mm",
           "of a label: area-weighted mean of absolute distances, point to triangle, over both surfaces; of "
           "all: the mean of the labels"},
          {"dice",
           "twice the common samples divided by the sum of both, at A's samples; of all: over all labels"}};
}

using Names = std::map<int, std::string>;

std::string name_of(const Names& names, int label) {
  const auto name = names.find(label);
  return name == names.end() ? "label " + std::to_string(label) : name->second;
}

/// The names of the labels that occur in a map; appends findings on its table.
Names names_of(const Side& side, std::vector<std::string>& findings) {
  std::set<int> occurring;
  for (const auto& [label, samples] : side.samples) occurring.insert(label);
  LabelTable table = label_table_of(side.path, occurring);
  findings.insert(findings.end(), table.passed_over.begin(), table.passed_over.end());
  std::erase_if(table.names, [&](const auto& entry) { return !occurring.contains(entry.first); });
  return std::move(table.names);
}

/// The numbers of a map's labels by name; a label without a name has one such as "label 5". Throws if two
/// labels have the same name.
std::map<std::string, int> numbers_of(const Side& side, const Names& names) {
  std::map<std::string, int> numbers;
  for (const auto& [label, samples] : side.samples)
    if (const auto [known, is_new] = numbers.try_emplace(name_of(names, label), label); !is_new)
      throw std::runtime_error(side.path.string() + ": the labels " + std::to_string(known->second) +
                               " and " + std::to_string(label) + " are both named '" + known->first +
                               "', so labels cannot be paired by name: rename one of them");
  return numbers;
}

/// Pairs labels by name if both maps have names, else by number. Adds findings where names and numbers
/// contradict each other.
std::vector<Pair> pairs_of(const Side& a, const Side& b, std::vector<std::string>& findings) {
  const Names names_a = names_of(a, findings), names_b = names_of(b, findings);
  const bool by_name = !names_a.empty() && !names_b.empty();
  if (names_a.empty() != names_b.empty())
    findings.push_back("labels are paired by number, because only " +
                       (names_b.empty() ? a : b).path.string() + " has names");
  for (const auto& [label, samples] : a.samples)
    if (by_name && b.samples.contains(label) && name_of(names_a, label) != name_of(names_b, label))
      findings.push_back("number " + std::to_string(label) + " is '" + name_of(names_a, label) + "' in " +
                         a.path.string() + " and '" + name_of(names_b, label) + "' in " + b.path.string() +
                         ": labels are paired by name");
  const Names none;
  std::map<std::string, Pair> by_key;
  for (const auto& [key, label] : numbers_of(a, by_name ? names_a : none)) by_key[key].a = label;
  for (const auto& [key, label] : numbers_of(b, by_name ? names_b : none)) by_key[key].b = label;
  std::vector<Pair> pairs;
  for (auto& [key, pair] : by_key) {
    const Names& names = pair.a && names_a.contains(*pair.a) ? names_a : names_b;
    pair.name = by_name ? key : name_of(names, pair.number());
    pairs.push_back(std::move(pair));
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& left, const Pair& right) { return left.number() < right.number(); });
  return pairs;
}

}  // namespace

bool is_label_map(const fs::path& path) {
  return voxel::volume_format(path).has_value() || (voxel::extension_of(path) == ".dcm" && !is_mesh(path));
}

FileAnswer compare_label_maps(const fs::path& path_a, const fs::path& path_b, bool other_identity,
                              const FileBench& bench) {
  FileAnswer answer;
  const Side a = side_of(path_a, bench, answer.findings);
  const Side b = side_of(path_b, bench, answer.findings, &a.scene.lattice);
  for (std::string& finding :
       need_same_patient({path_a.string(), a.scene.identity}, {path_b.string(), b.scene.identity},
                         other_identity, "--other-identity"))
    answer.findings.push_back(std::move(finding));
  const std::vector<Pair> pairs = pairs_of(a, b, answer.findings);
  const voxel::Lattice lattice = covering(a.scene.lattice, b.scene.lattice);
  const bool is_one_lattice =
      lattice.dims == a.scene.lattice.dims && lattice.dims == b.scene.lattice.dims &&
      glm::distance(lattice.lps_mm(lattice.dims - 1), b.scene.lattice.lps_mm(lattice.dims - 1)) < 1e-3;
  if (!is_one_lattice)
    answer.findings.emplace_back("the maps have different lattices: Dice is computed at the samples of " +
                                 path_a.string());
  const voxel::Universe universe = voxel::universe_on(lattice);
  const Stopwatch watch(bench.timings, "compare");
  Totals totals;
  MapComparison made;
  for (const Pair& pair : pairs) {
    if (bench.stop.stop_requested()) throw voxel::Stopped("stopped while labels were compared");
    const LabelComparison& label = made.labels.emplace_back(compared(pair, a, b, universe, totals));
    answer.rows.emplace_back(
        pair.name, "Dice " + grouped(label.dice.value_or(0.0), 5) +
                       (label.mean_mm ? ", mean " + grouped(*label.mean_mm, 3) + " mm, Hausdorff 95 " +
                                            grouped(*label.hausdorff95_mm, 3) + " mm"
                                      : std::string()));
    if (!label.mean_mm)
      answer.findings.push_back("'" + pair.name + "'" + " (" + std::to_string(pair.number()) +
                                ") is only in " + (pair.a ? path_a : path_b).string() +
                                ", so distances cannot be computed");
  }
  if (totals.compared > 0) {
    made.hausdorff_mm = totals.hausdorff_mm;
    made.hausdorff95_mm = totals.hausdorff95_mm;
    made.mean_mm = totals.mean_mm / static_cast<double>(totals.compared);
  }
  if (totals.both_mm3 > 0.0) made.dice = 2.0 * totals.common_mm3 / totals.both_mm3;
  made.definition = definitions();
  made.findings = answer.findings;
  answer.json = print_record(made);
  return answer;
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
// The operated scan: a scan of an expression of objects, each sample from the object that owns its place.
#include <algorithm>
#include <cmath>
#include <random>

#include "planner/operation/object/combine.h"
#include "planner/operation/table/operation.h"
#include "verify/question/expression_on_meshes.h"
#include "verify/question/expression_tree.h"
#include "verify/witness/reading.h"
#include "voxel/solid/expression_scan.h"

namespace octotomy::planner {
namespace {

using Json = nlohmann::ordered_json;

struct ScanOf {
  ScanName scan;
  std::string expression;
  std::optional<double> hole_value, filled_value;
};

std::vector<std::string> uses(const ScanOf& step) {
  return voxel::names_in(step.expression);
}

void check(const ScanOf& step, const Place& place) {
  check_expression(step.expression, place.at("expression"));
}

// The second reading: places of samples that are drawn at random, decided by the objects' witnesses and by an
// interpolation of its own. Neither shares code with the voxel kernel.

double stored_at(const voxel::Scene& scene, const glm::ivec3& at) {
  const glm::ivec3& dims = scene.lattice.dims;
  const std::size_t index =
      static_cast<std::size_t>(at.x) +
      static_cast<std::size_t>(dims.x) * (static_cast<std::size_t>(at.y) +
                                          static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(at.z));
  return std::visit([&](const auto& samples) { return static_cast<double>(samples[index]); }, scene.samples);
}

/// The trilinear sample of a scan at a point; none where a sample about it is padding or lies outside.
std::optional<double> sample_at(const voxel::Scene& scene, const glm::dvec3& p_mm) {
  constexpr double rounding = 1e-9;
  const glm::dvec3 p(glm::inverse(scene.lattice.lps_from_voxel) * glm::dvec4(p_mm, 1.0));
  const glm::dvec3 low = glm::floor(p + rounding);
  const glm::dvec3 t = glm::max(p - low, glm::dvec3(0.0));
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) weight *= side[axis] == 1 ? t[axis] : 1.0 - t[axis];
    if (weight <= rounding) continue;
    const glm::ivec3 at = glm::ivec3(low) + side;
    if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, scene.lattice.dims)))
      return std::nullopt;
    const double value = stored_at(scene, at);
    if (scene.padding && value == *scene.padding) return std::nullopt;
    sum += weight * value;
  }
  return sum;
}

/// Whether a place is in an expression, and the object in it that gives the sample.
struct Owned {
  bool is_inside = false;
  bool is_known = true;  ///< no surface is near
  const Object* owner = nullptr;
};

class SecondReading {
 public:
  SecondReading(const std::string& expression, const Objects& objects, double near_mm) : near_mm_(near_mm) {
    tree_ = verify::expression_tree_of(expression, names_);
    for (const std::string& name : names_) objects_.push_back(&objects.at(name));
  }

  Owned operator()(const glm::dvec3& p_mm) const { return read(tree_, p_mm); }

 private:
  Owned read(const verify::ExpressionTree& tree, const glm::dvec3& p_mm) const {
    if (tree.parts.empty()) {
      const Object& object = *objects_[static_cast<std::size_t>(tree.leaf)];
      if (!object.witness) return {false, false, nullptr};
      const verify::Word word = object.witness(p_mm, near_mm_, verify::Asked::BothWords).voxel;
      return {word.in, word.in != word.out && !word.near, object.is_tool ? nullptr : &object};
    }
    Owned made = read(tree.parts.front(), p_mm);
    // Which sample a complement has is the voxel kernel's rule, and is not read again.
    if (tree.symbol == '~') return {!made.is_inside, made.is_known && made.is_inside, nullptr};
    for (std::size_t i = 1; i < tree.parts.size(); ++i)
      made = joined(tree.symbol, made, read(tree.parts[i], p_mm));
    return made;
  }

  static Owned joined(char symbol, const Owned& a, const Owned& b) {
    const bool is_known = a.is_known && b.is_known;
    if (symbol == '&') return {a.is_inside && b.is_inside, is_known, a.owner != nullptr ? a.owner : b.owner};
    if (symbol == '-') return {a.is_inside && !b.is_inside, is_known, a.owner};
    const Object* owner = a.is_inside && (a.owner != nullptr || !b.is_inside) ? a.owner : b.owner;
    return {symbol == '|' ? a.is_inside || b.is_inside : a.is_inside != b.is_inside, is_known, owner};
  }

  double near_mm_;
  std::vector<std::string> names_;
  verify::ExpressionTree tree_;
  std::vector<const Object*> objects_;
};

struct Compared {
  int drawn = 0, compared = 0, differing = 0;
  double largest = 0.0;  ///< difference of a sample, in the scan's unit
};

/// What the second reading expects at a place; none where it cannot decide.
std::optional<double> expected(const Owned& owned, const glm::dvec3& p_mm,
                               const voxel::ExpressionScan& made) {
  if (!owned.is_known) return std::nullopt;
  if (!owned.is_inside) return made.hole;
  if (owned.owner == nullptr || !owned.owner->shown || !owned.owner->shown->samples) return std::nullopt;
  const Shown& shown = *owned.owner->shown;
  return sample_at(*shown.samples, glm::dvec3(glm::inverse(shown.moved_from_still) * glm::dvec4(p_mm, 1.0)));
}

/// Compares drawn samples of the made scan. Cost: `drawn` readings of the witnesses.
Compared compare(const ScanOf& step, const ScanBench& bench, const voxel::ExpressionScan& made) {
  constexpr int drawn = 20000;
  const voxel::Lattice& lattice = made.scene.lattice;
  const LoadedScan& frame = (*bench.scans)(step.scan.name);
  const glm::dvec3 spacing = lattice.spacing_mm();
  const SecondReading reading(step.expression, *bench.objects, std::max({spacing.x, spacing.y, spacing.z}));
  // A sample is rounded to a step of its scan.
  const double allowed = 0.5 * frame.grey.step() * (1.0 + 1e-6) + 1e-6;
  Compared result;
  std::mt19937_64 random(1);
  for (; result.drawn < drawn; ++result.drawn) {
    bench.progress.at(0.6 + 0.4 * result.drawn / drawn);
    glm::ivec3 at;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = static_cast<int>(random() % static_cast<std::uint64_t>(lattice.dims[axis]));
    const glm::dvec3 p_mm = lattice.lps_mm(glm::dvec3(at));
    const std::optional<double> wanted = expected(reading(p_mm), p_mm, made);
    if (!wanted) continue;
    const double off = std::abs(stored_at(made.scene, at) - *wanted);
    ++result.compared;
    if (off > allowed) ++result.differing;
    result.largest = std::max(result.largest, off);
  }
  return result;
}

MadeScan made(const ScanOf& step, const ScanBench& bench) {
  const LoadedScan& frame = (*bench.scans)(step.scan.name);
  voxel::Names names;
  names.object = [&](std::string_view name) -> voxel::Expression {
    const VoxelSide& object = bench.objects->at(std::string(name)).voxel;
    return object.symbol ? *object.symbol : voxel::Expression(object.octree);
  };
  voxel::ExpressionScanOptions options{step.hole_value, step.filled_value, bench.progress};
  voxel::ExpressionScan result = voxel::expression_scan(
      frame.scene(), frame.grey, voxel::parse_expression(step.expression, names), options);
  const Compared compared = compare(step, bench, result);
  const double sample_mm3 = frame.scene().lattice.voxel_mm3();
  Json details{{"expression", step.expression},
               {"changed_samples", result.changed_samples},
               {"hole_samples", result.hole_samples},
               {"hole_mm3", static_cast<double>(result.hole_samples) * sample_mm3},
               {"hole_value", result.hole},
               {"filled_value", result.filled},
               {"second_reading",
                {{"drawn", compared.drawn},
                 {"compared", compared.compared},
                 {"differing", compared.differing},
                 {"largest_difference", compared.largest}}}};
  std::vector<std::string> findings;
  for (const std::string& name : uses(step)) {
    const std::optional<Shown>& shown = bench.objects->at(name).shown;
    if (shown && shown->scan != step.scan.name)
      findings.push_back("the samples of '" + name + "' come from '" + shown->scan +
                         "' and stand beside those of '" + step.scan.name +
                         "' as they are: their units and scanners may differ");
  }
  if (compared.compared == 0)
    findings.emplace_back("no sample could be read a second time: nothing confirms this scan");
  if (compared.differing > 0)
    findings.push_back(std::to_string(compared.differing) + " of " + std::to_string(compared.compared) +
                       " samples that were read a second time differ, by up to " +
                       std::to_string(compared.largest) + ": do not rely on this scan, and please report it");
  if (step.hole_value && result.hole_samples > 0)
    findings.push_back(std::to_string(result.hole_samples) + " samples where no object is have the value " +
                       std::to_string(*step.hole_value) + ", as chosen: nothing was scanned there");
  return {std::move(result.scene), std::move(details), std::nullopt, std::move(findings)};
}

}  // namespace

Operation scan_of_operation() {
  return Describe<ScanOf>(
             "scan_of",
             "Makes the scan of an expression of objects, such as the operated head: each sample "
             "from the object that owns its place, moved along with it.",
             Makes::Scan)
      .takes(field("scan", &ScanOf::scan, "The scan whose lattice, unit and patient the made one takes over.")
                 .required())
      .takes(field("expression", &ScanOf::expression,
                   "Names of objects under & | - ^ ~ and parentheses. Of two that overlap the one that is "
                   "named first gives the sample.")
                 .required())
      .takes(field("hole_value", &ScanOf::hole_value,
                   "Sample where no object is. Default: the scan's padding, or a value below all its "
                   "samples; it counts as not scanned."))
      .takes(field("filled_value", &ScanOf::filled_value,
                   "Sample of objects that come from no scan, such as a plate. Default: 3071 of Hounsfield "
                   "units, otherwise the scan's largest sample."))
      .example(R"({"id": "operated", "do": "scan_of", "scan": "ct", "expression": "advanced | rest"})")
      .check(check)
      .scan(made)
      .uses(uses);
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
// The operated scan: a scan of an expression of objects, each sample from the object that owns its place.
#include <algorithm>
#include <cmath>
#include <random>

#include "convert/deck/scan_sampler.h"
#include "planner/operation/object/combine.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/question/expression_on_meshes.h"
#include "verify/question/expression_tree.h"
#include "verify/witness/reading.h"
#include "verify/witness/reshaped_witness.h"
#include "voxel/solid/expression_scan.h"
#include "voxel/solid/grey_owner.h"
#include "voxel/space/shared_progress.h"

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

void check(const ScanOf& step, const FieldLocation& place) {
  check_expression(step.expression, place.at("expression"));
}

/// The kind of a scan's samples in words, such as "MR samples in no known unit" or "labels".
std::string kind_of(const voxel::Scene& scene) {
  if (scene.meaning == voxel::Meaning::Label) return "labels";
  const std::string samples = scene.modality.empty() ? "samples" : scene.modality + " samples";
  return samples + (scene.meaning == voxel::Meaning::Hounsfield ? " in HU" : " in no known unit");
}

/// The samples at an object's place before its motions, and the motion that moves them along with the object.
struct OwnSamples {
  const Shown* scan = nullptr;
  glm::dmat4 moved_from_still{1.0};

  explicit operator bool() const { return scan != nullptr; }
  bool operator==(const OwnSamples& other) const {
    return scan != nullptr && other.scan != nullptr && scan->scan == other.scan->scan &&
           moved_from_still == other.moved_from_still;
  }
};

/// The samples that all parts have in common; none if the parts have different ones.
template <typename Parts, typename Of>
OwnSamples in_common(const Parts& parts, const Of& of) {
  OwnSamples common;
  for (const auto& part : parts) {
    const OwnSamples own = of(part);
    if (!own || (common && !(own == common))) return {};
    common = own;
  }
  return common;
}

/// The samples of the scan from which an object derives. None if no scan or several do, or if the object is
/// not a rigid image of its scan, such as a warped object.
OwnSamples own_samples(const Objects& objects, const Object& object) {
  if (object.shown) return {&*object.shown, object.shown->moved_from_still};
  if (!object.bound.windows.empty())
    return in_common(object.bound.windows, [](const Shown& window) {
      return OwnSamples{&window, window.moved_from_still};
    });
  if (object.image) {
    OwnSamples own = own_samples(objects, objects.at(object.image->object));
    own.moved_from_still = object.image->image_from_object * own.moved_from_still;
    return own;
  }
  if (verify::is_reshaped(object.witness) && object.bound.reshaped.size() == 1)
    return own_samples(objects, objects.at(object.bound.reshaped.front()));
  if (object.kind != "combine") return {};
  std::vector<const Object*> parts;
  for (const std::string& name : voxel::names_in(object.definition))
    if (!objects.at(name).is_tool) parts.push_back(&objects.at(name));
  return in_common(parts, [&](const Object* part) { return own_samples(objects, *part); });
}

/// An object's voxels, with the samples of its windows where there are any, and elsewhere with those of its
/// scan.
voxel::Expression sampled(const Objects& objects, const Object& object) {
  const VoxelSide& side = object.voxel;
  const voxel::Expression voxels = side.symbol ? *side.symbol : voxel::Expression(side.octree);
  if (object.is_tool) return voxels;
  const OwnSamples own = own_samples(objects, object);
  return own ? voxel::with_samples(voxels, voxel::all_samples(own.scan->grey, own.moved_from_still)) : voxels;
}

bool is_one_grey(const voxel::GreyOctree& a, const voxel::GreyOctree& b) {
  // Grey octrees are immutable and shared, so the address of the storage identifies the universe.
  return &a.universe() == &b.universe();
}

/// Throws if samples have another meaning than those of the frame, such as a label map's beside Hounsfield
/// units, or another step.
void need_one_meaning(const ScanOf& step, const ScanBench& bench, const voxel::Expression& expression) {
  const LoadedScan& loaded = (*bench.scans)(step.scan.name);
  const voxel::Scene& frame = loaded.scene();
  const std::vector<voxel::Window> giving = voxel::positive_windows(expression);
  for (const std::string& name : uses(step)) {
    const Object& object = bench.objects->at(name);
    std::vector<Shown> windows = object.bound.windows;
    if (const OwnSamples own = own_samples(*bench.objects, object)) windows.push_back(*own.scan);
    for (const Shown& window : windows) {
      const bool gives = std::any_of(giving.begin(), giving.end(), [&](const voxel::Window& given) {
        return is_one_grey(given.grey, window.grey);
      });
      if (!gives || !window.samples || window.scan == step.scan.name) continue;
      const voxel::Scene& other = *window.samples;
      const bool is_other_device =
          !other.modality.empty() && !frame.modality.empty() && other.modality != frame.modality;
      std::string why;
      if (other.meaning != frame.meaning || is_other_device)
        why = "differ in meaning from those of '" + step.scan.name + "' (" + kind_of(other) + " beside " +
              kind_of(frame) + ")";
      else if (window.grey.step() != loaded.grey.step())
        why = "have steps of " + plain(window.grey.step()) + ", those of '" + step.scan.name + "' steps of " +
              plain(loaded.grey.step());
      if (!why.empty())
        throw voxel::Error(voxel::ErrorCode::Input, "the samples of '" + name + "' come from '" +
                                                        window.scan + "' and " + why + ": leave '" + name +
                                                        "' out, or set \"scan\" to '" + window.scan + "'");
    }
  }
}

// The second reading computes randomly drawn samples by the objects' witnesses and by separate code for
// interpolation. Neither shares code with the voxel kernel.

/// Whether an expression contains a point, and the object from which the point's sample comes.
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
      const verify::AllowedSides word = object.witness(p_mm, near_mm_, verify::ReadingNeeds::BothSides).voxel;
      return {word.in, word.in != word.out && !word.near, object.is_tool ? nullptr : &object};
    }
    Owned made = read(tree.parts.front(), p_mm);
    // The voxel kernel determines the sample in a complement, which the second reading cannot check.
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

/// The voxel kernel's share of the progress; the rest is for the second reading.
constexpr double kernel_share = 0.6;

struct Compared {
  int drawn = 0, compared = 0, differing = 0;
  double largest = 0.0;  ///< largest difference of a sample, in the scan's unit
};

/// The sample that the second reading expects at a point; none if it cannot decide. At points outside of the
/// expression, padding of the frame is not checked.
std::optional<double> expected(const Owned& owned, const glm::dvec3& p_mm, const Objects& objects,
                               bool frame_is_padding, const voxel::ExpressionScan& made) {
  if (!owned.is_known) return std::nullopt;
  if (!owned.is_inside) return frame_is_padding ? std::nullopt : std::optional(made.hole);
  if (owned.owner == nullptr) return std::nullopt;
  const OwnSamples own = own_samples(objects, *owned.owner);
  if (!own || !own.scan->samples) return std::nullopt;
  const convert::ScanSampler scan(*own.scan->samples);
  const glm::dvec3 at = scan.voxel(glm::dvec3(glm::inverse(own.moved_from_still) * glm::dvec4(p_mm, 1.0)));
  return scan.holds(at) ? std::optional(scan.at(at)) : std::nullopt;
}

/// Compares randomly drawn samples of the made scan with the second reading. Cost: `drawn` readings of the
/// witnesses.
Compared compare(const ScanOf& step, const ScanBench& bench, const voxel::ExpressionScan& made) {
  constexpr int drawn = 20000;
  const voxel::Lattice& lattice = made.scene.lattice;
  const LoadedScan& frame = (*bench.scans)(step.scan.name);
  const glm::dvec3 spacing = lattice.spacing_mm();
  const convert::ScanSampler before(frame.scene()), after(made.scene);
  const SecondReading reading(step.expression, *bench.objects, std::max({spacing.x, spacing.y, spacing.z}));
  // Samples are rounded to a step of their scan.
  const double allowed = 0.5 * frame.grey.step() * (1.0 + 1e-6) + 1e-6;
  Compared result;
  std::mt19937_64 random(1);
  for (; result.drawn < drawn; ++result.drawn) {
    bench.progress.at(kernel_share + (1.0 - kernel_share) * result.drawn / drawn);
    glm::ivec3 at;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = static_cast<int>(random() % static_cast<std::uint64_t>(lattice.dims[axis]));
    const glm::dvec3 p_mm = lattice.lps_mm(glm::dvec3(at));
    const glm::dvec3 voxel(at);
    const bool frame_is_padding = frame.scene().padding && before.at(voxel) == *frame.scene().padding;
    const std::optional<double> wanted =
        expected(reading(p_mm), p_mm, *bench.objects, frame_is_padding, made);
    if (!wanted) continue;
    const double off = std::abs(after.at(voxel) - *wanted);
    ++result.compared;
    if (off > allowed) ++result.differing;
    result.largest = std::max(result.largest, off);
  }
  return result;
}

/// The windows whose samples become part of the made scan. The distances of offset surfaces are not samples,
/// so they are left out.
std::vector<voxel::Window> giving_of(const Objects& objects, const Object& object, const LoadedScan& frame) {
  std::vector<voxel::Window> giving = voxel::positive_windows(sampled(objects, object));
  std::erase_if(giving, [&](const voxel::Window& window) { return window.grey.step() != frame.grey.step(); });
  return giving;
}

/// The objects of the expression without samples from a scan, such as " ('plate', 'screw')"; empty if there
/// are none.
std::string without_samples(const ScanOf& step, const Objects& objects, const LoadedScan& frame) {
  std::string names;
  for (const std::string& name : uses(step)) {
    const Object& object = objects.at(name);
    if (object.is_tool || !giving_of(objects, object, frame).empty()) continue;
    names += (names.empty() ? " ('" : ", '") + name + "'";
  }
  return names.empty() ? names : names + ")";
}

MadeScan made(const ScanOf& step, const ScanBench& bench) {
  const LoadedScan& frame = (*bench.scans)(step.scan.name);
  voxel::Names names;
  names.object = [&](std::string_view name) -> voxel::Expression {
    return sampled(*bench.objects, bench.objects->at(std::string(name)));
  };
  const voxel::Expression expression = voxel::parse_expression(step.expression, names);
  need_one_meaning(step, bench, expression);
  const voxel::ExpressionScanOptions options{step.hole_value, step.filled_value,
                                             voxel::part_of(bench.progress, 0.0, kernel_share)};
  voxel::ExpressionScan result = voxel::expression_scan(frame.scene(), frame.grey, expression, options);
  const Compared compared = compare(step, bench, result);
  const double sample_mm3 = frame.scene().lattice.voxel_mm3();
  Json details{{"expression", step.expression},
               {"changed_samples", result.changed_samples},
               {"hole_samples", result.hole_samples},
               {"hole_mm3", static_cast<double>(result.hole_samples) * sample_mm3},
               {"hole_value", result.hole},
               {"filled_samples", result.filled_samples},
               {"filled_value", result.filled},
               {"second_reading",
                {{"drawn", compared.drawn},
                 {"compared", compared.compared},
                 {"differing", compared.differing},
                 {"largest_difference", compared.largest}}}};
  std::vector<std::string> findings;
  for (const std::string& name : uses(step)) {
    const Object& object = bench.objects->at(name);
    const OwnSamples own = own_samples(*bench.objects, object);
    const std::vector<voxel::Window> giving = giving_of(*bench.objects, object, frame);
    const bool is_other = std::any_of(giving.begin(), giving.end(), [&](const voxel::Window& given) {
      return !is_one_grey(given.grey, frame.grey);
    });
    if (is_other)
      findings.push_back("the samples of '" + name + "' come from " +
                         (own ? "'" + own.scan->scan + "'" : std::string("another scan")) +
                         " and are combined with those of '" + step.scan.name +
                         "' unchanged: their units and scanners may differ");
  }
  if (result.filled_samples > 0)
    findings.push_back(std::to_string(result.filled_samples) +
                       " samples lie in objects that come from no scan" +
                       without_samples(step, *bench.objects, frame) + " and have the value " +
                       plain(result.filled) + ": these places were not scanned");
  if (result.hole_samples == frame.scene().lattice.sample_count())
    findings.push_back("no sample of the scan lies in '" + step.expression +
                       "', so all samples would have the value of holes: correct the expression");
  else if (compared.compared == 0)
    findings.emplace_back(
        "no sample could be checked by an independent computation, so nothing confirms this scan");
  if (compared.differing > 0)
    findings.push_back(
        std::to_string(compared.differing) + " of " + std::to_string(compared.compared) +
        " checked samples differ from an independent computation, in the scan's unit by up to " +
        std::to_string(compared.largest) + ": do not rely on this scan, and please report it");
  if (step.hole_value && result.hole_samples > 0)
    findings.push_back(std::to_string(result.hole_samples) +
                       " samples outside of all objects have the value " + plain(*step.hole_value) +
                       ", as requested: these places were not scanned");
  return {std::move(result.scene), std::move(details), std::nullopt, std::move(findings)};
}

}  // namespace

Operation scan_of_operation() {
  return Describe<ScanOf>("scan_of",
                          "Makes a scan of an expression of objects, such as the operated head. Each sample "
                          "comes from the object at its place and moves with it.",
                          Makes::Scan)
      .takes(field("scan", &ScanOf::scan,
                   "The scan that determines the lattice, unit and patient of the new scan.")
                 .required())
      .takes(field("expression", &ScanOf::expression,
                   "Names of objects with & | - ^ ~ and parentheses. Where two objects overlap, the sample "
                   "of the one named first is used.")
                 .required())
      .takes(field("hole_value", &ScanOf::hole_value,
                   "Sample at places outside of all objects, which count as not scanned. Default: the scan's "
                   "padding, or a value below all its samples."))
      .takes(field("filled_value", &ScanOf::filled_value,
                   "Sample in objects that come from no scan, such as a plate. Default: 3071 for a scan in "
                   "HU, else the scan's largest sample."))
      .example(R"({"id": "operated", "do": "scan_of", "scan": "ct", "expression": "advanced | rest"})")
      .check(check)
      .scan(made)
      .uses(uses);
}

}  // namespace octotomy::planner

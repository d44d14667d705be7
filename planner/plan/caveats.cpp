// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/caveats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "voxel/space/rounded.h"

namespace octotomy::planner {
namespace {

/// Warnings about parts of an object that lie in gaps between images of its scans. If there are none,
/// warnings that an object from which it was made has such parts.
std::vector<std::string> interpolated_parts(const MadeOf& from, const Object& object) {
  if (!object.voxel.measures.extents) return {};
  const voxel::Box& box = *object.voxel.measures.extents;
  const glm::dvec3 middle_mm = 0.5 * (box.low_mm + box.high_mm);
  std::vector<std::string> parts;
  for (const std::string& name : scans_used(from.action)) {
    double length_mm = 0.0;
    std::size_t count = 0;
    for (const voxel::Hole& hole : from.scan(name).scene().holes) {
      const double reach_mm = glm::dot(0.5 * (box.high_mm - box.low_mm), glm::abs(hole.normal));
      const double height_mm = glm::dot(middle_mm, hole.normal);
      if (height_mm - reach_mm >= hole.high_mm || height_mm + reach_mm <= hole.low_mm) continue;
      ++count;
      length_mm = std::max(length_mm, hole.length_mm());
    }
    if (count > 0)
      parts.push_back("interpolated over " + std::to_string(count) + (count == 1 ? " gap" : " gaps") +
                      " between the images of '" + name + "', up to " +
                      plain(std::round(10.0 * length_mm) / 10.0) +
                      " mm: both kernels read the same interpolated samples there");
  }
  for (const std::string& name : objects_used(from.action))
    if (parts.empty() && from.objects.at(name).is_interpolated && !object.is_tool)
      parts.push_back("made of '" + name + "', a part of which is interpolated between images");
  return parts;
}

/// The audit's finding that samples were not finite numbers, in this scan or in the scan from which it was
/// made. Null if there is none.
const voxel::Finding* unmeasured_finding(const std::vector<voxel::Finding>& audit) {
  const auto found = std::find_if(audit.begin(), audit.end(), [](const voxel::Finding& finding) {
    return finding.check == "finite" && finding.verdict != voxel::Verdict::Pass;
  });
  return found == audit.end() ? nullptr : &*found;
}

/// Whether a sample was not measured. Readers replace samples that are not finite by padding, but a scan that
/// a caller made in memory may contain them.
bool is_unmeasured(const voxel::Scene& scene, double sample) {
  return !std::isfinite(sample) || (scene.padding && sample == *scene.padding);
}

std::uint64_t unmeasured_samples(const voxel::Scene& scene) {
  return std::visit(
      [&](const auto& samples) {
        return static_cast<std::uint64_t>(std::count_if(samples.begin(), samples.end(), [&](auto sample) {
          return is_unmeasured(scene, static_cast<double>(sample));
        }));
      },
      scene.samples);
}

/// The number of unmeasured samples within the object's box that have samples of a window on both sides along
/// an axis.
std::uint64_t enclosed_samples(const voxel::Scene& scene, const Shown& window, const Object& object) {
  if (!object.voxel.measures.extents) return 0;
  const glm::ivec3 dims = scene.lattice.dims;
  const voxel::Box& box = *object.voxel.measures.extents;
  // The object's mesh extends beyond its voxels by less than a sample.
  const double beyond_mm = glm::length(scene.lattice.spacing_mm());
  const auto is_within = [&](std::size_t at) {
    const auto row = static_cast<std::size_t>(dims.x), slice = row * static_cast<std::size_t>(dims.y);
    const glm::dvec3 p_mm(window.moved_from_still *
                          glm::dvec4(scene.lattice.lps_mm({at % row, at % slice / row, at / slice}), 1.0));
    return glm::all(glm::greaterThan(p_mm, box.low_mm - beyond_mm)) &&
           glm::all(glm::lessThan(p_mm, box.high_mm + beyond_mm));
  };
  const std::array<std::size_t, 3> strides{
      1, static_cast<std::size_t>(dims.x),
      static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y)};
  std::vector<bool> enclosed(scene.lattice.sample_count(), false);
  std::uint64_t count = 0;
  std::visit(
      [&](const auto& samples) {
        const auto follow_row = [&](std::size_t first, std::size_t stride, int length) {
          bool began_inside = false;
          std::size_t run = 0;
          for (int i = 0; i < length; ++i) {
            const auto at = first + static_cast<std::size_t>(i) * stride;
            const auto value = static_cast<double>(samples[at]);
            if (is_unmeasured(scene, value)) {
              ++run;
              continue;
            }
            const bool is_inside = value >= window.threshold && value <= window.high;
            if (began_inside && is_inside)
              for (std::size_t k = 1; k <= run; ++k)
                if (!enclosed[at - k * stride] && is_within(at - k * stride)) {
                  enclosed[at - k * stride] = true;
                  ++count;
                }
            began_inside = is_inside;
            run = 0;
          }
        };
        for (int axis = 0; axis < 3; ++axis) {
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          for (int j = 0; j < dims[v]; ++j)
            for (int i = 0; i < dims[u]; ++i)
              follow_row(static_cast<std::size_t>(i) * strides[static_cast<std::size_t>(u)] +
                             static_cast<std::size_t>(j) * strides[static_cast<std::size_t>(v)],
                         strides[static_cast<std::size_t>(axis)], dims[axis]);
        }
      },
      scene.samples);
  return count;
}

/// Whether a scan was made by 'scan_of', or from such a scan. Its padding may be holes that a motion left
/// behind, where the plan states no tissue, so no measured tissue is missing.
bool is_operated(const std::vector<ScanRecord>& records, std::string name) {
  for (;;) {
    const auto record = std::find_if(records.begin(), records.end(),
                                     [&](const ScanRecord& scan) { return scan.name == name; });
    if (record == records.end() || record->made_by.empty()) return false;
    if (record->details.contains("hole_samples")) return true;
    name = record->made_by.substr(record->made_by.rfind(' ') + 1);
  }
}

/// Share of an object's volume. Enclosed padding with a larger share makes the object's numbers wrong. A
/// smaller share may be dark samples of an MR whose value happens to be that of the padding, 0.
constexpr double most_missing_share = 0.005;

void add_unmeasured(const MadeOf& from, Object& made) {
  for (const std::string& name : scans_used(from.action)) {
    const auto record = std::find_if(from.records.begin(), from.records.end(),
                                     [&](const ScanRecord& scan) { return scan.name == name; });
    const voxel::Scene& scene = from.scan(name).scene();
    const bool has_nonfinite = !scene.padding && std::holds_alternative<voxel::FloatSamples>(scene.samples);
    const bool are_nonfinite =
        has_nonfinite ||
        unmeasured_finding(record == from.records.end() ? scene.audit : record->audit) != nullptr;
    if (!are_nonfinite && !scene.padding) continue;
    const std::uint64_t count = unmeasured_samples(scene);
    if (count == 0 && (has_nonfinite || !are_nonfinite)) continue;
    std::uint64_t enclosed = 0;
    for (const Shown& window : made.bound.windows)
      if (window.scan == name) enclosed = std::max(enclosed, enclosed_samples(scene, window, made));
    // Scanners surround the measured region by padding, so only padding that an object encloses is a caveat.
    if (!are_nonfinite && enclosed == 0) continue;
    const bool left_by_motion = !are_nonfinite && is_operated(from.records, name);
    std::string reason = (count == 0 ? "Some" : std::to_string(count)) + " samples of '" + name + "' are " +
                         (are_nonfinite    ? "no finite numbers"
                          : left_by_motion ? "holes that no object fills"
                                           : "padding") +
                         ", and both kernels leave out the object there";
    if (enclosed > 0)
      reason += ": " + std::to_string(enclosed) + " of them lie between samples of this object, where " +
                three_figures(static_cast<double>(enclosed) * scene.lattice.voxel_mm3()) +
                (left_by_motion ? " mm3 are empty" : " mm3 of it are missing");
    reason += left_by_motion ? "; a 'hole_value' of the step 'scan_of' fills them"
                             : "; measure them again, or leave their slices out";
    made.findings.push_back(reason);
    const double missing_mm3 = static_cast<double>(enclosed) * scene.lattice.voxel_mm3();
    const bool is_hole = enclosed > 0 && !left_by_motion &&
                         (are_nonfinite || missing_mm3 > most_missing_share * made.voxel.measures.volume_mm3);
    made.caveats.push_back({is_hole ? voxel::Verdict::Fail : voxel::Verdict::Warn, std::move(reason), false,
                            false,
                            are_nonfinite || left_by_motion ? std::nullopt : std::optional(missing_mm3)});
  }
}

/// An upper bound in mm³ of the tissue that is missing in an object because of padding, over all windows from
/// which it was made. None if the samples of a window are not stored.
std::optional<double> missing_mm3(const Object& object) {
  double missing = 0.0;
  for (const Shown& window : object.bound.windows) {
    if (!window.samples) return {};
    missing += static_cast<double>(enclosed_samples(*window.samples, window, object)) *
               window.samples->lattice.voxel_mm3();
  }
  return missing;
}

void add_inherited(const MadeOf& from, Object& made) {
  std::optional<std::optional<double>> own_missing_mm3;  // computed only if a caveat needs it
  for (const std::string& name : objects_used(from.action)) {
    const Object& operand = from.objects.at(name);
    for (const Caveat& caveat : operand.caveats) {
      // A motion moves the whole object, including its part outside of the universe. If that part was cut off
      // permanently, the caveat remains.
      if (caveat.is_of_place && made.image && !operand.ends_with_universe) continue;
      const std::string reason =
          caveat.is_inherited ? caveat.reason : "made of '" + name + "': " + caveat.reason;
      const bool is_known = std::any_of(made.caveats.begin(), made.caveats.end(),
                                        [&](const Caveat& known) { return known.reason == reason; });
      if (is_known || (made.is_interpolated && operand.is_interpolated)) continue;
      std::optional<double> missing = caveat.missing_mm3;
      if (missing) {
        // An object that is a part of its operand may lie beside the padding that the operand encloses.
        if (!own_missing_mm3) own_missing_mm3 = missing_mm3(made);
        missing = std::min(*missing, own_missing_mm3->value_or(*missing));
      }
      made.caveats.push_back({voxel::Verdict::Warn, reason, true, false, missing});
    }
  }
}

std::string outside_text(double outside_mm3, double whole_mm3, const voxel::Box& universe_mm) {
  return three_figures(outside_mm3) + " mm3 of the object, " +
         three_figures(100.0 * outside_mm3 / whole_mm3) + " %, lie outside of the universe (" +
         plain(universe_mm) + ") and are left out of every number: move less, or use a scan with more room";
}

/// Does what add_part_outside() does for a moved object that has no mesh: reports the volume of the voxels
/// that the motion lost.
void add_voxels_outside(const Objects& objects, Object& made) {
  if (made.bound.spacing_mm == glm::dvec3(0.0) || made.is_tool || made.mesh.whole) return;
  if (!made.image || made.image->is_whole) return;
  const Object& still = still_of(objects, made);
  const double lost_mm3 = outside_mm3(still.voxel.octree, made.image->image_from_object);
  if (!(lost_mm3 > 0.0)) return;
  const double factor = std::abs(glm::determinant(glm::dmat3(made.image->image_from_object)));
  std::string text = outside_text(lost_mm3, factor * still.voxel.measures.volume_mm3,
                                  voxel::bounds(made.voxel.octree.universe().lattice()));
  made.findings.push_back(text);
  made.caveats.push_back({voxel::Verdict::Fail, std::move(text), false, true});
}

/// Adds the finding that a scan's border cuts the object off. Later objects are cut off at the same place, so
/// only the first one has the finding.
void add_border_finding(const MadeOf& from, Object& made) {
  if (made.is_tool) return;
  made.border_finding = made.image ? still_of(from.objects, made).border_finding : border_finding_of(made);
  if (made.border_finding && !scans_used(from.action).empty()) made.findings.push_back(*made.border_finding);
}

/// Whether an object is finite. A complement and a mask without an end extend beyond the universe.
bool ends_by_itself(const Object& object) {
  constexpr double endless_mm = 1e12;
  const voxel::Box& reach = object.witness.lines().box_mm;
  return !object.witness.lines() ||
         (glm::length(reach.low_mm) < endless_mm && glm::length(reach.high_mm) < endless_mm);
}

}  // namespace

void add_caveats(const MadeOf& from, Object& made) {
  const std::vector<std::string> interpolated = interpolated_parts(from, made);
  made.is_interpolated = !interpolated.empty();
  made.findings.insert(made.findings.end(), interpolated.begin(), interpolated.end());
  // Both kernels read the same interpolated samples, so errors in these do not show as a disagreement.
  for (const std::string& part : interpolated) made.caveats.push_back({voxel::Verdict::Warn, part, false});
  add_unmeasured(from, made);
  add_border_finding(from, made);
  add_voxels_outside(from.objects, made);
  add_inherited(from, made);
}

void keep_unmeasured(const Action& action, const std::vector<ScanRecord>& records, ScanRecord& made) {
  for (const std::string& name : scans_used(action))
    for (const ScanRecord& record : records) {
      const voxel::Finding* finding = record.name == name ? unmeasured_finding(record.audit) : nullptr;
      if (finding != nullptr && unmeasured_finding(made.audit) == nullptr) made.audit.push_back(*finding);
    }
}

void add_kept_parts(std::vector<verify::OpenPart> kept, const std::vector<verify::OpenPart>& open,
                    Object& made) {
  constexpr double little = 0.05;
  std::erase_if(kept, [&](const verify::OpenPart& part) {
    return std::any_of(open.begin(), open.end(), [&](const verify::OpenPart& other) {
      return std::find(other.part_mm.begin(), other.part_mm.end(), part.part_mm.front()) !=
             other.part_mm.end();
    });
  });
  if (kept.empty()) return;
  std::stable_sort(kept.begin(), kept.end(), [](const verify::OpenPart& a, const verify::OpenPart& b) {
    return a.bridge.volume_mm3 > b.bridge.volume_mm3;
  });
  double all_mm3 = 0.0;
  Json list = Json::array();
  for (const verify::OpenPart& part : kept) {
    all_mm3 += part.bridge.volume_mm3;
    list.push_back({{"at_mm", to_json(part.bridge.at_mm)}, {"volume_mm3", part.bridge.volume_mm3}});
  }
  made.mesh.details["kept_bridges"] = std::move(list);
  const std::string text =
      std::to_string(kept.size()) + (kept.size() == 1 ? " part of " : " parts with a total of ") +
      voxel::rounded(all_mm3) + " mm\u00b3 " +
      (kept.size() == 1 ? "is connected by a neck" : "are connected by necks") + " thinner than " +
      verify::thin_neck + ", the largest near " + voxel::rounded(kept.front().bridge.at_mm) +
      ": both kernels keep the parts that only one of them connects; "
      "'keep_bridges_mm' and 'cut_bridges_mm' of the step decide on such parts";
  made.findings.push_back(text);
  made.shared_values.push_back(
      made.kind + ": the choice of parts beyond thin necks, which stay if one kernel connects them");
  const double whole_mm3 = static_cast<double>(made.voxel.octree.voxel_count()) *
                           made.voxel.octree.universe().lattice().voxel_mm3();
  if (all_mm3 > little * whole_mm3) made.caveats.push_back({voxel::Verdict::Warn, text});
}

void add_part_outside(const voxel::Box& universe_mm, Object& made) {
  // A mask that consists of regions has no end and normally leaves the universe. An imported mesh does not.
  if (made.is_tool || (made.bound.spacing_mm == glm::dvec3(0.0) && !ends_by_itself(made))) return;
  made.findings.push_back(
      "a part lies outside of the universe (" + plain(universe_mm) +
      ") and is left out of every number and picture: move less, or use a scan with more room");
  const double whole_mm3 = made.mesh.whole->measures().volume_mm3;
  const double lost_mm3 = whole_mm3 - (made.mesh.within ? made.mesh.within->measures().volume_mm3 : 0.0);
  constexpr double rounding = 1e-9;  // share of the volume that rounding may cut off at the universe's border
  if (!ends_by_itself(made) || !(lost_mm3 > rounding * std::abs(whole_mm3))) return;
  made.caveats.push_back({voxel::Verdict::Fail, outside_text(lost_mm3, whole_mm3, universe_mm), false, true});
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/digitised.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "planner/operation/measure/recommended.h"
#include "planner/operation/table/deformation.h"
#include "planner/operation/table/number_format.h"
#include "voxel/measure/flat_parts.h"

namespace octotomy::planner {
namespace {

constexpr const char* smaller_voxels = "choose smaller voxels by 'voxel_mm' of the universe";

}  // namespace

Digitised digitised_of(const AnswerBench& bench) {
  Digitised digitised{bench.universe.lattice().spacing_mm()};
  for (const ScanRecord& scan : bench.scans)
    digitised.sample_mm = glm::max(digitised.sample_mm, scan.lattice.spacing_mm());
  return digitised;
}

Digitised digitised_of(const AnswerBench& bench, const Object& object) {
  Digitised digitised = digitised_of(bench);
  digitised.flat_mm2 = voxel::flat_parts_mm2(object.voxel.octree);
  std::set<std::tuple<std::string, double, double>> known;
  for (const Shown& window : object.bound.windows) {
    const double stretch = stretch_of(window.moved_from_still);
    if (!known.emplace(window.scan, window.threshold, stretch).second) continue;
    // The surface of the whole window is used, because the surface of a part is a piece of it.
    const std::optional<double> shift_mm =
        window.samples ? window_shift_mm(*window.samples, window.threshold, window.high)
                       : window_shift_mm(voxel::window_of(window.grey, window.threshold));
    if (shift_mm) digitised.shift_mm = std::max(digitised.shift_mm.value_or(0.0), stretch * *shift_mm);
  }
  return digitised;
}

std::optional<SeenSize> seen_size_of(const Object& object) {
  if (!object.mesh.within) return std::nullopt;
  const brep::Size& size = object.mesh.within->size();
  return SeenSize{"mesh", size.volume_mm3, size.area_mm2};
}

std::string why_no_voxels(const Object& object) {
  if (!object.mesh.within || object.mesh.within->empty()) return "'" + object.id + "' is empty";
  return "'" + object.id + "' has no voxels of " +
         plain(object.voxel.octree.universe().lattice().spacing_mm().x) + " mm, but its mesh encloses " +
         grouped(object.mesh.within->size().volume_mm3, 1) + " mm\u00b3 (" + smaller_voxels + ")";
}

std::optional<std::string> too_coarse_finding(const Object& object, const HalfWidth& width) {
  if (!width.is_too_coarse) return std::nullopt;
  const double seen_mm3 = object.mesh.within->size().volume_mm3;
  if (object.certificate && object.certificate->verdict == verify::Verdict::Fail)
    return "volume_mm3: the mesh encloses " + grouped(seen_mm3, 1) +
           " mm\u00b3, which differs by more than three half-widths: the object's certificate shows where "
           "the kernels disagree";
  return too_coarse_finding(object.voxel.octree.universe().lattice().spacing_mm(), "the mesh encloses",
                            seen_mm3, smaller_voxels);
}

}  // namespace octotomy::planner

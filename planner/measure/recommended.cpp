// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/measure/recommended.h"

#include <algorithm>
#include <cmath>

#include "voxel/measure/crofton.h"

namespace octotomy::planner {
namespace {

/// Interpolates the samples at a point of the object's frame.
std::function<double(const glm::dvec3&)> sampler_of(const voxel::GreyOctree& grey,
                                                    const glm::dmat4& moved_from_still) {
  return [&grey, voxel_from_lps = glm::inverse(grey.universe().lps_from_voxel) *
                                  glm::inverse(moved_from_still)](const glm::dvec3& p_mm) {
    const glm::dvec3 q(voxel_from_lps * glm::dvec4(p_mm, 1.0)), first = glm::floor(q), t = q - first;
    double value = 0.0;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 corner(i & 1, (i >> 1) & 1, i >> 2);
      const glm::dvec3 weights = glm::mix(1.0 - t, t, corner);
      value +=
          weights.x * weights.y * weights.z * static_cast<double>(grey.sample(glm::ivec3(first + corner)));
    }
    return value;
  };
}

verify::Interval interval(double value, const HalfWidth& width) {
  verify::Interval found{value, width.value, {}};
  for (const Doubt& doubt : width.terms)
    found.sources.push_back({doubt.name, doubt.formula, doubt.half_width});
  return found;
}

}  // namespace

Json to_json(const verify::Interval& interval, const std::string& unit) {
  Json sources = Json::array();
  for (const verify::DoubtSource& source : interval.sources)
    sources.push_back(
        {{"name", source.name}, {"formula", source.formula}, {"half_width", source.half_width}});
  return {{"value", interval.value},
          {"unit", unit},
          {"half_width", interval.half_width},
          {"coverage", verify::claimed_coverage},
          {"sources", sources}};
}

verify::SizeIntervals intervals_of_surface(const brep::Solid& solid, const SurfaceSamples& samples) {
  verify::SampledFrom from;
  from.sample_edges = glm::dmat3(samples.moved_from_still) * samples.scan_edges;
  from.window_shift_mm = samples.window_shift_mm;
  from.along_lps_mm = samples.along_lps_mm;
  if (samples.grey) {
    const glm::dvec3 voxel_mm = samples.grey->universe().lattice().spacing_mm();
    double coarsest = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      coarsest = std::max(coarsest, voxel_mm[axis] / glm::length(samples.scan_edges[axis]));
    // Voxels between samples were interpolated once before.
    const double interpolation = samples.voxels_are_samples ? 1.0 / 6.0 : (1.0 + coarsest * coarsest) / 6.0;
    from.blur_samples2 = verify::blur_of(solid, from.sample_edges,
                                         sampler_of(*samples.grey, samples.moved_from_still), interpolation);
  }
  return verify::size_intervals(solid, from);
}

verify::SizeIntervals intervals_of_count(const voxel::Measures& measures, const Digitised& digitised,
                                         const voxel::Lattice& lattice, const std::optional<SeenSize>& seen) {
  const glm::dvec3 shares = voxel::crofton13_of_flat(lattice);
  const double flat_mm2 = digitised.flat_mm2.x + digitised.flat_mm2.y + digitised.flat_mm2.z;
  const double area_mm2 = measures.area_crofton13_mm2 + glm::dot(digitised.flat_mm2, 1.0 - shares);
  const double oblique_mm2 =
      (1.0 - std::min({shares.x, shares.y, shares.z})) * std::max(area_mm2 - flat_mm2, 0.0);
  // A flat part that is half an edge off takes that from the walls around it; parts count as two squares.
  const double rims_mm2 = 4.0 * glm::dot(glm::sqrt(0.5 * digitised.flat_mm2), digitised.voxel_mm);
  HalfWidth area{std::hypot(oblique_mm2, rims_mm2),
                 {{"directions", "(1 - least share of a plane seen) (S - flats)", oblique_mm2},
                  {"flat", "h/2 * perimeter of flat parts", rims_mm2}}};
  if (seen && seen->area_mm2)
    widen_to_seen(area,
                  {seen->name, "|S - that of the " + seen->name + "|", std::abs(area_mm2 - *seen->area_mm2)});
  return {interval(measures.volume_mm3, volume_half_width(measures, digitised, seen)),
          interval(area_mm2, area),
          {}};
}

}  // namespace octotomy::planner

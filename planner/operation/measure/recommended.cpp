// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/recommended.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "planner/operation/table/number_format.h"
#include "voxel/measure/crofton.h"

namespace octotomy::planner {
namespace {

/// A function that interpolates the scan's own samples at a point in the frame of the moved object.
std::function<double(const glm::dvec3&)> sampler_of(const voxel::Scene& scan,
                                                    const glm::dmat4& moved_from_still) {
  return [&scan, still_from_moved = glm::inverse(moved_from_still)](const glm::dvec3& p_mm) {
    return voxel::interpolate(scan, scan.lattice.voxel(glm::dvec3(still_from_moved * glm::dvec4(p_mm, 1.0))));
  };
}

/// A function that interpolates the octree's samples at a point in the frame of the moved object.
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
    return value * grey.step();
  };
}

verify::SizeIntervals intervals_of_one(const brep::Solid& solid, const SurfaceSamples& samples) {
  verify::SampledFrom from;
  const glm::dmat4 lps_from_scan = samples.moved_from_still * samples.lps_from_scan;
  from.sample_edges = glm::dmat3(lps_from_scan);
  from.sample_at_mm = glm::dvec3(lps_from_scan[3]);
  from.window_shift_mm = samples.window_shift_mm;
  from.along_lps_mm = samples.along_lps_mm;
  // In a window with two bounds, samples rise and fall again, so the blur cannot be measured. The usual value
  // of 0.7 samples is assumed.
  constexpr double usual_blur2 = 0.5;
  if (samples.has_upper()) {
    from.blur_samples2 = usual_blur2;
  } else if (samples.samples) {
    from.blur_samples2 =
        verify::blur_of(solid, from.sample_edges, sampler_of(*samples.samples, samples.moved_from_still));
  } else if (samples.grey) {
    const glm::dvec3 voxel_mm = samples.grey->universe().lattice().spacing_mm();
    double coarsest = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      coarsest = std::max(coarsest, voxel_mm[axis] / glm::length(from.sample_edges[axis]));
    // Voxels that are no samples were already interpolated once, which adds blur.
    const double interpolation = samples.voxels_are_samples ? 1.0 / 6.0 : (1.0 + coarsest * coarsest) / 6.0;
    from.blur_samples2 = verify::blur_of(solid, from.sample_edges,
                                         sampler_of(*samples.grey, samples.moved_from_still), interpolation);
  }
  return verify::size_intervals(solid, from);
}

/// For each source, its share of the surface. Each of a few thousand faces is assigned to the source in whose
/// samples it is nearest to a bound of the window, if within one sample. Other faces are cuts. If all faces
/// are cuts, the shares are equal.
std::vector<double> shares_of(const brep::Solid& solid, const std::vector<SurfaceSamples>& sources) {
  constexpr std::size_t most_faces = 2000;
  std::vector<double> shares(sources.size(), 0.0);
  const brep::Triangles& triangles = solid.triangles();
  std::vector<std::function<double(const glm::dvec3&)>> samplers;
  for (const SurfaceSamples& source : sources)
    samplers.push_back(source.samples ? sampler_of(*source.samples, source.moved_from_still)
                       : source.grey  ? sampler_of(*source.grey, source.moved_from_still)
                                      : nullptr);
  const std::size_t stride = 1 + triangles.faces.size() / most_faces;
  double all = 0.0;
  for (std::size_t face = 0; face < triangles.faces.size(); face += stride) {
    const auto& [a, b, c] = triangles.faces[face];
    const glm::dvec3 &p = triangles.points_mm[a], &q = triangles.points_mm[b], &r = triangles.points_mm[c];
    const glm::dvec3 across = glm::cross(q - p, r - p), at = (p + q + r) / 3.0;
    const double size = glm::length(across);
    if (!(size > 0.0)) continue;
    double nearest = 1.0;
    std::optional<std::size_t> owner;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (!samplers[i]) continue;
      const glm::dmat3 edges = glm::dmat3(sources[i].moved_from_still * sources[i].lps_from_scan);
      const glm::dvec3 one = across / size * glm::length(glm::transpose(edges) * across) / size;
      const double slope = 0.5 * std::abs(samplers[i](at - one) - samplers[i](at + one));
      const double sample = samplers[i](at);
      const double off =
          std::min(std::abs(sample - sources[i].low), std::abs(sample - sources[i].high)) / slope;
      if (off < nearest) {
        nearest = off;
        owner = i;
      }
    }
    if (!owner) continue;
    shares[*owner] += size;
    all += size;
  }
  for (double& share : shares) share = all > 0.0 ? share / all : 1.0 / static_cast<double>(shares.size());
  return shares;
}

verify::Interval interval(double value, const HalfWidth& width) {
  verify::Interval found{value, width.value, {}};
  for (const Doubt& doubt : width.terms)
    found.sources.push_back({doubt.name, doubt.formula, doubt.half_width});
  return found;
}

}  // namespace

MeasuredInterval measured(const verify::Interval& interval, const std::string& unit) {
  MeasuredInterval made{interval.value, unit, interval.half_width, verify::claimed_coverage, {}};
  for (const verify::DoubtSource& source : interval.sources)
    made.sources.push_back({source.name, source.formula, source.half_width});
  return made;
}

verify::SizeIntervals intervals_of_surface(const brep::Solid& solid,
                                           const std::vector<SurfaceSamples>& sources) {
  if (sources.size() == 1) return intervals_of_one(solid, sources.front());
  const std::vector<double> shares = shares_of(solid, sources);
  std::vector<verify::SharedIntervals> parts;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (shares[i] > 0.0) parts.push_back({shares[i], intervals_of_one(solid, sources[i])});
  return verify::weighed(parts);
}

std::optional<double> window_shift_mm(const voxel::Scene& scan, double low, double high) {
  constexpr double most_units = 10.0;
  double units = most_units;
  if (scan.meaning != voxel::Meaning::Hounsfield) {
    const voxel::Range range = voxel::range(scan);
    units = std::min(most_units, 0.01 * (range.high - range.low));
  }
  const double area_mm2 = faces_mm2(scan, low, high) / 1.5;
  if (!(area_mm2 > 0.0)) return std::nullopt;
  const auto gained = [&](double by) { return static_cast<double>(count_in(scan, low - by, high)); };
  return 0.5 * (gained(units) - gained(-units)) * sample_mm3(scan) / area_mm2;
}

verify::SizeIntervals intervals_of_phases(const verify::TwoPhase& phases, verify::SizeIntervals by_surface) {
  if (!phases.evidence.is_ambiguous) {
    by_surface.volume_mm3 = phases.volume_mm3;
    by_surface.area_mm2 = phases.area_mm2;
    return by_surface;
  }
  verify::widen_to(phases.volume_mm3, by_surface.volume_mm3);
  verify::widen_to(phases.area_mm2, by_surface.area_mm2);
  return by_surface;
}

void add_counting(double doubt_mm3, verify::SizeIntervals& found) {
  verify::Interval &volume = found.volume_mm3, &area = found.area_mm2;
  volume.half_width = std::hypot(volume.half_width, doubt_mm3);
  volume.sources.push_back(
      {"samples", "2.8 of Gundersen and Jensen's deviation, 3 * 0.26 v sqrt(F)", doubt_mm3});
  if (!(volume.value > 0.0)) return;
  // Planes of samples that miss part of an object's volume also miss part of its surface.
  const double missed_mm2 = area.value * doubt_mm3 / volume.value;
  area.half_width += missed_mm2;
  area.sources.push_back({"samples", "S times the doubtful share of the volume", missed_mm2, true});
}

verify::SizeIntervals intervals_of_labels(const voxel::Scene& scan, double low, double high,
                                          verify::SizeIntervals by_surface) {
  const double counted_mm3 = static_cast<double>(count_in(scan, low, high)) * sample_mm3(scan);
  const double lost_mm3 = std::abs(counted_mm3 - by_surface.volume_mm3.value);
  by_surface.volume_mm3 = {counted_mm3, 0.0, {}};
  add_counting(counting_doubt_mm3(scan, low, high), by_surface);
  if (!(counted_mm3 > 0.0)) return by_surface;
  // If the triangles lose part of the counted volume, they also lose part of the surface.
  const double lost_mm2 = by_surface.area_mm2.value * lost_mm3 / counted_mm3;
  by_surface.area_mm2.half_width += lost_mm2;
  by_surface.area_mm2.sources.push_back(
      {"surface", "area times the share of the volume that triangles lose", lost_mm2, true});
  return by_surface;
}

void add_voxels(const glm::dvec3& voxel_mm, double area_mm2, verify::SizeIntervals& found) {
  const double cell_mm2 = std::pow(voxel_mm.x * voxel_mm.y * voxel_mm.z, 2.0 / 3.0);
  const double of_volume = 0.13 * cell_mm2 * std::sqrt(std::max(area_mm2, 0.0));
  const double of_area = 0.13 * std::sqrt(cell_mm2 * std::max(area_mm2, 0.0));
  const auto add = [](verify::Interval& interval, const char* formula, double half_width) {
    interval.half_width = std::hypot(interval.half_width, half_width);
    interval.sources.push_back({"voxels", formula, half_width});
  };
  add(found.volume_mm3, "0.13 v^(2/3) sqrt(S)", of_volume);
  add(found.area_mm2, "0.13 v^(1/3) sqrt(S)", of_area);
}

void add_thickness(const Thickness& thickness, double share, verify::SizeIntervals& found) {
  const auto add = [](verify::Interval& interval, const char* name, const char* formula, double half_width) {
    if (!(half_width > 0.0)) return;
    interval.half_width += half_width;
    interval.sources.push_back({name, formula, half_width, true});
  };
  add(found.volume_mm3, "thickness", "|V - V of samples twice as thick|",
      share * std::abs(thickness.volume_change_mm3));
  add(found.volume_mm3, "border", "half a sample beyond the scan's border", share * thickness.border_mm3);
  // If doubling the thickness leaves this share of the area, the true area is assumed to be larger by the
  // inverse share. Below a quarter the estimate is meaningless.
  const double kept = std::max(1.0 + thickness.area_change_share, 0.25);
  add(found.area_mm2, "thickness", "|S / S of samples twice as thick - 1| S",
      std::max(kept, 1.0 / kept) * found.area_mm2.value - found.area_mm2.value);
}

std::vector<std::string> findings_of(const verify::SizeIntervals& found, bool is_of_phases, bool has_core,
                                     const std::array<std::optional<double>, 2>& kernels_mm3,
                                     const std::array<std::optional<double>, 2>& kernels_mm2) {
  std::vector<std::string> findings;
  const double value = found.volume_mm3.value;
  const auto& [voxels_mm3, mesh_mm3] = kernels_mm3;
  const double rounding = 1e-6 * value;
  if (voxels_mm3 && mesh_mm3 &&
      (value > std::max(*voxels_mm3, *mesh_mm3) + rounding ||
       value < std::min(*voxels_mm3, *mesh_mm3) - rounding))
    findings.push_back(
        "WARN volume: the recommended " + grouped(value, 1) +
        " mm\u00b3 lies outside of both kernels' answers (voxels " + grouped(*voxels_mm3, 1) + ", mesh " +
        grouped(*mesh_mm3, 1) + " mm\u00b3): " +
        (!is_of_phases ? "labels are counted in the scan's own samples, which differ from the plan's voxels"
         : has_core ? "the threshold's surface loses parts that are thin or sharp compared with the scan's "
                      "blur, but the sum of the samples does not"
                    : "no part is thicker than the scan's blur, so the volume is the sum of the samples, "
                      "with the window's bound as the half level"));
  constexpr double far_off = 0.1;
  const double area = found.area_mm2.value;
  if (const auto& [voxels_mm2, mesh_mm2] = kernels_mm2;
      voxels_mm2 && mesh_mm2 &&
      (area > (1.0 + far_off) * std::max(*voxels_mm2, *mesh_mm2) ||
       area < (1.0 - far_off) * std::min(*voxels_mm2, *mesh_mm2)))
    findings.push_back("WARN area: the recommended " + grouped(area, 1) +
                       " mm\u00b2 differs from both kernels' answers by more than a tenth (voxels " +
                       grouped(*voxels_mm2, 1) + ", mesh " + grouped(*mesh_mm2, 1) +
                       " mm\u00b2), because it corrects for edges that the scan's blur rounds off");
  for (const auto& [name, interval] :
       {std::pair("volume", &found.volume_mm3), std::pair("area", &found.area_mm2)}) {
    if (interval->half_width <= interval->value || interval->sources.empty()) continue;
    const verify::DoubtSource& largest =
        *std::max_element(interval->sources.begin(), interval->sources.end(),
                          [](const verify::DoubtSource& a, const verify::DoubtSource& b) {
                            return a.half_width < b.half_width;
                          });
    findings.push_back(std::string("WARN ") + name + ": its interval is wider than its value (" +
                       three_figures(interval->value) + " \u00b1 " + three_figures(interval->half_width) +
                       "): the scan does not resolve this object, and the largest term is '" + largest.name +
                       "': " + largest.formula);
  }
  return findings;
}

verify::SizeIntervals intervals_of_count(const voxel::Measures& measures, const Digitised& digitised,
                                         const voxel::Lattice& lattice, const std::optional<SeenSize>& seen) {
  const glm::dvec3 shares = voxel::crofton13_of_flat(lattice);
  const double flat_mm2 = digitised.flat_mm2.x + digitised.flat_mm2.y + digitised.flat_mm2.z;
  const double area_mm2 = measures.area_crofton13_mm2 + glm::dot(digitised.flat_mm2, 1.0 - shares);
  const double oblique_mm2 =
      (1.0 - std::min({shares.x, shares.y, shares.z})) * std::max(area_mm2 - flat_mm2, 0.0);
  // If a flat part is displaced by half an edge, the walls around it grow or shrink by half an edge. The flat
  // parts are assumed to be two squares for each axis.
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

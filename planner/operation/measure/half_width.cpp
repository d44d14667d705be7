// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/half_width.h"

#include <algorithm>
#include <cmath>

#include "planner/operation/table/number_format.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

constexpr double window_units = 10.0;

/// Three standard deviations of a volume that is counted in cells of these edges. Exposed faces overestimate
/// an isotropic boundary by 3/2 along each axis, for cells of any shape.
double count_mm3(const voxel::Measures& measures, const glm::dvec3& cell_mm) {
  const double cell_mm3 = cell_mm.x * cell_mm.y * cell_mm.z;
  const double faces = glm::dot(measures.exposed_mm2, cell_mm / cell_mm3) / 1.5;
  return 3.0 * 0.26 * cell_mm3 * std::sqrt(faces);
}

/// Adds terms in quadrature.
HalfWidth sum_of(std::vector<Doubt> terms) {
  HalfWidth found;
  double squares = 0.0;
  for (const Doubt& doubt : terms) squares += doubt.half_width * doubt.half_width;
  found.value = std::sqrt(squares);
  found.terms = std::move(terms);
  return found;
}

/// 99 of 100 normally distributed errors are within this multiple of their standard deviation. A sum of a few
/// uniform errors stays within a smaller multiple.
constexpr double confidence = 2.576;

/// The spacing of the positions at which a point can be picked.
glm::dvec3 step_mm(const Digitised& digitised) {
  return glm::max(digitised.voxel_mm, digitised.sample_mm);
}

/// The variance of a picked point's position along `along`, times the square of that vector's length.
double picked_variance(const glm::dvec3& along, const glm::dvec3& step_mm) {
  const glm::dvec3 part = along * step_mm;
  return glm::dot(part, part) / 12.0;
}

}  // namespace

bool widen_to_seen(HalfWidth& width, const Doubt& off) {
  constexpr double no_chance = 3.0;
  if (off.half_width <= no_chance * width.value) return false;
  width.value = off.half_width;
  width.terms.push_back(off);
  return true;
}

HalfWidth volume_half_width(const voxel::Measures& measures, const Digitised& digitised,
                            const std::optional<SeenSize>& seen) {
  std::vector<Doubt> terms{{"voxels", "3 * 0.26 v sqrt(F)", count_mm3(measures, digitised.voxel_mm)}};
  if (digitised.sample_mm != glm::dvec3(0.0))
    terms.push_back(
        {"samples", "3 * 0.26 v sqrt(F) of the scan's samples", count_mm3(measures, digitised.sample_mm)});
  // Errors of the flat parts of one solid may have the same sign, so they are added linearly.
  if (digitised.flat_mm2 != glm::dvec3(0.0))
    terms.push_back({"flat", "h/2 * area of flat parts along the lattice",
                     glm::dot(digitised.flat_mm2, 0.5 * digitised.voxel_mm)});
  if (digitised.shift_mm)
    terms.push_back(
        {"window", "area * shift for ten sample units", measures.area_crofton13_mm2 * *digitised.shift_mm});
  HalfWidth width = sum_of(std::move(terms));
  if (!seen) return width;
  const glm::dvec3& voxel_mm = digitised.voxel_mm;
  const double off_mm3 = std::abs(seen->volume_mm3 - measures.volume_mm3);
  const bool is_wide = widen_to_seen(width, {seen->name, "|V - that of the " + seen->name + "|", off_mm3});
  width.is_too_coarse = is_wide && off_mm3 > voxel_mm.x * voxel_mm.y * voxel_mm.z;
  return width;
}

std::string too_coarse_finding(const glm::dvec3& voxel_mm, const std::string& seen, double seen_mm3,
                               const std::string& advice) {
  return "volume_mm3: voxels of " + plain(std::max({voxel_mm.x, voxel_mm.y, voxel_mm.z})) +
         " mm are too coarse to count this object: " + seen + " " + grouped(seen_mm3, 1) +
         " mm\u00b3: " + advice;
}

HalfWidth area_half_width(const SurfaceSize& surface, const Digitised& digitised) {
  const glm::dvec3 step = step_mm(digitised);
  const double longest_mm = std::max({step.x, step.y, step.z});
  std::vector<Doubt> terms{{"ripple", "0.03 S", 0.03 * surface.area_mm2},
                           {"edges", "0.3 s M", 0.3 * longest_mm * surface.curvature_mm}};
  if (digitised.shift_mm)
    terms.push_back({"window", "2 M * shift for ten sample units",
                     2.0 * surface.curvature_mm * std::abs(*digitised.shift_mm)});
  return sum_of(std::move(terms));
}

HalfWidth distance_half_width(const std::array<glm::dvec3, 2>& points_mm, const Digitised& digitised) {
  const glm::dvec3 between = points_mm[1] - points_mm[0];
  const double length = glm::length(between);
  // If the points coincide, every direction is possible.
  const glm::dvec3 along = length > 0.0 ? between / length : glm::dvec3(1.0);
  return sum_of({{"places", "2.58 sqrt(2 sum of (u s)^2 / 12)",
                  confidence * std::sqrt(2.0 * picked_variance(along, step_mm(digitised)))}});
}

HalfWidth angle_half_width(const std::array<glm::dvec3, 3>& points_mm, const Digitised& digitised) {
  const glm::dvec3 first = points_mm[0] - points_mm[1], last = points_mm[2] - points_mm[1];
  const double first_mm = glm::length(first), last_mm = glm::length(last);
  const double cosine = std::clamp(glm::dot(first, last) / (first_mm * last_mm), -1.0, 1.0);
  // The gradient of the angle with respect to an end is perpendicular to the end's leg, and has one over the
  // leg's length as size. With respect to the vertex the gradient is minus the sum of the other two.
  const auto across = [&](const glm::dvec3& leg, double leg_mm, const glm::dvec3& other, double other_mm) {
    const glm::dvec3 side = leg / leg_mm * cosine - other / other_mm;
    const double size = glm::length(side);
    // If the legs are collinear, every perpendicular direction is possible, and the one nearest to the
    // coarsest step is used.
    const glm::dvec3 step = step_mm(digitised);
    const double longest = std::max({step.x, step.y, step.z});
    return size > 1e-9 ? side / (size * leg_mm) : glm::dvec3(longest) / (step * leg_mm * std::sqrt(3.0));
  };
  const glm::dvec3 by_first = across(first, first_mm, last, last_mm),
                   by_last = across(last, last_mm, first, first_mm);
  const glm::dvec3 step = step_mm(digitised);
  const double variance = picked_variance(by_first, step) + picked_variance(by_last, step) +
                          picked_variance(by_first + by_last, step);
  return sum_of(
      {{"places", "2.58 sqrt(sum of (gradient s)^2 / 12)", glm::degrees(confidence * std::sqrt(variance))}});
}

HalfWidth gap_half_width(const glm::dvec3& direction, const Digitised& object, const Digitised& other) {
  const double length = glm::length(direction);
  const glm::dvec3 along = length > 0.0 ? glm::abs(direction / length) : glm::dvec3(std::sqrt(1.0 / 3.0));
  std::vector<Doubt> terms{
      {"voxels", "sum of |u| h", glm::dot(along, 0.5 * (object.voxel_mm + other.voxel_mm))}};
  const glm::dvec3 unseen =
      glm::max(glm::max(object.sample_mm, other.sample_mm) - object.voxel_mm, glm::dvec3(0.0));
  if (unseen != glm::dvec3(0.0)) terms.push_back({"samples", "sum of |u| (s - h)", glm::dot(along, unseen)});
  for (const Digitised* side : {&object, &other})
    if (side->shift_mm) terms.push_back({"window", "shift for ten sample units", std::abs(*side->shift_mm)});
  return sum_of(std::move(terms));
}

std::optional<double> window_shift_mm(const voxel::Window& window) {
  const voxel::Universe& universe = window.grey.universe();
  const auto count = [&](double low) {
    voxel::Window moved = window;
    moved.low = std::min(low, moved.high);
    return static_cast<double>(voxel::combine(universe, moved).voxel_count());
  };
  const double area_mm2 = voxel::measure(voxel::combine(universe, window)).area_crofton13_mm2;
  if (!(area_mm2 > 0.0)) return std::nullopt;
  const double steps = window_units / window.grey.step();
  const double voxels = 0.5 * (count(window.low - steps) - count(window.low + steps));
  return voxels * universe.lattice().voxel_mm3() / area_mm2;
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 The points give a first motion. Whether it is a reflection shows at the teeth's roots: the scan and the object
//   must lie on the same side of the points' plane.
// 2 The crowns of the scan, from their tips to a depth, are divided into patches by a grid. A hash of the grid's
//   cells holds back a quarter of them.
// 3 The other patches are fitted to the object's surface near the points.
// 4 The distances of the held patches from that surface are measured. Patches much farther off than the others,
//   where streaks or fillings hide the teeth, are left out. The remaining ones bound the error.
//
// The bound. Let e be the error of the scan at a point and c the error of the object's surface there, both
// along the normal. A held patch shows d = e - c. The fit has not used the patch, so e and c are independent
// there, except for an offset that is equal all over the object's surface. The fit follows this offset, which
// is at most a share of the samples' spacing. In squares, rms(e) is at most rms(d) plus the offset, and at
// least rms(d) less the largest rms(c); both bounds are widened because the patches are few. The error along
// the surface is not measured. In each of the two directions it is assumed to be between zero and the error
// along the normal, so the upper bound counts three times.
#include "brep/align/tooth_scan.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "brep/align/register_landmarks.h"
#include "brep/mesh/error.h"
#include "brep/mesh/move.h"
#include "brep/mesh/oriented_surface.h"
#include "brep/mesh/sample_surface.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

constexpr double on_surface_mm = 3.0;  ///< largest distance of a given point from its surface: points are
                                       ///< placed by hand
constexpr double beside_mm = 15.0;     ///< only the object's surface within this distance of the points is
                                       ///< used
constexpr double patch_mm = 4.0;       ///< about half a tooth
constexpr std::uint32_t held_one_in = 4;
constexpr std::size_t least_held = 8;
constexpr double sample_every_mm = 0.4;
/// Smallest accepted share of the held patches' samples that match the object's surface. Right scans of the
/// head phantom's teeth reach 0.8, those of the other jaw less than 0.4.
constexpr double least_matched = 0.55;
/// Shares of the samples' spacing. The first is the largest error that the object's surface has on all teeth
/// alike, the second the largest root mean square of its error. Isosurfaces of partial volumes stay within
/// both; see the bound above.
constexpr double common_share = 0.05, own_share = 0.25;
constexpr double deviations_99 = 2.58;

/// Surfaces within this distance of each other match. The scan's points and the object's samples do not
/// resolve smaller distances.
double match_mm(const ToothScanOptions& options) {
  return std::max(0.3, 0.5 * options.sample_mm);
}

bool is_beside(const glm::dvec3& p_mm, const std::vector<glm::dvec3>& points_mm) {
  return std::any_of(points_mm.begin(), points_mm.end(),
                     [&](const glm::dvec3& q_mm) { return glm::distance(p_mm, q_mm) < beside_mm; });
}

glm::dvec3 through(const glm::dmat4& motion, const glm::dvec3& p_mm) {
  return glm::dvec3(motion * glm::dvec4(p_mm, 1.0));
}

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::Geometry, why);
}

/// The triangles at whose middle `keeps` returns true, and only the points of these.
template <typename Keeps>
Triangles part_where(const Triangles& whole, const Keeps& keeps) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(whole.points_mm.size(), none);
  Triangles part;
  for (const auto& face : whole.faces) {
    const glm::dvec3 middle_mm =
        (whole.points_mm[face[0]] + whole.points_mm[face[1]] + whole.points_mm[face[2]]) / 3.0;
    if (!keeps(middle_mm)) continue;
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& n = number[face[k]];
      if (n == none) {
        n = static_cast<std::uint32_t>(part.points_mm.size());
        part.points_mm.push_back(whole.points_mm[face[k]]);
      }
      corners[k] = n;
    }
    part.faces.push_back(corners);
  }
  return part;
}

double area_mm2(const Triangles& surface) {
  double area = 0.0;
  for (const auto& [a, b, c] : surface.faces)
    area += 0.5 * glm::length(glm::cross(surface.points_mm[b] - surface.points_mm[a],
                                         surface.points_mm[c] - surface.points_mm[a]));
  return area;
}

/// Refuses a scan that is too small or too large to be of teeth, and names the unit in which it would fit.
void need_size(const Triangles& scan, const ToothScanOptions& options) {
  if (scan.faces.empty()) refuse(options.scan + " has no triangles: export it again");
  constexpr double least_mm = 8.0, most_mm = 250.0;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const glm::dvec3& p : scan.points_mm) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 edges = high - low;
  const double longest_mm = std::max({edges.x, edges.y, edges.z});
  if (longest_mm >= least_mm && longest_mm <= most_mm) return;
  std::string fits;
  for (const auto& [unit, mm] : {std::pair("um", 0.001), {"cm", 10.0}, {"m", 1000.0}, {"inch", 25.4}})
    if (longest_mm * mm >= 2.0 * least_mm && longest_mm * mm <= 0.5 * most_mm)
      fits += (fits.empty() ? "" : " or ") + std::string(unit);
  refuse(options.scan + " is " + short_text(longest_mm) + " mm long, which fits no row of teeth: " +
         (fits.empty() ? "give a scan of teeth, and its unit" : "its unit is probably " + fits));
}

void need_near(const std::vector<glm::dvec3>& points_mm, const SurfaceTree& tree, const std::string& which,
               const std::string& surface) {
  const std::vector<double> off_mm = tree.distances_mm(points_mm);
  for (std::size_t i = 0; i < off_mm.size(); ++i)
    if (off_mm[i] > on_surface_mm)
      refuse("point " + std::to_string(i + 1) + " of " + which + " lies " + short_text(off_mm[i]) +
             " mm off " + surface + ": give points on the biting surfaces of its teeth");
}

std::vector<Landmark> named(const std::vector<glm::dvec3>& points_mm, bool is_mirrored = false) {
  std::vector<Landmark> marks;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    const glm::dvec3& p = points_mm[i];
    marks.push_back({std::to_string(i + 1), is_mirrored ? glm::dvec3(-p.x, p.y, p.z) : p});
  }
  return marks;
}

constexpr const char* mirrored_words =
    " fits only mirrored: left and right are exchanged, by the order of the points or the frame of the file";

/// Fits the points alone.
LandmarkFit by_points(const ToothPoints& points, const ToothScanOptions& options) {
  if (points.fixed_mm.size() != points.scan_mm.size())
    refuse(std::to_string(points.fixed_mm.size()) + " points of " + options.fixed + " and " +
           std::to_string(points.scan_mm.size()) + " of " + options.scan +
           " are given: give the same places on both, in the same order");
  if (points.fixed_mm.size() < 3)
    refuse("the points are too few: give three or more places on the teeth of " + options.fixed +
           ", and the same on " + options.scan);
  const std::vector<Landmark> fixed = named(points.fixed_mm);
  LandmarkFit fit = register_landmarks(named(points.scan_mm), fixed);
  if (fit.rms_mm <= on_surface_mm) return fit;
  const double mirrored_mm = register_landmarks(named(points.scan_mm, true), fixed).rms_mm;
  if (mirrored_mm <= 0.5 * fit.rms_mm && mirrored_mm <= on_surface_mm) refuse(options.scan + mirrored_words);
  const auto worst = std::max_element(fit.residuals_mm.begin(), fit.residuals_mm.end());
  refuse("the points of " + options.scan + " lie " + short_text(fit.rms_mm) + " mm off those of " +
         options.fixed + ", most of all point " + std::to_string(worst - fit.residuals_mm.begin() + 1) +
         ": give the same places on both, in the same order");
}

/// The unit normal of the plane of least squares, which does not depend on the order of the points. Precondition:
/// they do not lie on one line.
glm::dvec3 normal_of(const std::vector<glm::dvec3>& points_mm) {
  const glm::dvec3 middle_mm = std::accumulate(points_mm.begin(), points_mm.end(), glm::dvec3(0.0)) /
                               static_cast<double>(points_mm.size());
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const glm::dvec3& p : points_mm) {
    const Eigen::Vector3d arm(p.x - middle_mm.x, p.y - middle_mm.y, p.z - middle_mm.z);
    squares += arm * arm.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares);  // its eigenvalues ascend
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  return glm::normalize(glm::dvec3(normal.x(), normal.y(), normal.z()));
}

/// Distances of a surface's samples from the fixed surface.
struct Distances {
  std::vector<glm::dvec3> at_mm;
  std::vector<double> mm;
  std::size_t samples = 0;  ///< number of samples, also those without a counterpart
};

/// A sample has a counterpart if the foot lies within the fixed surface and both normals agree to 60 degrees.
Distances distances_of(const Triangles& surface, const glm::dmat4& motion, const OrientedSurface& fixed) {
  const SurfaceSamples samples = sample_surface(moved(surface, motion), sample_every_mm);
  const std::vector<SignedFoot> feet = fixed.feet(samples.points_mm);
  Distances found;
  found.samples = feet.size();
  for (std::size_t i = 0; i < feet.size(); ++i) {
    if (feet[i].on_border || glm::dot(feet[i].normal, samples.normals[i]) < 0.5) continue;
    found.at_mm.push_back(samples.points_mm[i]);
    found.mm.push_back(feet[i].distance_mm);
  }
  return found;
}

using Cell = std::tuple<long, long, long>;
Cell cell_of(const glm::dvec3& p_mm) {
  const glm::dvec3 cell = glm::floor(p_mm / patch_mm);
  return {static_cast<long>(cell.x), static_cast<long>(cell.y), static_cast<long>(cell.z)};
}
bool is_held(const Cell& cell) {
  const auto part = [](long n) { return static_cast<std::uint64_t>(n); };
  std::uint64_t h = part(std::get<0>(cell)) * 0x9E3779B97F4A7C15U ^
                    part(std::get<1>(cell)) * 0xC2B2AE3D27D4EB4FU ^
                    part(std::get<2>(cell)) * 0x165667B19E3779F9U;
  h ^= h >> 29;
  h *= 0xBF58476D1CE4E5B9U;
  h ^= h >> 32;
  return h % held_one_in == 0;
}

double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The crowns, divided into the patches to fit and the patches held back.
struct Patches {
  Triangles fitted;
  std::map<Cell, Triangles> held;
  std::size_t fitted_count = 0;
};

Patches patches_of(const Triangles& crowns) {
  Patches patches;
  std::map<Cell, std::size_t> cells;
  for (const auto& [a, b, c] : crowns.faces)
    ++cells[cell_of((crowns.points_mm[a] + crowns.points_mm[b] + crowns.points_mm[c]) / 3.0)];
  patches.fitted = part_where(crowns, [](const glm::dvec3& p) { return !is_held(cell_of(p)); });
  for (const auto& [cell, count] : cells)
    if (is_held(cell))
      patches.held[cell] =
          part_where(crowns, [&, of = cell](const glm::dvec3& p) { return cell_of(p) == of; });
    else
      ++patches.fitted_count;
  return patches;
}

/// A patch with fewer samples is only a scrap at the border of the crowns.
constexpr std::size_t least_samples = 12;

/// Fits the crowns and measures the held patches.
void fit_patches(const Triangles& crowns, const OrientedSurface& fixed, const Mesh& near,
                 const glm::dmat4& start, const ToothScanOptions& options, LaidToothScan& laid) {
  const Patches patches = patches_of(crowns);
  SurfaceFitOptions fit;
  fit.start = start;
  fit.samples = options.samples;
  fit.stop = options.progress.stop;
  fit.progress = options.progress.report;
  laid.fit = register_surfaces(mesh_of(patches.fitted), near, fit);
  laid.fixed_from_scan = laid.fit.fixed_from_moving;
  laid.fitted_patches = patches.fitted_count;
  laid.held.clear();
  std::size_t samples = 0, matched = 0;
  const double near_mm = match_mm(options);
  for (const auto& [cell, patch] : patches.held) {
    const Distances distances = distances_of(patch, laid.fixed_from_scan, fixed);
    samples += distances.samples;
    for (const double mm : distances.mm) matched += std::abs(mm) <= near_mm ? 1 : 0;
    if (distances.mm.size() < least_samples) continue;
    HeldPatch held;
    const auto n = static_cast<double>(distances.mm.size());
    for (std::size_t i = 0; i < distances.mm.size(); ++i) {
      held.at_mm += distances.at_mm[i] / n;
      held.mean_mm += distances.mm[i] / n;
      held.mean_mm2 += distances.mm[i] * distances.mm[i] / n;
    }
    laid.held.push_back(held);
  }
  laid.matched_share = samples == 0 ? 0.0 : static_cast<double>(matched) / static_cast<double>(samples);
}

bool matches(const LaidToothScan& laid) {
  return laid.matched_share >= least_matched;
}

/// The crowns of a laid surface: its part near the points, down to the depth of the options.
Triangles crowns_of(const Triangles& surface, const glm::dmat4& motion, const ToothPoints& points,
                    const LaidToothScan& laid, const ToothScanOptions& options) {
  Triangles crowns = part_where(surface, [&](const glm::dvec3& p) {
    const glm::dvec3 q = through(motion, p);
    return laid.depth_mm(q) < options.depth_mm && is_beside(q, points.fixed_mm);
  });
  // About the area of three crowns.
  constexpr double least_mm2 = 150.0;
  if (const double mm2 = area_mm2(crowns); mm2 < least_mm2)
    refuse("only " + short_text(mm2) + " mm² of " + options.scan + " lie within " +
           short_text(options.depth_mm) + " mm of the tips of the teeth of " + options.fixed +
           ": give points on the biting surfaces of three teeth or more");
  return crowns;
}

/// The surface laid by a motion and reflected in the plane of the points.
Triangles reflected(Triangles surface, const glm::dmat4& motion, const LaidToothScan& laid) {
  for (glm::dvec3& p : surface.points_mm) {
    p = through(motion, p);
    p -= 2.0 * laid.depth_mm(p) * laid.to_roots;
  }
  for (auto& [a, b, c] : surface.faces) std::swap(b, c);
  return surface;
}

/// Sets the plane of the tips and its normal. The roots are on the side where the object lies at the points.
void find_roots(const Solid& fixed, const ToothPoints& points, const ToothScanOptions& options,
                LaidToothScan& laid) {
  constexpr double step_mm = 1.5;
  laid.to_roots = normal_of(points.fixed_mm);
  int votes = 0;
  for (const glm::dvec3& p : points.fixed_mm)
    votes += static_cast<int>(fixed.tree().is_inside(p + step_mm * laid.to_roots)) -
             static_cast<int>(fixed.tree().is_inside(p - step_mm * laid.to_roots));
  if (2 * std::abs(votes) < static_cast<int>(points.fixed_mm.size()))
    refuse("the points are not on teeth of " + options.fixed +
           ": at most of them, both sides of their plane are inside it, or neither is; give points on the "
           "biting surfaces of its teeth");
  if (votes < 0) laid.to_roots = -laid.to_roots;
  for (const glm::dvec3& p : points.fixed_mm)
    laid.tips_mm += glm::dot(p, laid.to_roots) / static_cast<double>(points.fixed_mm.size());
}

/// Whether the roots of the scan, laid by the points, lie on the same side as the object's.
bool is_upright(const Triangles& surface, const glm::dmat4& motion, const ToothPoints& points,
                const LaidToothScan& laid) {
  double depths = 0.0;
  for (const auto& [a, b, c] : surface.faces) {
    const glm::dvec3 p = through(motion, surface.points_mm[a]), q = through(motion, surface.points_mm[b]),
                     r = through(motion, surface.points_mm[c]), middle = (p + q + r) / 3.0;
    if (is_beside(middle, points.fixed_mm))
      depths += glm::length(glm::cross(q - p, r - p)) * laid.depth_mm(middle);
  }
  return depths >= 0.0;
}

/// Leaves out patches too far from the fixed surface, and bounds the error by the others.
void bound_error(const ToothScanOptions& options, LaidToothScan& laid) {
  constexpr double far = 4.0;  // times the middle patch
  std::vector<double> squares;
  for (const HeldPatch& patch : laid.held) squares.push_back(patch.mean_mm2);
  // A patch whose distance is below the samples' resolution is never far.
  const double resolved_mm = 0.1 * options.sample_mm;
  const double most_mm2 =
      squares.empty() ? 0.0 : std::max(far * far * middle_of(squares), resolved_mm * resolved_mm);
  squares.clear();
  for (HeldPatch& patch : laid.held) {
    patch.is_left_out = patch.mean_mm2 > most_mm2;
    if (!patch.is_left_out) squares.push_back(patch.mean_mm2);
  }
  if (squares.size() < least_held)
    refuse("only " + std::to_string(squares.size()) + " patches of " + options.scan +
           " are left to check the fit, and " + std::to_string(least_held) +
           " are needed: give a scan of more teeth, or points further apart");
  const auto n = static_cast<double>(squares.size());
  const double mean_mm2 = std::accumulate(squares.begin(), squares.end(), 0.0) / n;
  double spread = 0.0;
  for (const double square : squares) spread += (square - mean_mm2) * (square - mean_mm2) / (n - 1.0);
  const double chance_mm2 = deviations_99 * std::sqrt(spread / n);
  laid.distance_mm = std::sqrt(mean_mm2);
  const double common_mm = common_share * options.sample_mm, own_mm = own_share * options.sample_mm;
  const double most = std::sqrt(3.0 * (mean_mm2 + chance_mm2 + common_mm * common_mm));
  const double least = std::sqrt(std::max(mean_mm2 - chance_mm2 - own_mm * own_mm, 0.0));
  laid.error_mm = 0.5 * (most + least);
  laid.half_width_mm = 0.5 * (most - least);
}

}  // namespace

LaidToothScan lay_tooth_scan(const Mesh& scan, const Solid& fixed, const ToothPoints& points,
                             const ToothScanOptions& options) {
  const Triangles surface = triangles_of(scan);
  need_size(surface, options);
  need_near(points.scan_mm, SurfaceTree(surface), "the scan", options.scan);
  need_near(points.fixed_mm, fixed.tree(), "the object", options.fixed);
  const LandmarkFit start = by_points(points, options);
  LaidToothScan laid;
  laid.points_rms_mm = start.rms_mm;
  find_roots(fixed, points, options, laid);
  const Mesh near = mesh_of(
      part_where(fixed.triangles(), [&](const glm::dvec3& p) { return is_beside(p, points.fixed_mm); }));
  const OrientedSurface near_surface(near);
  if (!is_upright(surface, start.fixed_from_moving, points, laid)) {
    const Triangles mirror = reflected(surface, start.fixed_from_moving, laid);
    const glm::dmat4 as_it_is(1.0);
    LaidToothScan mirrored = laid;
    fit_patches(crowns_of(mirror, as_it_is, points, laid, options), near_surface, near, as_it_is, options,
                mirrored);
    if (matches(mirrored)) refuse(options.scan + mirrored_words);
    refuse("the roots of " + options.scan + " point away from those of " + options.fixed +
           ": the scan shows the other jaw, or left and right are exchanged in the order of the points");
  }
  fit_patches(crowns_of(surface, start.fixed_from_moving, points, laid, options), near_surface, near,
              start.fixed_from_moving, options, laid);
  if (!matches(laid))
    refuse("only " + short_text(100.0 * laid.matched_share) + " % of the crowns of " + options.scan +
           " lie within " + short_text(match_mm(options)) + " mm of the teeth of " + options.fixed +
           ": the scan shows the other jaw or another patient, or its points mark other places");
  bound_error(options, laid);
  return laid;
}

}  // namespace octotomy::brep

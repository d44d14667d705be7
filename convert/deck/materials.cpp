// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/materials.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <tbb/parallel_for.h>

#include "brep/mesh/distance.h"
#include "convert/deck/scan_sampler.h"
#include "convert/tet/element_faces.h"
#include "voxel/space/error.h"

namespace octotomy::convert {
namespace {

/// The largest number of points along an edge of an element.
constexpr int most_points_an_edge = 9;

/// Sample points of an element, equally weighted: barycentric coordinates (i + 1/4) / n that sum to 1, with n
/// points on each edge, about two for each voxel along the longest edge. Corners are in the scan's voxel
/// indices.
std::vector<glm::dvec3> points_over(const std::array<glm::dvec3, 4>& v) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) longest = std::max(longest, glm::distance(v[i], v[j]));
  const int n = std::clamp(static_cast<int>(std::ceil(2.0 * longest)), 1, most_points_an_edge);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j)
      for (int k = 0; i + j + k < n; ++k) {
        const int l = n - 1 - i - j - k;
        points.push_back(((i + 0.25) * v[0] + (j + 0.25) * v[1] + (k + 0.25) * v[2] + (l + 0.25) * v[3]) /
                         static_cast<double>(n));
      }
  return points;
}

/// Moves points to a depth below the surface of the elements.
class Depth {
 public:
  Depth(const Tetrahedra& tetrahedra, double depth_mm)
      : surface_(surface_of(tetrahedra)), tree_(surface_), depth_mm_(depth_mm) {}

  /// Moves each point that is nearer to the surface than the depth: away from its nearest surface point, to
  /// the depth. Returns false if no point was nearer.
  bool sink(std::vector<glm::dvec3>& points_mm) const {
    // A point within this share of the depth from the surface moves along the surface's normal.
    constexpr double too_near = 1e-6;
    bool any = false;
    const std::vector<brep::Foot> feet = tree_.feet(points_mm);
    for (std::size_t i = 0; i < feet.size(); ++i) {
      if (feet[i].distance_mm >= (1.0 - too_near) * depth_mm_) continue;
      any = true;
      const glm::dvec3 way = feet[i].distance_mm > too_near * depth_mm_
                                 ? (points_mm[i] - feet[i].p_mm) / feet[i].distance_mm
                                 : -normal(feet[i].face);
      points_mm[i] = feet[i].p_mm + depth_mm_ * way;
    }
    return any;
  }

 private:
  /// Outward, of unit length; zero for a triangle without area.
  glm::dvec3 normal(std::uint32_t face) const {
    const auto& [a, b, c] = surface_.faces[face];
    const auto& p = surface_.points_mm;
    const glm::dvec3 outward = glm::cross(p[b] - p[a], p[c] - p[a]);
    const double length = glm::length(outward);
    return length > 0.0 ? outward / length : glm::dvec3(0.0);
  }

  brep::Triangles surface_;
  brep::SurfaceTree tree_;
  double depth_mm_;
};

/// The mean over an element; none if no point of the element is in the scan.
std::optional<double> mean_over(const std::array<glm::dvec3, 4>& corners_mm, const ScanSampler& scan,
                                const std::optional<Depth>& depth) {
  std::array<glm::dvec3, 4> v;
  for (std::size_t i = 0; i < 4; ++i) v[i] = scan.voxel(corners_mm[i]);
  const std::vector<glm::dvec3> points = points_over(v);
  std::vector<double> below;  // by point: the largest of its values at the depth
  if (depth) {
    below.assign(points.size(), -std::numeric_limits<double>::infinity());
    std::vector<glm::dvec3> sunk_mm;
    sunk_mm.reserve(points.size());
    for (const glm::dvec3& p : points) sunk_mm.push_back(scan.lps_mm(p));
    // Near an edge or corner, a point moved away from one face may be near another face.
    constexpr int rounds = 3;
    for (int round = 0; round < rounds && depth->sink(sunk_mm); ++round)
      for (std::size_t i = 0; i < points.size(); ++i)
        below[i] = std::max(below[i], scan.at(scan.voxel(sunk_mm[i])));
  }
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!scan.holds(points[i])) continue;
    const double own = scan.at(points[i]);
    sum += depth ? std::max(own, below[i]) : own;
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

void check(const Tetrahedra& tetrahedra, const MaterialOptions& options) {
  if (tetrahedra.tets.empty()) throw std::invalid_argument("materials: there are no tetrahedra");
  if (options.bins < 1 || options.bins > 1000)
    throw voxel::InvalidInput("materials: bins must be 1 to 1000, not " + std::to_string(options.bins));
  if (!(options.least_mpa > 0.0) || !std::isfinite(options.least_mpa))
    throw voxel::InvalidInput("materials: the least Young's modulus must be positive");
  if (options.calibration && (!std::isfinite(options.calibration->slope_g_cm3_per_hu) ||
                              !std::isfinite(options.calibration->intercept_g_cm3) ||
                              options.calibration->slope_g_cm3_per_hu <= 0.0))
    throw voxel::InvalidInput("materials: a calibration's slope must be positive");
  if (!(options.surface_depth_mm >= 0.0) || !std::isfinite(options.surface_depth_mm))
    throw voxel::InvalidInput("materials: the depth below the surface must be 0 or more");
}

/// Groups elements into bins of equal ratio of Young's modulus, which resolve soft elements as well as stiff
/// ones. Empty bins are left out.
void gather(const MaterialOptions& options, ElementMaterials& result) {
  const auto ends = std::minmax_element(result.youngs_modulus_mpa.begin(), result.youngs_modulus_mpa.end());
  const double low = *ends.first;
  assert(low > 0.0);  // at least least_mpa
  const double width = std::log(*ends.second / low) / options.bins;
  struct Bin {
    double sum = 0.0;
    std::size_t count = 0;
  };
  std::map<int, Bin> bins;
  const auto bin_of = [&](double e) {
    return width > 0.0 ? std::min(static_cast<int>(std::log(e / low) / width), options.bins - 1) : 0;
  };
  for (const double e : result.youngs_modulus_mpa) {
    Bin& bin = bins[bin_of(e)];
    bin.sum += e;
    ++bin.count;
  }
  std::map<int, std::uint32_t> number;
  for (const auto& [bin, content] : bins) {
    number[bin] = static_cast<std::uint32_t>(result.materials.size());
    result.materials.push_back({"BONE" + std::to_string(result.materials.size() + 1),
                                content.sum / static_cast<double>(content.count), options.poisson_ratio});
  }
  for (const double e : result.youngs_modulus_mpa) {
    result.material_of_tet.push_back(number.at(bin_of(e)));
    const double ratio = result.materials[result.material_of_tet.back()].youngs_modulus_mpa / e;
    result.worst_ratio = std::max({result.worst_ratio, ratio, 1.0 / ratio});
  }
}

}  // namespace

const std::vector<StiffnessLaw>& stiffness_laws() {
  // Keyak's middle piece does not meet its neighbours exactly. Its numbers are those of the publication.
  static const std::vector<StiffnessLaw> laws = {
      {"morgan2003-femoral-neck",
       "Morgan, Bayraktar, Keaveny, J. Biomech. 36, 2003: E = 6850 rho_app^1.49",
       DensityKind::Apparent,
       {{0.0, 0.0, 6850.0, 1.49}}},
      {"morgan2003-pooled",
       "Morgan, Bayraktar, Keaveny, J. Biomech. 36, 2003: E = 8920 rho_app^1.83",
       DensityKind::Apparent,
       {{0.0, 0.0, 8920.0, 1.83}}},
      {"carter-hayes1977",
       "Carter, Hayes, J. Bone Joint Surg. 59-A, 1977: E = 3790 strain_rate^0.06 rho_app^3, at 0.01 / s",
       DensityKind::Apparent,
       {{0.0, 0.0, 3790.0 * 0.758577575, 3.0}}},
      {"keller1994",
       "Keller, J. Biomech. 27, 1994: E = 10500 rho_ash^2.29",
       DensityKind::Ash,
       {{0.0, 0.0, 10500.0, 2.29}}},
      {"keyak1998",
       "Keyak et al., J. Biomech. 31, 1998: E = 33900 rho_ash^2.20 to 0.27, 5307 rho_ash + 469 to 0.6, then "
       "10200 rho_ash^2.01",
       DensityKind::Ash,
       {{0.0, 0.0, 33900.0, 2.20}, {0.27, 469.0, 5307.0, 1.0}, {0.6, 0.0, 10200.0, 2.01}}},
  };
  return laws;
}

const StiffnessLaw& stiffness_law(const std::string& name) {
  std::string known;
  for (const StiffnessLaw& law : stiffness_laws()) {
    if (law.name == name) return law;
    known += (known.empty() ? "" : ", ") + law.name;
  }
  throw voxel::InvalidInput("materials: no law is called '" + name + "'; there are " + known);
}

double youngs_modulus_mpa(const StiffnessLaw& law, double rho_g_cm3) {
  assert(rho_g_cm3 >= 0.0 && !law.pieces.empty());
  auto piece = law.pieces.begin();
  while (piece + 1 != law.pieces.end() && (piece + 1)->from_g_cm3 <= rho_g_cm3) ++piece;
  return piece->a_mpa + piece->b * std::pow(rho_g_cm3, piece->c);
}

ElementMaterials element_materials(const Tetrahedra& tetrahedra, const voxel::Scene& scan,
                                   const MaterialOptions& options) {
  check(tetrahedra, options);
  voxel::check(scan);
  const StiffnessLaw& law = stiffness_law(options.law);
  const DensityCalibration calibration = options.calibration.value_or(DensityCalibration{});
  const ScanSampler sampler(scan);
  ElementMaterials result;
  const std::size_t count = tetrahedra.tets.size();
  result.hu.resize(count);
  result.density_g_cm3.resize(count);
  result.youngs_modulus_mpa.resize(count);
  std::atomic<std::size_t> outside{0};
  std::vector<std::uint8_t> is_outside(count, 0);
  std::optional<Depth> depth;
  if (options.surface_depth_mm > 0.0) depth.emplace(tetrahedra, options.surface_depth_mm);
  const auto sample = [&](std::size_t t) {
    const TetCorners p_mm = corners_mm(tetrahedra, t);
    const std::optional<double> mean = mean_over(p_mm, sampler, depth);
    if (!mean) ++outside;
    is_outside[t] = mean ? 0 : 1;
    result.hu[t] = mean ? *mean : sampler.at(sampler.voxel(0.25 * (p_mm[0] + p_mm[1] + p_mm[2] + p_mm[3])));
    result.density_g_cm3[t] =
        std::max(0.0, calibration.intercept_g_cm3 + calibration.slope_g_cm3_per_hu * result.hu[t]);
    result.youngs_modulus_mpa[t] =
        std::max(options.least_mpa, youngs_modulus_mpa(law, result.density_g_cm3[t]));
  };
  constexpr std::size_t at_once = 16384;  // elements: some tens of milliseconds
  for (std::size_t first = 0; first < count; first += at_once) {
    options.progress.at(static_cast<double>(first) / static_cast<double>(count));
    tbb::parallel_for(first, std::min(first + at_once, count), sample);
  }
  if (!options.calibration)
    result.findings.push_back(
        "NOT CALIBRATED: densities assume 0.0008 g/cm3 a HU, which no phantom confirms for this scanner. "
        "Stiffness may be wrong by a factor of two: give the calibration of the scan");
  for (std::uint32_t t = 0; t < count; ++t)
    if (is_outside[t]) result.outside.push_back(t);
  if (outside > 0)
    result.findings.push_back(std::to_string(outside) +
                              " elements lie outside the scan and have the nearest sample's stiffness");
  const auto least = static_cast<std::size_t>(
      std::count(result.youngs_modulus_mpa.begin(), result.youngs_modulus_mpa.end(), options.least_mpa));
  if (least > 0)
    result.findings.push_back(std::to_string(least) + " elements have the least Young's modulus allowed");
  gather(options, result);
  return result;
}

}  // namespace octotomy::convert

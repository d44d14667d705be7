// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "voxel/measure/measure.h"
#include "voxel/solid/expression.h"

namespace octotomy::planner {

/// One source of a number's uncertainty, with the formula of its half-width.
struct Doubt {
  std::string name;
  std::string formula;
  double half_width = 0.0;
};

/// The half-width of an interval around a number. As far as its terms are counts or picked positions, the
/// interval contains the true value in 99 of 100 cases. The term of an uncertain window bound is the change
/// of the number if the bound changes. Terms are independent, so their squares are added.
struct HalfWidth {
  double value = 0.0;
  std::vector<Doubt> terms;
  /// The voxels lose parts of the object by more than chance; the half-width is then the last term alone.
  bool is_too_coarse = false;
};

/// The size of an object by an estimator that includes parts that whole voxels lose.
struct SeenSize {
  std::string name;  ///< name of the estimator, such as "isosurface"
  double volume_mm3 = 0.0;
  std::optional<double> area_mm2 = {};
};
/// Voxels lose parts of an object that are thinner than a voxel. If the counted number differs from the other
/// estimate by more than three half-widths, chance does not explain it. Then the difference, `off`, becomes
/// the half-width and its last term. Returns whether this happened.
bool widen_to_seen(HalfWidth& width, const Doubt& off);

/// The resolution at which a solid was digitised, with its uncertainties.
struct Digitised {
  glm::dvec3 voxel_mm{1.0};
  glm::dvec3 sample_mm{0.0};  ///< spacing of the scan's samples; zero if the solid does not come from a scan
  /// Shift of the boundary for a change of ten sample units in its window's lower bound; none if it has no
  /// window.
  std::optional<double> shift_mm = {};
  glm::dvec3 flat_mm2{0.0};  ///< as voxel::flat_parts_mm2()
};

/// Half-width in mm3 of a counted volume. Its terms are: 3 * 0.26 v sqrt(F), where v is a voxel's volume and
/// F the boundary's area in voxel faces (Kendall 1948; verify/certificate/boundary_model.h), once for the
/// voxels and once for the scan's samples, because slices may be far apart; half a voxel's edge times the
/// area of flat parts along the lattice, because their errors have the same sign; and the boundary's area
/// times its shift for ten sample units. widen_to_seen() may widen it.
HalfWidth volume_half_width(const voxel::Measures& measures, const Digitised& digitised,
                            const std::optional<SeenSize>& seen = {});

/// The finding on a volume that is_too_coarse: "volume_mm3: voxels of 1 mm are too coarse to count this
/// object: SEEN 320.0 mm3: ADVICE", with `seen` and `advice`.
std::string too_coarse_finding(const glm::dvec3& voxel_mm, const std::string& seen, double seen_mm3,
                               const std::string& advice);

/// Half-width in mm2 of the area of an isosurface. Its terms are the ripple of marching cubes and the error
/// of crossings on voxels' edges (verify/certificate/certificate.cpp), and twice the integral of mean
/// curvature times the window's shift.
struct SurfaceSize {
  double area_mm2 = 0.0;
  double curvature_mm = 0.0;  ///< integral of the absolute mean curvature over the surface
};
HalfWidth area_half_width(const SurfaceSize& surface, const Digitised& digitised);

/// Half-width in mm of the distance between two points. Along each axis, each point has a uniform error of up
/// to half a step of the samples, or of the voxels if these are coarser.
HalfWidth distance_half_width(const std::array<glm::dvec3, 2>& points_mm, const Digitised& digitised);

/// Half-width in degrees of the angle at the second of three points with such errors. Precondition: the
/// second point equals neither of the others.
HalfWidth angle_half_width(const std::array<glm::dvec3, 3>& points_mm, const Digitised& digitised);

/// Half-width in mm of the least distance of two surfaces, for a distance along `direction`. Its terms are:
/// for each surface, half a voxel's width along the direction; one sample spacing if samples are coarser than
/// voxels, because a smaller gap is invisible; and the shift of each window.
HalfWidth gap_half_width(const glm::dvec3& direction, const Digitised& object, const Digitised& other);

/// The shift of a window's boundary for ten sample units of its lower bound: half the change of the volume
/// between ten units below and ten units above, divided by the area. None if the window is empty. Cost: two
/// windows.
std::optional<double> window_shift_mm(const voxel::Window& window);

}  // namespace octotomy::planner

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

/// One source of doubt about a number, with its formula.
struct Doubt {
  std::string name;
  std::string formula;
  double half_width = 0.0;
};

/// The half-width of an interval around a number. It contains the true value with 99 % confidence as far as
/// terms are counts or picked positions; for an uncertain bound of a window the term is the number's change.
/// The terms are independent and added by squares.
struct HalfWidth {
  double value = 0.0;
  std::vector<Doubt> terms;
  /// Voxels miss parts of the object by more than chance; the half-width is then the last term alone.
  bool is_too_coarse = false;
};

/// An object's size by an estimator that includes parts missed by whole voxels.
struct SeenSize {
  std::string name;  ///< name of the estimator, such as "isosurface"
  double volume_mm3 = 0.0;
  std::optional<double> area_mm2 = {};
};
/// Voxels miss parts thinner than themselves. If the counted number differs from the other estimate by more than
/// three half-widths (of three standard deviations each), this is not chance: the difference, `off`, then becomes the
/// half-width and its last term. Returns whether the half-width was widened.
bool widen_to_seen(HalfWidth& width, const Doubt& off);

/// The resolution at which a solid was digitised, and its uncertainties.
struct Digitised {
  glm::dvec3 voxel_mm{1.0};
  glm::dvec3 sample_mm{0.0};  ///< spacing of the scan's samples; zero if it does not come from a scan
  /// The shift of the boundary for ten sample units of its window's lower bound; none if it has no window.
  std::optional<double> shift_mm = {};
  glm::dvec3 flat_mm2{0.0};  ///< as voxel::flat_parts_mm2()
};

/// Half-width of a volume that was counted. 3 * 0.26 v sqrt(F), v a voxel's volume and F the boundary's area
/// in voxel faces (Kendall 1948; verify/certificate/boundary_model.h), once for the voxels and once for the
/// scan's samples, whose slices may be far apart; half a voxel's edge times the area of flat parts along the
/// lattice, whose errors have the same sign; and the boundary's area times its shift for ten sample units.
/// Widened by widen_to_seen().
HalfWidth volume_half_width(const voxel::Measures& measures, const Digitised& digitised,
                            const std::optional<SeenSize>& seen = {});

/// The finding on a volume that is_too_coarse: "volume_mm3: voxels of 1 mm are too coarse to count this
/// object: `seen` 320.0 mm3: `advice`".
std::string too_coarse_finding(const glm::dvec3& voxel_mm, const std::string& seen, double seen_mm3,
                               const std::string& advice);

/// Half-width of the area of an isosurface, in square millimetres: the known effects of marching cubes'
/// ripple and of the crossings' positions on voxels' edges (verify/certificate/certificate.cpp), and twice
/// the integral of mean curvature times the window's shift.
struct SurfaceSize {
  double area_mm2 = 0.0;
  double curvature_mm = 0.0;  ///< integral of mean curvature without sign
};
HalfWidth area_half_width(const SurfaceSize& surface, const Digitised& digitised);

/// Half-width of the distance between two points, in millimetres, each with a uniform error of up to half a
/// step of the samples, or else of the voxels, along each axis.
HalfWidth distance_half_width(const std::array<glm::dvec3, 2>& points_mm, const Digitised& digitised);

/// Half-width of the angle at the second of three points with such errors, in degrees. Precondition: the second point
/// equals neither of the others.
HalfWidth angle_half_width(const std::array<glm::dvec3, 3>& points_mm, const Digitised& digitised);

/// Half-width of the least distance of two surfaces, in millimetres, for a distance in this direction. Its
/// terms: for each surface, half a voxel's width along the direction; one sample spacing if samples are
/// coarser than voxels, because a smaller gap is invisible; each window's shift.
HalfWidth gap_half_width(const glm::dvec3& direction, const Digitised& object, const Digitised& other);

/// The shift of a window's boundary for ten sample units of its lower bound: half the change of volume
/// between ten units below and ten above it, divided by the area. None if nothing is inside. Cost: two
/// windows.
std::optional<double> window_shift_mm(const voxel::Window& window);

}  // namespace octotomy::planner

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

/// The half of an interval about a number that holds the truth with 99 % confidence where the terms are
/// counts or places picked, and the number's change where a window's bound is uncertain; independent terms,
/// added by squares.
struct HalfWidth {
  double value = 0.0;
  std::vector<Doubt> terms;
  /// Voxels pass over parts of the object that are larger than one of them: the last term alone counts.
  bool is_too_coarse = false;
};

/// An object's size by an estimator that sees what whole voxels pass over.
struct SeenSize {
  std::string name;  ///< of the estimator, as "isosurface"
  double volume_mm3 = 0.0;
  std::optional<double> area_mm2 = {};
};
/// Voxels pass over what is thinner than they are. Where their number is off what is seen by more than three
/// half-widths, each of three standard deviations, it is no chance: that difference, `off`, is the half-width
/// then, and its last term. Returns whether it is.
bool widen_to_seen(HalfWidth& width, const Doubt& off);

/// How a solid was digitised.
struct Digitised {
  glm::dvec3 voxel_mm{1.0};
  glm::dvec3 sample_mm{0.0};  ///< spacing of the scan's samples; zero where it comes from no scan
  /// How far the boundary moves for ten sample units of its window's lower bound; none where it has none.
  std::optional<double> shift_mm = {};
  glm::dvec3 flat_mm2{0.0};  ///< as voxel::flat_parts_mm2()
};

/// Half-width of a volume that was counted. 3 * 0.26 v sqrt(F), v a voxel's volume and F the boundary's area
/// in voxel faces (Kendall 1948; verify/certificate/boundary_model.h), once for the voxels and once for the
/// scan's samples, whose slices may be far apart; half a voxel's edge times the area of flat parts along the
/// lattice, which are off all alike; and the boundary's area times its shift for ten sample units. Widened to
/// what is seen.
HalfWidth volume_half_width(const voxel::Measures& measures, const Digitised& digitised,
                            const std::optional<SeenSize>& seen = {});

/// What is told of a volume that is_too_coarse: "volume_mm3: voxels of 1 mm are too coarse to count this
/// object: `seen` 320.0 mm3: `advice`".
std::string too_coarse_finding(const glm::dvec3& voxel_mm, const std::string& seen, double seen_mm3,
                               const std::string& advice);

/// Half-width of the area of an isosurface, in square millimetres: what marching cubes' ripple and the
/// crossings' places on voxels' edges were shown to add or lose (verify/certificate/certificate.cpp), and
/// twice the integral of mean curvature times the window's shift.
struct SurfaceSize {
  double area_mm2 = 0.0;
  double curvature_mm = 0.0;  ///< integral of mean curvature without sign
};
HalfWidth area_half_width(const SurfaceSize& surface, const Digitised& digitised);

/// Half-width of the distance between two points, in millimetres, each of them one of the places that
/// samples, or else voxels, tell apart: evenly within half a step along each axis.
HalfWidth distance_half_width(const std::array<glm::dvec3, 2>& points_mm, const Digitised& digitised);

/// Half-width of the angle at the second of three such points, in degrees. Precondition: it is neither of the
/// others.
HalfWidth angle_half_width(const std::array<glm::dvec3, 3>& points_mm, const Digitised& digitised);

/// Half-width of the least distance of two surfaces, in millimetres, from its direction: each lies within
/// half a voxel's width along it; where samples are further apart than voxels, a gap of one is not seen; and
/// each window's shift.
HalfWidth gap_half_width(const glm::dvec3& direction, const Digitised& object, const Digitised& other);

/// How far the boundary of a window's object moves for ten sample units of its lower bound: half the change
/// of volume from ten below to ten above it over the area. None where nothing is inside. Cost: two windows.
std::optional<double> window_shift_mm(const voxel::Window& window);

}  // namespace octotomy::planner

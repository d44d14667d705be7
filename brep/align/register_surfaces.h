// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct SurfaceFitOptions {
  /// Where to begin, fixed from moving. None searches: the surfaces' centres and axes are laid on each other
  /// and turned through the 60 rotations of an icosahedron, which finds any turn but of little overlap.
  std::optional<glm::dmat4> start = std::nullopt;
  /// Share of the moving surface's area that has a counterpart in the fixed one, above 0 to 1. Too
  /// large a share lets what is missing pull; a smaller one is safe down to a third of the truth.
  double overlap = 0.7;
  std::size_t samples = 5000;  ///< of the moving surface, at least 100; the error falls with its root
  int max_rounds = 100;        ///< of each of the last two refinements, at least 1
  /// A round that moves the samples by no more ends a refinement, above 0. Default: a millionth of their
  /// spread. One ends too when the rms has not fallen by a 10 000th in 12 rounds: then the best motion of all
  /// rounds is taken.
  std::optional<double> rest_mm = std::nullopt;
  std::stop_token stop = {};
  std::function<void(double)> progress = {};  ///< is called with 0..1
};

/// What a fit's samples leave open of its motion: the covariance of the motion's error for errors of the
/// samples' distances that are independent and of deviation one.
struct MotionDoubt {
  glm::dvec3 centre_mm{0.0};            ///< of the samples, in the fixed surface's frame
  double spread_mm = 1.0;               ///< by which turns are scaled
  std::array<double, 36> covariance{};  ///< of turns about x, y, z times the spread, and shifts; row by row

  /// Of a point's displacement along a unit direction, both in the fixed surface's frame, without unit.
  double deviation(const glm::dvec3& p_mm, const glm::dvec3& along) const;
  /// Of the turn about a unit axis, radians a millimetre of the samples' error.
  double turn_deviation(const glm::dvec3& axis) const;
};

struct SurfaceFit {
  glm::dmat4 fixed_from_moving{1.0};  ///< rigid
  double rms_mm = 0.0;                ///< point to surface, of the samples kept
  double kept_share = 0.0;            ///< of the samples
  int rounds = 0;                     ///< of the last two refinements
  bool converged = false;             ///< it came to rest before the rounds ran out
  double last_step_mm = 0.0;          ///< by which the last round moved the samples, root mean square
  double rest_mm = 0.0;               ///< below which that counts as rest
  /// How far the worst determined motion moves the surface along itself for one unit of distance, as a share
  /// of the best determined one's: near zero where the surfaces slide, as spheres and planes do.
  double stiffness = 0.0;
  MotionDoubt doubt;
  std::vector<std::string> findings;
};

/// The rigid motion that lays the moving surface on the fixed one, both in LPS millimetres, where part of
/// either may be missing: samples whose nearest point lies on the other's border, or whose normal looks the
/// other way, have no counterpart, and of the rest the furthest are trimmed; at last all within three
/// standard deviations of those kept count. Throws std::invalid_argument where a surface has no area, an
/// option is out of its range, or the overlap keeps fewer than six samples; Stopped.
/// The same bits on any number of threads. Cost: some 70 short searches of 500 samples, then about 50 rounds
/// of `samples`: a second for heads. Source: Chen and Medioni, "Object modelling by registration of multiple
/// range images", IVC 10, 1992 (point to plane); Chetverikov et al., "Robust Euclidean alignment of 3D point
/// sets: the trimmed iterative closest point algorithm", IVC 23, 2005; Turk and Levoy 1994 (borders).
SurfaceFit register_surfaces(const Mesh& moving, const Mesh& fixed, const SurfaceFitOptions& options = {});

}  // namespace octotomy::brep

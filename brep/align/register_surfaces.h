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
  /// Start of the fit, fixed from moving. None: the surfaces' centres and axes are made to coincide and the
  /// 60 rotations of an icosahedron are tried, which finds any rotation unless the overlap is small.
  std::optional<glm::dmat4> start = std::nullopt;
  /// Share of the moving surface's area that has a counterpart in the fixed one, above 0 to 1. If it is too
  /// large, missing parts distort the fit. A smaller value is safe down to a third of the true share.
  double overlap = 0.7;
  std::size_t samples = 5000;  ///< samples of the moving surface, at least 100; the error falls with the
                               ///< square root of their number
  int max_rounds = 100;        ///< limit for each of the last two refinements, at least 1
  /// A refinement ends with a round that moves the samples by at most this length, above 0. Default: a
  /// millionth of their spread. It also ends when the rms has not fallen by a 10 000th in 12 rounds; the
  /// result is then the best motion of all rounds.
  std::optional<double> rest_mm = std::nullopt;
  std::stop_token stop = {};
  std::function<void(double)> progress = {};  ///< is called with 0..1
};

/// The uncertainty of a fit's motion: the covariance of its error if the samples' distances have independent
/// errors of standard deviation one.
struct MotionDoubt {
  glm::dvec3 centre_mm{0.0};            ///< centre of the samples, in the fixed surface's frame
  double spread_mm = 1.0;               ///< length by which rotations are multiplied in the covariance
  std::array<double, 36> covariance{};  ///< of rotations about x, y, z times the spread, then of shifts; row
                                        ///< by row

  /// Standard deviation of a point's displacement error along a unit direction, in millimetres per millimetre
  /// of the samples' error. Point and direction are in the fixed surface's frame.
  double deviation(const glm::dvec3& p_mm, const glm::dvec3& along) const;
  /// Standard deviation of the rotation error about a unit axis, in radians per millimetre of the samples'
  /// error.
  double turn_deviation(const glm::dvec3& axis) const;
};

/// Whether a fit is the true position. Doubtful: there is evidence for it, but not enough.
enum class FitVerdict { Right, Doubtful, Failed };

/// The evidence for or against a fit.
struct FitTrust {
  FitVerdict verdict = FitVerdict::Right;
  double noise_mm = 0.0;            ///< own_noise_mm() of the rougher surface
  double tolerance_mm = 0.0;        ///< surfaces within this distance match
  double matched_share = 0.0;       ///< share of the moving surface within tolerance_mm, with normals that
                                    ///< agree
  double rival_share = 0.0;         ///< the largest matched share at another motion of the search
  std::size_t starts = 0;           ///< starts of the search; 0 if a start was given
  std::size_t agreeing_starts = 0;  ///< starts that ended at this fit
  std::vector<glm::dmat4> equals;   ///< other motions that match as much: the shape is symmetric
  std::string reason;               ///< figures that led to a verdict other than Right
};

struct SurfaceFit {
  glm::dmat4 fixed_from_moving{1.0};  ///< rigid
  double rms_mm = 0.0;                ///< root mean square distance to the surface of the samples that were
                                      ///< kept
  double kept_share = 0.0;            ///< share of the samples that were kept
  int rounds = 0;                     ///< rounds of the last two refinements
  bool converged = false;             ///< the fit came to rest within max_rounds
  double last_step_mm = 0.0;          ///< root mean square displacement of the samples in the last round
  double rest_mm = 0.0;               ///< last_step_mm below this counts as rest
  /// How strongly the worst determined motion changes the distances, divided by the same for the best
  /// determined motion of equal size. Near zero if the surfaces can slide on each other, as spheres and
  /// planes can.
  double stiffness = 0.0;
  MotionDoubt doubt;
  /// Computed by register_surfaces() only. Equal answers, and a verdict that is not Right, are also in
  /// `findings`.
  std::optional<FitTrust> trust = std::nullopt;
  std::vector<std::string> findings;
};

/// The rigid motion that fits the moving surface to the fixed one, both in LPS millimetres. Parts of either
/// may be missing: samples whose nearest point lies on the other's border, or whose normal points the other
/// way, have no counterpart, and of the remaining samples the farthest are trimmed. The last refinement uses
/// all samples whose distance is within three standard deviations of the kept ones' noise. Without a start, a
/// fit whose verdict is not Right is repeated with a half and a quarter of the overlap; a finding reports if
/// such a fit is returned. Throws std::invalid_argument if a surface has no area, an option is out of its
/// range, or the overlap keeps fewer than six samples; Stopped. The same bits on any number of threads. Cost:
/// about 75 short searches of 500 samples, then about 50 rounds of `samples`: a second for heads, up to three
/// times that for a fit that is tried again. Source: Chen and Medioni, "Object modelling by registration of
/// multiple range images", IVC 10, 1992 (point to plane); Chetverikov et al., "Robust Euclidean alignment of
/// 3D point sets: the trimmed iterative closest point algorithm", IVC 23, 2005; Turk and Levoy 1994
/// (borders).
SurfaceFit register_surfaces(const Mesh& moving, const Mesh& fixed, const SurfaceFitOptions& options = {});

}  // namespace octotomy::brep

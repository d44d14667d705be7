// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"

// One number for an object's volume and one for its area, each with the interval that holds the truth in 99
// of 100 cases. The source has the derivations, phantom_suite() shows the coverage.
namespace octotomy::verify {

/// One source of doubt.
struct DoubtSource {
  std::string name;     ///< "digitisation", "window", ...
  std::string formula;  ///< its size, in symbols that the source explains
  double half_width = 0.0;
  bool is_bias = false;  ///< errs to one side, as blur does, and often by all of it
};

struct Interval {
  double value = 0.0;  ///< recommended
  double half_width = 0.0;
  std::vector<DoubtSource> sources;  ///< the biases' sum, and the root of the others' squares
};
/// The share of cases that an interval's claim holds in.
inline constexpr double claimed_coverage = 0.99;

/// How a surface was found: the isosurface of samples, since carried by motions and cut by exact planes.
struct SampledFrom {
  glm::dmat3 sample_edges{1.0};  ///< columns: the lattice's steps in LPS millimetres, after all motions
  glm::dvec3 sample_at_mm{0.0};  ///< the place of a sample, after all motions
  double blur_samples2 = 0.0;    ///< blur_of()
  /// How far the surface moves for the doubt about its window's bound; none: the bound is certain.
  std::optional<double> window_shift_mm = {};
  /// Spacing of the samples along the LPS axes; set: the curvature by such samples is wanted, too.
  std::optional<glm::dvec3> along_lps_mm = {};
};

/// Of the triangles as they are.
struct AreaAndCurvature {
  double area_mm2 = 0.0;
  double curvature_mm = 0.0;  ///< as BoundaryModel's; zero if it was not asked for
};

struct SizeIntervals {
  Interval volume_mm3, area_mm2;
  AreaAndCurvature triangles;
};
/// Of a surface that samples were interpolated for; the value is the triangles'. An edge sharper than an
/// isosurface has is a cut, which errs by nothing. Motions keep both; a part has the doubt of its own
/// surface, so that parts of one whole add up to it. Cost: n log n in edges.
SizeIntervals size_intervals(const brep::Solid& solid, const SampledFrom& from);

/// Upper bounds of what could have been missed where nothing is found: a ball two samples across.
SizeIntervals nothing_found(const glm::dvec3& sample_mm);

/// Of an object whose surface comes from several samplings, the intervals as if one had shown all of it, and
/// that one's share of the surface.
struct SharedIntervals {
  double share = 0.0;
  SizeIntervals intervals;
};
/// Values and half-widths by their shares: doubts of one piece may err to the same side as the other's.
/// Precondition: the shares' sum is one.
SizeIntervals weighed(const std::vector<SharedIntervals>& parts);

/// The variance of the scan's blur, in squared samples, from the steepness of the samples across the surface.
/// `sample_at` interpolates the samples linearly at a point in LPS millimetres; `interpolation_samples2` is
/// the variance that interpolation adds, a sixth for the scan's own lattice. Zero where the surface is empty
/// or shows no step. Cost: some thousand points.
double blur_of(const brep::Solid& solid, const glm::dmat3& sample_edges,
               const std::function<double(const glm::dvec3& p_mm)>& sample_at,
               double interpolation_samples2 = 1.0 / 6.0);

}  // namespace octotomy::verify

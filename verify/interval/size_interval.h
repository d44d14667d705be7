// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"

// One value for an object's volume and one for its area, each with an interval that holds the truth in 99 of
// 100 cases. The source has the derivations; interval_suite() measures the coverage.
namespace octotomy::verify {

/// One source of uncertainty.
struct DoubtSource {
  std::string name;     ///< "digitisation", "window", ...
  std::string formula;  ///< its size, in symbols that the source explains
  double half_width = 0.0;
  bool is_bias = false;  ///< the error is to one side, as with blur, and often as large as half_width
};

struct Interval {
  double value = 0.0;  ///< the recommended value
  /// The sum of the biases plus the root of the sum of squares of the other sources.
  double half_width = 0.0;
  std::vector<DoubtSource> sources;
};
/// The share of cases whose interval must hold the truth.
inline constexpr double claimed_coverage = 0.99;

/// The origin of a surface: an isosurface of samples that was then moved and cut by exact planes.
struct SampledFrom {
  glm::dmat3 sample_edges{1.0};  ///< columns: the lattice's steps in LPS millimetres, after all motions
  glm::dvec3 sample_at_mm{0.0};  ///< the position of a sample, LPS, after all motions
  double blur_samples2 = 0.0;    ///< blur_of()
  /// Shift of the surface within the uncertainty of its window's bound. None: the bound is certain.
  std::optional<double> window_shift_mm = {};
  /// Spacing of the samples along the LPS axes. If it is set, the curvature is computed as well.
  std::optional<glm::dvec3> along_lps_mm = {};
};

/// Measures of the triangles themselves, without correction.
struct AreaAndCurvature {
  double area_mm2 = 0.0;
  double curvature_mm = 0.0;  ///< as in BoundaryModel; zero unless along_lps_mm was set
};

struct SizeIntervals {
  Interval volume_mm3, area_mm2;
  AreaAndCurvature triangles;
};
/// The intervals of an isosurface of samples. Their values are the measures of the triangles. An edge sharper
/// than an isosurface can have is a cut, which has no error. Motions do not change value and width. The width
/// of a part is computed from the part's own surface, so the parts' widths add up to the width of the whole.
/// Cost: n log n in edges.
SizeIntervals size_intervals(const brep::Solid& solid, const SampledFrom& from);

/// The intervals of an empty object: upper bounds of a part that may have been missed, a ball two samples
/// across.
SizeIntervals nothing_found(const glm::dvec3& sample_mm);

/// For an object whose surface comes from several samplings: the intervals as if one of them had sampled the
/// whole surface, and its share of the surface.
struct SharedIntervals {
  double share = 0.0;
  SizeIntervals intervals;
};
/// The mean of values and half-widths, weighted by the shares. The half-widths are added linearly because the
/// errors may be to the same side. Precondition: the shares add up to one.
SizeIntervals weighed(const std::vector<SharedIntervals>& parts);

/// The variance of the scan's blur, in squared samples, from the steepness of the samples across the surface.
/// `sample_at` interpolates the samples linearly at a point in LPS millimetres; `interpolation_samples2` is
/// the variance that interpolation adds, a sixth for the scan's own lattice. Zero where the surface is empty
/// or shows no step. Cost: some thousand points.
double blur_of(const brep::Solid& solid, const glm::dmat3& sample_edges,
               const std::function<double(const glm::dvec3& p_mm)>& sample_at,
               double interpolation_samples2 = 1.0 / 6.0);

}  // namespace octotomy::verify

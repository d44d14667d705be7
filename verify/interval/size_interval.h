// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"

// One value for an object's volume and one for its area, each with an interval that holds the truth in 99 of
// 100 cases. size_interval.cpp has the derivations; interval_suite() measures the coverage.
namespace octotomy::verify {

/// One source of uncertainty.
struct DoubtSource {
  std::string name;     ///< "digitisation", "window", ...
  std::string formula;  ///< formula of half_width, in symbols that size_interval.cpp explains
  double half_width = 0.0;
  bool is_bias = false;  ///< the error has one sign, as that of blur, and often reaches half_width
};

struct Interval {
  double value = 0.0;  ///< the recommended value
  /// The sum of the biases, plus the root of the sum of squares of the other sources.
  double half_width = 0.0;
  std::vector<DoubtSource> sources;
};
/// The least share of cases in which an interval must hold the truth.
inline constexpr double claimed_coverage = 0.99;

/// The samples from which a surface was made: an isosurface that was then moved and cut by exact planes.
struct SampledFrom {
  glm::dmat3 sample_edges{1.0};  ///< columns: the lattice's steps in LPS millimetres, after all motions
  glm::dvec3 sample_at_mm{0.0};  ///< the position of a sample, LPS, after all motions
  double blur_samples2 = 0.0;    ///< blur_of()
  /// Shift of the surface for the uncertainty of its window's bound. None: the bound is certain.
  std::optional<double> window_shift_mm = {};
  /// Spacing of the samples along the LPS axes. If set, AreaAndCurvature::curvature_mm is computed as well.
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
/// Returns the intervals of an isosurface of samples. Their values are the measures of the triangles. An edge
/// sharper than an isosurface can have is a cut, which has no error. Motions do not change values and widths.
/// The width of a part is computed from the part's own surface, so the widths of the parts add up to the
/// width of the whole. Cost: n log n in edges.
SizeIntervals size_intervals(const brep::Solid& solid, const SampledFrom& from);

/// Returns the intervals of an empty object: value 0, and as half-width the size of a part that may have been
/// missed, a ball two samples across.
SizeIntervals nothing_found(const glm::dvec3& sample_mm);

/// The intervals of an object as if one of several samplings had sampled its whole surface, and the share of
/// the surface that comes from this sampling.
struct SharedIntervals {
  double share = 0.0;
  SizeIntervals intervals;
};
/// Returns the mean of values and half-widths, weighted by the shares. Half-widths are added linearly,
/// because the errors may have the same sign. Precondition: the shares add up to one.
SizeIntervals weighed(const std::vector<SharedIntervals>& parts);

/// Estimates the variance of the scan's blur, in squared samples, from the steepness of the samples across
/// the surface. `sample_at` interpolates the samples linearly at a point in LPS millimetres.
/// `interpolation_samples2` is the variance that interpolation adds: a sixth on the scan's own lattice. Zero
/// if the surface is empty or the samples show no step. Cost: some thousand points.
double blur_of(const brep::Solid& solid, const glm::dmat3& sample_edges,
               const std::function<double(const glm::dvec3& p_mm)>& sample_at,
               double interpolation_samples2 = 1.0 / 6.0);

}  // namespace octotomy::verify

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "brep/mesh/triangles.h"
#include "verify/witness/reading.h"
#include "verify/witness/triangle_grid.h"
#include "voxel/space/lattice.h"

// Witnesses of objects whose surface one step, such as smoothing, made from another object's surface.
namespace octotomy::verify {

/// Bound of the rounding of a point's coordinates by a few operations, such as a motion or a Boolean.
inline double rounded_mm(const glm::dvec3& p_mm) {
  return 64.0 * std::numeric_limits<double>::epsilon() * (1.0 + glm::length(p_mm));
}

/// The surface that a right answer must have.
struct ReshapedSurface {
  TriangleGrid surface;
  /// The largest distance of a right answer's surface from this surface, and of this surface from the
  /// answer's.
  double reach_mm = 0.0;
  std::string formula;  ///< formula of the reach
};
/// An answer fails beyond this multiple of the reach. All comparisons use the same multiple
/// (add_comparison()).
inline constexpr double reach_doubt = 2.0;

/// The result of a step that reshapes a surface. If `sides` is set, it reads the sides of points, and
/// `expected` serves expected_surface() only. If it is not set, a point within reach_doubt times the reach is
/// near the surface. Any other point is inside if a ray crosses the surface an odd number of times.
struct Reshaped {
  ReshapedSurface expected;
  Witness sides = {};
};

/// A witness of a reshaped object. Both kernels' sides are the same, because only the mesh kernel computes
/// such objects. `make` is called once, at the first reading or expected_surface(), from any thread.
/// Preconditions: the surface is closed; `make` does not read this witness. Cost of a reading: some triangles
/// of the surface.
Witness witness_of_reshaped(std::function<Reshaped()> make);

/// The part of an object in a box. A reshaped witness stays reshaped and keeps the surface that the step
/// made, so an object that ends at its universe's border is judged like any other. Any other witness becomes
/// both() of itself and the box.
Witness cut_by_box(const Witness& whole, const voxel::Box& box);

/// Whether a witness was made by witness_of_reshaped() or cut_by_box() from it, and is not a Boolean or a
/// motion of other witnesses.
bool is_reshaped(const Witness& witness);
/// The expected surface of a reshaped witness. It is valid as long as a copy of the witness exists.
/// Precondition: is_reshaped().
const ReshapedSurface& expected_surface(const Witness& witness);

/// Returns the right result of `smooth` for closed triangles: rounds of a step in and a step out, by code of
/// this source alone (Taubin 1995, equal weights, 1 / 0.5 + 1 / step out = pass band). The reach is the
/// rounding of the steps' sums. Cost: rounds times triangles.
ReshapedSurface surface_smoothed(const brep::Triangles& still, int rounds, double pass_band);

/// Returns the surface before decimation. The result of `decimate` must stay within the largest requested
/// error of it.
ReshapedSurface surface_decimated(const brep::Triangles& still, double max_error_mm);

}  // namespace octotomy::verify

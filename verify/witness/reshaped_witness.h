// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "brep/mesh/triangles.h"
#include "verify/witness/reading.h"
#include "verify/witness/triangle_grid.h"
#include "voxel/space/lattice.h"

// Witnesses of objects whose surface a single step, such as smoothing, derived from another object's surface.
namespace octotomy::verify {

/// Rounding of a point's coordinates by some operations on the way, such as a motion or a Boolean.
inline double rounded_mm(const glm::dvec3& p_mm) {
  return 64.0 * std::numeric_limits<double>::epsilon() * (1.0 + glm::length(p_mm));
}

/// The expected surface of a right answer.
struct ReshapedSurface {
  TriangleGrid surface;
  /// The largest distance of a right answer's surface from this one, and of this one from the answer's.
  double reach_mm = 0.0;
  std::string formula;  ///< of the reach
};
/// A kernel's answer fails beyond this multiple of the reach, as all comparisons do (add_comparison()).
inline constexpr double reach_doubt = 2.0;

/// `sides` reads a point. If it is set, `expected` only serves expected_surface(). If it is not set, a point within
/// reach_doubt times the reach is near the surface; any other point is inside if a ray crosses the surface an odd
/// number of times.
struct Reshaped {
  ReshapedSurface expected;
  Witness sides = {};
};

/// Both sides are the same, because only one kernel makes such objects. `make` is called at the first reading
/// or expected_surface(), once, from any thread. Preconditions: the surface is closed; `make` does not read
/// this witness. Cost of a reading: some triangles of the surface.
Witness witness_of_reshaped(std::function<Reshaped()> make);

/// The part of the object in a box. A reshaped witness stays reshaped and keeps the surface that the step made, so an
/// object that ends at its universe's border is judged like any other. Any other witness becomes both() with the box.
Witness cut_by_box(const Witness& whole, const voxel::Box& box);

/// Whether a witness is a reshaped one, and not a Boolean or a motion of others.
bool is_reshaped(const Witness& witness);
/// The surface of a reshaped witness. It lives as long as a copy of the witness. Precondition:
/// is_reshaped().
const ReshapedSurface& expected_surface(const Witness& witness);

/// The required result of `smooth` for closed triangles: rounds of a step in and a step out, by code of
/// this source alone (Taubin 1995, equal weights, 1 / 0.5 + 1 / step out = pass band). The reach is the
/// rounding of the steps' sums. Cost: rounds times triangles.
ReshapedSurface surface_smoothed(const brep::Triangles& still, int rounds, double pass_band);

/// The surface before decimation. The result of `decimate` must stay near it, within the largest requested
/// error.
ReshapedSurface surface_decimated(const brep::Triangles& still, double max_error_mm);

}  // namespace octotomy::verify

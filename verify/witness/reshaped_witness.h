// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "brep/mesh/triangles.h"
#include "verify/witness/reading.h"
#include "verify/witness/triangle_grid.h"
#include "voxel/space/lattice.h"

// Witnesses of objects whose surface one step made of another object's surface.
namespace octotomy::verify {

/// Rounding of a point's coordinates by some operations on the way, such as a motion or a Boolean.
inline double rounded_mm(const glm::dvec3& p_mm) {
  return 64.0 * std::numeric_limits<double>::epsilon() * (1.0 + glm::length(p_mm));
}

/// Where the surface of a right answer lies.
struct ReshapedSurface {
  TriangleGrid surface;
  /// How far a right answer's surface may lie from it, and it from the answer's, at any place.
  double reach_mm = 0.0;
  std::string formula;  ///< of the reach
};
/// A kernel's answer fails beyond this multiple of the reach, as all comparisons do (add_comparison()).
inline constexpr double reach_doubt = 2.0;

/// What a point is read by. With `sides` that witness reads it, and the surface only serves
/// expected_surface(). Without, a point is near the surface within reach_doubt times the reach; any other
/// point is inside where a ray crosses the surface an odd number of times.
struct Reshaped {
  ReshapedSurface expected;
  Witness sides = {};
};

/// Both sides are the same, because only one kernel makes such objects. `make` is called at the first reading
/// or expected_surface(), once, from any thread. Preconditions: the surface is closed; `make` does not read
/// this witness. Cost of a reading: some triangles of the surface.
Witness witness_of_reshaped(std::function<Reshaped()> make);

/// The object where it lies in a box. Such a witness stays one, with the surface that the step made, so that
/// an object that ends at its universe's border is judged as one that does not. Of any other witness it is
/// both() with the box.
Witness cut_by_box(const Witness& whole, const voxel::Box& box);

/// Whether a witness is such a one, and not a Boolean or a motion of others.
bool is_reshaped(const Witness& witness);
/// The surface of such a witness. It lives as long as a copy of the witness. Precondition: is_reshaped().
const ReshapedSurface& expected_surface(const Witness& witness);

/// What `smooth` must make of closed triangles: rounds of a step in and a step out, by code of this source
/// alone (Taubin 1995, equal weights, 1 / 0.5 + 1 / step out = pass band). The reach is the rounding of the
/// steps' sums. Cost: rounds times triangles.
ReshapedSurface surface_smoothed(const brep::Triangles& still, int rounds, double pass_band);

/// The still surface, near which `decimate` must stay: within the largest error that was asked for.
ReshapedSurface surface_decimated(const brep::Triangles& still, double max_error_mm);

}  // namespace octotomy::verify

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "brep/mesh/components.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The reason why a solid does not intersect itself. Every solid is closed and consistently wound.
enum class Proof {
  Health,        ///< health(), in exact arithmetic, has no finding
  Construction,  ///< the algorithm that made it excludes intersections; its header states why
  /// Made from solids by exact predicates, then rounded to doubles: a Boolean or a motion. Triangles thinner
  /// than the rounding may overlap their neighbours.
  Rounded,
  /// The surface is only closed and consistently wound: its points were moved individually, or whole shells
  /// were selected. Check with health().
  Connection,
};

/// The interior of a closed surface in LPS millimetres, or the empty set. An immutable value that is cheap to
/// copy: copies share one state. Its mesh, size, measures and search tree are computed at the first call and
/// cached; any number of threads may call.
class Solid {
 public:
  /// The empty set: no triangles.
  Solid();

  /// If the solid was made from triangles, the first call costs mesh_of(). Prefer triangles(), which is
  /// cheaper.
  const Mesh& mesh() const;
  /// Converts to a mesh. The reference is valid as long as a copy of this solid exists.
  operator const Mesh&() const { return mesh(); }  // NOLINT(google-explicit-constructor)
  bool empty() const;
  Proof proof() const;

  /// Numbered as in the mesh. 24 bytes per triangle, and 12 for its neighbours.
  const Triangles& triangles() const { return linked().triangles; }
  const Linked& linked() const;
  /// size_of() of the solid. Cost of the first call: linear, parallel.
  const Size& size() const;
  /// measure() of the solid. Cost of the first call: linear, parallel.
  const Measures& measures() const;
  /// Cost of the first call: n log n, about 150 bytes per triangle.
  const SurfaceTree& tree() const;
  /// components() of the solid. Cost of the first call: linear, and tree() if there are cavities.
  const std::vector<Component>& components() const;

  /// Whether both are copies of one value. False for equal solids that were made independently.
  bool is_same(const Solid& other) const { return state_ == other.state_; }

 private:
  struct State;
  explicit Solid(std::shared_ptr<const State> state) : state_(std::move(state)) {}
  friend Solid solid_of(const Triangles& triangles);
  friend Solid solid_of(const Mesh& mesh);
  friend Solid trusted_solid(Triangles triangles, Proof proof);
  friend Solid trusted_solid(const Mesh& mesh, Proof proof);
  friend Solid moved(const Solid& solid, const glm::dmat4& moved_from_still);

  std::shared_ptr<const State> state_;
};

/// The solid of triangles that health() proves to be one. Throws Error (Geometry) with the first finding,
/// which names the defect, its triangle and its position in mm; throws as health() does. Cost: that of
/// health(), about 1 s for 300k triangles.
Solid solid_of(const Triangles& triangles);
Solid solid_of(const Mesh& mesh);

/// The solid of triangles for which the caller guarantees the proof; no triangles make the empty set.
/// Preconditions: the proof holds; for Health the caller has just called health() on these triangles; with
/// Construction the volume is not negative. Throws std::invalid_argument, which names the first triangle, if
/// the surface is open; throws as mesh_of() does. Cost: linear.
Solid trusted_solid(Triangles triangles, Proof proof);
Solid trusted_solid(const Mesh& mesh, Proof proof);

/// The proof that remains for some of a solid's shells, and for its image under a motion or reflection, whose
/// points are rounded.
constexpr Proof proof_of_part(Proof whole) {
  return whole == Proof::Health ? Proof::Construction : whole;
}
constexpr Proof proof_of_image(Proof still) {
  return still == Proof::Connection ? Proof::Connection : Proof::Rounded;
}

/// The solid moved by a rigid motion, as moved() moves its points. Cost: linear.
Solid moved(const Solid& solid, const glm::dmat4& moved_from_still);

// Access to a solid's cached values, under the names of the functions that compute them for a mesh.
inline const Triangles& triangles_of(const Solid& solid) {
  return solid.triangles();
}
inline const Size& size_of(const Solid& solid) {
  return solid.size();
}
inline double volume_mm3(const Solid& solid) {
  return solid.size().volume_mm3;
}
inline const Measures& measure(const Solid& solid) {
  return solid.measures();
}
inline const std::vector<Component>& components(const Solid& solid) {
  return solid.components();
}

}  // namespace octotomy::brep

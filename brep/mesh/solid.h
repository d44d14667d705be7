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

/// What a solid's freedom from self-intersection rests on. Every solid is closed, and its triangles wind
/// alike.
enum class Proof {
  Health,        ///< health() has no finding, in exact arithmetic
  Construction,  ///< its maker lets no triangles intersect; the maker's header says why
  /// Made of solids by exact predicates, then rounded to doubles: a Boolean or a motion. Triangles thinner
  /// than the rounding may overlap their neighbours.
  Rounded,
  /// Only closed and wound alike: its points were moved one by one, or whole shells were chosen. Ask
  /// health().
  Connection,
};

/// The inside of a closed surface in LPS millimetres, or the empty set. An immutable value that is cheap to
/// copy: copies share one state. Its mesh, size, measures and search tree are computed at the first call
/// and kept, on any number of threads at once.
class Solid {
 public:
  /// The empty set: no triangles.
  Solid();

  /// First call where the solid was made of triangles: as mesh_of(). Prefer triangles(), which cost less.
  const Mesh& mesh() const;
  /// A solid serves wherever a mesh does. The reference holds as long as a copy of this solid lives.
  operator const Mesh&() const { return mesh(); }  // NOLINT(google-explicit-constructor)
  bool empty() const;
  Proof proof() const;

  /// Numbered as the mesh's. 24 bytes a triangle, and 12 for what lies beyond its sides.
  const Triangles& triangles() const { return linked().triangles; }
  const Linked& linked() const;
  /// As size_of(). First call: linear, parallel.
  const Size& size() const;
  /// As measure(). First call: linear, parallel.
  const Measures& measures() const;
  /// First call: n log n, about 150 bytes a triangle.
  const SurfaceTree& tree() const;
  /// As components(). First call: linear, and tree() where there are cavities.
  const std::vector<Component>& components() const;

  /// Whether both are copies of one value. Equal sets that were made apart are not.
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
/// which names the defect, its triangle and its place in mm; as health(). Cost: health()'s, about 1 s for
/// 300k triangles.
Solid solid_of(const Triangles& triangles);
Solid solid_of(const Mesh& mesh);

/// The solid of triangles that their maker vouches for; no triangles make the empty set. Preconditions: the
/// proof holds; for Health the caller has just called health() on these triangles; a volume by Construction
/// is not negative. Throws std::invalid_argument naming the first triangle if the surface is open; as
/// mesh_of(). Cost: linear.
Solid trusted_solid(Triangles triangles, Proof proof);
Solid trusted_solid(const Mesh& mesh, Proof proof);

/// What is left of a proof for some of a solid's shells, and for its image under a motion or reflection,
/// whose points are rounded.
constexpr Proof proof_of_part(Proof whole) {
  return whole == Proof::Health ? Proof::Construction : whole;
}
constexpr Proof proof_of_image(Proof still) {
  return still == Proof::Connection ? Proof::Connection : Proof::Rounded;
}

/// The solid under a rigid motion, as moved() of its points. Cost: linear.
Solid moved(const Solid& solid, const glm::dmat4& moved_from_still);

// What a solid keeps, by the names of what computes it for a mesh.
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

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/solid.h"

#include <cassert>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <tbb/task_arena.h>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/move.h"

namespace octotomy::brep {
namespace {

void check_closed(const Mesh& mesh) {
  for (const auto h : mesh.halfedges())
    if (mesh.is_boundary(h))
      throw std::invalid_argument("the surface is open: triangle " +
                                  std::to_string(mesh.opposite_face_handle(h).idx()) +
                                  " has no neighbour along a side; close it first");
}

void check_health(const Triangles& triangles) {
  const Health found = health(triangles);
  if (!found.solid()) throw Error(ErrorCode::Geometry, "is not a solid: " + found.findings.front());
}

/// A value that is computed when it is first asked for.
template <typename Value>
class Kept {
 public:
  template <typename Compute>
  const Value& get(const Compute& compute) {
    // Isolated: a thread that waits for its parallel loop must not take up work that waits for this value.
    std::call_once(once_, [&] { tbb::this_task_arena::isolate([&] { value_.emplace(compute()); }); });
    return *value_;
  }

 private:
  std::once_flag once_;
  std::optional<Value> value_;
};

}  // namespace

struct Solid::State {
  State(const Mesh& given, Proof by) : mesh(given), proof(by) { check(); }
  State(Triangles given, Proof by) : mesh(mesh_of(given)), proof(by) {
    check();
    // Points that fans shared have copies in the mesh.
    if (mesh.n_vertices() == given.points_mm.size()) triangles.get([&] { return std::move(given); });
  }

  const Mesh mesh;
  const Proof proof;
  mutable Kept<Triangles> triangles;
  mutable Kept<Size> size;
  mutable Kept<Measures> measures;
  mutable Kept<SurfaceTree> tree;

 private:
  void check() const {
    check_closed(mesh);
    assert(proof != Proof::Construction || volume_mm3(mesh) >= 0.0);
  }
};

Solid::Solid() {
  static const auto empty = std::make_shared<const State>(Mesh(), Proof::Construction);
  state_ = empty;
}

const Mesh& Solid::mesh() const {
  return state_->mesh;
}

Proof Solid::proof() const {
  return state_->proof;
}

const Triangles& Solid::triangles() const {
  return state_->triangles.get([&] { return triangles_of(mesh()); });
}

const Size& Solid::size() const {
  return state_->size.get([&] { return size_of(mesh()); });
}

const Measures& Solid::measures() const {
  return state_->measures.get([&] { return measure(mesh()); });
}

const SurfaceTree& Solid::tree() const {
  return state_->tree.get([&] { return SurfaceTree(triangles()); });
}

Solid solid_of(const Triangles& triangles) {
  check_health(triangles);
  return Solid(std::make_shared<const Solid::State>(triangles, Proof::Health));
}

Solid solid_of(const Mesh& mesh) {
  check_health(triangles_of(mesh));
  return Solid(std::make_shared<const Solid::State>(mesh, Proof::Health));
}

Solid trusted_solid(Triangles triangles, Proof proof) {
  assert(proof != Proof::Health);
  return Solid(std::make_shared<const Solid::State>(std::move(triangles), proof));
}

Solid trusted_solid(const Mesh& mesh, Proof proof) {
  assert(proof != Proof::Health);
  return Solid(std::make_shared<const Solid::State>(mesh, proof));
}

Solid moved(const Solid& solid, const glm::dmat4& moved_from_still) {
  return trusted_solid(moved(solid.mesh(), moved_from_still), proof_of_image(solid.proof()));
}

}  // namespace octotomy::brep

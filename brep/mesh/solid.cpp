// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/solid.h"

#include <algorithm>
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

[[noreturn]] void refuse_open(std::size_t face) {
  throw InvalidInput("the surface is open: triangle " + std::to_string(face) +
                     " has no neighbour along a side; close it first");
}

Linked closed(Linked linked) {
  const auto open = std::find(linked.opposite.begin(), linked.opposite.end(), Linked::none);
  if (open != linked.opposite.end())
    refuse_open(static_cast<std::size_t>(open - linked.opposite.begin()) / 3);
  return linked;
}

void check_closed(const Mesh& mesh) {
  for (const auto h : mesh.halfedges())
    if (mesh.is_boundary(h)) refuse_open(static_cast<std::size_t>(mesh.opposite_face_handle(h).idx()));
}

void check_health(const Triangles& triangles) {
  const Health found = health(triangles);
  if (!found.solid()) throw Error(ErrorCode::Geometry, "is not a solid: " + found.findings.front());
}

/// A value that is computed at its first use.
template <typename Value>
class Kept {
 public:
  template <typename Compute>
  const Value& get(const Compute& compute) {
    // Isolated: a thread that waits within compute() must not run other tasks, because these may wait for
    // this value.
    std::call_once(once_, [&] { tbb::this_task_arena::isolate([&] { value_.emplace(compute()); }); });
    return *value_;
  }
  /// Precondition: the value was computed.
  const Value& given() const { return *value_; }

 private:
  std::once_flag once_;
  std::optional<Value> value_;
};

}  // namespace

struct Solid::State {
  State(const Mesh& given, Proof by) : from_mesh(true), face_count(given.n_faces()), proof(by) {
    check_closed(given);
    mesh.get([&] { return given; });
    check();
  }
  State(Linked given, Proof by) : from_mesh(false), face_count(given.triangles.faces.size()), proof(by) {
    linked.get([&] { return closed(std::move(given)); });
    check();
  }

  // Either mesh or linked triangles are set at construction; the other is computed from it.
  mutable Kept<Mesh> mesh;
  mutable Kept<Linked> linked;
  const Linked& list() const {
    return linked.get([&] { return linked_of(mesh.given()); });
  }
  const bool from_mesh;
  const std::size_t face_count;
  const Proof proof;
  mutable Kept<Size> size;
  mutable Kept<Measures> measures;
  mutable Kept<SurfaceTree> tree;
  mutable Kept<std::vector<Component>> components;

 private:
  void check() const { assert(proof != Proof::Construction || size_of(list().triangles).volume_mm3 >= 0.0); }
};

Solid::Solid() {
  static const auto empty = std::make_shared<const State>(Mesh(), Proof::Construction);
  state_ = empty;
}

const Mesh& Solid::mesh() const {
  return state_->mesh.get([&] { return mesh_of(state_->list()); });
}

bool Solid::empty() const {
  return state_->face_count == 0;
}

Proof Solid::proof() const {
  return state_->proof;
}

const Linked& Solid::linked() const {
  return state_->list();
}

const Size& Solid::size() const {
  return state_->size.get([&] { return size_of(triangles()); });
}

const Measures& Solid::measures() const {
  // A given mesh has its own order of edges, which determines the rounding of sums.
  return state_->measures.get([&] { return state_->from_mesh ? measure(mesh()) : measure(linked()); });
}

const SurfaceTree& Solid::tree() const {
  return state_->tree.get([&] { return SurfaceTree(triangles()); });
}

const std::vector<Component>& Solid::components() const {
  return state_->components.get(
      [&] { return brep::components(linked(), [&]() -> const SurfaceTree& { return tree(); }); });
}

Solid solid_of(const Triangles& triangles) {
  check_health(triangles);
  return Solid(std::make_shared<const Solid::State>(linked(triangles), Proof::Health));
}

Solid solid_of(const Mesh& mesh) {
  check_health(triangles_of(mesh));
  return Solid(std::make_shared<const Solid::State>(mesh, Proof::Health));
}

Solid trusted_solid(Triangles triangles, Proof proof) {
  return Solid(std::make_shared<const Solid::State>(linked(std::move(triangles)), proof));
}

Solid trusted_solid(const Mesh& mesh, Proof proof) {
  return Solid(std::make_shared<const Solid::State>(mesh, proof));
}

Solid moved(const Solid& solid, const glm::dmat4& moved_from_still) {
  const Proof proof = proof_of_image(solid.proof());
  if (solid.state_->from_mesh) return trusted_solid(moved(solid.mesh(), moved_from_still), proof);
  return Solid(std::make_shared<const Solid::State>(
      Linked{moved(solid.triangles(), moved_from_still), solid.linked().opposite}, proof));
}

}  // namespace octotomy::brep

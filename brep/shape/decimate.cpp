// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/decimate.h"

#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"

namespace octotomy::brep {
namespace {

/// A closed mesh whose edges are collapsed. OpenMesh's own test allocates memory for each edge and takes half
/// of the time; this one has the same results on meshes without a boundary. OpenMesh tests all edges from a
/// vertex in turn and chooses the collapse of least error. A collapse whose error is too large, or not
/// smaller than that of an earlier one, is refused without a test.
class CollapsedMesh : public Mesh {
 public:
  explicit CollapsedMesh(const Mesh& mesh) : Mesh(mesh) {}

  /// Returns a collapse's error; negative if it is too large.
  std::function<float(OpenMesh::HalfedgeHandle)> error_of;

  /// The error of the collapse that was tested last.
  float error() const { return error_; }
  /// Records that this collapse is allowed.
  void found() { least_error_ = error_; }

  /// Whether the mesh stays a manifold without that edge (the link condition): its ends have no common
  /// neighbours except the tips of its two triangles. OpenMesh's decimater calls this function by name.
  bool is_collapse_ok(OpenMesh::HalfedgeHandle edge) {
    const OpenMesh::HalfedgeHandle back = opposite_halfedge_handle(edge);
    const OpenMesh::VertexHandle from = to_vertex_handle(back), to = to_vertex_handle(edge);
    if (edge == halfedge_handle(from)) least_error_ = std::numeric_limits<float>::infinity();
    const bool is_in_turn = edge == next_in_turn_;
    next_in_turn_ = cw_rotated_halfedge_handle(edge);
    if (next_in_turn_ == halfedge_handle(from)) next_in_turn_.invalidate();
    error_ = error_of(edge);
    if (is_in_turn && (error_ < 0.0F || error_ >= least_error_)) return false;
    if (status(edge_handle(edge)).deleted() || status(from).deleted() || status(to).deleted()) return false;
    assert(!is_boundary(edge) && !is_boundary(back));
    const OpenMesh::VertexHandle left = to_vertex_handle(next_halfedge_handle(edge));
    const OpenMesh::VertexHandle right = to_vertex_handle(next_halfedge_handle(back));
    if (left == right) return false;
    for_neighbours(from, [&](OpenMesh::VertexHandle vertex) { status(vertex).set_tagged(false); });
    for_neighbours(to, [&](OpenMesh::VertexHandle vertex) { status(vertex).set_tagged(true); });
    bool is_ok = true;
    for_neighbours(from, [&](OpenMesh::VertexHandle vertex) {
      if (status(vertex).tagged() && vertex != left && vertex != right) is_ok = false;
    });
    return is_ok;
  }

 private:
  template <class Visit>
  void for_neighbours(OpenMesh::VertexHandle vertex, const Visit& visit) const {
    const OpenMesh::HalfedgeHandle first = halfedge_handle(vertex);
    OpenMesh::HalfedgeHandle spoke = first;
    do {
      visit(to_vertex_handle(spoke));
      spoke = next_halfedge_handle(opposite_halfedge_handle(spoke));
    } while (spoke != first);
  }

  OpenMesh::HalfedgeHandle next_in_turn_;  // none after a vertex's last edge
  float error_ = 0.0F;
  float least_error_ = std::numeric_limits<float>::infinity();
};

using Decimater = OpenMesh::Decimater::DecimaterT<CollapsedMesh>;

/// Returns a collapse's error or refuses it. OpenMesh evaluates the other modules before the one for errors;
/// this module evaluates errors first, because they cost least.
class ErrorThenShape : public OpenMesh::Decimater::ModQuadricT<CollapsedMesh> {
 public:
  using Handle = OpenMesh::Decimater::ModHandleT<ErrorThenShape>;
  using Error = OpenMesh::Decimater::ModQuadricT<CollapsedMesh>;

  explicit ErrorThenShape(CollapsedMesh& mesh) : Error(mesh), normals_(mesh), aspect_(mesh) {
    mesh.error_of = [this, &mesh](OpenMesh::HalfedgeHandle edge) {
      return Error::collapse_priority(CollapseInfo(mesh, edge));
    };
  }

  void limit(const DecimateOptions& options) {
    set_max_err(options.max_error_mm * options.max_error_mm, false);
    normals_.set_max_normal_deviation(options.max_normal_deviation_deg);
    aspect_.set_aspect_ratio(options.max_aspect);
  }
  void initialize() override {
    Error::initialize();
    aspect_.initialize();
  }
  void preprocess_collapse(const CollapseInfo& collapse) override { aspect_.preprocess_collapse(collapse); }
  float collapse_priority(const CollapseInfo& collapse) override {
    // OpenMesh has called is_collapse_ok() for this collapse just before.
    const float error = mesh().error();
    assert(error == Error::collapse_priority(collapse));
    if (error < 0.0F || normals_.collapse_priority(collapse) < 0.0F ||
        aspect_.collapse_priority(collapse) < 0.0F)
      return ILLEGAL_COLLAPSE;
    mesh().found();
    return error;
  }

 private:
  OpenMesh::Decimater::ModNormalFlippingT<CollapsedMesh> normals_;
  OpenMesh::Decimater::ModAspectRatioT<CollapsedMesh> aspect_;
};

/// Vertices of the original mesh are locked within this multiple of the extent of a triangle that intersects
/// another. The original triangles that it replaced lie within its extent, and their neighbours within half
/// as much again.
constexpr double lock_reach() {
  return 1.5;
}

void check(const Mesh& mesh, const DecimateOptions& options) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("decimate: " + why); };
  if (!(options.max_error_mm > 0.0) || !std::isfinite(options.max_error_mm))
    refuse("the largest error must be positive");
  if (!(options.max_normal_deviation_deg > 0.0 && options.max_normal_deviation_deg <= 90.0))
    refuse("the normals' deviation must be above 0 and at most 90 degrees");
  if (!(options.max_aspect > 1.0)) refuse("the aspect ratio must be above 1");
  if (options.max_rounds < 1) refuse("there must be at least one round");
  for (const auto halfedge : mesh.halfedges())
    if (mesh.is_boundary(halfedge))
      refuse("the mesh is open at vertex " + std::to_string(mesh.to_vertex_handle(halfedge).idx()) +
             ": close its holes first");
}

Mesh round_of_collapses(const Mesh& mesh, const DecimateOptions& options, const std::vector<bool>& locked) {
  CollapsedMesh coarse(mesh);
  coarse.request_face_normals();
  coarse.update_face_normals();
  assert(locked.size() == mesh.n_vertices());
  for (const auto vertex : coarse.vertices())
    coarse.status(vertex).set_locked(locked[static_cast<std::size_t>(vertex.idx())]);

  Decimater decimater(coarse);
  ErrorThenShape::Handle collapses;
  decimater.add(collapses);
  decimater.module(collapses).limit(options);
  decimater.initialize();
  decimater.decimate_to_faces(0, options.faces.value_or(0));

  coarse.garbage_collection();
  for (const auto vertex : coarse.vertices()) coarse.status(vertex).set_locked(false);
  coarse.release_face_normals();
  return coarse;
}

/// Locks the vertices of `mesh` around a triangle of `coarse`. Returns the number of newly locked vertices.
std::size_t lock_about(const Mesh& coarse, int face, const Mesh& mesh, std::vector<bool>& locked) {
  assert(face >= 0 && static_cast<std::size_t>(face) < coarse.n_faces());
  OpenMesh::Vec3d centre(0.0, 0.0, 0.0);
  for (const auto vertex : coarse.fv_range(OpenMesh::FaceHandle(face))) centre += coarse.point(vertex) / 3.0;
  double reach = 0.0;
  for (const auto vertex : coarse.fv_range(OpenMesh::FaceHandle(face)))
    reach = std::max(reach, (coarse.point(vertex) - centre).norm());
  reach *= lock_reach();
  std::size_t count = 0;
  for (const auto vertex : mesh.vertices()) {
    const auto number = static_cast<std::size_t>(vertex.idx());
    if (locked[number] || (mesh.point(vertex) - centre).sqrnorm() > reach * reach) continue;
    locked[number] = true;
    ++count;
  }
  return count;
}

}  // namespace

Mesh decimate(const Mesh& mesh, const DecimateOptions& options) {
  check(mesh, options);
  std::vector<bool> locked(mesh.n_vertices(), false);
  std::size_t intersections = 0;
  for (int round = 0; round < options.max_rounds; ++round) {
    Mesh coarse = round_of_collapses(mesh, options, locked);
    const Health found = health(coarse);
    intersections = found.self_intersections;
    if (intersections == 0) return coarse;
    std::size_t more = 0;
    for (const auto& [a, b] : found.crossing)
      more += lock_about(coarse, a, mesh, locked) + lock_about(coarse, b, mesh, locked);
    if (more == 0) break;
  }
  throw Error(ErrorCode::Geometry,
              "decimate: " + std::to_string(intersections) +
                  " pairs of triangles still intersect: check whether the input intersects itself (octotomy "
                  "info); if not, allow less error or more rounds");
}

}  // namespace octotomy::brep

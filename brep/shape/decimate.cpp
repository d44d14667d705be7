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
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "brep/shape/surface_error.h"

namespace octotomy::brep {
namespace {

/// A mesh whose edges are collapsed. The library's own test allocates memory for each edge and takes half of
/// the time; this test has the same results if the removed vertex is not on a border. The library visits all
/// edges from a vertex in turn and chooses the collapse of least error. A collapse whose error is too large,
/// or not below that of an earlier one in the turn, is refused without a test.
class CollapsedMesh : public Mesh {
 public:
  explicit CollapsedMesh(const Mesh& mesh) : Mesh(mesh) {}

  /// Returns a collapse's error; negative if it is too large.
  std::function<float(OpenMesh::HalfedgeHandle)> error_of;

  /// Makes the edge that is tested next begin a new turn around a vertex.
  void start_anew() { next_in_turn_.invalidate(); }

  /// The error of the collapse that was tested last.
  float error() const { return error_; }
  /// Records that this collapse is allowed.
  void found() { least_error_ = error_; }

  /// Whether the mesh stays a manifold without that edge (the link condition): the edge's ends have no common
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
    if (is_boundary(from)) return false;
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

/// A vertex that is removed, and the vertex that it is merged with.
struct Collapse {
  OpenMesh::VertexHandle from, to;
};

/// The largest error of a collapse is that of this number of planes, of triangles of mean area, each as far
/// from the vertex as the largest distance allowed. Most of the six planes about a vertex are nearer. The
/// resulting surface is measured, see decimate().
constexpr double quadric_share() {
  return 4.0;
}

/// Computes a collapse's error, or forbids the collapse. The library runs all other modules before the one
/// that computes errors; here errors come first, because they cost least.
class ErrorThenShape : public OpenMesh::Decimater::ModQuadricT<CollapsedMesh> {
 public:
  using Handle = OpenMesh::Decimater::ModHandleT<ErrorThenShape>;
  using Error = OpenMesh::Decimater::ModQuadricT<CollapsedMesh>;

  explicit ErrorThenShape(CollapsedMesh& mesh) : Error(mesh), normals_(mesh), aspect_(mesh) {
    mesh.error_of = [this, &mesh](OpenMesh::HalfedgeHandle edge) {
      return Error::collapse_priority(CollapseInfo(mesh, edge));
    };
  }

  std::vector<Collapse> made;  ///< the collapses made, in order

  void limit(const DecimateOptions& options, double mean_mm2) {
    // The library keeps errors as floats, and weighs each plane's squared distance by its triangle's area.
    constexpr double largest = 1e37;
    set_max_err(std::min(quadric_share() * mean_mm2 * options.max_error_mm * options.max_error_mm, largest),
                false);
    normals_.set_max_normal_deviation(options.max_normal_deviation_deg);
    aspect_.set_aspect_ratio(options.max_aspect);
  }
  void initialize() override {
    Error::initialize();
    aspect_.initialize();
  }
  void preprocess_collapse(const CollapseInfo& collapse) override {
    made.push_back({collapse.v0, collapse.v1});
    aspect_.preprocess_collapse(collapse);
  }
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

class Decimater : public OpenMesh::Decimater::DecimaterT<CollapsedMesh> {
 public:
  explicit Decimater(CollapsedMesh& mesh) : BaseDecimaterT(mesh), DecimaterT(mesh) {}

  /// Repeats the given collapses in their order, and leaves out those that are no longer allowed.
  void make_again(const std::vector<Collapse>& collapses) {
    for (const auto& [from, to] : collapses) {
      if (mesh().status(from).locked()) continue;
      const OpenMesh::HalfedgeHandle edge = mesh().find_halfedge(from, to);
      if (!edge.is_valid()) continue;
      OpenMesh::Decimater::CollapseInfoT<CollapsedMesh> collapse(mesh(), edge);
      mesh().start_anew();
      if (!is_collapse_legal(collapse) || collapse_priority(collapse) < 0.0F) continue;
      preprocess_collapse(collapse);
      mesh().collapse(edge);
      for (const auto face : mesh().vf_range(to)) mesh().set_normal(face, mesh().calc_face_normal(face));
      postprocess_collapse(collapse);
    }
  }
};

/// Vertices of the original mesh are locked within this multiple of the extent of a triangle that intersects
/// another. The original triangles that the intersecting triangle replaced lie within its extent, and their
/// neighbours within half as much again.
constexpr double lock_reach() {
  return 1.5;
}

void check(const DecimateOptions& options) {
  const auto refuse = [](const std::string& why) { throw InvalidInput("decimate: " + why); };
  if (!(options.max_error_mm > 0.0)) refuse("the largest error must be positive");
  if (!(options.max_normal_deviation_deg > 0.0 && options.max_normal_deviation_deg <= 90.0))
    refuse("the normals' deviation must be above 0 and at most 90 degrees");
  if (!(options.max_aspect > 1.0)) refuse("the aspect ratio must be above 1");
  if (options.max_rounds < 1) refuse("there must be at least one round");
}

/// Marks the vertices on borders, which stay.
std::vector<bool> border_of(const Mesh& mesh) {
  std::vector<bool> locked(mesh.n_vertices(), false);
  for (const auto halfedge : mesh.halfedges())
    if (mesh.is_boundary(halfedge))
      locked[static_cast<std::size_t>(mesh.to_vertex_handle(halfedge).idx())] = true;
  return locked;
}

/// A mesh and the collapses that made it.
struct Coarse {
  Mesh mesh;
  std::vector<Collapse> collapses;            ///< collapses in terms of the given mesh's vertices
  std::vector<OpenMesh::VertexHandle> given;  ///< for each vertex, the same vertex of the given mesh
};

/// Repeats the collapses of `before` as far as they are allowed. If there are none, searches for collapses.
Coarse round_of_collapses(const Mesh& mesh, double mean_mm2, const DecimateOptions& options,
                          const std::vector<bool>& locked, const std::vector<Collapse>& before) {
  CollapsedMesh coarse(mesh);
  coarse.request_face_normals();
  coarse.update_face_normals();
  assert(locked.size() == mesh.n_vertices());
  for (const auto vertex : coarse.vertices())
    coarse.status(vertex).set_locked(locked[static_cast<std::size_t>(vertex.idx())]);

  Decimater decimater(coarse);
  ErrorThenShape::Handle collapses;
  decimater.add(collapses);
  decimater.module(collapses).limit(options, mean_mm2);
  decimater.initialize();
  if (before.empty())
    decimater.decimate_to_faces(0, options.faces.value_or(0));
  else
    decimater.make_again(before);

  // The library could record where vertices go, but in a map, which is slow.
  OpenMesh::VPropHandleT<OpenMesh::VertexHandle> was;
  coarse.add_property(was);
  for (std::size_t v = 0; v < coarse.n_vertices(); ++v) {
    const OpenMesh::VertexHandle vertex(static_cast<int>(v));
    coarse.property(was, vertex) = vertex;
  }
  coarse.garbage_collection();
  std::vector<OpenMesh::VertexHandle> given;
  given.reserve(coarse.n_vertices());
  for (const auto vertex : coarse.vertices()) given.push_back(coarse.property(was, vertex));
  coarse.remove_property(was);
  for (const auto vertex : coarse.vertices()) coarse.status(vertex).set_locked(false);
  coarse.release_face_normals();
  return {coarse, decimater.module(collapses).made, std::move(given)};
}

/// Locks the vertices that were merged into a corner of the given triangles of the coarse mesh. Returns the
/// number of newly locked ones.
std::size_t lock_what_went_into(const std::vector<std::uint32_t>& faces, const Coarse& coarse,
                                std::vector<bool>& locked) {
  std::vector<bool> is_corner(locked.size(), false);
  for (const std::uint32_t face : faces)
    for (const auto corner : coarse.mesh.fv_range(OpenMesh::FaceHandle(static_cast<int>(face))))
      is_corner[static_cast<std::size_t>(coarse.given[static_cast<std::size_t>(corner.idx())].idx())] = true;
  std::size_t count = 0;
  // Backwards, because a vertex that received another one may have been merged itself later.
  for (auto collapse = coarse.collapses.rbegin(); collapse != coarse.collapses.rend(); ++collapse) {
    const auto from = static_cast<std::size_t>(collapse->from.idx());
    if (!is_corner[static_cast<std::size_t>(collapse->to.idx())]) continue;
    is_corner[from] = true;
    count += !locked[from];
    locked[from] = true;
  }
  return count;
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

/// The given surface, prepared for measuring every round against it. If the allowed error is infinite,
/// nothing is measured.
class Given {
 public:
  Given(const Mesh& mesh, double limit_mm) : limit_mm_(limit_mm) {
    if (!std::isfinite(limit_mm)) return;
    surface_ = triangles_of(mesh);
    tree_.emplace(surface_);
  }

  FarPlaces far_places_of(const Coarse& coarse) {
    if (!tree_) return {};
    std::vector<std::uint32_t> given_of_coarse;
    given_of_coarse.reserve(coarse.given.size());
    for (const OpenMesh::VertexHandle vertex : coarse.given)
      given_of_coarse.push_back(static_cast<std::uint32_t>(vertex.idx()));
    return far_places(surface_, *tree_, triangles_of(coarse.mesh), given_of_coarse, limit_mm_, near_);
  }

 private:
  double limit_mm_ = 0.0;
  Triangles surface_;
  std::optional<SurfaceTree> tree_;
  NearFaces near_;
};

}  // namespace

Mesh decimate(const Mesh& mesh, const DecimateOptions& options) {
  check(options);
  if (mesh.n_faces() == 0) return mesh;
  Given given(mesh, options.max_error_mm);
  const double mean_mm2 = size_of(triangles_of(mesh)).area_mm2 / static_cast<double>(mesh.n_faces());
  std::vector<bool> locked = border_of(mesh);
  DecimateOptions now = options;
  std::size_t intersections = 0;
  std::vector<Collapse> before;
  for (int round = 0; round < options.max_rounds; ++round) {
    Coarse coarse = round_of_collapses(mesh, mean_mm2, now, locked, before);
    const Health found = health(coarse.mesh);
    intersections = found.self_intersections;
    std::size_t more = 0;
    if (intersections == 0) {
      const FarPlaces far = given.far_places_of(coarse);
      if (far.given_points.empty()) return std::move(coarse.mesh);
      for (const std::uint32_t v : far.given_points) {
        more += !locked[v];
        locked[v] = true;
      }
      more += lock_what_went_into(far.coarse_faces, coarse, locked);
      constexpr int careful_rounds = 2;
      if (more == 0 || round + careful_rounds >= options.max_rounds - 1) now.max_error_mm *= 0.5;
    }
    for (const auto& [a, b] : found.crossing)
      more += lock_about(coarse.mesh, a, mesh, locked) + lock_about(coarse.mesh, b, mesh, locked);
    if (intersections > 0 && more == 0) break;
    // If a number of faces is requested, collapses are searched anew: repeating them would end above that
    // number.
    if (!options.faces) before = std::move(coarse.collapses);
  }
  if (intersections == 0) return mesh;
  throw Error(ErrorCode::Geometry,
              "decimate: " + std::to_string(intersections) +
                  " pairs of triangles still intersect: check whether the input intersects itself (octotomy "
                  "info); if not, allow less error or more rounds");
}

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// What counting centres does to a boundary, triangle by triangle, in voxels of the lattice ("index space"):
//
// planes   A plane whose normal n is a vector of small integers errs coherently: centres lie on lattice
// planes
//          1 / |n| apart, and the digitised plane lies half-way between two of them. Where it lies is known,
//          so the displacement is exact and has a sign, but for a plane through centres, which may go either
//          way.
//
// count    Elsewhere the error of a count is a sum over the reciprocal lattice (Poisson; Kendall, "On the
//          number of lattice points inside a random oval", 1948): over all places of the lattice its variance
//          is the sum over integer vectors k of the indicator's Fourier transform squared, and that is, where
//          the boundary is curved, a(k) / (4 pi^2 |k|^4) for every point whose normal is along k, with a the
//          area there per solid angle of normals (1 / Gaussian curvature). A sphere has 0.0666 S in all, a
//          root mean square of 0.258 sqrt(S): the 0.20 to 0.32 that were measured. Of other solids a(k) is
//          taken from the triangles whose normal is near k for the 13 nearest directions and their multiples,
//          which have 65 % of the sum, and as if normals were spread evenly for the rest. So poles that an
//          anisotropic lattice flattens, and facets nearly along it, count as the more that they err.
//          Departure: near is within 15, 7 or 3.5 degrees, whichever gives most. The moments take pieces of
//          equal area as equal and independent parts.
//
// bent     A polyhedron with its vertices on a surface lies within it where it is convex, and interpolation
//          between samples a length d apart puts a point off by d^2 / 8 times the curvature along d. So what
//          an isosurface loses is a constant times the integral of d(t)^2 curvature(t) over the tangent's
//          directions t, and of a triangle mesh that integral is the sum over edges of length times angle
//          times d^2 across the edge, d the spacing of samples in that direction (the curvature measure of
//          Cohen-Steiner and Morvan, 2003). Marching cubes' triangles alternate about the surface: with its
//          sign the sum levels that out; without, it is taken cell by cell of three samples and by the
//          direction of the normal, so that the two sides of a thin plate do not cancel.
#include "verify/boundary_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "brep/triangles.h"

namespace octotomy::verify {
namespace {

using std::numbers::pi;

struct Triangle {
  std::array<glm::dvec3, 3> p;
  glm::dvec3 centre() const { return (p[0] + p[1] + p[2]) / 3.0; }
  glm::dvec3 area_vector() const { return 0.5 * glm::cross(p[1] - p[0], p[2] - p[0]); }
};

/// A plane n . q = c of index space q whose normal has small integers.
struct LatticePlane {
  glm::ivec3 normal{0};
  double offset = 0.0;
};

/// A plane counts as one of the lattice's where its points leave it by less than this, in voxels: a thousand
/// times what coordinates of a universe of 4096 voxels round to.
constexpr double flatness_voxels = 1000.0 * 4096.0 * std::numeric_limits<double>::epsilon();
/// Integers up to here: a plane of a larger normal errs by less than h / 8 in each voxel, and no longer all
/// in step.
constexpr int largest_index = 3;

std::optional<LatticePlane> lattice_plane(const std::array<glm::dvec3, 3>& q) {
  const glm::dvec3 across = glm::cross(q[1] - q[0], q[2] - q[0]);
  const double largest = std::max({std::abs(across.x), std::abs(across.y), std::abs(across.z)});
  if (!(largest > 0.0)) return std::nullopt;
  for (int index = 1; index <= largest_index; ++index) {
    const glm::dvec3 normal = glm::round(across * (index / largest));
    const std::array<double, 3> c{glm::dot(normal, q[0]), glm::dot(normal, q[1]), glm::dot(normal, q[2])};
    const auto [low, high] = std::minmax({c[0], c[1], c[2]});
    if (high - low < flatness_voxels * index) return LatticePlane{glm::ivec3(normal), 0.5 * (low + high)};
  }
  return std::nullopt;
}

constexpr std::array<std::array<int, 3>, 13> directions{{{1, 0, 0},
                                                         {0, 1, 0},
                                                         {0, 0, 1},
                                                         {1, 1, 0},
                                                         {1, -1, 0},
                                                         {1, 0, 1},
                                                         {1, 0, -1},
                                                         {0, 1, 1},
                                                         {0, 1, -1},
                                                         {1, 1, 1},
                                                         {1, 1, -1},
                                                         {1, -1, 1},
                                                         {1, -1, -1}}};

std::array<glm::dvec3, 13> units(const glm::dmat3& from_index) {
  std::array<glm::dvec3, 13> unit;
  for (std::size_t d = 0; d < unit.size(); ++d)
    unit[d] = glm::normalize(from_index * glm::dvec3(directions[d][0], directions[d][1], directions[d][2]));
  return unit;
}

/// The share of directions of space nearest to each unit vector, by a Fibonacci lattice of 20 000 points on
/// the sphere: a share's error is below one in a hundred.
std::array<double, 13> shares_of_space(const std::array<glm::dvec3, 13>& unit) {
  constexpr int points = 20000;
  std::array<int, 13> count{};
  for (int i = 0; i < points; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / points;
    const double turn = 2.0 * pi * i / std::numbers::phi;
    const double level = std::sqrt(1.0 - z * z);
    const glm::dvec3 way(level * std::cos(turn), level * std::sin(turn), z);
    std::size_t nearest = 0;
    for (std::size_t d = 1; d < unit.size(); ++d)
      if (std::abs(glm::dot(way, unit[d])) > std::abs(glm::dot(way, unit[nearest]))) nearest = d;
    ++count[nearest];
  }
  std::array<double, 13> share{};
  for (std::size_t d = 0; d < share.size(); ++d) share[d] = static_cast<double>(count[d]) / points;
  return share;
}

/// The variance of a count by the boundary's normals, all in voxels.
class CountVariance {
 public:
  CountVariance() : unit_(units(glm::dmat3(1.0))) {}
  void add(const glm::dvec3& area) {
    const double size = glm::length(area);
    area_ += size;
    for (std::size_t d = 0; d < unit_.size(); ++d)
      for (std::size_t w = 0; w < cosines.size(); ++w)
        if (std::abs(glm::dot(area, unit_[d])) > cosines[w] * size) in_cone_[d][w] += size;
  }
  double sum() const {
    // Sums over all integer vectors but zero of 1 / |k|^4, and over the multiples of one.
    constexpr double epstein = 16.5323;
    constexpr double multiples = pi * pi * pi * pi / 90.0;
    double counted = 0.0, variance = 0.0;
    for (std::size_t d = 0; d < unit_.size(); ++d) {
      const auto& g = directions[d];
      const double square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
      const double both = 2.0 * multiples / (square * square);
      counted += both;
      double most = 0.0;
      for (std::size_t w = 0; w < cosines.size(); ++w) {
        const double per_angle = in_cone_[d][w] / (2.0 * pi * (1.0 - cosines[w]));
        // All in step the planes 1 / |g| apart cannot err by more than evenly over half of that.
        const double in_step = in_cone_[d][w] * in_cone_[d][w] / (12.0 * square);
        most = std::max(most, std::min(both / (4.0 * pi * pi) * per_angle, in_step));
      }
      variance += most;
    }
    // Points with normals along +k and -k: two of the even density S / 4 pi.
    return variance + (epstein - counted) / (4.0 * pi * pi) * area_ / (2.0 * pi);
  }

 private:
  /// 15, 7 and 3.5 degrees.
  static constexpr std::array<double, 3> cosines{0.9659258262890683, 0.992546151641322, 0.9981347984218669};
  std::array<glm::dvec3, 13> unit_;
  std::array<std::array<double, 3>, 13> in_cone_{};
  double area_ = 0.0;
};

/// The model of one mesh in the making.
class Modeller {
 public:
  Modeller(const brep::Mesh& mesh, const BoundaryFrame& frame)
      : mesh_(mesh),
        frame_(frame),
        triangles_(brep::triangles_of(mesh)),
        moved_mm_(triangles_.faces.size()) {}

  BoundaryModel run() {
    add_faces();
    add_edges();
    return model_;
  }

 private:
  glm::dvec3 normal_of(const Triangle& triangle) const {
    const glm::dvec3 across = triangle.area_vector();
    const double length = glm::length(across);
    return length > 0.0 ? across / length : glm::dvec3(0.0);
  }
  Triangle triangle(std::size_t face) const {
    const auto& corner = triangles_.faces[face];
    return {
        {triangles_.points_mm[corner[0]], triangles_.points_mm[corner[1]], triangles_.points_mm[corner[2]]}};
  }

  void add_faces() {
    const glm::dmat3 edges(frame_.lattice.lps_from_voxel);
    const std::array<glm::dvec3, 13> lines = units(edges);
    const std::array<double, 13> share = shares_of_space(lines);
    const double voxel_mm3 = frame_.lattice.voxel_mm3();
    CountVariance count;
    double free_mm2 = 0.0, free_mm4 = 0.0, free_mm6 = 0.0;
    for (std::size_t face = 0; face < triangles_.faces.size(); ++face) {
      const Triangle at_mm = triangle(face);
      Triangle at_voxel;
      for (std::size_t i = 0; i < 3; ++i) at_voxel.p[i] = frame_.lattice.voxel(at_mm.p[i]);
      const double area_mm2 = glm::length(at_mm.area_vector());
      model_.area_mm2 += area_mm2;
      const glm::dvec3 normal = normal_of(at_mm);
      for (std::size_t d = 0; d < lines.size(); ++d)
        model_.crofton13_mm2 += 2.0 * share[d] * std::abs(glm::dot(normal, lines[d])) * area_mm2;
      if (const std::optional<LatticePlane> plane = lattice_plane(at_voxel.p)) {
        moved_mm_[face] = add_plane(*plane, at_mm, area_mm2);
        continue;
      }
      count.add(at_voxel.area_vector());
      const glm::dvec3 arm_mm = at_mm.centre() - frame_.about_mm;
      const double square = glm::dot(arm_mm, arm_mm);
      free_mm2 += area_mm2;
      free_mm4 += area_mm2 * square;
      free_mm6 += area_mm2 * square * square;
    }
    if (free_mm2 == 0.0) return;
    model_.count_mm6 = count.sum() * voxel_mm3 * voxel_mm3;
    model_.count_mm8 = model_.count_mm6 * free_mm4 / free_mm2;
    model_.count_mm10 = model_.count_mm6 * free_mm6 / free_mm2;
  }

  /// How far counting moves the plane outward.
  double add_plane(const LatticePlane& plane, const Triangle& triangle, double area_mm2) {
    // Moves of one in n . q are moves of 1 / |n'| millimetres, n' the normal in LPS.
    const glm::dmat3 normal_from_voxel =
        glm::transpose(glm::inverse(glm::dmat3(frame_.lattice.lps_from_voxel)));
    const glm::dvec3 normal = normal_from_voxel * glm::dvec3(plane.normal);
    const glm::ivec3 index = glm::abs(plane.normal);
    const glm::dvec3 arm_mm = triangle.centre() - frame_.about_mm;
    model_.coherent_mm2 += area_mm2;
    if (index.x + index.y + index.z == 1) model_.flat_mm2 += area_mm2 * glm::dvec3(index);
    // Centres have whole n . q, so the digitised plane lies half-way between two of them.
    const double shift = std::floor(plane.offset) + 0.5 - plane.offset;
    const double outward = glm::dot(triangle.area_vector(), normal) < 0.0 ? -1.0 : 1.0;
    const double moved_mm = outward * shift / glm::length(normal);
    if (0.5 - std::abs(shift) < flatness_voxels * largest_index) {
      const double mm3 = 0.5 / glm::length(normal) * area_mm2;
      model_.tied_mm3 += mm3;
      model_.unsure.add(mm3, glm::length(arm_mm));
    } else {
      model_.planes.add(moved_mm * area_mm2, arm_mm);
    }
    model_.planes_without_sign.add(std::abs(moved_mm) * area_mm2, glm::length(arm_mm));
    return moved_mm;
  }

  /// A part of a cell's sum.
  struct Bend {
    std::uint64_t cell = 0;  // of three samples a side, and the direction of the normal
    double mm = 0.0;
    double mm3 = 0.0;
    glm::dvec3 arm_mm{0.0};
  };

  void add_edges() {
    std::vector<Bend> bends;
    for (const auto edge : mesh_.edges()) {
      if (mesh_.is_boundary(edge)) continue;
      const auto side = mesh_.halfedge_handle(edge, 0);
      const auto a = static_cast<std::size_t>(mesh_.face_handle(side).idx());
      const auto b = static_cast<std::size_t>(mesh_.opposite_face_handle(side).idx());
      const glm::dvec3 from = point(mesh_.from_vertex_handle(side)), to = point(mesh_.to_vertex_handle(side));
      const glm::dvec3 middle = 0.5 * (from + to);
      if (moved_mm_[a].has_value() != moved_mm_[b].has_value()) {
        const double mm2 = std::abs(moved_mm_[a] ? *moved_mm_[a] : *moved_mm_[b]) * glm::length(to - from);
        model_.rims_mm2 += mm2;
        model_.unsure.add(mm2 * longest_mm_, glm::length(middle - frame_.about_mm));
      }
      const double angle = mesh_.calc_dihedral_angle(edge);
      if (!std::isfinite(angle) || angle == 0.0) continue;
      const glm::dvec3 normal = normal_of(triangle(a)) + normal_of(triangle(b));
      const glm::dvec3 across = glm::cross(normal, to - from);
      const double length = glm::length(across);
      if (!(length > 0.0)) continue;
      const glm::dvec3 spacing_mm = frame_.sample_spacing_mm * across / length;
      const double mm = 0.5 * glm::length(to - from) * angle;
      bends.push_back(
          {cell_of(middle, normal), mm, mm * glm::dot(spacing_mm, spacing_mm), middle - frame_.about_mm});
    }
    add_bends(std::move(bends));
  }
  glm::dvec3 point(const OpenMesh::VertexHandle vertex) const {
    const auto& p = mesh_.point(vertex);
    return {p[0], p[1], p[2]};
  }
  std::uint64_t cell_of(const glm::dvec3& p_mm, const glm::dvec3& normal) const {
    int direction = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (std::abs(normal[axis]) > std::abs(normal[direction])) direction = axis;
    // 20 bits an axis hold three million samples about the origin.
    constexpr std::int64_t middle = 1 << 19;
    auto key = static_cast<std::uint64_t>(normal[direction] < 0.0 ? direction : direction + 3);
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell =
          static_cast<std::int64_t>(std::floor(p_mm[axis] / (3.0 * frame_.sample_spacing_mm[axis])));
      key = (key << 20) | (static_cast<std::uint64_t>(cell + middle) & 0xFFFFFU);
    }
    return key;
  }

  void add_bends(std::vector<Bend> bends) {
    std::stable_sort(bends.begin(), bends.end(),
                     [](const Bend& x, const Bend& y) { return x.cell < y.cell; });
    double cell_mm = 0.0, cell_mm3 = 0.0;
    for (std::size_t i = 0; i < bends.size(); ++i) {
      model_.bent.add(bends[i].mm3, bends[i].arm_mm);
      cell_mm += bends[i].mm;
      cell_mm3 += bends[i].mm3;
      if (i + 1 < bends.size() && bends[i + 1].cell == bends[i].cell) continue;
      model_.bent_without_sign.add(std::abs(cell_mm3), glm::length(bends[i].arm_mm));
      model_.curvature_mm += std::abs(cell_mm);
      cell_mm = cell_mm3 = 0.0;
    }
  }

  const brep::Mesh& mesh_;
  const BoundaryFrame& frame_;
  brep::Triangles triangles_;
  /// Displacement of each face in millimetres outward, where it is part of a lattice plane.
  std::vector<std::optional<double>> moved_mm_;
  const double longest_mm_ =
      std::max({frame_.sample_spacing_mm.x, frame_.sample_spacing_mm.y, frame_.sample_spacing_mm.z});
  BoundaryModel model_;
};

}  // namespace

BoundaryModel boundary_model(const brep::Mesh& mesh, const BoundaryFrame& frame) {
  return Modeller(mesh, frame).run();
}

}  // namespace octotomy::verify

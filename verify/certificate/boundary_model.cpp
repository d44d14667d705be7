// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The effect of counting centres on a boundary, triangle by triangle, in voxels of the lattice ("index
// space"):
//
// planes   A plane whose normal n is a vector of small integers errs coherently: centres lie on lattice
//          planes 1 / |n| apart, and the digitised plane lies half-way between two of them. Its position
//          follows from the lattice, so the displacement is exact and has a sign. Only a plane through
//          centres may move either way. Two planes that are displaced outward by a and b, with an angle t
//          between their normals, gain (a b - (a^2 + b^2) / 2 cos t) / sin t in addition along each unit of
//          their common edge; at an inside corner they lose it.
//
// nearly   After blur or noise such a plane is curved, but its error is still coherent: along a column of
//          centres the count follows the surface to half a voxel's step, floor(z) + 1/2 - z. The integral of
//          this step over the triangles within 15 degrees of an axis is exact up to the scatter of columns,
//          which `count` includes. A displaced part adds area past its rim: a displacement d times the
//          integral of the curvature there (the first variation of area; do Carmo, Differential Geometry of
//          Curves and Surfaces, section 3.5), which is d times the rim's length where the surface turns by a
//          right angle. Parts are displaced independently, so the squares of their areas add up.
//
// count    Elsewhere the error of a count is a sum over the reciprocal lattice (Poisson; Kendall, "On the
//          number of lattice points inside a random oval", 1948). Over all positions of the lattice its
//          variance is the sum, over integer vectors k, of the squared Fourier transform of the indicator.
//          Where the boundary is curved, that square is a(k) / (4 pi^2 |k|^4) for every k along a normal, a the
//          area there per solid angle of normals (1 / Gaussian curvature). A sphere has 0.0666 S in all, a
//          root mean square of 0.258 sqrt(S): the 0.20 to 0.32 that were measured. Of other solids a(k) is
//          computed from the triangles whose normal is near k for the 13 nearest directions and their
//          multiples, which have 65 % of the sum. For the rest normals are assumed to be spread evenly. So
//          the sum includes the larger errors of poles that an anisotropic lattice flattens and of facets
//          nearly along the lattice. Departure: near is within 15, 7 or 3.5 degrees, the one with the largest
//          variance. The moments treat pieces of equal area as equal and independent parts. Large flat facets
//          are not curved, and those along the lattice err coherently over their whole extent. Their
//          transform is summed instead (facet_count.h).
//
// bent     A polyhedron with its vertices on a surface lies within it where it is convex, and interpolation
//          between samples a length d apart displaces a point by d^2 / 8 times the curvature along d. So an
//          isosurface loses a constant times the integral of d(t)^2 curvature(t) over the tangent's
//          directions t. For a triangle mesh that integral is the sum over edges of length times angle
//          times d^2 across the edge, d the spacing of samples in that direction (the curvature measure of
//          Cohen-Steiner and Morvan, 2003). The triangles of marching cubes lie alternately on both sides of
//          the surface. In the sum with sign these deviations cancel. The sum without sign adds the absolute
//          values of cells of three samples, separate by the direction of the normal, so that the two sides
//          of a thin plate do not cancel.
// sharp    A line of voxels' centres, h apart, misses a chord of the length l < h with the probability
//          1 - l / h, and with it two crossings. Across a wedge whose faces turn by t at an edge, chords at a
//          distance x from the edge have the length x / f, f = sin a sin(t - a) / sin t for a line at the
//          angle a to one face. The loss is twice h f / 2 crossings along each unit of the edge. Over all
//          directions, with the 13 directions' mean distance of 1.39 h, the area loses
//          2 / (3 pi) 1.39 h (1 - t cot t) = 0.295 h (1 - t cot t) along each unit. Up to 75 degrees that is
//          less than 0.3 times 0.5 t, the edge's share of the mean curvature. The probability of chords:
//          Santalo, Integral Geometry and Geometric Probability, 1976, chapter 4.
// This file is long because all terms of the model use the same points and displacements.
#include "verify/certificate/boundary_model.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "brep/mesh/dihedral_angle.h"
#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/triangles.h"
#include "verify/certificate/facet_count.h"
#include "verify/interval/cell_table.h"
#include "verify/interval/ordered_parallel.h"

namespace octotomy::verify {
namespace {

using std::numbers::pi;

struct Triangle {
  std::array<glm::dvec3, 3> p;
  glm::dvec3 centre() const { return (p[0] + p[1] + p[2]) / 3.0; }
  glm::dvec3 area_vector() const { return 0.5 * glm::cross(p[1] - p[0], p[2] - p[0]); }
};

/// A quadrature point of a triangle, and the point's weight. A triangle's weights add up to 1.
struct SharePoint {
  glm::dvec3 p{0.0};
  double share = 0.0;
};

/// Six weighted points of a triangle. The weighted sum of a polynomial's values at these points is the
/// polynomial's mean over the triangle, exact up to the fourth degree (Dunavant, "High degree efficient
/// symmetrical Gaussian quadrature rules for the triangle", 1985).
std::array<SharePoint, 6> share_points_of(const Triangle& triangle) {
  struct Orbit {
    // `share`: weight of a point; `corner`, `side`: its barycentric coordinates for one corner, and for each
    // other corner
    double share, corner, side;
  };
  constexpr std::array<Orbit, 2> orbits{{{0.223381589678011, 0.108103018168070, 0.445948490915965},
                                         {0.109951743655322, 0.816847572980459, 0.091576213509771}}};
  std::array<SharePoint, 6> pieces;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Orbit& orbit = orbits[i / 3];
    const glm::dvec3 sum = triangle.p[0] + triangle.p[1] + triangle.p[2];
    pieces[i] = {orbit.side * sum + (orbit.corner - orbit.side) * triangle.p[i % 3], orbit.share};
  }
  return pieces;
}

/// A lattice plane: the points q of index space with normal . q = offset. The normal is a vector of small
/// integers.
struct LatticePlane {
  glm::ivec3 normal{0};
  double offset = 0.0;
};

/// Points within this distance, in voxels, of a plane count as lying in the plane: a thousand times the
/// rounding of coordinates in a universe of 4096 voxels.
constexpr double flatness_voxels = 1000.0 * 4096.0 * std::numeric_limits<double>::epsilon();
/// The largest component of a LatticePlane's normal. Counting moves a plane with a larger normal by less than
/// h / 8 in each voxel, and not coherently.
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

/// For each of 13 lines: the share of all directions that are nearer to this line than to the others.
/// Computed from a Fibonacci lattice of 20 000 points on the sphere; the error of a share is below 1 %.
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

/// Computes the variance of a count of voxel centres from the areas and normals of the boundary. Lengths are
/// in voxels.
class CountVariance {
 public:
  CountVariance() : unit_(units(glm::dmat3(1.0))) {}
  /// A triangle's area, and one bit for each cone that contains the triangle's normal.
  struct Share {
    double size = 0.0;
    std::uint64_t cones = 0;
  };
  Share share_of(const glm::dvec3& area) const {
    Share share{glm::length(area), 0};
    for (std::size_t d = 0; d < unit_.size(); ++d)
      for (std::size_t w = 0; w < cosines.size(); ++w)
        if (std::abs(glm::dot(area, unit_[d])) > cosines[w] * share.size)
          share.cones |= std::uint64_t{1} << (cosines.size() * d + w);
    return share;
  }
  void add(const Share& share) {
    area_ += share.size;
    for (std::uint64_t left = share.cones; left != 0; left &= left - 1) {
      const auto cone = static_cast<std::size_t>(std::countr_zero(left));
      in_cone_[cone / cosines.size()][cone % cosines.size()] += share.size;
    }
  }
  double sum() const {
    // Sums of 1 / |k|^4: over all integer vectors k but zero, and over the positive multiples of a unit
    // vector.
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
        // The variance is at most that of a fully coherent error. Such an error moves the whole area by up to
        // half of the distance 1 / |g| of lattice planes, inward or outward, all distances being equally
        // likely.
        const double in_step = in_cone_[d][w] * in_cone_[d][w] / (12.0 * square);
        most = std::max(most, std::min(both / (4.0 * pi * pi) * per_angle, in_step));
      }
      variance += most;
    }
    // Evenly spread normals have the area S / (4 pi) per solid angle. Normals along k and along -k both
    // contribute.
    return variance + (epstein - counted) / (4.0 * pi * pi) * area_ / (2.0 * pi);
  }

 private:
  /// Cosines of the cones' half-angles: 15, 7 and 3.5 degrees.
  static constexpr std::array<double, 3> cosines{0.9659258262890683, 0.992546151641322, 0.9981347984218669};
  std::array<glm::dvec3, 13> unit_;
  std::array<std::array<double, 3>, 13> in_cone_{};
  double area_ = 0.0;
};

/// A flat part of at least this area, in voxel faces, contributes to the count's variance by its Fourier
/// transform. Smaller parts are numerous, and their errors are independent.
constexpr double large_facet = 16.0;

/// The cosine of 15 degrees. A part whose normal is within that angle of an axis lies between two layers of
/// centres over several voxels.
constexpr double nearly_along = 0.9659258262890683;

class Modeller {
 public:
  Modeller(const brep::Solid& solid, const BoundaryFrame& frame)
      : linked_(solid.linked()), frame_(frame), triangles_(linked_.triangles) {}

  BoundaryModel run() {
    const glm::dmat3 voxel_from_mm = glm::inverse(glm::dmat3(frame_.lattice.lps_from_voxel));
    const glm::dvec3 first_mm(frame_.lattice.lps_from_voxel[3]);
    points_voxel_.reserve(triangles_.points_mm.size());
    for (const glm::dvec3& p_mm : triangles_.points_mm)
      points_voxel_.push_back(voxel_from_mm * (p_mm - first_mm));
    moved_.resize(triangles_.faces.size());
    nearly_.resize(triangles_.faces.size());
    add_faces();
    add_counts();
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
    struct Face {
      double area_mm2 = 0.0;
      std::array<double, 13> seen_mm2{};
      std::optional<LatticePlane> plane;
    };
    ordered_parallel<Face>(
        triangles_.faces.size(),
        [&](std::size_t face) {
          const Triangle at_mm = triangle(face);
          Face made{glm::length(at_mm.area_vector()), {}, lattice_plane(in_voxels(face).p)};
          const glm::dvec3 normal = normal_of(at_mm);
          for (std::size_t d = 0; d < lines.size(); ++d)
            made.seen_mm2[d] = 2.0 * share[d] * std::abs(glm::dot(normal, lines[d])) * made.area_mm2;
          return made;
        },
        [&](std::size_t face, const Face& made) {
          model_.area_mm2 += made.area_mm2;
          for (const double seen_mm2 : made.seen_mm2) model_.crofton13_mm2 += seen_mm2;
          if (made.plane) moved_[face] = add_plane(*made.plane, triangle(face), made.area_mm2);
        });
  }
  Triangle in_voxels(std::size_t face) const {
    const auto& corner = triangles_.faces[face];
    return {{points_voxel_[corner[0]], points_voxel_[corner[1]], points_voxel_[corner[2]]}};
  }

  /// A face's area. For each of its six pieces: the area times the squared distance from the frame's origin
  /// of moments, and times the fourth power of that distance.
  struct ArmsOfFace {
    double mm2 = 0.0;
    std::array<double, 6> mm4{}, mm6{};
  };
  ArmsOfFace arms_of(const Triangle& triangle) const {
    ArmsOfFace made{glm::length(triangle.area_vector()), {}, {}};
    const std::array<SharePoint, 6> pieces = share_points_of(triangle);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const glm::dvec3 arm_mm = pieces[i].p - frame_.about_mm;
      const double square = glm::dot(arm_mm, arm_mm);
      made.mm4[i] = pieces[i].share * made.mm2 * square;
      made.mm6[i] = pieces[i].share * made.mm2 * square * square;
    }
    return made;
  }

  /// Adds the count's variance for the boundary outside lattice planes. Large flat facets contribute by their
  /// Fourier transforms, all other faces by their normals.
  void add_counts() {
    const std::vector<std::uint32_t> set = flat_sets();
    std::vector<double> area(set.size(), 0.0);
    ordered_parallel<double>(
        set.size(), [&](std::size_t face) { return glm::length(in_voxels(face).area_vector()); },
        [&](std::size_t face, double size) {
          if (!moved_[face]) area[set[face]] += size;
        });
    std::vector<Facet> facets;
    std::vector<std::optional<std::size_t>> facet_of_set(set.size());
    CountVariance curved;
    Arms curved_arms, flat_arms;
    struct Face {
      glm::dvec3 across{0.0};
      bool is_curved = false;
      CountVariance::Share share;
      NearlyPlane nearly;
      ArmsOfFace arms;
    };
    ordered_parallel<Face>(
        set.size(),
        [&](std::size_t face) {
          Face made;
          if (moved_[face]) return made;
          made.across = in_voxels(face).area_vector();
          made.is_curved = area[set[face]] < large_facet;
          made.arms = arms_of(triangle(face));
          if (!made.is_curved) return made;
          made.share = curved.share_of(made.across);
          made.nearly = nearly_plane_of(face, made.across);
          return made;
        },
        [&](std::size_t face, const Face& made) {
          if (moved_[face]) return;
          (made.is_curved ? curved_arms : flat_arms).add(made.arms);
          if (made.is_curved) {
            curved.add(made.share);
            for (std::size_t i = 0; i < made.nearly.count; ++i)
              model_.nearly_planes.add(made.nearly.mm3[i], made.nearly.arm_mm[i]);
            nearly_[face] = made.nearly.displaced();
            return;
          }
          std::optional<std::size_t>& number = facet_of_set[set[face]];
          if (!number) {
            number = facets.size();
            facets.emplace_back();
          }
          facets[*number].area += made.across;
          add_rims(facets[*number], static_cast<std::uint32_t>(face), set);
        });
    add_variance(curved.sum(), curved_arms);
    add_variance(count_variance(facets), flat_arms);
    add_nearly_rims();
  }

  /// The volume that counting adds beyond a face nearly along the lattice; negative where counting loses
  /// volume. `way`: the axis of the face's normal, 1 to 3, negative for a normal along the negative axis; 0
  /// for a face that is not nearly along the lattice.
  struct Displaced {
    int way = 0;
    double mm3 = 0.0;
  };
  /// The pieces of a face nearly along the lattice, with the volume that counting adds beyond each piece.
  /// `count` is 0 for any other face.
  struct NearlyPlane {
    std::size_t count = 0;
    int way = 0;
    std::array<double, 6> mm3{};
    std::array<glm::dvec3, 6> arm_mm{};

    Displaced displaced() const { return {way, std::accumulate(mm3.begin(), mm3.end(), 0.0)}; }
  };
  /// Returns the pieces of a face whose normal is nearly along an axis; none for any other face. In each
  /// column of centres along that axis, counting moves the face to the middle between two centres.
  NearlyPlane nearly_plane_of(std::size_t face, const glm::dvec3& across) const {
    NearlyPlane made;
    int axis = 0;
    for (int i = 1; i < 3; ++i)
      if (std::abs(across[i]) > std::abs(across[axis])) axis = i;
    if (!(std::abs(across[axis]) > nearly_along * glm::length(across))) return made;
    const Triangle at_mm = triangle(face), at_voxel = in_voxels(face);
    const std::array<SharePoint, 6> places = share_points_of(at_voxel), points = share_points_of(at_mm);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double step = std::floor(places[i].p[axis]) + 0.5 - places[i].p[axis];
      made.mm3[i] = places[i].share * step * across[axis] * frame_.lattice.voxel_mm3();
      made.arm_mm[i] = points[i].p - frame_.about_mm;
    }
    made.count = places.size();
    made.way = across[axis] < 0.0 ? -(axis + 1) : axis + 1;
    return made;
  }

  /// Joins adjacent faces of one `way` into parts, and adds the area that each part gains past its rim.
  void add_nearly_rims() {
    brep::DisjointSets sets(nearly_.size());
    const auto each_side = [&](const auto& take) {
      for (std::uint32_t side = 0; side < linked_.opposite.size(); ++side)
        if (linked_.is_inner_edge(side) && nearly_[side / 3].way != 0)
          take(side, side / 3, linked_.opposite[side] / 3);
    };
    each_side([&](std::uint32_t, std::uint32_t a, std::uint32_t b) {
      if (nearly_[a].way == nearly_[b].way) sets.join(a, b);
    });
    struct Part {
      double mm3 = 0.0, mm2 = 0.0, rim_mm = 0.0;
    };
    std::vector<Part> parts(nearly_.size());
    for (std::uint32_t face = 0; face < nearly_.size(); ++face) {
      if (nearly_[face].way == 0) continue;
      Part& part = parts[sets.set_of(face)];
      part.mm3 += nearly_[face].mm3;
      part.mm2 += glm::length(triangle(face).area_vector());
    }
    each_side([&](std::uint32_t side, std::uint32_t a, std::uint32_t b) {
      if (nearly_[a].way != nearly_[b].way)
        parts[sets.set_of(a)].rim_mm += glm::length(to(side) - from(side));
    });
    double all_mm2 = 0.0, squares = 0.0;
    for (const Part& part : parts) {
      if (!(part.mm2 > 0.0)) continue;
      const double mm2 = std::abs(part.mm3) / part.mm2 * part.rim_mm;
      all_mm2 += mm2;
      squares += mm2 * mm2;
    }
    constexpr double coverage = 3.0;
    model_.rims_mm2 += std::min(all_mm2, coverage * std::sqrt(squares));
  }

  /// Returns for each face the number of the set of adjacent coplanar faces that contains it. A face in a
  /// lattice plane is a set of its own.
  std::vector<std::uint32_t> flat_sets() const {
    brep::DisjointSets sets(triangles_.faces.size());
    struct Pair {
      std::uint32_t a = 0, b = 0;
      bool flat = false;
    };
    ordered_parallel<Pair>(
        linked_.opposite.size(),
        [&](std::size_t number) {
          const auto side = static_cast<std::uint32_t>(number);
          if (!linked_.is_inner_edge(side)) return Pair{};
          const std::uint32_t a = side / 3, b = linked_.opposite[side] / 3;
          if (moved_[a] || moved_[b]) return Pair{};
          const glm::dvec3 from = in_voxels(a).area_vector(), to = in_voxels(b).area_vector();
          const bool a_larger = glm::dot(from, from) >= glm::dot(to, to);
          const Triangle large = in_voxels(a_larger ? a : b), small = in_voxels(a_larger ? b : a);
          const double size = glm::length(large.area_vector());
          if (!(size > 0.0) || glm::dot(from, to) < 0.0) return Pair{};
          const glm::dvec3 normal = large.area_vector() / size;
          const bool flat = std::all_of(small.p.begin(), small.p.end(), [&](const glm::dvec3& p) {
            return std::abs(glm::dot(p - large.p[0], normal)) < flatness_voxels;
          });
          return Pair{a, b, flat};
        },
        [&](std::size_t, const Pair& pair) {
          if (pair.flat) sets.join(pair.a, pair.b);
        });
    std::vector<std::uint32_t> set(triangles_.faces.size());
    for (std::uint32_t face = 0; face < set.size(); ++face) set[face] = sets.set_of(face);
    return set;
  }

  /// Adds to the facet those sides of a face beyond which another facet begins.
  void add_rims(Facet& facet, std::uint32_t face, const std::vector<std::uint32_t>& set) const {
    for (std::uint32_t side = 3 * face; side != 3 * face + 3; ++side) {
      const std::uint32_t beyond = linked_.opposite[side] / 3;
      if (!moved_[beyond] && set[beyond] == set[face]) continue;
      facet.sides.push_back({frame_.lattice.voxel(from(side)), frame_.lattice.voxel(to(side))});
    }
  }

  /// The area of several faces, and the sums of its second and fourth moments.
  struct Arms {
    double mm2 = 0.0, mm4 = 0.0, mm6 = 0.0;
    void add(const ArmsOfFace& face) {
      mm2 += face.mm2;
      for (std::size_t i = 0; i < face.mm4.size(); ++i) {
        mm4 += face.mm4[i];
        mm6 += face.mm6[i];
      }
    }
  };

  void add_variance(double voxels, const Arms& arms) {
    if (!(arms.mm2 > 0.0)) return;
    const double voxel_mm3 = frame_.lattice.voxel_mm3();
    const double mm6 = voxels * voxel_mm3 * voxel_mm3;
    model_.count_mm6 += mm6;
    model_.count_mm8 += mm6 * arms.mm4 / arms.mm2;
    model_.count_mm10 += mm6 * arms.mm6 / arms.mm2;
  }

  /// The displacement of a plane by counting; `mm` is positive outward.
  struct Moved {
    double mm = 0.0;
    bool tied = false;  ///< the plane goes through voxel centres, so it may move to either side
    glm::ivec3 normal{0};
  };

  Moved add_plane(const LatticePlane& plane, const Triangle& triangle, double area_mm2) {
    // A step of 1 in n . q is a step of 1 / |n'| millimetres, with n' the normal in LPS.
    const glm::dmat3 normal_from_voxel =
        glm::transpose(glm::inverse(glm::dmat3(frame_.lattice.lps_from_voxel)));
    const glm::dvec3 normal = normal_from_voxel * glm::dvec3(plane.normal);
    const glm::ivec3 index = glm::abs(plane.normal);
    model_.coherent_mm2 += area_mm2;
    if (index.x + index.y + index.z == 1) model_.flat_mm2 += area_mm2 * glm::dvec3(index);
    // At centres n . q is an integer, so the digitised plane lies half-way between two integers.
    const double shift = std::floor(plane.offset) + 0.5 - plane.offset;
    const double outward = glm::dot(triangle.area_vector(), normal) < 0.0 ? -1.0 : 1.0;
    const Moved moved{outward * shift / glm::length(normal),
                      0.5 - std::abs(shift) < flatness_voxels * largest_index, plane.normal};
    const double most_mm = moved.tied ? 0.5 / glm::length(normal) : std::abs(moved.mm);
    for (const SharePoint& piece : share_points_of(triangle)) {
      const double arm_mm = glm::distance(piece.p, frame_.about_mm);
      if (moved.tied) model_.unsure.add(piece.share * most_mm * area_mm2, arm_mm);
      model_.planes_without_sign.add(piece.share * most_mm * area_mm2, arm_mm);
    }
    if (moved.tied)
      model_.tied_mm3 += most_mm * area_mm2;
    else
      model_.planes.add(moved.mm * area_mm2, triangle.centre() - frame_.about_mm);
    return moved;
  }

  /// The integral of mean curvature along an edge, or over the edges of a cell. A sum has the position of the
  /// edge that was added last.
  struct Bend {
    std::uint64_t cell = 0;  // number of a cell of three samples a side, and of the normal's nearest axis
    double mm = 0.0;
    double mm3 = 0.0;
    glm::dvec3 arm_mm{0.0};

    void add(const Bend& other) {
      mm += other.mm;
      mm3 += other.mm3;
      arm_mm = other.arm_mm;
    }
  };

  /// Area lost per unit length of an edge whose faces turn by `angle`, for voxels of edge 1; see `sharp`
  /// above. The turn counts as 165 degrees at most. The formula has no bound towards 180 degrees, but a wedge
  /// of less than 15 degrees ends before it loses more area than that.
  static double sharp_loss(double angle) {
    constexpr double bluntest = 75.0 / 180.0 * pi, sharpest = 165.0 / 180.0 * pi;
    const double turn = std::min(std::abs(angle), sharpest);
    if (turn < bluntest) return 0.0;
    return std::max(0.0, 0.295 * (1.0 - turn / std::tan(turn)) - 0.3 * 0.5 * turn);
  }

  /// The dihedral angle of an inner edge, and the edge's curvature if the angle is not zero.
  struct BentEdge {
    double angle = 0.0, sharp_mm = 0.0;
    bool is_inner = false, bends = false;
    Bend bend;
  };
  /// Computes the edge of a side. The second side of an edge returns an empty BentEdge, so that each edge
  /// counts once.
  BentEdge bent_edge(std::uint32_t side) const {
    BentEdge made;
    if (!linked_.is_inner_edge(side)) return made;
    made.is_inner = true;
    const Triangle a = triangle(side / 3), b = triangle(linked_.opposite[side] / 3);
    const glm::dvec3 from = this->from(side), to = this->to(side);
    const glm::dvec3 middle = 0.5 * (from + to);
    made.angle = brep::dihedral_angle(a.area_vector(), b.area_vector(), to - from);
    if (made.angle == 0.0) return made;
    const glm::dvec3 normal = normal_of(a) + normal_of(b);
    const glm::dvec3 across = glm::cross(normal, to - from);
    const double length = glm::length(across);
    if (!(length > 0.0)) return made;
    const glm::dvec3 spacing_mm = frame_.sample_spacing_mm * across / length;
    const double mm = 0.5 * glm::length(to - from) * made.angle;
    made.bends = true;
    made.sharp_mm = glm::length(to - from) * sharp_loss(made.angle);
    made.bend = {cell_of(middle, normal), mm, mm * glm::dot(spacing_mm, spacing_mm),
                 middle - frame_.about_mm};
    return made;
  }

  void add_edges() {
    CellTable<Bend> cells;
    ordered_parallel<BentEdge>(
        linked_.opposite.size(),
        [&](std::size_t side) { return bent_edge(static_cast<std::uint32_t>(side)); },
        [&](std::size_t side, const BentEdge& edge) {
          if (edge.is_inner) add_displaced(static_cast<std::uint32_t>(side), edge.angle);
          if (!edge.bends) return;
          model_.bent.add(edge.bend.mm3, edge.bend.arm_mm);
          model_.sharp_mm += edge.sharp_mm;
          cells.at(edge.bend.cell).add(edge.bend);
        });
    cells.each([&](const Bend& cell) {
      model_.bent_without_sign.add(std::abs(cell.mm3), glm::length(cell.arm_mm));
      model_.curvature_mm += std::abs(cell.mm);
    });
  }
  /// Adds what counting gains at an edge: between two displaced planes a volume; at the rim of one displaced
  /// plane an area, and a volume of unknown sign.
  void add_displaced(std::uint32_t side, double angle) {
    const std::uint32_t a = side / 3, b = linked_.opposite[side] / 3;
    if (!moved_[a] && !moved_[b]) return;
    const glm::dvec3 from = this->from(side), to = this->to(side);
    const glm::dvec3 middle = 0.5 * (from + to);
    if (moved_[a] && moved_[b])
      return add_corner(*moved_[a], *moved_[b], angle, glm::length(to - from), middle - frame_.about_mm);
    const double mm2 = std::abs(moved_[a] ? moved_[a]->mm : moved_[b]->mm) * glm::length(to - from);
    model_.rims_mm2 += mm2;
    model_.unsure.add(mm2 * longest_mm_, glm::length(middle - frame_.about_mm));
  }
  /// Adds the volume at the common edge of two displaced planes, which the planes' own displacements leave
  /// out.
  void add_corner(const Moved& a, const Moved& b, double angle, double length_mm, const glm::dvec3& arm_mm) {
    // Parallel planes have no common edge. An edge between their triangles comes from rounding.
    if (a.normal == b.normal || a.normal == -b.normal || !(std::abs(std::sin(angle)) > flatness_voxels))
      return;
    const double mm2 = (a.mm * b.mm - 0.5 * (a.mm * a.mm + b.mm * b.mm) * std::cos(angle)) / std::sin(angle);
    if (a.tied || b.tied)
      model_.unsure.add(std::abs(mm2) * length_mm, glm::length(arm_mm));
    else
      model_.planes.add(mm2 * length_mm, arm_mm);
    model_.planes_without_sign.add(std::abs(mm2) * length_mm, glm::length(arm_mm));
  }
  glm::dvec3 from(std::uint32_t side) const { return triangles_.points_mm[linked_.from(side)]; }
  glm::dvec3 to(std::uint32_t side) const { return triangles_.points_mm[linked_.to(side)]; }
  std::uint64_t cell_of(const glm::dvec3& p_mm, const glm::dvec3& normal) const {
    int direction = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (std::abs(normal[axis]) > std::abs(normal[direction])) direction = axis;
    // 20 bits per axis cover three million samples about the origin.
    constexpr std::int64_t middle = 1 << 19;
    auto key = static_cast<std::uint64_t>(normal[direction] < 0.0 ? direction : direction + 3);
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::floor(p_mm[axis] / (3.0 * frame_.sample_spacing_mm[axis]));
      // Without samples the spacing is zero, and all edges belong to one cell.
      const std::int64_t number = std::abs(cell) < 0x1p62 ? static_cast<std::int64_t>(cell) : 0;
      key = (key << 20) | (static_cast<std::uint64_t>(number + middle) & 0xFFFFFU);
    }
    return key;
  }

  const brep::Linked& linked_;
  const BoundaryFrame& frame_;
  const brep::Triangles& triangles_;
  std::vector<glm::dvec3> points_voxel_;     ///< the points of the triangles
  std::vector<std::optional<Moved>> moved_;  ///< by face; none for a face outside all lattice planes
  std::vector<Displaced> nearly_;            ///< by face
  const double longest_mm_ =
      std::max({frame_.sample_spacing_mm.x, frame_.sample_spacing_mm.y, frame_.sample_spacing_mm.z});
  BoundaryModel model_;
};

}  // namespace

BoundaryModel boundary_model(const brep::Solid& solid, const BoundaryFrame& frame) {
  return Modeller(solid, frame).run();
}

}  // namespace octotomy::verify

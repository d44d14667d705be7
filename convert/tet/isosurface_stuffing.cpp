// SPDX-License-Identifier: AGPL-3.0-or-later
// Source: Labelle and Shewchuk 2007 (isosurface_stuffing.h), with its numbers for a uniform lattice.
// Departures: the sign and the cut points come from triangles instead of a function, and quadrilaterals are
// cut from their node that comes first in one order of all nodes (pass 5) in place of the paper's table; the
// tests check the bound with random cuts on every side.
// 1 Mark the lattice points inside: each row along x crosses the surface, and the parity changes there.
// 2 On each side between an inside and an outside lattice point, add a cut point where a triangle crosses it.
// 3 Warp a lattice point to the nearest cut point that lies too near to it for good angles; its sides lose
//   their cuts.
// 4 Of each of the lattice's tetrahedra keep the part inside: corners inside, warped corners, and cut points.
// 5 Where this part is a pyramid or a prism, divide it from its first node. All tetrahedra use the same order
//   of nodes, so neighbours divide their common face in the same way.
#include "convert/tet/isosurface_stuffing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unordered_map>

#include "brep/mesh/distance.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"

namespace octotomy::convert {
namespace {

// Coordinates in halves of a cell, so that corners of cubes are even and their middles odd on all axes.
using LatticePoint = glm::ivec3;

/// The sides that leave a lattice point in the half space of positive directions: three long, four short.
constexpr std::array<std::array<int, 3>, 7> ways{
    {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}}};
constexpr std::size_t long_ways = 3;
LatticePoint way(std::size_t w) {
  return {ways.at(w)[0], ways.at(w)[1], ways.at(w)[2]};
}

/// The share of a side within which a cut point is too near to its end: the paper's table 1.
double too_near(std::size_t w) {
  return w < long_ways ? 0.24999 : 0.41189;
}

struct Lattice {
  glm::dvec3 origin_mm{0.0};
  double half_mm = 0.5;
  glm::ivec3 points{0};  ///< number of lattice positions along each axis, half a cell apart

  glm::dvec3 at(const LatticePoint& p) const { return origin_mm + half_mm * glm::dvec3(p); }
  bool has(const LatticePoint& p) const {
    return glm::all(glm::greaterThanEqual(p, LatticePoint(0))) && glm::all(glm::lessThan(p, points));
  }
  std::size_t index(const LatticePoint& p) const {
    return (static_cast<std::size_t>(p.z) * static_cast<std::size_t>(points.y) +
            static_cast<std::size_t>(p.y)) *
               static_cast<std::size_t>(points.x) +
           static_cast<std::size_t>(p.x);
  }
};

Lattice lattice_about(const brep::Triangles& surface, double cell_mm) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const auto& face : surface.faces)
    for (const std::uint32_t v : face) {
      low = glm::min(low, surface.points_mm[v]);
      high = glm::max(high, surface.points_mm[v]);
    }
  Lattice lattice;
  lattice.half_mm = 0.5 * cell_mm;
  // The offsets are not round parts of a cell, so that planes at round coordinates do not coincide with the
  // lattice's.
  lattice.origin_mm = low - cell_mm * glm::dvec3(1.27182818, 1.31415926, 1.14142135);
  const glm::dvec3 halves = glm::ceil((high - lattice.origin_mm) / lattice.half_mm) + 4.0;
  constexpr double most_points = 536870912.0;
  if (!(halves.x * halves.y * halves.z < most_points))
    throw voxel::Error(voxel::ErrorCode::Resource, "isosurface stuffing: cells of " +
                                                       voxel::rounded(cell_mm) +
                                                       " mm are too many for the surface: take larger ones");
  lattice.points = glm::ivec3(halves);
  return lattice;
}

/// The x at which the row along x through a point meets a face's plane, within the face.
double x_of(const brep::Triangles& surface, std::uint32_t face, const glm::dvec3& p) {
  const auto& corners = surface.faces[face];
  const glm::dvec3 &a = surface.points_mm[corners[0]], &b = surface.points_mm[corners[1]],
                   &c = surface.points_mm[corners[2]];
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double low = std::min({a.x, b.x, c.x}), high = std::max({a.x, b.x, c.x});
  if (normal.x == 0.0) return 0.5 * (low + high);
  return std::clamp(a.x + (normal.y * (a.y - p.y) + normal.z * (a.z - p.z)) / normal.x, low, high);
}

/// Pass 1. Points that are no lattice points, even on one axis and odd on another, stay outside.
std::vector<std::uint8_t> marked_inside(const brep::Triangles& surface, const Lattice& lattice,
                                        const voxel::Progress& progress) {
  std::vector<std::uint8_t> inside(lattice.index({0, 0, lattice.points.z}), 0);
  const brep::SurfaceTree tree(surface);
  tbb::parallel_for(tbb::blocked_range<int>(0, lattice.points.z), [&](const auto& range) {
    std::vector<double> passed;
    for (int z = range.begin(); z != range.end() && !progress.stop.stop_requested(); ++z)
      for (int y = z % 2; y < lattice.points.y; y += 2) {
        const glm::dvec3 start = lattice.at({0, y, z});
        passed.clear();
        for (const brep::Crossing& crossing : tree.crossings(start))
          passed.push_back(x_of(surface, crossing.face, start));
        if (passed.empty()) continue;
        std::sort(passed.begin(), passed.end());
        std::size_t behind = 0;
        for (int x = z % 2; x < lattice.points.x; x += 2) {
          const double at = lattice.at({x, y, z}).x;
          while (behind < passed.size() && passed[behind] < at) ++behind;
          inside[lattice.index({x, y, z})] = static_cast<std::uint8_t>(behind % 2);
        }
      }
  });
  return inside;
}

/// The triangles by the cubes of the lattice that their boxes meet.
class CubeLists {
 public:
  CubeLists(const brep::Triangles& surface, const Lattice& lattice)
      : surface_(surface), lattice_(lattice), cubes_((lattice.points + 1) / 2) {
    begin_.assign(number(glm::ivec3(0, 0, cubes_.z)) + 1, 0);
    each([&](std::size_t cube, std::uint32_t) { ++begin_[cube + 1]; });
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    faces_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    each([&](std::size_t cube, std::uint32_t f) { faces_[next[cube]++] = f; });
  }

  /// The share of the way from a point inside to one outside at which the last triangle is crossed.
  double cut(const LatticePoint& inside, const LatticePoint& outside) const {
    const glm::dvec3 a = lattice_.at(inside), along = lattice_.at(outside) - a;
    const LatticePoint low = glm::min(inside, outside) / 2, high = glm::max(inside, outside) / 2;
    double share = -1.0;
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
          for (std::size_t i = begin_[number({x, y, z})]; i < begin_[number({x, y, z}) + 1]; ++i)
            if (const auto found = crossing(a, along, surface_.faces[faces_[i]]))
              share = std::max(share, *found);
    // Rounding hid the crossing, so the middle of the side is used.
    return share < 0.0 ? 0.5 : share;
  }

 private:
  std::size_t number(const glm::ivec3& cube) const {
    return (static_cast<std::size_t>(cube.z) * static_cast<std::size_t>(cubes_.y) +
            static_cast<std::size_t>(cube.y)) *
               static_cast<std::size_t>(cubes_.x) +
           static_cast<std::size_t>(cube.x);
  }

  template <typename Visit>
  void each(const Visit& visit) const {
    constexpr double slack = 1e-6;
    for (std::uint32_t f = 0; f < surface_.faces.size(); ++f) {
      const auto& face = surface_.faces[f];
      std::array<glm::dvec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = (surface_.points_mm[face[k]] - lattice_.origin_mm) / (2.0 * lattice_.half_mm);
      const glm::ivec3 low(glm::floor(glm::min(p[0], glm::min(p[1], p[2])) - slack));
      const glm::ivec3 high(glm::floor(glm::max(p[0], glm::max(p[1], p[2])) + slack));
      for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
          for (int x = low.x; x <= high.x; ++x) visit(number({x, y, z}), f);
    }
  }

  std::optional<double> crossing(const glm::dvec3& a, const glm::dvec3& along,
                                 const std::array<std::uint32_t, 3>& face) const {
    const glm::dvec3& corner = surface_.points_mm[face[0]];
    const glm::dvec3 u = surface_.points_mm[face[1]] - corner, v = surface_.points_mm[face[2]] - corner;
    const glm::dvec3 h = glm::cross(along, v);
    const double det = glm::dot(u, h);
    if (det == 0.0) return std::nullopt;
    const glm::dvec3 from = a - corner, q = glm::cross(from, u);
    const double s = glm::dot(from, h) / det, r = glm::dot(along, q) / det, share = glm::dot(v, q) / det;
    constexpr double slack = 1e-9;
    if (s < -slack || r < -slack || s + r > 1.0 + slack || share < 0.0 || share > 1.0) return std::nullopt;
    return share;
  }

  const brep::Triangles& surface_;
  const Lattice& lattice_;
  glm::ivec3 cubes_;
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> faces_;
};

/// The remaining part of a lattice tetrahedron. Its nodes are listed in the order in which quadrilaterals
/// are cut: cut points of long sides, then lattice points, then cut points of short sides.
struct Node {
  std::uint64_t order = 0;
  std::uint32_t number = 0;
};
using Nodes = std::array<Node, 4>;

class Stuffing {
 public:
  Stuffing(const brep::Triangles& surface, const Lattice& lattice, const voxel::Progress& progress)
      : lattice_(lattice), progress_(progress), inside_(marked_inside(surface, lattice, progress)) {
    progress_.at(0.3);
    cut(CubeLists(surface, lattice));
    progress_.at(0.6);
    warp();
    progress_.at(0.7);
    for (int z = 0; z < lattice_.points.z; ++z) {
      progress_.at(0.7 + 0.3 * z / lattice_.points.z);
      for (int y = z % 2; y < lattice_.points.y; y += 2)
        for (int x = z % 2; x < lattice_.points.x; x += 2) add_about({x, y, z});
    }
  }

  Tetrahedra result() && { return std::move(made_); }

 private:
  /// The key of a side: the end from which its direction leaves, and the direction.
  std::uint64_t key(const LatticePoint& from, std::size_t w) const { return lattice_.index(from) * 7 + w; }
  bool is_inside(const LatticePoint& p) const { return lattice_.has(p) && inside_[lattice_.index(p)] != 0; }

  template <typename Visit>
  void each_cut_side(const Visit& visit) const {
    for (int z = 0; z < lattice_.points.z; ++z)
      for (int y = z % 2; y < lattice_.points.y; y += 2)
        for (int x = z % 2; x < lattice_.points.x; x += 2) {
          const LatticePoint from(x, y, z);
          const bool in = inside_[lattice_.index(from)] != 0;
          for (std::size_t w = 0; w < ways.size(); ++w)
            if (const LatticePoint to = from + way(w); lattice_.has(to) && in != is_inside(to))
              visit(from, to, w);
        }
  }

  /// Pass 2. Stores cut points as shares of the side, from the end that the side's key names.
  void cut(const CubeLists& triangles) {
    struct Side {
      LatticePoint from{0}, to{0};
      std::size_t w = 0;
      double share = 0.0;
    };
    std::vector<Side> sides;
    each_cut_side([&](const LatticePoint& from, const LatticePoint& to, std::size_t w) {
      sides.push_back({from, to, w, 0.0});
    });
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sides.size(), 1024), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        Side& side = sides[i];
        side.share = is_inside(side.from) ? triangles.cut(side.from, side.to)
                                          : 1.0 - triangles.cut(side.to, side.from);
      }
    });
    cuts_.reserve(sides.size());
    for (const Side& side : sides) {
      cuts_.emplace(key(side.from, side.w), Cut{side.share, none});
      // Ends of cut sides in the order of the sides, each once.
      for (const LatticePoint& end : {side.from, side.to})
        if (ends_.emplace(lattice_.index(end), end).second) end_order_.push_back(end);
    }
  }

  /// Pass 3, in the order in which the lattice points are met.
  void warp() {
    for (const LatticePoint& p : end_order_) {
      double nearest_mm = std::numeric_limits<double>::infinity();
      glm::dvec3 there(0.0);
      for (std::size_t w = 0; w < ways.size(); ++w)
        for (const bool leaves : {true, false}) {
          const LatticePoint from = leaves ? p : p - way(w), other = leaves ? p + way(w) : from;
          if (!lattice_.has(from) || warped_.count(lattice_.index(other)) != 0) continue;
          const auto found = cuts_.find(key(from, w));
          if (found == cuts_.end()) continue;
          const double share = leaves ? found->second.share : 1.0 - found->second.share;
          const glm::dvec3 along = lattice_.at(other) - lattice_.at(p);
          if (share >= too_near(w) || share * glm::length(along) >= nearest_mm) continue;
          nearest_mm = share * glm::length(along);
          there = lattice_.at(p) + share * along;
        }
      if (std::isfinite(nearest_mm)) warped_.emplace(lattice_.index(p), there);
    }
  }

  std::uint32_t new_node(const glm::dvec3& p_mm) {
    made_.nodes_mm.push_back(p_mm);
    return static_cast<std::uint32_t>(made_.nodes_mm.size() - 1);
  }

  static constexpr std::uint64_t short_cuts = std::uint64_t{1} << 62, lattice_points = std::uint64_t{1} << 61;
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  Node node_at(const LatticePoint& p) {
    const std::size_t index = lattice_.index(p);
    const auto [known, is_new] = lattice_nodes_.emplace(index, none);
    if (is_new) {
      const auto moved = warped_.find(index);
      known->second = new_node(moved == warped_.end() ? lattice_.at(p) : moved->second);
    }
    return {lattice_points + index, known->second};
  }

  Node cut_between(const LatticePoint& p, const LatticePoint& q) {
    for (std::size_t w = 0; w < ways.size(); ++w) {
      if (q - p != way(w) && p - q != way(w)) continue;
      const LatticePoint from = q - p == way(w) ? p : q;
      Cut& cut = cuts_.at(key(from, w));
      if (cut.node == none)
        cut.node = new_node(lattice_.at(from) + cut.share * lattice_.half_mm * glm::dvec3(way(w)));
      return {(w < long_ways ? 0 : short_cuts) + key(from, w), cut.node};
    }
    throw std::logic_error("isosurface stuffing: points share no side");
  }

  void add(const Nodes& n) {
    std::array<std::uint32_t, 4> tet{n[0].number, n[1].number, n[2].number, n[3].number};
    const auto& p = made_.nodes_mm;
    if (glm::dot(glm::cross(p[tet[1]] - p[tet[0]], p[tet[2]] - p[tet[0]]), p[tet[3]] - p[tet[0]]) < 0.0)
      std::swap(tet[0], tet[1]);
    made_.tets.push_back(tet);
  }

  /// A pyramid over the quadrilateral a, b, c, d.
  void add_pyramid(const Node& a, const Node& b, const Node& c, const Node& d, const Node& tip) {
    if (std::min(a.order, c.order) < std::min(b.order, d.order)) {
      add({a, b, c, tip});
      add({a, c, d, tip});
    } else {
      add({b, c, d, tip});
      add({b, d, a, tip});
    }
  }

  /// Adds a prism between the triangles a and b: divides it from its first node, over the faces that do not
  /// contain this node.
  void add_prism(std::array<Node, 3> a, std::array<Node, 3> b) {
    const auto before = [](const Node& p, const Node& q) { return p.order < q.order; };
    auto first = std::min_element(a.begin(), a.end(), before);
    if (const auto other = std::min_element(b.begin(), b.end(), before); before(*other, *first)) {
      std::swap(a, b);
      first = std::min_element(a.begin(), a.end(), before);
    }
    std::rotate(b.begin(), b.begin() + (first - a.begin()), b.end());
    std::rotate(a.begin(), first, a.end());
    add({a[0], b[0], b[1], b[2]});
    add_pyramid(a[1], a[2], b[2], b[1], a[0]);
  }

  /// Does passes 4 and 5 for a tetrahedron of the lattice.
  void add_inside_of(const std::array<LatticePoint, 4>& corners) {
    std::array<LatticePoint, 4> in{}, out{}, zero{};
    std::size_t ins = 0, outs = 0, zeros = 0;
    for (const LatticePoint& p : corners)
      if (warped_.count(lattice_.index(p)) != 0)
        zero.at(zeros++) = p;
      else if (is_inside(p))
        in.at(ins++) = p;
      else
        out.at(outs++) = p;
    if (ins == 0) return;
    if (outs == 0 || ins == 1) {
      Nodes nodes;
      std::size_t k = 0;
      for (std::size_t i = 0; i < ins; ++i) nodes.at(k++) = node_at(in.at(i));
      for (std::size_t i = 0; i < zeros; ++i) nodes.at(k++) = node_at(zero.at(i));
      for (std::size_t i = 0; i < outs; ++i) nodes.at(k++) = cut_between(in[0], out.at(i));
      add(nodes);
    } else if (ins == 2 && outs == 1) {
      add_pyramid(node_at(in[0]), node_at(in[1]), cut_between(in[1], out[0]), cut_between(in[0], out[0]),
                  node_at(zero[0]));
    } else if (ins == 2) {
      add_prism({node_at(in[0]), cut_between(in[0], out[0]), cut_between(in[0], out[1])},
                {node_at(in[1]), cut_between(in[1], out[0]), cut_between(in[1], out[1])});
    } else {
      add_prism({node_at(in[0]), node_at(in[1]), node_at(in[2])},
                {cut_between(in[0], out[0]), cut_between(in[1], out[0]), cut_between(in[2], out[0])});
    }
  }

  /// Adds the four tetrahedra about each long side that leaves a cube's corner. The other two corners of such
  /// a tetrahedron are neighbours on the square of cubes' middles about the side. Each tetrahedron has two
  /// long sides, one between corners and one between middles of cubes, so visiting only the former adds each
  /// tetrahedron once.
  void add_about(const LatticePoint& p) {
    if ((p.x & 1) != 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      LatticePoint along(0), u(0), v(0);
      along[axis] = 1;
      u[(axis + 1) % 3] = 1;
      v[(axis + 2) % 3] = 1;
      const LatticePoint q = p + 2 * along, middle = p + along;
      const std::array<LatticePoint, 4> ring{middle + u + v, middle - u + v, middle - u - v, middle + u - v};
      for (std::size_t k = 0; k < 4; ++k) {
        const std::array<LatticePoint, 4> corners{p, q, ring.at(k), ring.at((k + 1) % 4)};
        if (std::all_of(corners.begin(), corners.end(),
                        [&](const LatticePoint& c) { return lattice_.has(c); }))
          add_inside_of(corners);
      }
    }
  }

  struct Cut {
    double share = 0.0;
    std::uint32_t node = 0;
  };

  const Lattice& lattice_;
  const voxel::Progress& progress_;
  std::vector<std::uint8_t> inside_;
  std::unordered_map<std::uint64_t, Cut> cuts_;
  std::unordered_map<std::size_t, LatticePoint> ends_;
  std::vector<LatticePoint> end_order_;
  std::unordered_map<std::size_t, glm::dvec3> warped_;
  std::unordered_map<std::size_t, std::uint32_t> lattice_nodes_;
  Tetrahedra made_;
};

}  // namespace

double cell_of_elements_mm(double volume_mm3, double elements) {
  return std::cbrt(12.0 * volume_mm3 / elements);
}

Tetrahedra stuff(const brep::Triangles& surface, const StuffingOptions& options) {
  if (!(options.cell_mm > 0.0) || !std::isfinite(options.cell_mm))
    throw voxel::InvalidInput("isosurface stuffing: the cells' edge must be above 0 mm");
  if (surface.faces.empty()) throw voxel::InvalidInput("isosurface stuffing: the surface has no triangles");
  const Lattice lattice = lattice_about(surface, options.cell_mm);
  Tetrahedra made = Stuffing(surface, lattice, options.progress).result();
  made.boundary_nodes = boundary_nodes(made.tets);
  made.method = "isosurface stuffing";
  return made;
}

}  // namespace octotomy::convert

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/sharp_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "brep/mesh/segment.h"
#include "convert/tet/element_faces.h"
#include "convert/tet/split_sides.h"

// Some meshers make a new surface with nodes on the given one; its triangles then cut off sharp edges. Here
// such nodes move onto these edges, as Labelle and Shewchuk (isosurface_stuffing.h) move
// lattice nodes onto the surface.

namespace octotomy::convert {
namespace {

/// An edge is sharp if the cosine between its two triangles' normals is below this: 40 degrees.
constexpr double sharp_cosine() {
  return 0.766;
}

using Ends = std::pair<std::uint32_t, std::uint32_t>;  // the lower first

Ends ends(std::uint32_t a, std::uint32_t b) {
  return std::minmax(a, b);
}

glm::dvec3 unit_normal_of(const brep::Triangles& surface, const std::array<std::uint32_t, 3>& face) {
  const glm::dvec3& p = surface.points_mm[face[0]];
  const glm::dvec3 across = glm::cross(surface.points_mm[face[1]] - p, surface.points_mm[face[2]] - p);
  const double length = glm::length(across);
  return length > 0.0 ? across / length : glm::dvec3(0.0);
}

glm::dvec3 nearest_on(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  return a + brep::share_along(p, a, b) * (b - a);
}

using Cell = std::array<int, 3>;

Cell cell_of(const glm::dvec3& p_mm, double side_mm) {
  const glm::dvec3 cell = glm::floor(p_mm / side_mm);
  return {static_cast<int>(cell.x), static_cast<int>(cell.y), static_cast<int>(cell.z)};
}

/// Calls f(entry) for the entries of a cell and of the 26 about it.
template <typename Entry, typename F>
void for_each_near(const std::map<Cell, std::vector<Entry>>& cells, const Cell& middle, const F& f) {
  for (int n = 0; n < 27; ++n) {
    const auto found = cells.find({middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1});
    if (found == cells.end()) continue;
    for (const Entry& entry : found->second) f(entry);
  }
}

/// The area of the flat part of the surface that each triangle belongs to: triangles that share an edge
/// belong to one part if their normals agree to a degree.
std::vector<double> flat_areas_mm2(const brep::Triangles& surface, const std::vector<glm::dvec3>& normals) {
  constexpr double flat_cosine = 0.99985;
  std::vector<std::uint32_t> part(surface.faces.size());
  std::iota(part.begin(), part.end(), 0U);
  const auto part_of = [&part](std::uint32_t f) {
    while (part[f] != f) f = part[f] = part[part[f]];
    return f;
  };
  std::map<Ends, std::uint32_t> first;
  for (std::uint32_t f = 0; f < surface.faces.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [at, is_new] =
          first.emplace(ends(surface.faces[f].at(i), surface.faces[f].at((i + 1) % 3)), f);
      if (!is_new && glm::dot(normals[at->second], normals[f]) >= flat_cosine)
        part[part_of(f)] = part_of(at->second);
    }
  std::vector<double> areas(surface.faces.size(), 0.0);
  for (std::uint32_t f = 0; f < surface.faces.size(); ++f) {
    const auto& [a, b, c] = surface.faces[f];
    const auto& p = surface.points_mm;
    areas[part_of(f)] += 0.5 * glm::length(glm::cross(p[b] - p[a], p[c] - p[a]));
  }
  for (std::uint32_t f = 0; f < surface.faces.size(); ++f) areas[f] = areas[part_of(f)];
  return areas;
}

/// The sharp edges of a surface between two flat parts that are several elements large, sorted into cells of space, and the points where at least three end.
class SharpEdges {
 public:
  SharpEdges(const brep::Triangles& surface, const std::vector<glm::dvec3>& normals, double cell_mm)
      : surface_(surface), cell_mm_(cell_mm) {
    // The surfaces of bone have edges everywhere. Nodes held on these would prevent good elements.
    const double least_mm2 = 8.0 * cell_mm * cell_mm;
    const std::vector<double> areas_mm2 = flat_areas_mm2(surface, normals);
    std::map<Ends, std::uint32_t> first;
    std::map<std::uint32_t, int> edges_at;
    for (std::uint32_t f = 0; f < surface.faces.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i) {
        const Ends edge = ends(surface.faces[f].at(i), surface.faces[f].at((i + 1) % 3));
        const auto [at, is_new] = first.emplace(edge, f);
        if (is_new || glm::dot(normals[at->second], normals[f]) >= sharp_cosine() ||
            std::min(areas_mm2[at->second], areas_mm2[f]) < least_mm2)
          continue;
        add(edge);
        ++edges_at[edge.first];
        ++edges_at[edge.second];
      }
    for (const auto& [point, count] : edges_at)
      if (count >= 3) corners_mm_.push_back(surface.points_mm[point]);
  }

  const std::vector<glm::dvec3>& corners_mm() const { return corners_mm_; }

  /// The nearest point of a sharp edge within a cell's side; infinitely far where there is none.
  glm::dvec3 nearest_mm(const glm::dvec3& p_mm) const {
    glm::dvec3 best_mm(std::numeric_limits<double>::infinity());
    double least_mm = cell_mm_;
    for_each_near(edges_, cell_of(p_mm, cell_mm_), [&](const Ends& edge) {
      const glm::dvec3 at_mm =
          nearest_on(p_mm, surface_.points_mm[edge.first], surface_.points_mm[edge.second]);
      const double far_mm = glm::distance(at_mm, p_mm);
      if (far_mm >= least_mm) return;
      least_mm = far_mm;
      best_mm = at_mm;
    });
    return best_mm;
  }

 private:
  /// Adds the edge to the cells of points on it that are at most half a cell's side apart.
  void add(const Ends& edge) {
    const glm::dvec3 &a = surface_.points_mm[edge.first], &b = surface_.points_mm[edge.second];
    const int steps = std::max(1, static_cast<int>(std::ceil(2.0 * glm::distance(a, b) / cell_mm_)));
    for (int i = 0; i <= steps; ++i) {
      std::vector<Ends>& here = edges_[cell_of(a + static_cast<double>(i) / steps * (b - a), cell_mm_)];
      if (here.empty() || here.back() != edge) here.push_back(edge);
    }
  }

  const brep::Triangles& surface_;
  double cell_mm_;
  std::map<Cell, std::vector<Ends>> edges_;
  std::vector<glm::dvec3> corners_mm_;
};

class Putting {
 public:
  Putting(Tetrahedra& tetrahedra, const KeptSurface& given, double least_deg)
      : t_(tetrahedra),
        given_(given),
        least_deg_(least_deg),
        about_(elements_about(tetrahedra)),
        is_moved_(tetrahedra.nodes_mm.size(), false) {
    for (const auto& face : given.triangles.faces) normals_.push_back(unit_normal_of(given.triangles, face));
  }

  std::vector<std::uint32_t> run() {
    const std::vector<Ends> sides = surface_sides();
    double sum_mm = 0.0;
    for (const auto& [a, b] : sides) sum_mm += glm::distance(t_.nodes_mm[a], t_.nodes_mm[b]);
    const double side_mm = sum_mm / static_cast<double>(sides.size());
    const SharpEdges edges(given_.triangles, normals_, side_mm);
    put_on_corners(edges, side_mm);
    // The second round moves nodes that an element kept in place in the first round and that may move after
    // the element has changed.
    constexpr int rounds = 2;
    for (int round = 0; round < rounds; ++round) put_on_edges(edges, sides);
    // A split leaves two sides that may still cut the edge off, and its node makes further notches to fill.
    constexpr int most_splits = 4;
    fill_at_edges(edges, side_mm);
    for (int round = 0; round < most_splits && split_at_edges(edges, side_mm); ++round)
      fill_at_edges(edges, side_mm);
    std::sort(moved_.begin(), moved_.end());
    return moved_;
  }

 private:
  double least_angle_deg(std::uint32_t v) const {
    Tetrahedra star;
    for (const std::uint32_t t : about_[v]) {
      const TetCorners p = corners_mm(t_, t);
      if (!(six_volumes(p) > 0.0)) return -1.0;
      const auto first = static_cast<std::uint32_t>(star.nodes_mm.size());
      star.nodes_mm.insert(star.nodes_mm.end(), p.begin(), p.end());
      star.tets.push_back({first, first + 1, first + 2, first + 3});
    }
    return quality(star).min_dihedral_deg;
  }

  bool put(std::uint32_t v, const glm::dvec3& at_mm) {
    const double before_deg = least_angle_deg(v);
    const glm::dvec3 before_mm = t_.nodes_mm[v];
    t_.nodes_mm[v] = at_mm;
    if (least_angle_deg(v) >= std::min(before_deg, least_deg_)) {
      moved_.push_back(v);
      is_moved_[v] = true;
      return true;
    }
    t_.nodes_mm[v] = before_mm;
    return false;
  }

  void put_on_corners(const SharpEdges& edges, double side_mm) {
    constexpr double near_share = 0.7;
    std::map<Cell, std::vector<std::uint32_t>> nodes;
    for (const std::uint32_t v : t_.boundary_nodes) nodes[cell_of(t_.nodes_mm[v], side_mm)].push_back(v);
    for (const glm::dvec3& corner_mm : edges.corners_mm()) {
      double least_mm = near_share * side_mm;
      std::optional<std::uint32_t> nearest;
      for_each_near(nodes, cell_of(corner_mm, side_mm), [&](std::uint32_t v) {
        const double far_mm = glm::distance(t_.nodes_mm[v], corner_mm);
        if (far_mm >= least_mm || is_moved_[v]) return;
        least_mm = far_mm;
        nearest = v;
      });
      if (nearest) put(*nearest, corner_mm);
    }
  }

  void put_on_edges(const SharpEdges& edges, const std::vector<Ends>& sides) {
    std::vector<glm::dvec3> points_mm;
    for (const std::uint32_t v : t_.boundary_nodes) points_mm.push_back(t_.nodes_mm[v]);
    const std::vector<brep::Foot> feet = given_.tree.feet(points_mm);
    std::vector<glm::dvec3> normal(t_.nodes_mm.size(), glm::dvec3(0.0));
    for (std::size_t i = 0; i < feet.size(); ++i) normal[t_.boundary_nodes[i]] = normals_[feet[i].face];
    for (const auto& [a, b] : sides) {
      if (is_moved_[a] || is_moved_[b] || glm::dot(normal[a], normal[b]) >= sharp_cosine()) continue;
      std::array<std::uint32_t, 2> order{a, b};
      std::array<glm::dvec3, 2> to_mm{edges.nearest_mm(t_.nodes_mm[a]), edges.nearest_mm(t_.nodes_mm[b])};
      if (glm::distance(to_mm[1], t_.nodes_mm[b]) < glm::distance(to_mm[0], t_.nodes_mm[a])) {
        std::swap(order[0], order[1]);
        std::swap(to_mm[0], to_mm[1]);
      }
      for (std::size_t i = 0; i < 2; ++i)
        if (std::isfinite(to_mm.at(i).x) && put(order.at(i), to_mm.at(i))) break;
    }
  }

  bool are_joined(std::uint32_t a, std::uint32_t b) const {
    return std::any_of(about_[a].begin(), about_[a].end(), [&](std::uint32_t t) {
      return std::find(t_.tets[t].begin(), t_.tets[t].end(), b) != t_.tets[t].end();
    });
  }

  /// Fills notches with an element each: where a side of the surface cuts an edge off, and the two triangles at
  /// the side have their third nodes on that edge.
  void fill_at_edges(const SharpEdges& edges, double side_mm) {
    const auto is_on_edge = [&](const glm::dvec3& p_mm) {
      return glm::distance(edges.nearest_mm(p_mm), p_mm) <= 1e-6 * side_mm;
    };
    const brep::Triangles surface = surface_of(t_);
    about_ = elements_about(t_);
    std::map<Ends, std::vector<std::pair<std::uint32_t, std::uint32_t>>> at_side;  // face, and its other node
    for (std::uint32_t f = 0; f < surface.faces.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& face = surface.faces[f];
        if (is_on_edge(t_.nodes_mm[face.at((i + 2) % 3)]))
          at_side[ends(face.at(i), face.at((i + 1) % 3))].emplace_back(f, face.at((i + 2) % 3));
      }
    std::vector<bool> is_covered(surface.faces.size(), false);
    for (const auto& [side, faces] : at_side) {
      if (faces.size() != 2) continue;
      const auto& [f, p] = faces[0];
      const auto& [g, q] = faces[1];
      if (is_covered[f] || is_covered[g] || are_joined(p, q) ||
          !is_on_edge(0.5 * (t_.nodes_mm[p] + t_.nodes_mm[q])))
        continue;
      // Faces run counter-clockwise seen from outside, where the notch is.
      const auto& [a, b, c] = surface.faces[f];
      const auto& at = t_.nodes_mm;
      if (!is_fit({at[a], at[b], at[c], at[q]}, least_deg_)) continue;
      const auto made = static_cast<std::uint32_t>(t_.tets.size());
      t_.tets.push_back({a, b, c, q});
      for (const std::uint32_t v : t_.tets[made]) about_[v].push_back(made);
      is_covered[f] = is_covered[g] = true;
    }
  }

  /// Splits the sides of the surface that still cut an edge off, with a node on the edge; true if any.
  bool split_at_edges(const SharpEdges& edges, double side_mm) {
    constexpr double least_off = 0.05;  // of the side's length: chords of a smooth surface stay
    std::vector<Ends> sides;
    std::vector<glm::dvec3> middles_mm, edge_mm;
    for (const Ends& side : surface_sides()) {
      const glm::dvec3 middle_mm = 0.5 * (t_.nodes_mm[side.first] + t_.nodes_mm[side.second]);
      const glm::dvec3 at_mm = edges.nearest_mm(middle_mm);
      if (!(glm::distance(at_mm, middle_mm) <= side_mm)) continue;
      sides.push_back(side);
      middles_mm.push_back(middle_mm);
      edge_mm.push_back(at_mm);
    }
    const std::vector<double> off_mm = given_.tree.distances_mm(middles_mm);
    SideSplitter splitter(t_, least_deg_);
    const std::size_t before = moved_.size();
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const auto [a, b] = sides[i];
      if (off_mm[i] <= least_off * glm::distance(t_.nodes_mm[a], t_.nodes_mm[b]) ||
          !splitter.split(a, b, edge_mm[i]))
        continue;
      const auto made = static_cast<std::uint32_t>(t_.nodes_mm.size() - 1);
      t_.boundary_nodes.push_back(made);
      moved_.push_back(made);
    }
    return moved_.size() > before;
  }

  std::vector<Ends> surface_sides() const {
    std::vector<Ends> sides;
    for (const auto& [a, b, c] : surface_of(t_).faces)
      for (const Ends& side : {ends(a, b), ends(b, c), ends(c, a)}) sides.push_back(side);
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    return sides;
  }

  Tetrahedra& t_;
  const KeptSurface& given_;
  double least_deg_;
  std::vector<std::vector<std::uint32_t>> about_;
  std::vector<glm::dvec3> normals_;  ///< of the given triangles
  std::vector<std::uint32_t> moved_;
  std::vector<bool> is_moved_;
};

}  // namespace

std::vector<std::uint32_t> put_on_sharp_edges(Tetrahedra& tetrahedra, const KeptSurface& given,
                                              double least_deg) {
  return Putting(tetrahedra, given, least_deg).run();
}

}  // namespace octotomy::convert

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/flat_interfaces.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "convert/tet/element_faces.h"
#include "convert/tet/split_sides.h"
#include "voxel/space/rounded.h"

namespace octotomy::convert {

InterfacePlane fitted_plane(const std::vector<glm::dvec3>& points_mm, InterfacePlane plane, double near_mm) {
  constexpr int rounds = 5;
  for (int round = 0; round < rounds; ++round) {
    glm::dvec3 middle_mm(0.0);
    double count = 0.0;
    const auto visit_near = [&](const auto& visit) {
      for (const glm::dvec3& p_mm : points_mm)
        if (std::abs(plane.away_mm(p_mm)) <= near_mm) visit(p_mm);
    };
    visit_near([&](const glm::dvec3& p_mm) {
      middle_mm += p_mm;
      count += 1.0;
    });
    if (count == 0.0) return plane;
    middle_mm /= count;
    // The slopes along two directions of the plane solve a system of two equations.
    const glm::dvec3 other = std::abs(plane.normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(plane.normal, other)), w = glm::cross(plane.normal, u);
    glm::dmat2 squares(0.0);
    glm::dvec2 products(0.0);
    visit_near([&](const glm::dvec3& p_mm) {
      const glm::dvec3 arm = p_mm - middle_mm;
      const glm::dvec2 at(glm::dot(arm, u), glm::dot(arm, w));
      squares += glm::outerProduct(at, at);
      products += glm::dot(arm, plane.normal) * at;
    });
    plane.on_mm = middle_mm;
    const double determinant = glm::determinant(squares);
    if (!(determinant > 0.0)) return plane;
    const glm::dvec2 slopes = glm::inverse(squares) * products;
    plane.normal = glm::normalize(plane.normal - slopes.x * u - slopes.y * w);
  }
  return plane;
}

const LabelPlane* plane_between(const std::vector<LabelPlane>& planes, std::uint8_t one, std::uint8_t other) {
  const auto [low, high] = std::minmax(one, other);
  const auto found =
      std::find_if(planes.begin(), planes.end(),
                   [low = low, high = high](const LabelPlane& p) { return p.low == low && p.high == high; });
  return found == planes.end() ? nullptr : &*found;
}

namespace {

std::vector<std::uint32_t> nodes_of(const Tetrahedra& made, const Interface& between) {
  std::vector<std::uint32_t> nodes;
  for (const ElementFace& face : between.faces)
    for (const std::uint32_t v : corners_of(made, face)) nodes.push_back(v);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

const LabelPlane* plane_of(const std::vector<LabelPlane>& planes, const Interface& between) {
  return plane_between(planes, static_cast<std::uint8_t>(between.from + 1),
                       static_cast<std::uint8_t>(between.to + 1));
}

/// For each node: 1 if an element of the plane's lower region has it, 2 if one of the higher region has it, 3
/// if both, 0 if neither.
std::vector<std::uint8_t> touched(const Tetrahedra& made, const LabelPlane& plane) {
  std::vector<std::uint8_t> touches(made.nodes_mm.size(), 0);
  for (std::size_t t = 0; t < made.tets.size(); ++t) {
    const std::uint64_t label = made.region_of_tet[t] + 1;
    if (label != plane.low && label != plane.high) continue;
    for (const std::uint32_t v : made.tets[t]) touches[v] |= label == plane.low ? 1 : 2;
  }
  return touches;
}

/// The elements of the plane's regions that have a node which both regions have.
std::vector<std::uint32_t> elements_at(const Tetrahedra& made, const LabelPlane& plane) {
  const std::vector<std::uint8_t> touches = touched(made, plane);
  std::vector<std::uint32_t> at;
  for (std::uint32_t t = 0; t < made.tets.size(); ++t) {
    const std::uint64_t label = made.region_of_tet[t] + 1;
    if ((label == plane.low || label == plane.high) &&
        std::any_of(made.tets[t].begin(), made.tets[t].end(),
                    [&](std::uint32_t v) { return touches[v] == 3; }))
      at.push_back(t);
  }
  return at;
}

std::optional<InterfacePlane> plane_of_most(const Tetrahedra& made, const Interface& between,
                                            const std::vector<std::uint32_t>& nodes, double near_mm) {
  constexpr std::size_t most_tried = 200;
  constexpr double least_share = 0.6;
  std::optional<InterfacePlane> best;
  std::size_t most = 0;
  const std::size_t step = std::max<std::size_t>(1, between.faces.size() / most_tried);
  for (std::size_t f = 0; f < between.faces.size(); f += step) {
    const auto [a, b, c] = corners_of(made, between.faces[f]);
    const glm::dvec3& p_mm = made.nodes_mm[a];
    const glm::dvec3 across = glm::cross(made.nodes_mm[b] - p_mm, made.nodes_mm[c] - p_mm);
    if (!(glm::length(across) > 0.0)) continue;
    const InterfacePlane plane{p_mm, glm::normalize(across)};
    const auto count =
        static_cast<std::size_t>(std::count_if(nodes.begin(), nodes.end(), [&](std::uint32_t v) {
          return std::abs(plane.away_mm(made.nodes_mm[v])) <= near_mm;
        }));
    if (count <= most) continue;
    most = count;
    best = plane;
  }
  if (static_cast<double>(most) < least_share * static_cast<double>(nodes.size())) return std::nullopt;
  std::vector<glm::dvec3> points_mm;
  for (const std::uint32_t v : nodes) points_mm.push_back(made.nodes_mm[v]);
  return fitted_plane(points_mm, *best, near_mm);
}

}  // namespace

void divide_by_planes(Tetrahedra& made, const std::vector<LabelPlane>& planes) {
  for (const LabelPlane& plane : planes)
    for (const std::uint32_t t : elements_at(made, plane)) {
      const TetCorners p = corners_mm(made, t);
      const double away_mm = plane.away_mm(0.25 * (p[0] + p[1] + p[2] + p[3]));
      made.region_of_tet[t] = static_cast<std::uint32_t>((away_mm < 0.0 ? plane.low : plane.high) - 1);
    }
}

void flatten_interfaces(Tetrahedra& made, const FlatInterfaceOptions& options) {
  const double near_mm = 0.05 * options.voxel_mm;  // five times the mesher's accuracy for these surfaces
  const double far_mm = 0.75 * options.size_mm;
  const std::vector<std::vector<std::uint32_t>> about = elements_about(made);
  for (const Interface& between : interfaces(made)) {
    const std::vector<std::uint32_t> nodes = nodes_of(made, between);
    std::optional<InterfacePlane> plane;
    if (const LabelPlane* known = plane_of(options.planes, between))
      plane = *known;
    else
      plane = plane_of_most(made, between, nodes, near_mm);
    if (!plane) continue;
    for (const std::uint32_t v : nodes) {
      const double away_mm = plane->away_mm(made.nodes_mm[v]);
      if (std::abs(away_mm) > far_mm) continue;
      const glm::dvec3 before_mm = made.nodes_mm[v];
      made.nodes_mm[v] -= away_mm * plane->normal;
      const bool is_unfit = std::any_of(about[v].begin(), about[v].end(), [&](std::uint32_t t) {
        return !is_fit(corners_mm(made, t), options.least_deg);
      });
      if (is_unfit) made.nodes_mm[v] = before_mm;
    }
  }
}

std::size_t split_at_planes(Tetrahedra& made, const FlatInterfaceOptions& options) {
  // Nodes that were put on a plane are off it by rounding alone.
  const double rounding_mm = 1e-6 * options.voxel_mm;
  const std::size_t before = made.nodes_mm.size();
  SideSplitter splitter(made, options.least_deg);
  for (const LabelPlane& plane : options.planes) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (const std::uint32_t t : elements_at(made, plane))
      for (const auto& [k, l] : sides_of_tet) {
        const auto [a, b] = std::minmax(made.tets[t][k], made.tets[t][l]);
        const double a_mm = plane.away_mm(made.nodes_mm[a]), b_mm = plane.away_mm(made.nodes_mm[b]);
        if (std::min(a_mm, b_mm) < -rounding_mm && std::max(a_mm, b_mm) > rounding_mm)
          sides.emplace_back(a, b);
      }
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    for (const auto& [a, b] : sides) {
      const glm::dvec3 &p = made.nodes_mm[a], &q = made.nodes_mm[b];
      const double p_mm = plane.away_mm(p), q_mm = plane.away_mm(q);
      const glm::dvec3 at_mm = p + p_mm / (p_mm - q_mm) * (q - p);
      splitter.split(a, b, at_mm);
    }
  }
  divide_by_planes(made, options.planes);
  made.boundary_nodes = boundary_nodes(made.tets);
  return made.nodes_mm.size() - before;
}

std::vector<std::string> bumps(const Tetrahedra& made, const FlatInterfaceOptions& options) {
  constexpr double least_share = 0.02;  // of a voxel
  std::vector<std::string> findings;
  for (const Interface& between : interfaces(made)) {
    const LabelPlane* plane = plane_of(options.planes, between);
    if (plane == nullptr) continue;
    const std::vector<std::uint32_t> nodes = nodes_of(made, between);
    std::size_t off = 0;
    double most_mm = 0.0;
    for (const std::uint32_t v : nodes) {
      const double away_mm = std::abs(plane->away_mm(made.nodes_mm[v]));
      if (away_mm > least_share * options.voxel_mm) ++off;
      most_mm = std::max(most_mm, away_mm);
    }
    if (off > 0)
      findings.push_back("the interface of regions " + std::to_string(between.from + 1) + " and " +
                         std::to_string(between.to + 1) + " is flat, but " + std::to_string(off) +
                         " of its " + std::to_string(nodes.size()) + " nodes stay off its plane, by up to " +
                         voxel::rounded(most_mm) +
                         " mm: surfaces in contact interlock there; take another size of elements");
  }
  return findings;
}

}  // namespace octotomy::convert

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/tetrahedra.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <tbb/parallel_sort.h>

namespace octotomy::convert {
namespace {

struct TetMeasures {
  double volume = 0.0;
  double min_dihedral = 0.0;  ///< radians
  double max_dihedral = 0.0;
  double radius_edge = 0.0;
};

TetMeasures measures_of(const TetCorners& p) {
  TetMeasures m;
  const double six = six_volumes(p);
  m.volume = six / 6.0;

  m.min_dihedral = std::numbers::pi;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const std::size_t k = i == 0 ? (j == 1 ? 2 : 1) : 0;
      const std::size_t l = 6 - i - j - k;
      const glm::dvec3 edge = p.at(j) - p.at(i);
      // The angle between the two faces at the edge equals that between their normals.
      const glm::dvec3 one = glm::cross(edge, p.at(k) - p.at(i));
      const glm::dvec3 other = glm::cross(edge, p.at(l) - p.at(i));
      const double angle = std::atan2(glm::length(glm::cross(one, other)), glm::dot(one, other));
      m.min_dihedral = std::min(m.min_dihedral, angle);
      m.max_dihedral = std::max(m.max_dihedral, angle);
      shortest = std::min(shortest, glm::length(edge));
    }

  const glm::dvec3 a = p[1] - p[0];
  const glm::dvec3 b = p[2] - p[0];
  const glm::dvec3 c = p[3] - p[0];
  const glm::dvec3 numerator = glm::dot(a, a) * glm::cross(b, c) + glm::dot(b, b) * glm::cross(c, a) +
                               glm::dot(c, c) * glm::cross(a, b);
  m.radius_edge = glm::length(numerator) / (2.0 * std::abs(six)) / shortest;
  return m;
}

}  // namespace

std::uint32_t region_of(const Tetrahedra& tetrahedra, std::size_t tet) {
  return tetrahedra.region_of_tet.empty() ? 0 : tetrahedra.region_of_tet[tet];
}

TetCorners corners_mm(const Tetrahedra& tetrahedra, std::size_t tet) {
  TetCorners corners;
  for (std::size_t i = 0; i < 4; ++i) corners.at(i) = tetrahedra.nodes_mm.at(tetrahedra.tets.at(tet).at(i));
  return corners;
}

double six_volumes(const TetCorners& corners_mm) {
  const auto& [a, b, c, d] = corners_mm;
  return glm::dot(glm::cross(b - a, c - a), d - a);
}

TetQuality quality(const Tetrahedra& tetrahedra) {
  if (tetrahedra.tets.empty()) throw std::invalid_argument("without tetrahedra there is no quality");
  TetQuality q;
  q.min_volume_mm3 = std::numeric_limits<double>::infinity();
  q.min_dihedral_deg = 180.0;
  for (std::size_t tet = 0; tet < tetrahedra.tets.size(); ++tet) {
    const TetMeasures m = measures_of(corners_mm(tetrahedra, tet));
    q.volume_mm3 += m.volume;
    q.min_volume_mm3 = std::min(q.min_volume_mm3, m.volume);
    q.min_dihedral_deg = std::min(q.min_dihedral_deg, glm::degrees(m.min_dihedral));
    q.max_dihedral_deg = std::max(q.max_dihedral_deg, glm::degrees(m.max_dihedral));
    q.max_radius_edge = std::max(q.max_radius_edge, m.radius_edge);
    const auto step =
        std::upper_bound(dihedral_steps_deg.begin(), dihedral_steps_deg.end(), glm::degrees(m.min_dihedral));
    ++q.by_dihedral.at(static_cast<std::size_t>(step - dihedral_steps_deg.begin()));
  }
  return q;
}

std::vector<std::uint32_t> boundary_nodes(const std::vector<std::array<std::uint32_t, 4>>& tets) {
  std::vector<std::array<std::uint32_t, 3>> faces;
  faces.reserve(4 * tets.size());
  for (const auto& [a, b, c, d] : tets)
    for (std::array<std::uint32_t, 3> face : {std::array{a, b, c}, {a, b, d}, {a, c, d}, {b, c, d}}) {
      std::sort(face.begin(), face.end());
      faces.push_back(face);
    }
  tbb::parallel_sort(faces.begin(), faces.end());
  std::vector<std::uint32_t> nodes;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end] == faces[i]) ++end;
    if (end == i + 1) nodes.insert(nodes.end(), faces[i].begin(), faces[i].end());
    i = end;
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace octotomy::convert

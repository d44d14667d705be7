// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "brep/mesh/triangles.h"
#include "tests/brep/shapes.h"

// Closed surfaces with known volumes, and an independent test of closedness.

namespace octotomy::tests {

using brep::shapes::inside_out;
using brep::shapes::together;

/// The reason why the triangles are no closed oriented manifold surface: the first edge that has not exactly
/// one triangle in each direction, or the first triangle that repeats a point. None if they are one.
inline std::optional<std::string> fault_in_closedness(const brep::Triangles& triangles) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * triangles.faces.size());
  for (const auto& face : triangles.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      if (face[i] == face[(i + 1) % 3]) return "a triangle repeats point " + std::to_string(face[i]);
      edges.emplace_back(face[i], face[(i + 1) % 3]);
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const std::string name = std::to_string(edges[i].first) + " -> " + std::to_string(edges[i].second);
    if (i > 0 && edges[i] == edges[i - 1]) return "edge " + name + " is used twice";
    if (!std::binary_search(edges.begin(), edges.end(), std::pair{edges[i].second, edges[i].first}))
      return "edge " + name + " has no opposite";
  }
  return std::nullopt;
}

inline double volume_mm3(const brep::Triangles& t) {
  double six = 0.0;
  for (const auto& [a, b, c] : t.faces)
    six += glm::dot(glm::cross(t.points_mm[a], t.points_mm[b]), t.points_mm[c]);
  return six / 6.0;
}

inline double area_mm2(const brep::Triangles& t) {
  double twice = 0.0;
  for (const auto& [a, b, c] : t.faces)
    twice += glm::length(glm::cross(t.points_mm[b] - t.points_mm[a], t.points_mm[c] - t.points_mm[a]));
  return twice / 2.0;
}

inline brep::Triangles box(const glm::dvec3& low, const glm::dvec3& high) {
  brep::Triangles t;
  for (int corner = 0; corner < 8; ++corner)
    t.points_mm.push_back(
        {(corner & 1) ? high.x : low.x, (corner & 2) ? high.y : low.y, (corner & 4) ? high.z : low.z});
  t.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
             {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return t;
}

inline brep::Triangles octahedron(const glm::dvec3& centre, double radius) {
  brep::Triangles t;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      glm::dvec3 p = centre;
      p[axis] += sign * radius;
      t.points_mm.push_back(p);
    }
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    const std::uint32_t x = octant & 1;
    const std::uint32_t y = 2 + ((octant >> 1) & 1);
    const std::uint32_t z = 4 + (octant >> 2);
    const bool even = (x + y + z) % 2 == 1;
    t.faces.push_back(even ? std::array{x, y, z} : std::array{x, z, y});
  }
  return t;
}

/// An octahedron whose triangles are split in four `levels` times, its points on the sphere.
inline brep::Triangles ball(const glm::dvec3& centre, double radius, int levels) {
  brep::Triangles t = octahedron(glm::dvec3(0.0), 1.0);
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                    static_cast<std::uint32_t>(t.points_mm.size()));
      if (is_new) t.points_mm.push_back(glm::normalize(t.points_mm[a] + t.points_mm[b]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> split;
    for (const auto& [a, b, c] : t.faces) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      split.insert(split.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    t.faces = split;
  }
  for (glm::dvec3& p : t.points_mm) p = centre + radius * p;
  return t;
}

}  // namespace octotomy::tests

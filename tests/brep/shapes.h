// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <numbers>

#include "brep/mesh/triangles.h"

namespace octotomy::brep::shapes {

/// The box between two corners: 12 triangles.
inline Triangles box(const glm::dvec3& low, const glm::dvec3& high) {
  Triangles t;
  for (int corner = 0; corner < 8; ++corner)
    t.points_mm.emplace_back(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                             corner & 4 ? high.z : low.z);
  t.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
             {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return t;
}

/// An icosahedron, each triangle split into four `splits` times, with its points on the sphere.
inline Triangles sphere(const glm::dvec3& centre, double radius, int splits) {
  const double g = std::numbers::phi;
  Triangles t;
  t.points_mm = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  t.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int s = 0; s < splits; ++s) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                       static_cast<std::uint32_t>(t.points_mm.size()));
      if (is_new) t.points_mm.push_back(glm::normalize(t.points_mm[a]) + glm::normalize(t.points_mm[b]));
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& f : t.faces) {
      const std::uint32_t a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], a, c}, {f[1], b, a}, {f[2], c, b}, {a, b, c}});
    }
    t.faces = finer;
  }
  for (glm::dvec3& p : t.points_mm) p = centre + radius * glm::normalize(p);
  return t;
}

/// A ring about the z axis, and its tube, by their radii.
inline Triangles torus(double ring, double tube, int around, int across) {
  Triangles t;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = ring + tube * std::cos(v);
      t.points_mm.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i % around * across + j % across); };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      t.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      t.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return t;
}

/// Both surfaces in one list.
inline Triangles together(Triangles a, const Triangles& b) {
  const auto shift = static_cast<std::uint32_t>(a.points_mm.size());
  a.points_mm.insert(a.points_mm.end(), b.points_mm.begin(), b.points_mm.end());
  for (const auto& f : b.faces) a.faces.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
  return a;
}

inline Triangles inside_out(Triangles t) {
  for (auto& f : t.faces) std::swap(f[1], f[2]);
  return t;
}

}  // namespace octotomy::brep::shapes

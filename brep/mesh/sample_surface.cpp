// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/sample_surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

namespace octotomy::brep {

SurfaceSamples sample_surface(const Mesh& mesh, double spacing_mm) {
  return sample_surface(triangles_of(mesh), spacing_mm);
}

SurfaceSamples sample_surface(const Triangles& triangles, double spacing_mm) {
  if (!(spacing_mm > 0.0))
    throw std::invalid_argument("sample_surface: the spacing must be positive, it is " +
                                std::to_string(spacing_mm) + " mm");
  SurfaceSamples samples;
  for (const auto& face : triangles.faces) {
    const glm::dvec3 a = triangles.points_mm[face[0]], ab = triangles.points_mm[face[1]] - a,
                     ac = triangles.points_mm[face[2]] - a;
    const double longest = std::max({glm::length(ab), glm::length(ac), glm::length(ac - ab)});
    const double parts = std::max(1.0, std::ceil(longest / spacing_mm));
    // A centre lies two thirds of a median from the furthest corner, and no median is longer than a side.
    samples.reach_mm = std::max(samples.reach_mm, 2.0 / 3.0 * longest / parts);
    const glm::dvec3 normal = glm::cross(ab, ac);
    const double twice = glm::length(normal);
    if (twice == 0.0) continue;
    assert(parts >= 1.0 && parts < 1e6);
    const auto n = static_cast<int>(parts);
    const auto add = [&](double u, double v) {
      samples.points_mm.push_back(a + (u / parts) * ab + (v / parts) * ac);
      samples.normals.push_back(normal / twice);
      samples.areas_mm2.push_back(0.5 * twice / (parts * parts));
    };
    for (int v = 0; v < n; ++v)
      for (int u = 0; u + v < n; ++u) {
        add(u + 1.0 / 3.0, v + 1.0 / 3.0);
        if (u + v + 1 < n) add(u + 2.0 / 3.0, v + 2.0 / 3.0);
      }
  }
  return samples;
}

}  // namespace octotomy::brep

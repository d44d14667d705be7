// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/sample_surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

constexpr double most_samples = 1 << 26;

}  // namespace

SurfaceSamples sample_surface(const Mesh& mesh, double spacing_mm) {
  return sample_surface(triangles_of(mesh), spacing_mm);
}

SurfaceSamples sample_surface(const Triangles& triangles, double spacing_mm) {
  if (!(spacing_mm > 0.0))
    throw std::invalid_argument("sample_surface: the spacing must be positive, it is " +
                                std::to_string(spacing_mm) + " mm");
  struct Split {
    glm::dvec3 a, ab, ac;
    double longest_mm, parts;
    glm::dvec3 normal;  ///< twice the triangle's area long
  };
  const auto split_of = [&](std::size_t f) {
    const auto& face = triangles.faces[f];
    const glm::dvec3 a = triangles.points_mm[face[0]], ab = triangles.points_mm[face[1]] - a,
                     ac = triangles.points_mm[face[2]] - a;
    const double longest_mm = std::max({glm::length(ab), glm::length(ac), glm::length(ac - ab)});
    const double parts = std::max(1.0, std::ceil(longest_mm / spacing_mm));
    return Split{a, ab, ac, longest_mm, parts, glm::cross(ab, ac)};
  };
  SurfaceSamples samples;
  std::vector<std::size_t> first(triangles.faces.size() + 1, 0);
  double count = 0.0;
  for (std::size_t f = 0; f < triangles.faces.size(); ++f) {
    const Split split = split_of(f);
    // A centre lies two thirds of a median from the furthest corner, and no median is longer than a side.
    samples.reach_mm = std::max(samples.reach_mm, 2.0 / 3.0 * split.longest_mm / split.parts);
    const double own = glm::length(split.normal) == 0.0 ? 0.0 : split.parts * split.parts;
    count += own;
    if (!(count <= most_samples))
      throw Error(ErrorCode::Resource,
                  "samples " + short_text(spacing_mm) + " mm apart are too many: the triangle at (" +
                      short_text(split.a.x) + ", " + short_text(split.a.y) + ", " + short_text(split.a.z) +
                      ") mm, which is " + short_text(split.longest_mm) +
                      " mm long, brings them over 2^26; take them further apart or mend the triangle");
    first[f + 1] = first[f] + static_cast<std::size_t>(own);
  }
  samples.points_mm.resize(first.back());
  samples.normals.resize(first.back());
  samples.areas_mm2.resize(first.back());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.faces.size(), 4096), [&](const auto& range) {
    for (std::size_t f = range.begin(); f != range.end(); ++f) {
      if (first[f] == first[f + 1]) continue;
      const Split split = split_of(f);
      const double twice_mm2 = glm::length(split.normal);
      std::size_t i = first[f];
      const auto add = [&](double u, double v) {
        samples.points_mm[i] = split.a + (u / split.parts) * split.ab + (v / split.parts) * split.ac;
        samples.normals[i] = split.normal / twice_mm2;
        samples.areas_mm2[i++] = 0.5 * twice_mm2 / (split.parts * split.parts);
      };
      const auto n = static_cast<int>(split.parts);
      for (int v = 0; v < n; ++v)
        for (int u = 0; u + v < n; ++u) {
          add(u + 1.0 / 3.0, v + 1.0 / 3.0);
          if (u + v + 1 < n) add(u + 2.0 / 3.0, v + 2.0 / 3.0);
        }
      assert(i == first[f + 1]);
    }
  });
  return samples;
}

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/sample_surface.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t most_of_all = std::size_t{1} << 26;

/// A triangle split into parts^2 equal ones, each sampled at its centre.
struct Grid {
  glm::dvec3 a, ab, ac;
  double area_mm2, parts;

  double count() const { return parts * parts; }

  /// Calls `add` with each part's centre and area.
  template <class Add>
  void each(const Add& add) const {
    const auto n = static_cast<int>(parts);
    const auto add_at = [&](double u, double v) {
      add(a + (u / parts) * ab + (v / parts) * ac, area_mm2 / (parts * parts));
    };
    for (int v = 0; v < n; ++v)
      for (int u = 0; u + v < n; ++u) {
        add_at(u + 1.0 / 3.0, v + 1.0 / 3.0);
        if (u + v + 1 < n) add_at(u + 2.0 / 3.0, v + 2.0 / 3.0);
      }
  }
};

/// A triangle with a short side from `foot`, cut by parallels to that side and by rays from `tip`. The sides
/// of a cell are at most half the spacing long, so its diameter is at most the spacing.
struct Wedge {
  glm::dvec3 tip, foot, across;    ///< across: the short side, from the foot
  double area_mm2, strips, cells;  ///< cells: number of cells in the strip at the short side, furthest from
                                   ///< the tip

  double cells_at(double share) const { return std::max(1.0, std::ceil(share * cells)); }

  /// The number of cells; infinite if it certainly exceeds `most`.
  double count(double most) const {
    if (area_mm2 == 0.0) return 0.0;
    if (!(strips * std::max(1.0, cells / 2.0) <= most)) return INFINITY;
    double sum = 0.0;
    for (double i = 1.0; i <= strips; ++i) sum += cells_at(i / strips);
    return sum;
  }

  /// Calls `add` with each cell's centre of gravity and area.
  template <class Add>
  void each(const Add& add) const {
    if (area_mm2 == 0.0) return;
    for (double i = 1.0; i <= strips; ++i) {
      const double near = (i - 1.0) / strips, far = i / strips, n = cells_at(far);
      const double centre = 2.0 / 3.0 * (near * near + near * far + far * far) / (near + far);
      const double own_mm2 = (far * far - near * near) / n * area_mm2;
      for (double j = 0.5; j < n; ++j) add(tip + centre * (foot - tip + (j / n) * across), own_mm2);
    }
  }
};

/// The two halves of the triangle on both sides of the height over its longest side; their areas add up to
/// `area_mm2`.
std::array<Wedge, 2> wedges_of(const std::array<glm::dvec3, 3>& corners, double area_mm2, double spacing_mm) {
  const auto side_mm = [&](std::size_t k) { return glm::distance(corners[k], corners[(k + 1) % 3]); };
  std::size_t longest = 0;
  for (const std::size_t k : {1u, 2u})
    if (side_mm(k) > side_mm(longest)) longest = k;
  const glm::dvec3 a = corners[longest], b = corners[(longest + 1) % 3], top = corners[(longest + 2) % 3];
  const double share = std::clamp(glm::dot(top - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
  const glm::dvec3 foot = a + share * (b - a);
  const auto half = [&](const glm::dvec3& end, double own_mm2) {
    const bool flat = glm::distance(end, foot) >= glm::distance(top, foot);
    const glm::dvec3 tip = flat ? end : top, across = (flat ? top : end) - foot;
    const double strips = std::max(1.0, std::ceil(2.0 * glm::distance(end, top) / spacing_mm));
    return Wedge{tip, foot, across, own_mm2, strips, std::ceil(2.0 * glm::length(across) / spacing_mm)};
  };
  return {half(a, share * area_mm2), half(b, (1.0 - share) * area_mm2)};
}

/// The subdivision by which a triangle is sampled.
struct Split {
  Grid grid;
  std::array<Wedge, 2> wedges;
  glm::dvec3 normal;  ///< normal whose length is twice the triangle's area
  double longest_mm, count;
  bool sliver = false;  ///< divided into wedges instead of a grid

  /// Upper bound on the distance of a point of the triangle from a sample: in a convex piece no point is
  /// further from the centre of gravity than two thirds of the piece's diameter.
  double reach_mm(double spacing_mm) const {
    return 2.0 / 3.0 * (sliver ? spacing_mm : longest_mm / grid.parts);
  }

  template <class Add>
  void each(const Add& add) const {
    if (!sliver) return grid.each(add);
    for (const Wedge& wedge : wedges) wedge.each(add);
  }
};

/// The number of a grid's parts grows as the square of the longest side, that of the wedges' cells as the
/// area. A triangle is split into wedges if these have fewer than a quarter as many cells.
Split split_of(const std::array<glm::dvec3, 3>& corners, double spacing_mm) {
  const auto& [a, b, c] = corners;
  const glm::dvec3 ab = b - a, ac = c - a;
  Split split;
  split.normal = glm::cross(ab, ac);
  split.longest_mm = std::max({glm::length(ab), glm::length(ac), glm::length(ac - ab)});
  split.grid = {a, ab, ac, 0.5 * glm::length(split.normal),
                std::max(1.0, std::ceil(split.longest_mm / spacing_mm))};
  split.count = split.grid.area_mm2 == 0.0 ? 0.0 : split.grid.count();
  const double enough = std::min(split.count / 4.0, static_cast<double>(most_of_all));
  // Wedges have at least about two strips for each part of the longest side.
  if (!(2.0 * split.grid.parts < enough)) return split;
  split.wedges = wedges_of(corners, split.grid.area_mm2, spacing_mm);
  const double count = split.wedges[0].count(enough) + split.wedges[1].count(enough);
  split.sliver = count < enough;
  if (split.sliver) split.count = count;
  return split;
}

}  // namespace

SurfaceSamples sample_surface(const Mesh& mesh, double spacing_mm) {
  return sample_surface(triangles_of(mesh), spacing_mm);
}

SurfaceSamples sample_surface(const Triangles& triangles, double spacing_mm, std::size_t most_samples) {
  if (!(spacing_mm > 0.0))
    throw InvalidInput("sample_surface: the spacing must be positive, it is " + std::to_string(spacing_mm) +
                       " mm");
  most_samples = std::min(most_samples, most_of_all);
  const auto split_at = [&](std::size_t f) {
    const auto& face = triangles.faces[f];
    return split_of(
        {triangles.points_mm[face[0]], triangles.points_mm[face[1]], triangles.points_mm[face[2]]},
        spacing_mm);
  };
  SurfaceSamples samples;
  std::vector<std::size_t> first(triangles.faces.size() + 1, 0);
  double count = 0.0;
  for (std::size_t f = 0; f < triangles.faces.size(); ++f) {
    const Split split = split_at(f);
    samples.reach_mm = std::max(samples.reach_mm, split.reach_mm(spacing_mm));
    count += split.count;
    if (!(count <= static_cast<double>(most_samples)))
      throw Error(ErrorCode::Resource,
                  "samples " + short_text(spacing_mm) + " mm apart are too many: the triangle at (" +
                      short_text(split.grid.a.x) + ", " + short_text(split.grid.a.y) + ", " +
                      short_text(split.grid.a.z) + ") mm, which is " + short_text(split.longest_mm) +
                      " mm long, brings their number above " + std::to_string(most_samples) +
                      "; increase the distance between samples or mend the triangle");
    first[f + 1] = first[f] + static_cast<std::size_t>(split.count);
  }
  samples.points_mm.resize(first.back());
  samples.normals.resize(first.back());
  samples.areas_mm2.resize(first.back());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.faces.size(), 4096), [&](const auto& range) {
    for (std::size_t f = range.begin(); f != range.end(); ++f) {
      if (first[f] == first[f + 1]) continue;
      const Split split = split_at(f);
      std::size_t i = first[f];
      split.each([&](const glm::dvec3& p_mm, double area_mm2) {
        samples.points_mm[i] = p_mm;
        samples.normals[i] = split.normal / glm::length(split.normal);
        samples.areas_mm2[i++] = area_mm2;
      });
      assert(i == first[f + 1]);
    }
  });
  return samples;
}

double widened_spacing_mm(const Triangles& triangles, double spacing_mm, double most_samples) {
  double long_mm = 0.0;
  for (const auto& face : triangles.faces) {
    const glm::dvec3 &a = triangles.points_mm[face[0]], &b = triangles.points_mm[face[1]],
                     &c = triangles.points_mm[face[2]];
    const double longest_mm = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    if (longest_mm > spacing_mm) long_mm += longest_mm;
  }
  // A triangle as thin as a needle is divided into two wedges, with about two strips of cells for each
  // spacing along the longest side.
  return std::max(spacing_mm, 4.0 * long_mm / most_samples);
}

}  // namespace octotomy::brep

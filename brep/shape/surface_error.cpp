// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/surface_error.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace octotomy::brep {
namespace {

/// The sides of triangles in ascending order, each once, the lower end first.
std::vector<std::array<std::uint32_t, 2>> sides_of(const Triangles& surface) {
  // The sides are grouped by their lower end, so only the few sides of a point are sorted.
  std::vector<std::size_t> starts(surface.points_mm.size() + 1, 0);
  const auto for_sides = [&surface](const auto& visit) {
    for (const auto& [a, b, c] : surface.faces)
      for (const auto& [from, to] : {std::array{a, b}, std::array{b, c}, std::array{c, a}})
        visit(std::min(from, to), std::max(from, to));
  };
  for_sides([&](std::uint32_t low, std::uint32_t) { ++starts[low + 1]; });
  for (std::size_t v = 1; v < starts.size(); ++v) starts[v] += starts[v - 1];
  std::vector<std::uint32_t> ends(starts.back());
  std::vector<std::size_t> next(starts.begin(), starts.end() - 1);
  for_sides([&](std::uint32_t low, std::uint32_t high) { ends[next[low]++] = high; });
  std::vector<std::array<std::uint32_t, 2>> sides;
  sides.reserve(ends.size() / 2 + 1);
  const auto at = [&ends](std::size_t i) { return ends.begin() + static_cast<std::ptrdiff_t>(i); };
  for (std::size_t v = 0; v + 1 < starts.size(); ++v) {
    std::sort(at(starts[v]), at(starts[v + 1]));
    for (std::size_t i = starts[v]; i < starts[v + 1]; ++i)
      if (i == starts[v] || ends[i] != ends[i - 1]) sides.push_back({static_cast<std::uint32_t>(v), ends[i]});
  }
  return sides;
}

/// The points that are corners of triangles, in ascending order.
std::vector<std::uint32_t> corners_of(const Triangles& surface) {
  std::vector<std::uint8_t> is_corner(surface.points_mm.size(), 0);
  for (const auto& face : surface.faces)
    for (const std::uint32_t v : face) is_corner[v] = 1;
  std::vector<std::uint32_t> corners;
  for (std::size_t v = 0; v < is_corner.size(); ++v)
    if (is_corner[v] != 0) corners.push_back(static_cast<std::uint32_t>(v));
  return corners;
}

/// Points spread over a face, at most `spacing_mm` apart along its sides; the face's corners are left out,
/// because they are points of the given surface.
void spread(const Triangles& surface, std::uint32_t face, double spacing_mm, std::vector<glm::dvec3>& points,
            std::vector<std::uint32_t>& face_of) {
  constexpr int most = 256;
  const auto& [a, b, c] = surface.faces[face];
  const glm::dvec3 &p = surface.points_mm[a], &q = surface.points_mm[b], &r = surface.points_mm[c];
  const double longest_mm = std::max({glm::distance(p, q), glm::distance(q, r), glm::distance(r, p)});
  const int steps = std::clamp(static_cast<int>(std::ceil(longest_mm / spacing_mm)), 2, most);
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j) {
      if (i == steps || j == steps || (i == 0 && j == 0)) continue;
      points.push_back(p + (static_cast<double>(i) * (q - p) + static_cast<double>(j) * (r - p)) /
                               static_cast<double>(steps));
      face_of.push_back(face);
    }
}

struct Nearest {
  double distance_mm = 0.0;
  std::uint32_t face = 0;  ///< the nearest, or one within `enough_mm`
};

std::vector<Nearest> nearest_of(const SurfaceTree& tree, const std::vector<glm::dvec3>& points,
                                double enough_mm) {
  std::vector<Nearest> nearest(points.size());
  // Blocks are fixed, so that the start of each search does not depend on the threads.
  constexpr std::size_t block = 256;
  tbb::parallel_for(std::size_t{0}, (points.size() + block - 1) / block, [&](std::size_t b) {
    std::uint32_t triangle = 0;
    for (std::size_t i = b * block; i < std::min((b + 1) * block, points.size()); ++i) {
      const Foot foot = tree.foot(points[i], triangle, enough_mm);
      nearest[i] = {foot.distance_mm, foot.face};
    }
  });
  return nearest;
}

void sort_once(std::vector<std::uint32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

using Triple = std::array<std::uint32_t, 3>;
constexpr Triple no_triple{0xFFFFFFFFU, 0xFFFFFFFFU, 0xFFFFFFFFU};

Triple ascending(Triple triple) {
  std::sort(triple.begin(), triple.end());
  return triple;
}

bool has(const std::vector<Triple>& sorted, const Triple& triple) {
  return std::binary_search(sorted.begin(), sorted.end(), triple);
}

/// The triangles of a surface as corner numbers, once in the surface's order and once sorted.
struct Triples {
  std::vector<Triple> of_face, sorted;

  Triples(const std::vector<std::array<std::uint32_t, 3>>& faces, const std::vector<std::uint32_t>* numbers) {
    of_face.reserve(faces.size());
    for (const auto& [a, b, c] : faces)
      of_face.push_back(numbers == nullptr ? ascending({a, b, c})
                                           : ascending({(*numbers)[a], (*numbers)[b], (*numbers)[c]}));
    sorted = of_face;
    tbb::parallel_sort(sorted.begin(), sorted.end());
  }
};

double mean_side_mm(const Triangles& surface, const std::vector<std::array<std::uint32_t, 2>>& sides) {
  double sum_mm = 0.0;
  for (const auto& [a, b] : sides) sum_mm += glm::distance(surface.points_mm[a], surface.points_mm[b]);
  return sum_mm / static_cast<double>(sides.size());
}

/// Where a surface is measured: at its corners, then at the middles of its sides.
struct Samples {
  const std::vector<std::uint32_t>& corners;
  const std::vector<std::array<std::uint32_t, 2>>& sides;

  std::size_t size() const { return corners.size() + sides.size(); }

  glm::dvec3 at_mm(const Triangles& surface, std::size_t i) const {
    if (i < corners.size()) return surface.points_mm[corners[i]];
    const auto& [a, b] = sides[i - corners.size()];
    return 0.5 * (surface.points_mm[a] + surface.points_mm[b]);
  }

  /// Appends the corner, or both ends of the side.
  void add_points_of(std::size_t i, std::vector<std::uint32_t>& points) const {
    if (i < corners.size())
      points.push_back(corners[i]);
    else
      points.insert(points.end(), sides[i - corners.size()].begin(), sides[i - corners.size()].end());
  }
};

}  // namespace

FarPlaces far_places(const Triangles& given, const SurfaceTree& tree, const Triangles& coarse,
                     const std::vector<std::uint32_t>& given_of_coarse, double limit_mm, NearFaces& near) {
  assert(given_of_coarse.size() == coarse.points_mm.size());
  FarPlaces far;
  const Triples now(coarse.faces, &given_of_coarse);
  if (near.given_sides.empty()) {
    near.given_corners = corners_of(given);
    near.given_sides = sides_of(given);
    near.given_faces = Triples(given.faces, nullptr).sorted;
    near.given_side_mm = mean_side_mm(given, near.given_sides);
  }
  const std::vector<std::uint32_t>& used = near.given_corners;
  const std::vector<std::array<std::uint32_t, 2>>& sides = near.given_sides;
  const Samples of_given{used, sides};

  // Measures from the given surface to the coarse one, except points and sides that the coarse one still
  // has.
  std::vector<std::uint8_t> is_point_of_coarse(given.points_mm.size(), 0);
  for (const Triple& triple : now.of_face)
    for (const std::uint32_t v : triple) is_point_of_coarse[v] = 1;
  const std::vector<std::array<std::uint32_t, 2>> coarse_sides =
      sides_of({.points_mm = given.points_mm, .faces = now.of_face});
  near.of_sample.resize(of_given.size(), no_triple);
  std::vector<glm::dvec3> points;
  std::vector<std::size_t> samples;
  for (std::size_t i = 0; i < near.of_sample.size(); ++i) {
    const bool is_there = i < used.size() ? is_point_of_coarse[used[i]] != 0
                                          : std::binary_search(coarse_sides.begin(), coarse_sides.end(),
                                                               sides[i - used.size()]);
    if (is_there || has(now.sorted, near.of_sample[i])) continue;
    samples.push_back(i);
    points.push_back(of_given.at_mm(given, i));
  }
  const std::vector<Nearest> to_coarse = nearest_of(SurfaceTree(coarse), points, limit_mm);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::size_t i = samples[k];
    far.largest_mm = std::max(far.largest_mm, to_coarse[k].distance_mm);
    near.of_sample[i] = now.of_face[to_coarse[k].face];
    if (to_coarse[k].distance_mm <= limit_mm) continue;
    near.of_sample[i] = no_triple;
    far.coarse_faces.push_back(to_coarse[k].face);
    of_given.add_points_of(i, far.given_points);
  }

  // Measures from the coarse surface to the given one, except triangles of the given one and those measured
  // before.
  points.clear();
  std::vector<std::uint32_t> face_of;
  for (std::uint32_t f = 0; f < coarse.faces.size(); ++f)
    if (!has(near.given_faces, now.of_face[f]) && !has(near.coarse, now.of_face[f]))
      spread(coarse, f, near.given_side_mm, points, face_of);
  const std::vector<Nearest> to_given = nearest_of(tree, points, limit_mm);
  std::vector<std::uint32_t> far_faces;
  for (std::size_t i = 0; i < to_given.size(); ++i) {
    far.largest_mm = std::max(far.largest_mm, to_given[i].distance_mm);
    if (to_given[i].distance_mm <= limit_mm) continue;
    far_faces.push_back(face_of[i]);
    const auto& face = given.faces[to_given[i].face];
    far.given_points.insert(far.given_points.end(), face.begin(), face.end());
  }
  sort_once(far_faces);
  near.coarse.clear();
  for (std::uint32_t f = 0; f < coarse.faces.size(); ++f)
    if (!std::binary_search(far_faces.begin(), far_faces.end(), f)) near.coarse.push_back(now.of_face[f]);
  std::sort(near.coarse.begin(), near.coarse.end());
  far.coarse_faces.insert(far.coarse_faces.end(), far_faces.begin(), far_faces.end());
  sort_once(far.given_points);
  sort_once(far.coarse_faces);
  return far;
}

FarPlaces far_places(const Triangles& given, const SurfaceTree& tree, const Triangles& coarse,
                     double limit_mm, double enough_mm) {
  assert(enough_mm <= limit_mm);
  FarPlaces far;
  const std::vector<std::array<std::uint32_t, 2>> sides = sides_of(given);
  const double spacing_mm = mean_side_mm(given, sides);

  // Measures from the given surface to the coarse one.
  const std::vector<std::uint32_t> used = corners_of(given);
  const Samples of_given{used, sides};
  std::vector<glm::dvec3> points;
  points.reserve(of_given.size());
  for (std::size_t i = 0; i < of_given.size(); ++i) points.push_back(of_given.at_mm(given, i));
  const std::vector<Nearest> to_coarse = nearest_of(SurfaceTree(coarse), points, enough_mm);
  for (std::size_t i = 0; i < to_coarse.size(); ++i) {
    far.largest_mm = std::max(far.largest_mm, to_coarse[i].distance_mm);
    if (to_coarse[i].distance_mm <= limit_mm) continue;
    far.coarse_faces.push_back(to_coarse[i].face);
    of_given.add_points_of(i, far.given_points);
  }

  // Measures from the coarse surface to the given one.
  points.clear();
  std::vector<std::uint32_t> face_of;
  for (std::uint32_t f = 0; f < coarse.faces.size(); ++f) spread(coarse, f, spacing_mm, points, face_of);
  const std::vector<Nearest> to_given = nearest_of(tree, points, enough_mm);
  for (std::size_t i = 0; i < to_given.size(); ++i) {
    far.largest_mm = std::max(far.largest_mm, to_given[i].distance_mm);
    if (to_given[i].distance_mm <= limit_mm) continue;
    far.coarse_faces.push_back(face_of[i]);
    const auto& face = given.faces[to_given[i].face];
    far.given_points.insert(far.given_points.end(), face.begin(), face.end());
  }
  sort_once(far.given_points);
  sort_once(far.coarse_faces);
  return far;
}

}  // namespace octotomy::brep

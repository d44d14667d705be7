// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 spread samples over both surfaces; corners of small triangles are samples too; 2 find the nearest point
// (foot) of every sample and vertex on the other surface; 3 weight the distances by area, and sort them for
// percentiles. Sums run in the order of the samples.
#include "brep/measure/difference.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/oriented_surface.h"
#include "brep/mesh/sample_surface.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

constexpr double samples_wanted = 200'000.0;

/// A sample represents a triangle, whose area is at most half the square of the spacing. So this spacing
/// yields at least the wanted number of samples if triangles are large. Small triangles add their corners as
/// samples.
double spacing_mm(double area_mm2, const Triangles& a, const Triangles& b) {
  const double even_mm = std::sqrt(2.0 * area_mm2 / samples_wanted);
  return std::max(widened_spacing_mm(a, even_mm, 8.0 * samples_wanted),
                  widened_spacing_mm(b, even_mm, 8.0 * samples_wanted));
}

std::size_t most_samples(const Triangles& triangles) {
  return (std::size_t{1} << 23) + 4 * triangles.faces.size();
}

void check(const DifferenceOptions& options, double area_a_mm2, double area_b_mm2) {
  const auto refuse = [](const std::string& why) { throw InvalidInput("difference: " + why); };
  if (!(area_a_mm2 > 0.0)) refuse("the first surface has no area");
  if (!(area_b_mm2 > 0.0)) refuse("the second surface has no area");
  if (options.spacing_mm && !(*options.spacing_mm > 0.0)) refuse("the spacing must be positive");
  if (options.bins < 1) refuse("a histogram needs at least one bin");
  double last = 0.0;
  for (const double tolerance : options.tolerances_mm) {
    if (!(tolerance > last)) refuse("tolerances must be positive and ascending");
    last = tolerance;
  }
}

/// Signed distances of a surface's samples and of its vertices.
struct Distances {
  std::vector<double> areas_mm2, sample_mm, vertex_mm;
  std::vector<bool> vertex_has_face;  ///< false for a point that no triangle uses, which is not on the
                                      ///< surface
  double reach_mm = 0.0;
  std::size_t on_border_count = 0;
};

/// Triangles with sides up to the spacing are represented by their corners, each with a third of the area;
/// larger ones are sampled.
struct Split {
  Triangles large;                 ///< with the surface's points
  std::vector<double> corner_mm2;  ///< area assigned to each of the surface's points
  double reach_mm = 0.0;           ///< largest distance of a point of a small triangle from its nearest
                                   ///< corner
};

Split split_at(const Triangles& surface, double spacing) {
  Split split;
  split.corner_mm2.assign(surface.points_mm.size(), 0.0);
  for (const auto& face : surface.faces) {
    const glm::dvec3 &a = surface.points_mm[face[0]], &b = surface.points_mm[face[1]],
                     &c = surface.points_mm[face[2]];
    const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    if (longest > spacing) {
      split.large.faces.push_back(face);
      continue;
    }
    // The largest distance is at the centre of an equilateral triangle.
    split.reach_mm = std::max(split.reach_mm, longest / std::sqrt(3.0));
    for (const std::uint32_t v : face)
      split.corner_mm2[v] += 0.5 * glm::length(glm::cross(b - a, c - a)) / 3.0;
  }
  return split;
}

Distances distances_to(const Triangles& from, const OrientedSurface& to, double spacing) {
  Split split = split_at(from, spacing);
  Distances found;
  const std::vector<OrientedSurface::Distance> corners = to.distances(from.points_mm);
  for (const OrientedSurface::Distance& corner : corners) found.vertex_mm.push_back(corner.mm);
  found.vertex_has_face.assign(from.points_mm.size(), false);
  for (const auto& face : from.faces)
    for (const std::uint32_t v : face) found.vertex_has_face[v] = true;
  const auto add = [&](const OrientedSurface::Distance& distance, double area_mm2) {
    found.sample_mm.push_back(distance.mm);
    found.areas_mm2.push_back(area_mm2);
    found.on_border_count += distance.on_border;
  };
  for (std::size_t v = 0; v < corners.size(); ++v)
    if (split.corner_mm2[v] > 0.0) add(corners[v], split.corner_mm2[v]);
  found.reach_mm = split.reach_mm;
  if (split.large.faces.empty()) return found;
  split.large.points_mm = from.points_mm;
  SurfaceSamples samples = sample_surface(split.large, spacing, most_samples(from));
  const std::vector<OrientedSurface::Distance> distances = to.distances(samples.points_mm);
  samples.points_mm = {};
  samples.normals = {};
  found.sample_mm.reserve(found.sample_mm.size() + distances.size());
  found.areas_mm2.reserve(found.areas_mm2.size() + distances.size());
  for (std::size_t i = 0; i < distances.size(); ++i) add(distances[i], samples.areas_mm2[i]);
  found.reach_mm = std::max(found.reach_mm, samples.reach_mm);
  return found;
}

double percentile_mm(const Distances& distances, double share) {
  assert(!distances.sample_mm.empty() && distances.areas_mm2.size() == distances.sample_mm.size());
  std::vector<std::pair<double, std::size_t>> sizes(distances.sample_mm.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = {std::abs(distances.sample_mm[i]), i};
  tbb::parallel_sort(sizes.begin(), sizes.end());
  double whole = 0.0, reached = 0.0;
  for (const auto& [size, i] : sizes) whole += distances.areas_mm2[i];
  for (const auto& [size, i] : sizes) {
    reached += distances.areas_mm2[i];
    if (reached >= share * whole) return size;
  }
  return sizes.back().first;
}

OneWay one_way(const Distances& distances, const std::vector<double>& tolerances) {
  OneWay way;
  way.within.assign(tolerances.size(), 0.0);
  double whole = 0.0;
  for (std::size_t i = 0; i < distances.sample_mm.size(); ++i) {
    const double d = distances.sample_mm[i], area = distances.areas_mm2[i];
    whole += area;
    way.mean_mm += area * std::abs(d);
    way.signed_mean_mm += area * d;
    way.rms_mm += area * d * d;
    way.max_mm = std::max(way.max_mm, std::abs(d));
    for (std::size_t k = 0; k < tolerances.size(); ++k)
      if (std::abs(d) <= tolerances[k]) way.within[k] += area;
  }
  for (std::size_t v = 0; v < distances.vertex_mm.size(); ++v)
    if (distances.vertex_has_face[v]) way.max_mm = std::max(way.max_mm, std::abs(distances.vertex_mm[v]));
  assert(whole > 0.0);
  way.mean_mm /= whole;
  way.signed_mean_mm /= whole;
  way.rms_mm = std::sqrt(way.rms_mm / whole);
  for (double& share : way.within) share /= whole;
  way.p95_mm = percentile_mm(distances, 0.95);
  return way;
}

/// Bins are symmetric about zero and extend to the largest distance.
DistanceHistogram histogram_of(const Distances& distances, double max_mm, std::size_t bins) {
  assert(max_mm >= 0.0 && bins > 0);
  DistanceHistogram histogram;
  histogram.low_mm = -max_mm;
  histogram.width_mm = 2.0 * max_mm / static_cast<double>(bins);
  histogram.shares.assign(bins, 0.0);
  double whole = 0.0;
  for (std::size_t i = 0; i < distances.sample_mm.size(); ++i) {
    const double place = max_mm > 0.0 ? (distances.sample_mm[i] + max_mm) / histogram.width_mm
                                      : 0.5 * static_cast<double>(bins);
    const auto bin = static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(bins - 1)));
    histogram.shares[bin] += distances.areas_mm2[i];
    whole += distances.areas_mm2[i];
  }
  for (double& share : histogram.shares) share /= whole;
  return histogram;
}

double area_of(const Distances& distances) {
  return std::accumulate(distances.areas_mm2.begin(), distances.areas_mm2.end(), 0.0);
}

}  // namespace

Difference difference(const Linked& a, const Linked& b, const DifferenceOptions& options) {
  const double area_a = size_of(a.triangles).area_mm2, area_b = size_of(b.triangles).area_mm2;
  check(options, area_a, area_b);
  const double spacing = options.spacing_mm ? *options.spacing_mm
                                            : spacing_mm(std::max(area_a, area_b), a.triangles, b.triangles);
  Difference answer;
  Distances from_a, from_b;
  tbb::parallel_invoke(
      [&] {
        from_a = distances_to(a.triangles, OrientedSurface(b), spacing);
        answer.a_to_b = one_way(from_a, options.tolerances_mm);
      },
      [&] {
        from_b = distances_to(b.triangles, OrientedSurface(a), spacing);
        answer.b_to_a = one_way(from_b, options.tolerances_mm);
      });
  answer.hausdorff_mm = std::max(answer.a_to_b.max_mm, answer.b_to_a.max_mm);
  answer.hausdorff95_mm = std::max(answer.a_to_b.p95_mm, answer.b_to_a.p95_mm);
  const double share_a = area_of(from_a) / (area_of(from_a) + area_of(from_b)), share_b = 1.0 - share_a;
  answer.mean_mm = share_a * answer.a_to_b.mean_mm + share_b * answer.b_to_a.mean_mm;
  answer.rms_mm = std::sqrt(share_a * answer.a_to_b.rms_mm * answer.a_to_b.rms_mm +
                            share_b * answer.b_to_a.rms_mm * answer.b_to_a.rms_mm);
  answer.hausdorff_short_by_mm = std::max(from_a.reach_mm, from_b.reach_mm);
  answer.histogram = histogram_of(from_a, answer.a_to_b.max_mm, options.bins);
  answer.vertex_mm = from_a.vertex_mm;
  answer.sample_count = from_a.sample_mm.size() + from_b.sample_mm.size();
  answer.on_border_count = from_a.on_border_count + from_b.on_border_count;
  answer.spacing_mm = spacing;
  return answer;
}

Difference difference(const Mesh& a, const Mesh& b, const DifferenceOptions& options) {
  return difference(linked_of(a), linked_of(b), options);
}

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Samples. The vertices, and points of each side and triangle on a regular grid of barycentric weights. A
//   vertex belongs to the first triangle that has it, a side to the one that passes it from its smaller
//   vertex to its larger one.
// 2 Distances. Each sample's distance to the other surface, up to some multiples of the reach. A search ends
//   as soon as the sample is surely nearer than another one, of any thread, because only the largest distance
//   and the first sample that has it are reported. Samples beyond the multiples are far; the exact distance
//   is computed for some of them, evenly through their order.
// 3 Border. The answer is cut at the world's border. Its samples on the border have no counterpart, and
//   neither do the surface's samples that are no farther from it than the comparison allows.
#include "verify/certificate/surface_reach.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vector>

#include "verify/certificate/difference_bound.h"
#include "voxel/space/rounded.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::verify {
namespace {

/// A sample with its distance from the other surface. Infinite: not computed, because the sample is far.
struct FarSample {
  double distance_mm = -1.0;  ///< below 0: there is no sample
  glm::dvec3 at_mm{0.0};

  void take(const FarSample& other) {
    if (other.distance_mm > distance_mm) *this = other;
  }
};

constexpr std::size_t most_measured = 256;

double area_of(const brep::Triangles& mesh) {
  double area_mm2 = 0.0;
  for (const auto& [a, b, c] : mesh.faces)
    area_mm2 += 0.5 * glm::length(glm::cross(mesh.points_mm[b] - mesh.points_mm[a],
                                             mesh.points_mm[c] - mesh.points_mm[a]));
  return area_mm2;
}

/// Returns for each vertex the lowest number of a triangle at this vertex.
std::vector<std::uint32_t> first_faces(const brep::Triangles& mesh) {
  std::vector<std::uint32_t> first(mesh.points_mm.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::uint32_t face = 0; face < mesh.faces.size(); ++face)
    for (const std::uint32_t corner : mesh.faces[face]) first[corner] = std::min(first[corner], face);
  return first;
}

/// Calls `visit` with the samples that belong to one triangle.
template <typename Visit>
void for_samples(const brep::Triangles& mesh, const std::vector<std::uint32_t>& first, std::size_t face,
                 double spacing_mm, const Visit& visit) {
  const auto& f = mesh.faces[face];
  const glm::dvec3 &a = mesh.points_mm[f[0]], &b = mesh.points_mm[f[1]], &c = mesh.points_mm[f[2]];
  const double longest_mm = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  constexpr double most_steps = 4096.0;  // of one triangle's sides
  const int steps = static_cast<int>(std::clamp(std::ceil(longest_mm / spacing_mm), 2.0, most_steps));
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j) {
      const int k = steps - i - j;
      const bool is_of_other =
          (i == steps && first[f[0]] != face) || (j == steps && first[f[1]] != face) ||
          (k == steps && first[f[2]] != face) || (k == 0 && i > 0 && j > 0 && f[0] > f[1]) ||
          (i == 0 && j > 0 && k > 0 && f[1] > f[2]) || (j == 0 && k > 0 && i > 0 && f[2] > f[0]);
      if (is_of_other) continue;
      visit((static_cast<double>(i) * a + static_cast<double>(j) * b + static_cast<double>(k) * c) /
            static_cast<double>(steps));
    }
  if (steps == 2) visit((a + b + c) / 3.0);
}

/// Raises a number to `to` if it is lower. Several threads may call this.
void raise(std::atomic<double>& number, double to) {
  double now = number.load(std::memory_order_relaxed);
  while (now < to && !number.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
  }
}

/// The sample that is farthest from a surface, among those for which `counts` is true.
FarSample farthest(const brep::Triangles& mesh, const TriangleGrid& from, double spacing_mm, double search_mm,
                   const std::function<bool(const glm::dvec3&)>& counts, const voxel::Progress& progress) {
  constexpr std::size_t some = 1024;
  const std::vector<std::uint32_t> first = first_faces(mesh);
  std::vector<FarSample> of_face(mesh.faces.size());
  std::atomic<double> largest_mm{0.0};  // the largest distance so far
  voxel::SharedProgress done(progress, mesh.faces.size() / some + 1);
  tbb::parallel_for(std::size_t{0}, mesh.faces.size() / some + 1, [&](std::size_t part) {
    if (progress.stop.stop_requested()) return;
    for (std::size_t face = part * some; face < std::min(of_face.size(), (part + 1) * some); ++face)
      for_samples(mesh, first, face, spacing_mm, [&](const glm::dvec3& p_mm) {
        if (!counts(p_mm)) return;
        const auto foot = from.nearest(p_mm, search_mm, largest_mm.load(std::memory_order_relaxed));
        if (foot) raise(largest_mm, foot->distance_mm);
        of_face[face].take({foot ? foot->distance_mm : std::numeric_limits<double>::infinity(), p_mm});
      });
    done.one_more();
  });
  std::vector<std::size_t> far;
  FarSample worst;
  for (std::size_t face = 0; face < of_face.size(); ++face) {
    if (std::isinf(of_face[face].distance_mm))
      far.push_back(face);
    else
      worst.take(of_face[face]);
  }
  if (far.empty()) return worst;
  std::vector<FarSample> measured(std::min(far.size(), most_measured));
  tbb::parallel_for(std::size_t{0}, measured.size(), [&](std::size_t i) {
    const glm::dvec3 at_mm = of_face[far[i * far.size() / measured.size()]].at_mm;
    const auto foot = from.nearest(at_mm, std::numeric_limits<double>::infinity());
    measured[i] = {foot ? foot->distance_mm : 0.0, at_mm};
  });
  for (const FarSample& sample : measured) worst.take(sample);
  return worst;
}

/// Distance of a point within the world to its border; below 0 outside.
double depth_mm(const voxel::Box& world_mm, const glm::dvec3& p_mm) {
  const glm::dvec3 depth = glm::min(p_mm - world_mm.low_mm, world_mm.high_mm - p_mm);
  return std::min({depth.x, depth.y, depth.z});
}

void add_reach(Certificate& certificate, const FarSample& found, double reach_mm, const std::string& formula,
               bool is_of_answer) {
  if (!(found.distance_mm >= 0.0))
    return lower(certificate, Verdict::Warn,
                 std::string("No sample of ") + (is_of_answer ? "the answer" : "the step's right result") +
                     " lies far enough within the universe to be compared: take a larger universe.");
  add_comparison(
      certificate,
      {.quantity = is_of_answer ? "answer's surface from where it must lie"
                                : "where it must lie from the answer's surface",
       .unit = "mm",
       .difference = found.distance_mm,
       .tolerance = reach_mm,
       .formula = formula,
       .statement = is_of_answer ? "The answer's surface lies up to % from where it must lie"
                                 : "A place where a surface must lie is % from the answer's surface"});
  if (certificate.comparisons.back().verdict == Verdict::Pass) return;
  const WorstPlace place{found.at_mm, found.distance_mm,
                         is_of_answer ? "the answer has a surface there that its step must not make"
                                      : "the answer lacks a surface there that its step must make"};
  certificate.reasons.push_back(text_of(place));
  if (!certificate.worst || certificate.worst->size_mm < place.size_mm) certificate.worst = place;
}

}  // namespace

void judge_reach(Certificate& certificate, const brep::Triangles& answer, const ReshapedSurface& expected,
                 const ReachOptions& options, const voxel::Progress& progress) {
  const double reach_mm = expected.reach_mm + options.shift_mm, fails_mm = reach_doubt * reach_mm;
  const double border_mm = on_border_mm(options.world_mm);
  const auto is_inner = [&](const glm::dvec3& p_mm) {
    return depth_mm(options.world_mm, p_mm) > fails_mm + border_mm;
  };
  const brep::Triangles& surface = expected.surface.triangles();
  const bool has_surface = std::any_of(surface.faces.begin(), surface.faces.end(), [&](const auto& face) {
    return std::any_of(face.begin(), face.end(),
                       [&](std::uint32_t corner) { return is_inner(surface.points_mm[corner]); });
  });
  if (answer.faces.empty() || surface.faces.empty()) {
    if (answer.faces.empty() && has_surface)
      lower(certificate, Verdict::Fail,
            "The answer is empty, but its step must make a surface of " + voxel::rounded(area_of(surface)) +
                " mm2.");
    if (!answer.faces.empty())
      lower(certificate, Verdict::Fail, "The answer has a surface, but its step must make none.");
    return;
  }
  const TriangleGrid grid(answer);
  const double search_mm = std::max(4.0 * fails_mm, options.spacing_mm);
  const FarSample of_answer = farthest(
      answer, expected.surface, options.spacing_mm, search_mm,
      [&](const glm::dvec3& p_mm) { return depth_mm(options.world_mm, p_mm) > border_mm; },
      voxel::part_of(progress, 0.0, 0.5));
  const FarSample of_surface =
      farthest(surface, grid, options.spacing_mm, search_mm, is_inner, voxel::part_of(progress, 0.5, 1.0));
  add_reach(certificate, of_answer, reach_mm, expected.formula, true);
  add_reach(certificate, of_surface, reach_mm, expected.formula, false);
  if (certificate.limit)
    certificate.limit->volume_mm3 = std::max(certificate.limit->volume_mm3, fails_mm * area_of(surface));
  judge_evidence(certificate);
  progress.at(1.0);
}

}  // namespace octotomy::verify

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/surface_distances.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>
#include <utility>

#include "brep/mesh/distance.h"
#include "verify/certificate/necks.h"
#include "verify/phantom/chance.h"
#include "voxel/measure/boundary_distance.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::verify {
namespace {

/// Spacing of the points on the solid. An isosurface's triangles are smaller and have one point each.
constexpr double spacing_voxels = 2.0;
/// Largest number of runs of neighbouring points; mean and percentile use one point of each. With 32768
/// points the estimated 95th percentile lies between the true percentiles 94.6 and 95.4: three standard
/// deviations, 3 sqrt(0.95 * 0.05 / 32768). The largest distance is exact.
constexpr std::size_t most_runs = std::size_t{1} << 15;

SurfaceDistances::Points face_centres(const voxel::Octree& octree) {
  const voxel::Lattice lattice = octree.universe().lattice();
  const glm::dvec3 edges_mm = lattice.spacing_mm();
  const std::vector<voxel::VoxelFace> faces = voxel::voxel_boundary(octree);
  SurfaceDistances::Points points{std::vector<glm::dvec3>(faces.size()), std::vector<double>(faces.size())};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, faces.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const int axis = faces[i].axis;
      glm::dvec3 centre(faces[i].voxel);
      centre[axis] += 0.5 * faces[i].side;
      points.p_mm[i] = lattice.lps_mm(centre);
      points.areas_mm2[i] = edges_mm[(axis + 1) % 3] * edges_mm[(axis + 2) % 3];
    }
  });
  return points;
}

struct Farthest {
  double mm = -1.0;
  std::size_t number = 0;  ///< of the point; the first one of equal distances

  static Farthest of(const Farthest& a, const Farthest& b) {
    return a.mm > b.mm || (a.mm == b.mm && a.number < b.number) ? a : b;
  }
};

/// `start` returns a function (point, enough_mm) that measures the distances of neighbouring points one after
/// the other. A distance below enough_mm need not be exact; any number below enough_mm may be returned.
template <typename Start>
SurfaceDistances::Directed directed(const std::vector<glm::dvec3>& p_mm, const std::vector<double>& areas_mm2,
                                    bool sampled, const Start& start) {
  const std::size_t count = p_mm.size(), run = sampled ? (count + most_runs - 1) / most_runs : 1,
                    runs = (count + run - 1) / run;
  SurfaceDistances::Directed directed;
  directed.distances_mm.resize(runs);
  directed.areas_mm2.resize(runs);
  directed.numbers.resize(runs);
  std::atomic<double> largest_mm = 0.0;
  const Farthest farthest = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, runs, std::max<std::size_t>(1, 256 / run)), Farthest(),
      [&](const auto& range, Farthest found) {
        auto measure = start();
        for (std::size_t r = range.begin(); r != range.end(); ++r) {
          const std::size_t begin = r * run, end = std::min(begin + run, count);
          const std::size_t chosen =
              begin + std::min(end - begin - 1, static_cast<std::size_t>(Chance(r).between(
                                                    0.0, static_cast<double>(end - begin))));
          for (std::size_t i = begin; i < end; ++i) {
            const double mm =
                measure(p_mm[i], i == chosen ? 0.0 : largest_mm.load(std::memory_order_relaxed));
            if (i == chosen) {
              directed.distances_mm[r] = mm;
              directed.areas_mm2[r] = areas_mm2[i];
              directed.numbers[r] = static_cast<std::uint32_t>(i);
            }
            found = Farthest::of(found, {mm, i});
          }
          double known_mm = largest_mm.load(std::memory_order_relaxed);
          while (known_mm < found.mm &&
                 !largest_mm.compare_exchange_weak(known_mm, found.mm, std::memory_order_relaxed)) {
          }
        }
        return found;
      },
      Farthest::of);
  if (count > 0) {
    directed.largest_mm = farthest.mm;
    directed.farthest_mm = p_mm[farthest.number];
  }
  directed.sum_up();
  return directed;
}

}  // namespace

void SurfaceDistances::Directed::sum_up() {
  const double area_mm2 = std::accumulate(areas_mm2.begin(), areas_mm2.end(), 0.0);
  const double sum_mm3 = std::inner_product(distances_mm.begin(), distances_mm.end(), areas_mm2.begin(), 0.0);
  mean_mm = area_mm2 > 0.0 ? sum_mm3 / area_mm2 : 0.0;
  std::vector<std::pair<double, std::size_t>> order(distances_mm.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = {distances_mm[i], i};
  tbb::parallel_sort(order.begin(), order.end());
  percentile95_mm = largest_mm;
  double reached_mm2 = 0.0;
  for (const auto& [distance_mm, number] : order)
    if ((reached_mm2 += areas_mm2[number]) >= 0.95 * area_mm2) {
      percentile95_mm = distance_mm;
      break;
    }
}

SurfaceDistances::SurfaceDistances(const voxel::Octree& octree, const brep::Solid& solid,
                                   const brep::Triangles& measured, bool sampled)
    : octree_(octree), solid_(solid) {
  const glm::dvec3 edges_mm = octree.universe().lattice().spacing_mm();
  samples_ = brep::sample_surface(measured, spacing_voxels * std::max({edges_mm.x, edges_mm.y, edges_mm.z}));
  const voxel::BoundaryDistance to_voxels(octree);
  from_solid_ = directed(samples_.points_mm, samples_.areas_mm2, sampled, [&] {
    return [&](const glm::dvec3& p_mm, double enough_mm) { return to_voxels(p_mm, enough_mm); };
  });
  const double sampled_mm2 = std::accumulate(from_solid_.areas_mm2.begin(), from_solid_.areas_mm2.end(), 0.0);
  if (sampled_mm2 > 0.0)
    mm2_a_sampled_mm2_ =
        std::accumulate(samples_.areas_mm2.begin(), samples_.areas_mm2.end(), 0.0) / sampled_mm2;
  const brep::SurfaceTree& tree = solid.tree();
  const Points centres = face_centres(octree);
  from_voxels_ = directed(centres.p_mm, centres.areas_mm2, sampled, [&] {
    return [&tree, triangle = std::uint32_t{0}](const glm::dvec3& p_mm, double enough_mm) mutable {
      return tree.distance_mm(p_mm, triangle, enough_mm);
    };
  });
}

double SurfaceDistances::mean_mm() const {
  return std::max(from_voxels_.mean_mm, from_solid_.mean_mm);
}
double SurfaceDistances::percentile95_mm() const {
  return std::max(from_voxels_.percentile95_mm, from_solid_.percentile95_mm);
}
double SurfaceDistances::largest_mm() const {
  return std::max(from_voxels_.largest_mm, from_solid_.largest_mm);
}

WorstPlace SurfaceDistances::worst() const {
  const bool of_voxels = from_voxels_.largest_mm >= from_solid_.largest_mm;
  const Directed& farther = of_voxels ? from_voxels_ : from_solid_;
  const glm::dvec3 p_mm = farther.farthest_mm;
  // A point of one surface inside the other object shows that the other object has a part there.
  const bool mesh_has_more =
      of_voxels ? solid_.tree().inside({p_mm}).front() != 0
                : !octree_.contains(glm::ivec3(glm::round(octree_.universe().lattice().voxel(p_mm))));
  return {p_mm, farther.largest_mm, mesh_has_more ? part_of_mesh_only : part_of_voxels_only};
}

void SurfaceDistances::leave_out_beside(const std::vector<glm::ivec3>& voxels) {
  const voxel::Lattice lattice = octree_.universe().lattice();
  const auto is_beside = [&](const glm::dvec3& p_mm) {
    const glm::ivec3 own(glm::round(lattice.voxel(p_mm)));
    for (int i = 0; i < 27; ++i)
      if (std::binary_search(voxels.begin(), voxels.end(), own + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1,
                             before))
        return true;
    return false;
  };
  const auto leave_out = [&](Directed& directed, const std::vector<glm::dvec3>& p_mm) {
    Directed kept;
    for (std::size_t i = 0; i < directed.numbers.size(); ++i) {
      const std::uint32_t number = directed.numbers[i];
      if (is_beside(p_mm[number])) continue;
      const double mm = directed.distances_mm[i];
      kept.distances_mm.push_back(mm);
      kept.areas_mm2.push_back(directed.areas_mm2[i]);
      kept.numbers.push_back(number);
      if (mm > kept.largest_mm) kept.largest_mm = mm, kept.farthest_mm = p_mm[number];
    }
    kept.sum_up();
    directed = std::move(kept);
  };
  leave_out(from_voxels_, face_centres(octree_).p_mm);
  leave_out(from_solid_, samples_.points_mm);
}

double SurfaceDistances::leave_out_thin() {
  const glm::dmat3 axes_mm(octree_.universe().lps_from_voxel);
  const std::vector<std::uint32_t>& numbers = from_solid_.numbers;
  const std::size_t count = numbers.size();
  // The width of a voxel along the normal. A slab of this width holds a voxel's centre near each of its points.
  std::vector<double> widths_mm(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 along = glm::abs(samples_.normals[numbers[i]] * axes_mm);
    widths_mm[i] = along.x + along.y + along.z;
  }
  // Sheets may be stacked, so the point at the far end of a voxel may lie in the next sheet or gap. So points
  // at several shares of that distance are tested.
  std::vector<std::uint8_t> thin(count, 0);
  std::vector<std::size_t> left;
  std::vector<glm::dvec3> within_mm, beyond_mm;
  for (const double share : {1.0, 0.5, 0.25, 0.75}) {
    left.clear(), within_mm.clear(), beyond_mm.clear();
    for (std::size_t i = 0; i < count; ++i) {
      if (thin[i] != 0) continue;
      const glm::dvec3& p_mm = samples_.points_mm[numbers[i]];
      const glm::dvec3 by_mm = share * widths_mm[i] * samples_.normals[numbers[i]];
      left.push_back(i);
      within_mm.push_back(p_mm - by_mm);
      beyond_mm.push_back(p_mm + by_mm);
    }
    const std::vector<std::uint8_t> thick = solid_.tree().inside(within_mm),
                                    closing = solid_.tree().inside(beyond_mm);
    for (std::size_t k = 0; k < left.size(); ++k)
      if (thick[k] == 0 || closing[k] != 0) thin[left[k]] = 1;
  }
  return leave_out(thin);
}

double SurfaceDistances::leave_out_unheld(const voxel::Octree& digitised, double reach_mm) {
  const voxel::BoundaryDistance to_digitised(digitised);
  std::vector<std::uint8_t> unheld(from_solid_.numbers.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, unheld.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      unheld[i] = to_digitised(samples_.points_mm[from_solid_.numbers[i]], reach_mm) > reach_mm ? 1 : 0;
  });
  return leave_out(unheld);
}

double SurfaceDistances::leave_out(const std::vector<std::uint8_t>& is_out) {
  double out_mm2 = 0.0;
  Directed kept;
  for (std::size_t i = 0; i < is_out.size(); ++i) {
    const double area_mm2 = from_solid_.areas_mm2[i];
    if (is_out[i] != 0) {
      out_mm2 += area_mm2;
      continue;
    }
    const std::uint32_t number = from_solid_.numbers[i];
    const double mm = from_solid_.distances_mm[i];
    kept.distances_mm.push_back(mm);
    kept.areas_mm2.push_back(area_mm2);
    kept.numbers.push_back(number);
    if (mm > kept.largest_mm) kept.largest_mm = mm, kept.farthest_mm = samples_.points_mm[number];
  }
  kept.sum_up();
  from_solid_ = std::move(kept);
  return out_mm2 * mm2_a_sampled_mm2_;
}

}  // namespace octotomy::verify

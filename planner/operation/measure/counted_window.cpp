// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/counted_window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <vector>

#include "planner/operation/table/number_format.h"

namespace octotomy::planner {
namespace {

std::size_t plane_of(const glm::ivec3& dims) {
  return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y);
}

/// Averages neighbouring pairs of samples along one axis.
template <typename Sample>
voxel::Samples<Sample> averaged(const voxel::Samples<Sample>& samples, glm::ivec3& dims, int axis,
                                const std::optional<double>& padding) {
  const glm::ivec3 from = dims;
  dims[axis] = (dims[axis] + 1) / 2;
  voxel::Samples<Sample> made(plane_of(dims) * static_cast<std::size_t>(dims.z));
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? static_cast<std::size_t>(from.x) : plane_of(from);
  tbb::parallel_for(0, dims.z, [&](int z) {
    std::size_t to = plane_of(dims) * static_cast<std::size_t>(z);
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x, ++to) {
        glm::ivec3 at(x, y, z);
        at[axis] *= 2;
        const std::size_t first = static_cast<std::size_t>(at.x) +
                                  static_cast<std::size_t>(from.x) * static_cast<std::size_t>(at.y) +
                                  plane_of(from) * static_cast<std::size_t>(at.z);
        const auto a = static_cast<double>(samples[first]);
        const auto b = at[axis] + 1 < from[axis] ? static_cast<double>(samples[first + stride]) : a;
        const double mean = padding && a == *padding ? b : padding && b == *padding ? a : 0.5 * (a + b);
        if constexpr (std::is_integral_v<Sample>)
          made[to] = static_cast<Sample>(std::lround(mean));
        else
          made[to] = static_cast<Sample>(mean);
      }
  });
  return made;
}

/// For each axis, the number of samples in the window in the first and last plane across this axis.
glm::dvec3 outermost(const voxel::Scene& scan, double low, double high) {
  low = voxel::above_padding(scan, low);
  const glm::ivec3 dims = scan.lattice.dims;
  glm::dvec3 counts(0.0);
  std::visit(
      [&](const auto& samples) {
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 at(0);
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          for (const int end : {0, dims[axis] - 1})
            for (at[v] = 0; at[v] < dims[v]; ++at[v])
              for (at[u] = 0; at[u] < dims[u]; ++at[u]) {
                at[axis] = end;
                const auto sample = static_cast<double>(
                    samples[static_cast<std::size_t>(at.x) +
                            static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(at.y) +
                            plane_of(dims) * static_cast<std::size_t>(at.z)]);
                counts[axis] += sample >= low && sample <= high ? 1.0 : 0.0;
              }
        }
      },
      scan.samples);
  return counts;
}

/// For each axis, the number of faces across it between a sample in the window and a neighbour outside of it.
glm::dvec3 faces_of(const voxel::Scene& scan, double low, double high) {
  low = voxel::above_padding(scan, low);
  const glm::ivec3 dims = scan.lattice.dims;
  const std::size_t row = static_cast<std::size_t>(dims.x), plane = plane_of(dims);
  std::vector<glm::dvec3> faces(static_cast<std::size_t>(dims.z), glm::dvec3(0.0));
  std::visit(
      [&](const auto& samples) {
        const auto is_in = [&](std::size_t i) {
          const auto sample = static_cast<double>(samples[i]);
          return sample >= low && sample <= high;
        };
        tbb::parallel_for(0, dims.z, [&](int z) {
          glm::dvec3 sum(0.0);
          for (int y = 0; y < dims.y; ++y)
            for (int x = 0; x < dims.x; ++x) {
              const std::size_t i = static_cast<std::size_t>(x) + row * static_cast<std::size_t>(y) +
                                    plane * static_cast<std::size_t>(z);
              const bool here = is_in(i);
              sum.x += x + 1 < dims.x && here != is_in(i + 1) ? 1.0 : 0.0;
              sum.y += y + 1 < dims.y && here != is_in(i + row) ? 1.0 : 0.0;
              sum.z += z + 1 < dims.z && here != is_in(i + plane) ? 1.0 : 0.0;
            }
          faces[static_cast<std::size_t>(z)] = sum;
        });
      },
      scan.samples);
  glm::dvec3 all(0.0);
  for (const glm::dvec3& sum : faces) all += sum;
  return all;
}

/// For each axis, the number of samples in the window in each plane across this axis.
std::array<std::vector<double>, 3> sections_of(const voxel::Scene& scan, double low, double high) {
  low = voxel::above_padding(scan, low);
  const glm::ivec3 dims = scan.lattice.dims;
  std::array<std::vector<double>, 3> counts;
  for (int axis = 0; axis < 3; ++axis)
    counts[static_cast<std::size_t>(axis)].assign(static_cast<std::size_t>(dims[axis]), 0.0);
  std::visit(
      [&](const auto& samples) {
        std::size_t i = 0;
        for (std::size_t z = 0; z < counts[2].size(); ++z)
          for (std::size_t y = 0; y < counts[1].size(); ++y)
            for (std::size_t x = 0; x < counts[0].size(); ++x, ++i) {
              const auto sample = static_cast<double>(samples[i]);
              if (sample < low || sample > high) continue;
              ++counts[0][x];
              ++counts[1][y];
              ++counts[2][z];
            }
      },
      scan.samples);
  return counts;
}

}  // namespace

std::size_t count_in(const voxel::Scene& scan, double low, double high) {
  low = voxel::above_padding(scan, low);
  return std::visit(
      [&](const auto& samples) {
        return tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, samples.size()), std::size_t{0},
            [&](const auto& range, std::size_t count) {
              for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const auto sample = static_cast<double>(samples[i]);
                count += sample >= low && sample <= high ? 1 : 0;
              }
              return count;
            },
            std::plus<>());
      },
      scan.samples);
}

double faces_mm2(const voxel::Scene& scan, double low, double high) {
  return glm::dot(faces_of(scan, low, high), sample_mm3(scan) / scan.lattice.spacing_mm());
}

double counting_doubt_mm3(const voxel::Scene& scan, double low, double high) {
  const glm::dvec3 faces = faces_of(scan, low, high);
  const std::array<std::vector<double>, 3> sections = sections_of(scan, low, high);
  double variance = 0.0;
  for (const std::vector<double>& counts : sections) {
    double same = 0.0, next = 0.0, after = 0.0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      same += counts[i] * counts[i];
      if (i >= 1) next += counts[i] * counts[i - 1];
      if (i >= 2) after += counts[i] * counts[i - 2];
    }
    variance += std::max(3.0 * same + after - 4.0 * next, 0.0) / 12.0;
  }
  constexpr double confidence = 2.8;
  return sample_mm3(scan) *
         std::hypot(confidence * std::sqrt(variance), 3.0 * 0.26 * std::sqrt(faces.x + faces.y + faces.z));
}

double sample_mm3(const voxel::Scene& scan) {
  return std::abs(glm::determinant(glm::dmat3(scan.lattice.lps_from_voxel)));
}

voxel::Scene indicator_of(const voxel::Scene& scan, double low, double high) {
  low = voxel::above_padding(scan, low);
  voxel::Scene made;
  made.lattice = scan.lattice;
  made.meaning = voxel::Meaning::Label;
  voxel::Int16Samples ones(plane_of(scan.lattice.dims) * static_cast<std::size_t>(scan.lattice.dims.z));
  std::visit(
      [&](const auto& samples) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, ones.size()), [&](const auto& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const auto sample = static_cast<double>(samples[i]);
            ones[i] = sample >= low && sample <= high ? 1 : 0;
          }
        });
      },
      scan.samples);
  made.samples = std::move(ones);
  return made;
}

voxel::Scene averaged_by_two(const voxel::Scene& scan) {
  voxel::Scene made;
  made.meaning = scan.meaning;
  made.padding = scan.padding;
  made.lattice = scan.lattice;
  const glm::dvec3 spacing_mm = scan.lattice.spacing_mm();
  const double coarsest_mm = std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  glm::ivec3 dims = scan.lattice.dims;
  std::visit(
      [&](const auto& samples) {
        auto kept = &samples;
        std::remove_cvref_t<decltype(samples)> means;
        for (int axis = 0; axis < 3; ++axis) {
          if (spacing_mm[axis] < 0.75 * coarsest_mm || dims[axis] < 2) continue;
          means = averaged(*kept, dims, axis, scan.padding);
          kept = &means;
          glm::dmat4& axes = made.lattice.lps_from_voxel;
          axes[3] += 0.5 * axes[axis];
          axes[axis] *= 2.0;
        }
        made.samples = *kept;
      },
      scan.samples);
  made.lattice.dims = dims;
  return made;
}

double cut_mm2(const voxel::Scene& scan, double low, double high) {
  return glm::dot(outermost(scan, low, high), sample_mm3(scan) / scan.lattice.spacing_mm());
}

std::optional<std::string> cut_finding(double cut_mm2, double area_mm2) {
  if (!(cut_mm2 > 0.001 * area_mm2)) return std::nullopt;
  return "the scan's border cuts off the object over an area of " + three_figures(cut_mm2) +
         " mm²: the reported numbers do not include the part beyond";
}

std::optional<Thickness> thickness_of(const voxel::Scene& scan, double low, double high) {
  const double counted_mm3 = static_cast<double>(count_in(scan, low, high)) * sample_mm3(scan);
  if (!(counted_mm3 > 0.0)) return std::nullopt;
  Thickness found;
  found.faces_mm2 = faces_mm2(scan, low, high);
  const glm::dvec3 counts = outermost(scan, low, high);
  found.border_mm3 = 0.5 * (counts.x + counts.y + counts.z) * sample_mm3(scan);
  const voxel::Scene thick = averaged_by_two(scan);
  found.volume_change_mm3 = static_cast<double>(count_in(thick, low, high)) * sample_mm3(thick) - counted_mm3;
  found.area_change_share = found.faces_mm2 > 0.0 ? faces_mm2(thick, low, high) / found.faces_mm2 - 1.0 : 0.0;
  return found;
}

}  // namespace octotomy::planner

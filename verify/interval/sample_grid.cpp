// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/interval/sample_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace octotomy::verify {
namespace {

/// Filters along each axis in turn. combine(made, count, source) must compute `count` adjacent samples at
/// `made`. source(k) points to the same samples shifted by k - reach along the axis, for k = 0 .. 2 reach.
/// Samples beyond the border repeat those of the border. Along x each call filters a row; along y and z it
/// filters a row's samples side by side, so that memory is read in order.
template <typename Values, typename Combine>
void filter(const SampleGrid& grid, Values& values, std::size_t reach, const Combine& combine) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto length = static_cast<std::size_t>(grid.dims[axis]);
    const std::size_t width = axis == 0 ? 1 : static_cast<std::size_t>(grid.dims.x),
                      stride = grid.stride(axis);
    tbb::parallel_for(0, axis == 2 ? grid.dims.y : grid.dims.z, [&](int i) {
      thread_local Values before;
      before.resize((length + 2 * reach) * width);
      for (int j = 0; j < (axis == 0 ? grid.dims.y : 1); ++j) {
        const auto first =
            values.begin() + static_cast<std::ptrdiff_t>(axis == 2 ? grid.at(0, i, 0) : grid.at(0, j, i));
        for (std::size_t k = 0; k < length + 2 * reach; ++k) {
          const std::size_t from = std::clamp(k, reach, length + reach - 1) - reach;
          std::copy_n(first + static_cast<std::ptrdiff_t>(from * stride), width,
                      before.begin() + static_cast<std::ptrdiff_t>(k * width));
        }
        if (axis == 0) {
          combine(&*first, length, [&](std::size_t k) { return before.data() + k; });
          continue;
        }
        for (std::size_t to = 0; to < length; ++to)
          combine(&*(first + static_cast<std::ptrdiff_t>(to * stride)), width,
                  [&](std::size_t k) { return before.data() + (to + k) * width; });
      }
    });
  }
}

}  // namespace

SampleValues blurred(const SampleGrid& grid, SampleValues values, double deviation) {
  const auto reach = static_cast<std::size_t>(std::ceil(3.5 * deviation));
  std::vector<float> weights(2 * reach + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double off = static_cast<double>(i) - static_cast<double>(reach);
    sum += weights[i] = static_cast<float>(std::exp(-0.5 * off * off / (deviation * deviation)));
  }
  for (float& weight : weights) weight = static_cast<float>(weight / sum);
  filter(grid, values, reach, [&](float* made, std::size_t count, const auto& source) {
    std::fill_n(made, count, 0.0F);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const float weight = weights[k], *from = source(k);
      for (std::size_t i = 0; i < count; ++i) made[i] += weight * from[i];
    }
  });
  return values;
}

void grow(const SampleGrid& grid, SampleMask& mask, std::size_t reach) {
  filter(grid, mask, reach, [reach](std::uint8_t* made, std::size_t count, const auto& source) {
    for (std::size_t k = 0; k <= 2 * reach; ++k) {
      const std::uint8_t* from = source(k);
      for (std::size_t i = 0; i < count; ++i) made[i] |= from[i];
    }
  });
}

SampleValues extremes(const SampleGrid& grid, SampleValues values, std::size_t reach, bool highest) {
  filter(grid, values, reach, [reach, highest](float* made, std::size_t count, const auto& source) {
    for (std::size_t k = 0; k <= 2 * reach; ++k) {
      const float* from = source(k);
      if (highest)
        for (std::size_t i = 0; i < count; ++i) made[i] = from[i] > made[i] ? from[i] : made[i];
      else
        for (std::size_t i = 0; i < count; ++i) made[i] = from[i] < made[i] ? from[i] : made[i];
    }
  });
  return values;
}

double level_mm2(const SampleGrid& grid, const SampleValues& values, float level) {
  constexpr int tets[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                              {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  SampleGrid cells = grid;
  --cells.dims.z;
  return by_planes<double>(cells, [&](int z, double& area) {
    for (int y = 0; y + 1 < grid.dims.y; ++y)
      for (int x = 0; x + 1 < grid.dims.x; ++x) {
        std::array<double, 8> f;
        int inside = 0;
        for (int i = 0; i < 8; ++i) {
          const float value = values[grid.at(x + (i & 1), y + ((i >> 1) & 1), z + (i >> 2))];
          f[static_cast<std::size_t>(i)] = static_cast<double>(value - level);
          inside += value >= level ? 1 : 0;
        }
        if (inside == 0 || inside == 8) continue;
        for (const auto& tet : tets) {
          std::array<int, 4> in{}, out{};
          std::size_t in_count = 0, out_count = 0;
          for (const int k : tet)
            if (f[static_cast<std::size_t>(k)] >= 0.0)
              in[in_count++] = k;
            else
              out[out_count++] = k;
          if (in_count == 0 || out_count == 0) continue;
          const auto crossing = [&](int i, int o) {
            const double fi = f[static_cast<std::size_t>(i)], fo = f[static_cast<std::size_t>(o)];
            const auto place = [&](int k) {
              return glm::dvec3(k & 1, (k >> 1) & 1, k >> 2) * grid.spacing_mm;
            };
            return glm::mix(place(i), place(o), fi / (fi - fo));
          };
          const auto triangle = [&](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
            area += 0.5 * glm::length(glm::cross(q - p, r - p));
          };
          if (in_count == 1)
            triangle(crossing(in[0], out[0]), crossing(in[0], out[1]), crossing(in[0], out[2]));
          else if (out_count == 1)
            triangle(crossing(in[0], out[0]), crossing(in[1], out[0]), crossing(in[2], out[0]));
          else {
            const glm::dvec3 p = crossing(in[0], out[0]), r = crossing(in[1], out[1]);
            triangle(p, crossing(in[0], out[1]), r);
            triangle(p, r, crossing(in[1], out[0]));
          }
        }
      }
  });
}

}  // namespace octotomy::verify

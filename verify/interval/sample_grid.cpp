// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/interval/sample_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace octotomy::verify {

SampleValues blurred(const SampleGrid& grid, SampleValues values, double deviation) {
  const auto reach = static_cast<std::size_t>(std::ceil(3.5 * deviation));
  std::vector<float> weights(2 * reach + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double off = static_cast<double>(i) - static_cast<double>(reach);
    sum += weights[i] = static_cast<float>(std::exp(-0.5 * off * off / (deviation * deviation)));
  }
  for (float& weight : weights) weight = static_cast<float>(weight / sum);
  for (int axis = 0; axis < 3; ++axis)
    each_row(grid, axis, [&](std::size_t first, std::size_t stride, std::size_t length) {
      thread_local std::vector<float> line;
      line.resize(length + 2 * reach);
      for (std::size_t i = 0; i < length; ++i) line[i + reach] = values[first + i * stride];
      std::fill_n(line.begin(), reach, line[reach]);
      std::fill_n(line.end() - static_cast<std::ptrdiff_t>(reach), reach, line[length + reach - 1]);
      for (std::size_t i = 0; i < length; ++i) {
        float value = 0.0F;
        for (std::size_t k = 0; k < weights.size(); ++k) value += weights[k] * line[i + k];
        values[first + i * stride] = value;
      }
    });
  return values;
}

void grow(const SampleGrid& grid, SampleMask& mask, std::size_t reach) {
  for (int axis = 0; axis < 3; ++axis)
    each_row(grid, axis, [&](std::size_t first, std::size_t stride, std::size_t length) {
      thread_local SampleMask line;
      line.assign(length, 0);
      std::size_t until = 0;  // one beyond the reach of the last set sample
      for (std::size_t i = 0; i < length; ++i)
        if (mask[first + i * stride] != 0) {
          for (std::size_t k = std::max(until, i > reach ? i - reach : 0);
               k < std::min(length, i + reach + 1); ++k)
            line[k] = 1;
          until = i + reach + 1;
        }
      for (std::size_t i = 0; i < length; ++i) mask[first + i * stride] = line[i];
    });
}

SampleValues extremes(const SampleGrid& grid, SampleValues values, std::size_t reach, bool highest) {
  for (int axis = 0; axis < 3; ++axis)
    each_row(grid, axis, [&](std::size_t first, std::size_t stride, std::size_t length) {
      thread_local std::vector<float> line;
      line.resize(length);
      for (std::size_t i = 0; i < length; ++i) line[i] = values[first + i * stride];
      for (std::size_t i = 0; i < length; ++i) {
        const auto from = line.begin() + static_cast<std::ptrdiff_t>(i - std::min(i, reach));
        const auto end = line.begin() + static_cast<std::ptrdiff_t>(std::min(length, i + reach + 1));
        values[first + i * stride] = highest ? *std::max_element(from, end) : *std::min_element(from, end);
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

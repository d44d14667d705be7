// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/mean_depth.h"

#include <algorithm>
#include <cassert>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace octotomy::voxel {
namespace {

constexpr int cell_px = 4;

/// The last cell whose centre is not behind a pixel's centre, and the weight of the next cell.
std::pair<int, float> between_cells(int pixel, int cells) {
  const float at = std::clamp((static_cast<float>(pixel) + 0.5f) / static_cast<float>(cell_px) - 0.5f, 0.0f,
                              static_cast<float>(cells - 1));
  const int low = std::min(static_cast<int>(at), std::max(cells - 2, 0));
  return {low, at - static_cast<float>(low)};
}

}  // namespace

MeanDepth::MeanDepth(const DepthPlane& plane, const glm::ivec2& size_px)
    : cells_((size_px + (cell_px - 1)) / cell_px),
      sums_(static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y)),
      lit_(sums_.size()) {
  for (int x = 0; x < size_px.x; ++x) {
    const auto [low, share] = between_cells(x, cells_.x);
    low_cell_.push_back(static_cast<std::uint32_t>(low));
    share_.push_back(share);
  }
  tbb::parallel_for(0, cells_.y, [&](int cell_y) {
    for (int y = cell_y * cell_px; y < std::min((cell_y + 1) * cell_px, size_px.y); ++y) {
      const float* row = plane.depth.row(y);
      const glm::ivec2& lit = plane.lit[static_cast<std::size_t>(y)];
      for (int x = lit.x; x < lit.y; ++x) {
        const bool seen = row[x] < surely_lit_mm;
        sums_[index(x / cell_px, cell_y)] += seen ? row[x] : 0.0f;
        lit_[index(x / cell_px, cell_y)] += seen ? 1.0f : 0.0f;
      }
    }
  });
  const int reach = std::max(1, std::max(size_px.x, size_px.y) / (40 * cell_px));
  for (int pass = 0; pass < 2; ++pass) {
    blur(sums_, reach);
    blur(lit_, reach);
  }
}

/// Sums values over 2 reach + 1 cells along x, then along y.
void MeanDepth::blur(std::vector<float>& values, int reach) const {
  std::vector<float> between(values.size(), 0.0f);
  const auto each_row = [&](const auto& row) {
    constexpr int rows_a_task = 32;
    tbb::parallel_for(tbb::blocked_range<int>(0, cells_.y, rows_a_task),
                      [&](const tbb::blocked_range<int>& range) {
                        for (int y = range.begin(); y < range.end(); ++y) row(y);
                      });
  };
  each_row([&](int y) {
    for (int i = -reach; i <= reach; ++i) {
      const int first = std::max(0, -i);
      const int last = std::min(cells_.x, cells_.x - i);
      float* to = &between[index(0, y)];
      const float* from = &values[index(0, y)];
      for (int x = first; x < last; ++x) to[x] += from[x + i];
    }
  });
  each_row([&](int y) {
    float* to = &values[index(0, y)];
    std::fill_n(to, cells_.x, 0.0f);
    for (int j = std::max(0, y - reach); j <= std::min(cells_.y - 1, y + reach); ++j) {
      const float* from = &between[index(0, j)];
      for (int x = 0; x < cells_.x; ++x) to[x] += from[x];
    }
  });
}

void MeanDepth::mean_row(int y, const glm::ivec2& span, std::vector<float>& to) const {
  assert(span.x >= 0 && (span.y <= span.x || static_cast<std::size_t>(span.y) <= to.size()));
  // Interpolates bilinearly between the cells' centres, separately for sums and for counts, so that cells
  // without lit pixels have no weight.
  const auto [j, t] = between_cells(y, cells_.y);
  const int above = std::min(j + 1, cells_.y - 1);
  thread_local std::vector<float> sums, lit;
  sums.resize(static_cast<std::size_t>(cells_.x) + 1);
  lit.resize(sums.size());
  for (int x = 0; x < cells_.x; ++x) {
    const auto cell = static_cast<std::size_t>(x);
    sums[cell] = (1.0f - t) * sums_[index(x, j)] + t * sums_[index(x, above)];
    lit[cell] = (1.0f - t) * lit_[index(x, j)] + t * lit_[index(x, above)];
  }
  sums.back() = sums[sums.size() - 2];
  lit.back() = lit[lit.size() - 2];
  for (int at = span.x; at < span.y; ++at) {
    const auto x = static_cast<std::size_t>(at);
    const std::uint32_t cell = low_cell_[x];
    const float s = share_[x];
    to[x] = ((1.0f - s) * sums[cell] + s * sums[cell + 1]) /
            ((1.0f - s) * lit[cell] + s * lit[cell + 1] + 1e-20f);
  }
}

}  // namespace octotomy::voxel

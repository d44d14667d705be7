// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 number the points' cells along the curve; 2 sort by that number, 12 bits at a time from the lowest;
// 3 part the order where the curve leaves a cube, the largest first, and lay boxes over the runs.
#include "brep/mesh/morton_tree.h"

#include <array>
#include <bit>
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace octotomy::brep {
namespace {

constexpr int cell_bits = 20;  ///< of each axis
constexpr int digit_bits = 12;

/// 20 bits spread to every third.
std::uint64_t spread(std::uint64_t bits) {
  assert(bits < (1u << cell_bits));
  bits = (bits | bits << 32) & 0x001f00000000ffffu;
  bits = (bits | bits << 16) & 0x001f0000ff0000ffu;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
  return (bits | bits << 2) & 0x1249249249249249u;
}

using Keyed = std::pair<std::uint64_t, std::uint32_t>;

void sort_by_digits(std::vector<Keyed>& keyed) {
  std::vector<Keyed> sorted(keyed.size());
  for (int shift = 0; shift < 3 * cell_bits; shift += digit_bits) {
    const auto digit = [&](const Keyed& item) { return (item.first >> shift) & ((1u << digit_bits) - 1); };
    std::array<std::size_t, (1u << digit_bits) + 1> begin{};
    for (const Keyed& item : keyed) ++begin[digit(item) + 1];
    for (std::size_t d = 1; d < begin.size(); ++d) begin[d] += begin[d - 1];
    for (const Keyed& item : keyed) sorted[begin[digit(item)]++] = item;
    keyed.swap(sorted);
  }
}

std::vector<std::uint32_t> all_of(const Triangles& surface) {
  std::vector<std::uint32_t> faces(surface.faces.size());
  std::iota(faces.begin(), faces.end(), 0u);
  return faces;
}

}  // namespace

std::size_t MortonOrder::split(std::size_t begin, std::size_t end) const {
  assert(begin + 1 < end && end <= cells.size());
  const std::uint64_t first = cells[begin], last = cells[end - 1];
  if (first == last) return begin + (end - begin) / 2;
  const std::uint64_t parting = std::bit_floor(first ^ last), beyond = last & ~(parting - 1);
  return static_cast<std::size_t>(std::lower_bound(cells.begin() + static_cast<std::ptrdiff_t>(begin),
                                                   cells.begin() + static_cast<std::ptrdiff_t>(end), beyond) -
                                  cells.begin());
}

MortonOrder morton_order(const std::vector<glm::dvec3>& points_mm) {
  MortonOrder order{std::vector<std::uint32_t>(points_mm.size()),
                    std::vector<std::uint64_t>(points_mm.size())};
  if (points_mm.empty()) return order;
  glm::dvec3 low = points_mm.front(), high = low;
  for (const glm::dvec3& p : points_mm) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  // Halves, as the whole extent of the largest doubles is none.
  const glm::dvec3 half = glm::max(0.5 * high - 0.5 * low, glm::dvec3(std::numeric_limits<double>::min()));
  std::vector<Keyed> keyed(points_mm.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, keyed.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const glm::dvec3 share = glm::min((0.5 * points_mm[i] - 0.5 * low) / half, glm::dvec3(1.0));
      const glm::dvec3 cell = share * static_cast<double>((1u << cell_bits) - 1);
      keyed[i] = {spread(static_cast<std::uint64_t>(cell.x)) |
                      spread(static_cast<std::uint64_t>(cell.y)) << 1 |
                      spread(static_cast<std::uint64_t>(cell.z)) << 2,
                  static_cast<std::uint32_t>(i)};
    }
  });
  sort_by_digits(keyed);
  for (std::size_t i = 0; i < keyed.size(); ++i) {
    order.cells[i] = keyed[i].first;
    order.numbers[i] = keyed[i].second;
  }
  return order;
}

MortonTree::MortonTree(const Triangles& surface) : MortonTree(surface, all_of(surface)) {}

MortonTree::MortonTree(const Triangles& surface, const std::vector<std::uint32_t>& faces) {
  MortonOrder order;
  {
    std::vector<glm::dvec3> centres_mm(faces.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, faces.size(), 4096), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const auto& [a, b, c] = surface.faces[faces[i]];
        const glm::dvec3 &p = surface.points_mm[a], &q = surface.points_mm[b], &r = surface.points_mm[c];
        centres_mm[i] = 0.5 * glm::min(p, glm::min(q, r)) + 0.5 * glm::max(p, glm::max(q, r));
      }
    });
    order = morton_order(centres_mm);
  }
  faces_.resize(faces.size());
  for (std::size_t i = 0; i < faces_.size(); ++i) faces_[i] = faces[order.numbers[i]];
  boxes_.resize(faces_.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, faces_.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      for (const std::uint32_t v : surface.faces[faces_[i]]) boxes_[i].add(surface.points_mm[v]);
  });
  nodes_.reserve(faces_.size());
  if (!faces_.empty()) build(order, 0, static_cast<std::uint32_t>(faces_.size()));
}

void MortonTree::build(const MortonOrder& order, std::uint32_t begin, std::uint32_t end) {
  assert(begin < end && end <= faces_.size());
  const std::size_t self = nodes_.size();
  Node node{{}, begin, end, 0};
  nodes_.push_back(node);
  if (end - begin <= leaf_size) {
    for (std::uint32_t i = begin; i < end; ++i) node.box.add(boxes_[i]);
  } else {
    const auto middle = static_cast<std::uint32_t>(order.split(begin, end));
    build(order, begin, middle);
    node.second = static_cast<std::uint32_t>(nodes_.size());
    build(order, middle, end);
    node.box = nodes_[self + 1].box;
    node.box.add(nodes_[node.second].box);
  }
  nodes_[self] = node;
}

}  // namespace octotomy::brep

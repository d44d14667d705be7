// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 number the points' cells along the curve; 2 sort by that number, 12 bits at a time from the lowest;
// 3 split the order where the curve leaves a cube, largest cubes first, and build boxes around the runs.
#include "brep/mesh/morton_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>
#include <utility>

namespace octotomy::brep {
namespace {

constexpr int cell_bits = 20;  ///< of each axis
constexpr int digit_bits = 12;

/// Spreads 20 bits to every third position.
std::uint64_t spread(std::uint64_t bits) {
  assert(bits < (1u << cell_bits));
  bits = (bits | bits << 32) & 0x001f00000000ffffu;
  bits = (bits | bits << 16) & 0x001f0000ff0000ffu;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
  return (bits | bits << 2) & 0x1249249249249249u;
}

using Keyed = std::pair<std::uint64_t, std::uint32_t>;

/// Sorts by key; equal keys keep their order. The result does not depend on the number of threads.
void sort_by_digits(std::vector<Keyed>& keyed) {
  constexpr std::size_t digits = 1u << digit_bits, least_part = 1u << 16;
  const std::size_t parts = std::clamp<std::size_t>(
      keyed.size() / least_part, 1, static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
  const auto begin_of = [&](std::size_t part) { return keyed.size() * part / parts; };
  std::vector<Keyed> sorted(keyed.size());
  std::vector<std::array<std::size_t, digits>> places(parts);
  for (int shift = 0; shift < 3 * cell_bits; shift += digit_bits) {
    const auto digit = [&](const Keyed& item) { return (item.first >> shift) & (digits - 1); };
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
      places[part].fill(0);
      for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) ++places[part][digit(keyed[i])];
    });
    std::size_t place = 0;
    for (std::size_t d = 0; d < digits; ++d)
      for (auto& of_part : places) place += std::exchange(of_part[d], place);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
      for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i)
        sorted[places[part][digit(keyed[i])]++] = keyed[i];
    });
    keyed.swap(sorted);
  }
}

/// Calls body(i) for 0 .. count - 1, in parallel.
template <typename Body>
void for_each_number(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
  });
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
  using Bounds = std::pair<glm::dvec3, glm::dvec3>;
  const auto [low, high] = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, points_mm.size(), 4096),
      Bounds(points_mm.front(), points_mm.front()),
      [&](const auto& range, Bounds bounds) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          bounds = {glm::min(bounds.first, points_mm[i]), glm::max(bounds.second, points_mm[i])};
        return bounds;
      },
      [](const Bounds& a, const Bounds& b) {
        return Bounds(glm::min(a.first, b.first), glm::max(a.second, b.second));
      });
  // Uses half the extent, because the extent itself may overflow for the largest doubles.
  const glm::dvec3 half = glm::max(0.5 * high - 0.5 * low, glm::dvec3(std::numeric_limits<double>::min()));
  std::vector<Keyed> keyed(points_mm.size());
  for_each_number(keyed.size(), [&, low = low](std::size_t i) {
    const glm::dvec3 share = glm::min((0.5 * points_mm[i] - 0.5 * low) / half, glm::dvec3(1.0));
    const glm::dvec3 cell = share * static_cast<double>((1u << cell_bits) - 1);
    keyed[i] = {spread(static_cast<std::uint64_t>(cell.x)) | spread(static_cast<std::uint64_t>(cell.y)) << 1 |
                    spread(static_cast<std::uint64_t>(cell.z)) << 2,
                static_cast<std::uint32_t>(i)};
  });
  sort_by_digits(keyed);
  for_each_number(keyed.size(), [&](std::size_t i) {
    order.cells[i] = keyed[i].first;
    order.numbers[i] = keyed[i].second;
  });
  return order;
}

MortonTree::MortonTree(const Triangles& surface) : MortonTree(surface, all_of(surface)) {}

MortonTree::MortonTree(const Triangles& surface, const std::vector<std::uint32_t>& faces) {
  const auto corners_of = [&](std::uint32_t face) -> std::array<glm::dvec3, 3> {
    const auto& [a, b, c] = surface.faces[face];
    return {surface.points_mm[a], surface.points_mm[b], surface.points_mm[c]};
  };
  std::vector<glm::dvec3> centres_mm(faces.size());
  for_each_number(faces.size(), [&](std::size_t i) {
    const auto [p, q, r] = corners_of(faces[i]);
    centres_mm[i] = 0.5 * glm::min(p, glm::min(q, r)) + 0.5 * glm::max(p, glm::max(q, r));
  });
  const MortonOrder order = morton_order(centres_mm);
  centres_mm = {};
  faces_.resize(faces.size());
  boxes_.resize(faces.size());
  for_each_number(faces.size(), [&](std::size_t i) {
    faces_[i] = faces[order.numbers[i]];
    for (const glm::dvec3& corner : corners_of(faces_[i])) boxes_[i].add(corner);
  });
  if (!faces.empty()) build(order);
}

void MortonTree::build(const MortonOrder& order) {
  const auto count = static_cast<std::uint32_t>(faces_.size());
  const std::uint32_t task_size = std::max(count / 12, std::uint32_t{1} << 14);
  // The tree's upper nodes, each before its children, over runs that are built in parallel.
  struct Upper {
    std::uint32_t begin, end, second;  ///< `second`: index of the second child in this list; 0 for a run
  };
  std::vector<Upper> upper;
  const auto part = [&](const auto& self, std::uint32_t begin, std::uint32_t end) -> void {
    const std::size_t own = upper.size();
    upper.push_back({begin, end, 0});
    if (end - begin <= task_size) return;
    const auto middle = static_cast<std::uint32_t>(order.split(begin, end));
    self(self, begin, middle);
    upper[own].second = static_cast<std::uint32_t>(upper.size());
    self(self, middle, end);
  };
  part(part, 0, count);

  std::vector<std::vector<Node>> runs(upper.size());
  tbb::parallel_for(std::size_t{0}, upper.size(), [&](std::size_t u) {
    if (upper[u].second != 0) return;
    runs[u].reserve(upper[u].end - upper[u].begin);
    append(order, upper[u].begin, upper[u].end, runs[u]);
  });
  std::vector<std::uint32_t> first(upper.size() + 1, 0);  // first node of each upper node
  for (std::size_t u = 0; u < upper.size(); ++u)
    first[u + 1] = first[u] + (upper[u].second != 0 ? 1 : static_cast<std::uint32_t>(runs[u].size()));
  nodes_.reserve(first.back());
  for (std::size_t u = 0; u < upper.size(); ++u)
    if (upper[u].second != 0)
      nodes_.push_back({{}, upper[u].begin, upper[u].end, first[upper[u].second]});
    else
      nodes_.insert(nodes_.end(), runs[u].begin(), runs[u].end());
  tbb::parallel_for(std::size_t{0}, upper.size(), [&](std::size_t u) {
    if (upper[u].second == 0)
      for (std::uint32_t n = first[u]; n < first[u + 1]; ++n)
        if (!nodes_[n].is_leaf()) nodes_[n].second += first[u];
  });
  for (std::size_t u = upper.size(); u-- > 0;)
    if (upper[u].second != 0) {
      Node& node = nodes_[first[u]];
      for (const std::uint32_t child : {first[u] + 1, node.second}) node.box.add(nodes_[child].box);
    }
}

void MortonTree::append(const MortonOrder& order, std::uint32_t begin, std::uint32_t end,
                        std::vector<Node>& nodes) const {
  assert(begin < end && end <= faces_.size());
  const std::size_t self = nodes.size();
  Node node{{}, begin, end, 0};
  nodes.push_back(node);
  if (end - begin <= leaf_size) {
    for (std::uint32_t i = begin; i < end; ++i) node.box.add(boxes_[i]);
  } else {
    const auto middle = static_cast<std::uint32_t>(order.split(begin, end));
    append(order, begin, middle, nodes);
    node.second = static_cast<std::uint32_t>(nodes.size());
    append(order, middle, end, nodes);
    node.box = nodes[self + 1].box;
    node.box.add(nodes[node.second].box);
  }
  nodes[self] = node;
}

}  // namespace octotomy::brep

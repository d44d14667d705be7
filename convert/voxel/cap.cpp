// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 The rim's edges. For any surface, as many of them enter a vertex as leave it.
// 2 Follow edges from vertex to vertex. Where the way meets itself, the loop is cut off.
// 3 Fill each loop by strips to loops of half the length, then by a cone.
#include "convert/voxel/cap.h"

#include <algorithm>
#include <cstdint>

namespace octotomy::convert {
namespace {

using Loop = std::vector<glm::dvec3>;

struct RimEdge {
  std::uint32_t from = 0, to = 0;
};

/// Pass 1, in ascending order.
std::vector<RimEdge> rim_of(const brep::Triangles& surface) {
  std::vector<std::pair<std::uint64_t, int>> ways;
  ways.reserve(3 * surface.faces.size());
  for (const auto& face : surface.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = face[i], to = face[(i + 1) % 3];
      if (from != to)
        ways.emplace_back((std::uint64_t{std::min(from, to)} << 32) | std::max(from, to), from < to ? 1 : -1);
    }
  std::sort(ways.begin(), ways.end());
  std::vector<RimEdge> rim;
  for (std::size_t i = 0; i < ways.size();) {
    const std::uint64_t key = ways[i].first;
    int excess = 0;
    for (; i < ways.size() && ways[i].first == key; ++i) excess += ways[i].second;
    const auto low = static_cast<std::uint32_t>(key >> 32), high = static_cast<std::uint32_t>(key);
    const RimEdge edge = excess > 0 ? RimEdge{low, high} : RimEdge{high, low};
    rim.insert(rim.end(), static_cast<std::size_t>(std::abs(excess)), edge);
  }
  std::sort(rim.begin(), rim.end(), [](const RimEdge& a, const RimEdge& b) {
    return a.from != b.from ? a.from < b.from : a.to < b.to;
  });
  return rim;
}

/// Pass 2.
std::vector<Loop> loops_of(const brep::Triangles& surface, const std::vector<RimEdge>& rim) {
  constexpr std::size_t off_way = ~std::size_t{0};
  // For each vertex: its first edge that was not followed yet, and its place on the way.
  std::vector<std::size_t> next(surface.points_mm.size() + 1, 0), place(surface.points_mm.size(), off_way);
  for (const RimEdge& edge : rim) ++next[edge.from + 1];
  for (std::size_t v = 0; v + 1 < next.size(); ++v) next[v + 1] += next[v];
  std::vector<bool> followed(rim.size(), false);
  std::vector<Loop> loops;
  for (std::size_t first = 0; first < rim.size(); ++first) {
    if (followed[first]) continue;
    std::vector<std::uint32_t> way{rim[first].from};
    place[way[0]] = 0;
    // As many edges leave a vertex as enter it, so the way ends where it began.
    while (!way.empty()) {
      const std::size_t edge = next[way.back()];
      if (edge == rim.size() || rim[edge].from != way.back()) break;
      ++next[way.back()];
      followed[edge] = true;
      const std::uint32_t to = rim[edge].to;
      if (place[to] == off_way) {
        place[to] = way.size();
        way.push_back(to);
        continue;
      }
      Loop& loop = loops.emplace_back();
      for (std::size_t i = place[to]; i < way.size(); ++i) {
        loop.push_back(surface.points_mm[way[i]]);
        if (i > place[to]) place[way[i]] = off_way;
      }
      way.resize(place[to] + 1);
    }
    for (const std::uint32_t v : way) place[v] = off_way;
  }
  return loops;
}

/// Pass 3.
void fill(Loop loop, const glm::dvec3& offset_mm, std::vector<std::array<glm::dvec3, 3>>& cap) {
  constexpr std::size_t cone_size = 6;  // the longest loop that a cone fills
  glm::dvec3 offset = offset_mm;
  while (loop.size() > cone_size) {
    Loop half((loop.size() + 1) / 2);
    for (std::size_t i = 0; i < half.size(); ++i)
      half[i] = 0.5 * (loop[2 * i] + loop[std::min(2 * i + 1, loop.size() - 1)]) + offset;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::size_t after = (i + 1) % loop.size();
      cap.push_back({loop[after], loop[i], half[i / 2]});
      if (i / 2 != after / 2) cap.push_back({loop[after], half[i / 2], half[after / 2]});
    }
    loop = std::move(half);
    offset = glm::dvec3(0.0);
  }
  glm::dvec3 apex(0.0);
  for (const glm::dvec3& p : loop) apex += p / static_cast<double>(loop.size());
  for (std::size_t i = 0; i < loop.size(); ++i)
    cap.push_back({loop[(i + 1) % loop.size()], loop[i], apex + offset});
}

}  // namespace

std::vector<std::array<glm::dvec3, 3>> cap_of(const brep::Triangles& surface, const glm::dvec3& offset_mm) {
  std::vector<std::array<glm::dvec3, 3>> cap;
  for (Loop& loop : loops_of(surface, rim_of(surface))) fill(std::move(loop), offset_mm, cap);
  return cap;
}

}  // namespace octotomy::convert

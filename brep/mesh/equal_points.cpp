// SPDX-License-Identifier: AGPL-3.0-or-later
// A table of the first point at each place, by open addressing: no more than half full.
#include "brep/mesh/equal_points.h"

#include <bit>
#include <limits>

namespace octotomy::brep {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

std::uint64_t hash_of(const glm::dvec3& p) {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    // -0 stands where 0 does.
    hash = (hash ^ std::bit_cast<std::uint64_t>(p[axis] + 0.0)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash * 0xbf58476d1ce4e5b9u >> 20;
}

}  // namespace

std::vector<std::uint32_t> first_equal_points(const std::vector<glm::dvec3>& points_mm) {
  const std::size_t mask = std::bit_ceil(2 * points_mm.size() + 1) - 1;
  std::vector<std::uint32_t> table(mask + 1, none), first(points_mm.size());
  for (std::uint32_t v = 0; v < points_mm.size(); ++v) {
    first[v] = v;
    // What is no number equals nothing.
    if (glm::any(glm::isnan(points_mm[v]))) continue;
    std::size_t slot = hash_of(points_mm[v]) & mask;
    while (table[slot] != none && points_mm[table[slot]] != points_mm[v]) slot = (slot + 1) & mask;
    if (table[slot] == none) table[slot] = v;
    first[v] = table[slot];
  }
  return first;
}

std::vector<std::uint8_t> shared_points(const Triangles& triangles, const std::vector<std::uint32_t>& first,
                                        const std::vector<std::uint32_t>& label) {
  std::vector<std::uint32_t> label_at(first.size(), none);
  std::vector<std::uint8_t> several(first.size(), 0), shared(first.size(), 0);
  for (std::size_t f = 0; f < label.size(); ++f)
    for (const std::uint32_t v : triangles.faces[f]) {
      std::uint32_t& there = label_at[first[v]];
      if (there == none) there = label[f];
      several[first[v]] |= there != label[f];
    }
  for (std::size_t v = 0; v < first.size(); ++v) shared[v] = several[first[v]];
  return shared;
}

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
// A hash table of the first point at each position, with open addressing, at most half full.
#include "brep/mesh/equal_points.h"

#include <bit>
#include <cassert>
#include <limits>

namespace octotomy::brep {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

std::uint64_t hash_of(const glm::dvec3& p) {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    // Adding 0.0 gives -0 the same hash as 0.
    hash = (hash ^ std::bit_cast<std::uint64_t>(p[axis] + 0.0)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash * 0xbf58476d1ce4e5b9u >> 20;
}

/// The slot of a point in the table, or the free slot for it. Precondition: the table has a free slot.
std::size_t slot_of(const glm::dvec3& p, const std::vector<glm::dvec3>& points_mm,
                    const std::vector<std::uint32_t>& table) {
  const std::size_t mask = table.size() - 1;
  std::size_t slot = hash_of(p) & mask;
  while (table[slot] != none && points_mm[table[slot]] != p) slot = (slot + 1) & mask;
  return slot;
}

/// NaN equals nothing, so such points are not stored: many of them in one table would make searches slow.
bool has_place(const glm::dvec3& p) {
  return !glm::any(glm::isnan(p));
}

/// The size of a table that `points` points fill at most by half.
std::size_t table_size(std::size_t points) {
  return std::bit_ceil(2 * points + 1);
}

}  // namespace

PointNumbers::PointNumbers(std::vector<glm::dvec3>& points_mm, std::size_t expected) : points_mm_(points_mm) {
  assert(points_mm.empty());
  points_mm_.reserve(expected);
  make_room(expected);
}

void PointNumbers::make_room(std::size_t expected) {
  table_.assign(table_size(expected), none);
  for (std::uint32_t v = 0; v < points_mm_.size(); ++v)
    if (has_place(points_mm_[v])) table_[slot_of(points_mm_[v], points_mm_, table_)] = v;
}

std::uint32_t PointNumbers::number_of(const glm::dvec3& p_mm) {
  const auto next = static_cast<std::uint32_t>(points_mm_.size());
  if (has_place(p_mm)) {
    std::uint32_t& number = table_[slot_of(p_mm, points_mm_, table_)];
    if (number != none) return number;
    number = next;
  }
  points_mm_.push_back(p_mm + 0.0);  // -0 becomes 0
  if (2 * points_mm_.size() >= table_.size()) make_room(2 * points_mm_.size());
  return next;
}

void PointNumbers::number(std::span<const glm::dvec3> points_mm, std::span<std::uint32_t> numbers) {
  assert(numbers.size() == points_mm.size());
  for (const glm::dvec3& p : points_mm) __builtin_prefetch(&table_[hash_of(p) & (table_.size() - 1)]);
  for (std::size_t i = 0; i < points_mm.size(); ++i) numbers[i] = number_of(points_mm[i]);
}

std::vector<std::uint32_t> first_equal_points(const std::vector<glm::dvec3>& points_mm) {
  std::vector<std::uint32_t> table(table_size(points_mm.size()), none), first(points_mm.size());
  for (std::uint32_t v = 0; v < points_mm.size(); ++v) {
    first[v] = v;
    if (!has_place(points_mm[v])) continue;
    std::uint32_t& there = table[slot_of(points_mm[v], points_mm, table)];
    if (there == none) there = v;
    first[v] = there;
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

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/visits.h"

#include <cassert>

namespace octotomy::voxel {
namespace {

std::uint64_t& of_status(LevelCount& level, Status status) {
  return status == Status::Partial ? level.partial : status == Status::Full ? level.full : level.empty;
}

void add_levels(std::vector<LevelCount>& to, const std::vector<LevelCount>& from) {
  if (to.size() < from.size()) to.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    to[i].level = from[i].level;
    to[i].partial += from[i].partial;
    to[i].full += from[i].full;
    to[i].empty += from[i].empty;
  }
}

/// The share of nodes without a visit if `visited` of them have one; none if there is no node.
std::optional<double> share_without(const std::vector<LevelCount>& levels, std::uint64_t visited) {
  std::uint64_t nodes = 0;
  for (const LevelCount& level : levels) nodes += level.partial + level.full + level.empty;
  if (nodes == 0) return std::nullopt;
  return 1.0 - static_cast<double>(visited) / static_cast<double>(nodes);
}

/// A key that identifies the node: sixteen bits for each coordinate and for the level.
std::uint64_t key_of(int level, const glm::ivec3& corner) {
  assert(glm::all(glm::greaterThanEqual(corner, glm::ivec3(0))) && level < 16);
  static_assert(Universe::max_depth <= 12);
  return static_cast<std::uint64_t>(corner.x) | static_cast<std::uint64_t>(corner.y) << 16 |
         static_cast<std::uint64_t>(corner.z) << 32 | static_cast<std::uint64_t>(level) << 48;
}

}  // namespace

std::optional<double> Visits::unvisited_fraction() const {
  return share_without(existing, visited_count);
}

std::optional<double> Visits::directly_unvisited_fraction() const {
  return share_without(existing, directly_visited_count);
}

void Visits::add(const Visits& other) {
  add_levels(existing, other.existing);
  add_levels(direct.octree, other.direct.octree);
  add_levels(all.octree, other.all.octree);
  direct.quadtree += other.direct.quadtree;
  all.quadtree += other.all.quadtree;
  visited_count += other.visited_count;
  directly_visited_count += other.directly_visited_count;
  pixel_count = other.pixel_count;
}

VisitCounter::VisitCounter(std::vector<LevelCount> existing, std::uint64_t pixel_count) {
  visits_.pixel_count = pixel_count;
  for (const LevelCount& level : existing) {
    visits_.direct.octree.push_back({level.level, 0, 0, 0});
    visits_.all.octree.push_back({level.level, 0, 0, 0});
  }
  visits_.existing = std::move(existing);
}

void VisitCounter::direct(int level, Status status, const glm::ivec3& corner) {
  if (level == 0) return;
  ++of_status(visits_.direct.octree[static_cast<std::size_t>(level - 1)], status);
  ++of_status(visits_.all.octree[static_cast<std::size_t>(level - 1)], status);
  visited_.insert(key_of(level, corner));
  directly_visited_.insert(key_of(level, corner));
}

void VisitCounter::indirect(int level, Status status, const glm::ivec3& corner) {
  if (level == 0) return;
  ++of_status(visits_.all.octree[static_cast<std::size_t>(level - 1)], status);
  visited_.insert(key_of(level, corner));
}

Visits VisitCounter::visits() const {
  Visits visits = visits_;
  visits.visited_count = visited_.size();
  visits.directly_visited_count = directly_visited_.size();
  return visits;
}

}  // namespace octotomy::voxel

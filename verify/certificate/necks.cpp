// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A neck may be thinner than the spacing of the voxels, and then no path of voxels leads through it. So a part that
// no voxel connects is followed through the witness's reading, at `fine` points per voxel edge. A point belongs to
// the path if the reading allows either kernel to have it inside. Bone may be thinner than the spacing of these
// points as well, over the whole length of a path. A part that the reading does not connect counts as connected if
// the component of the mesh that contains it contains voxels of both answers.
#include "verify/certificate/necks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <iterator>
#include <memory>
#include <optional>
#include <tbb/task_arena.h>
#include <unordered_set>
#include <utility>
#include <vector>

#include "brep/mesh/components.h"
#include "brep/mesh/triangles.h"
#include "convert/voxel/voxelise.h"
#include "verify/certificate/place_fault.h"
#include "verify/witness/witness.h"
#include "voxel/filter/components.h"
#include "voxel/filter/morphology.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

constexpr int fine = 4;
/// neck_by_reading() gives up after this number of points, which is a few thousand voxels.
constexpr std::size_t most_followed = 200000;

bool has(const voxel::Octree& octree, const glm::ivec3& at) {
  return is_within(at, octree) && octree.contains(at);
}
glm::ivec3 beside(const glm::ivec3& at, int neighbour) {
  return at + glm::ivec3(neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1);
}

voxel::Octree connected(const voxel::Octree& set, const voxel::Octree& common) {
  return voxel::components_that_meet(set, common, voxel::Neighbours::Corners);
}

}  // namespace

Necks::Necks(voxel::Octree octree, voxel::Octree digitised, Witness whole)
    : octree_(std::move(octree)), whole_(std::move(whole)), digitised_(std::move(digitised)) {}

Necks::Necks(ChosenParts chosen, Witness whole)
    : octree_(std::move(chosen.voxels)),
      solid_(std::move(chosen.mesh)),
      whole_(std::move(whole)),
      decided_mm_(std::move(chosen.decided_mm)),
      kept_mm_(std::move(chosen.kept_mm)),
      sample_mm_(chosen.sample_mm) {}

void Necks::prepare() const {
  if (common_) return;
  if (!digitised_) digitised_ = convert::voxelise(octree_.universe(), solid_->linked());
  common_ = voxel::combine(octree_.universe(), voxel::Expression(octree_) & voxel::Expression(*digitised_));
  by_voxels_.set = &octree_;
  by_mesh_.set = &*digitised_;
}

Necks::Side* Necks::side_near(const glm::ivec3& at) const {
  const auto side_at = [&](const glm::ivec3& voxel) -> Side* {
    const bool in_voxels = has(octree_, voxel), in_mesh = has(*digitised_, voxel);
    return in_voxels == in_mesh ? nullptr : in_voxels ? &by_voxels_ : &by_mesh_;
  };
  constexpr int middle = 13;
  if (Side* here = side_at(beside(at, middle))) return here;
  for (int neighbour = 0; neighbour < 27; ++neighbour)
    if (Side* near = side_at(beside(at, neighbour))) return near;
  return nullptr;
}

bool Necks::is_thick(Side& side, const std::vector<glm::ivec3>& part) const {
  if (!side.eroded) {
    const glm::dvec3 voxel_mm = octree_.universe().lattice().spacing_mm();
    // A little more than a voxel or half a sample, whichever is larger.
    const glm::dvec3 past_mm = 1.01 * glm::max(voxel_mm, 0.5 * sample_mm_);
    const double radius_mm = std::max({past_mm.x, past_mm.y, past_mm.z});
    side.eroded = connected(voxel::erode(*side.set, radius_mm), *common_);
  }
  return std::any_of(part.begin(), part.end(), [&](const glm::ivec3& at) { return has(*side.eroded, at); });
}

bool Necks::is_surely_connected(const std::vector<glm::ivec3>& part) const {
  const voxel::Lattice lattice = octree_.universe().lattice();
  const auto is_sure = [&](const glm::dvec3& voxel) {
    const Reading reading = whole_.allowed_sides(lattice.lps_mm(voxel));
    return reading.voxel.in && !reading.voxel.near && reading.mesh.in && !reading.mesh.near;
  };
  // The part is a whole group of touching voxels, so the first step of a path out of it reaches a voxel of
  // both answers.
  const auto leads_to = [&](const glm::ivec3& at, const glm::ivec3& on) {
    for (int i = 0; i <= fine; ++i)
      if (!is_sure(glm::mix(glm::dvec3(at), glm::dvec3(on), static_cast<double>(i) / fine))) return false;
    return true;
  };
  return std::any_of(part.begin(), part.end(), [&](const glm::ivec3& at) {
    if (has(octree_, at) == has(*digitised_, at)) return false;
    for (int axis = 0; axis < 3; ++axis)
      for (const int by : {-1, 1}) {
        glm::ivec3 on = at;
        on[axis] += by;
        if (has(*common_, on) && leads_to(at, on)) return true;
      }
    return false;
  });
}

std::optional<glm::dvec3> Necks::neck_by_voxels(Side& side, const std::vector<glm::ivec3>& part) const {
  if (!side.whole) side.whole = connected(*side.set, *common_);
  if (!has(*side.whole, part.front())) return std::nullopt;
  const voxel::Lattice lattice = octree_.universe().lattice();
  for (const glm::ivec3& at : part)
    for (int neighbour = 0; neighbour < 27; ++neighbour)
      if (has(*common_, beside(at, neighbour))) return lattice.lps_mm(glm::dvec3(at));
  return lattice.lps_mm(glm::dvec3(part.front()));
}

std::optional<glm::dvec3> Necks::neck_by_reading(const glm::ivec3& from) const {
  const voxel::Lattice lattice = octree_.universe().lattice();
  const glm::ivec3 end(fine * octree_.universe().side());
  const auto key = [](const glm::ivec3& at) {
    return (static_cast<std::uint64_t>(at.z) << 42) | (static_cast<std::uint64_t>(at.y) << 21) |
           static_cast<std::uint64_t>(at.x);
  };
  std::deque<glm::ivec3> next{fine * from};
  std::unordered_set<std::uint64_t> seen{key(next.front())};
  while (!next.empty() && seen.size() < most_followed) {
    const glm::ivec3 at = next.front();
    next.pop_front();
    for (int axis = 0; axis < 3; ++axis)
      for (const int by : {-1, 1}) {
        glm::ivec3 on = at;
        on[axis] += by;
        if (glm::any(glm::lessThan(on, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(on, end))) continue;
        if (!seen.insert(key(on)).second) continue;
        const glm::dvec3 p_mm = lattice.lps_mm(glm::dvec3(on) / static_cast<double>(fine));
        const Reading reading = whole_(p_mm, 0.0);
        if (!reading.voxel.in && !reading.mesh.in) continue;
        if (on % fine == glm::ivec3(0) && has(*common_, on / fine)) return p_mm;
        next.push_back(on);
      }
  }
  return std::nullopt;
}

std::optional<glm::dvec3> Necks::neck_by_mesh(const std::vector<glm::ivec3>& part) const {
  if (!solid_) return std::nullopt;
  const voxel::Universe& universe = octree_.universe();
  const brep::Triangles& triangles = solid_->triangles();
  const auto voxel_of = [&](std::uint32_t face) {
    return glm::ivec3(
        glm::round(universe.lattice().voxel(triangles.points_mm[triangles.faces[face].front()])));
  };
  const auto is_beside = [](const glm::ivec3& at, const auto& is_in) {
    for (int neighbour = 0; neighbour < 27; ++neighbour)
      if (is_in(beside(at, neighbour))) return true;
    return false;
  };
  const auto is_in_part = [&](const glm::ivec3& at) {
    return std::binary_search(part.begin(), part.end(), at, before);
  };
  for (const brep::Component& component : solid_->components()) {
    std::vector<std::uint32_t> next;
    std::copy_if(component.faces.begin(), component.faces.end(), std::back_inserter(next),
                 [&](std::uint32_t face) { return is_beside(voxel_of(face), is_in_part); });
    if (next.empty()) continue;
    const brep::Solid alone = brep::trusted_solid(brep::part_of(solid_->mesh(), component.faces),
                                                  brep::proof_of_part(solid_->proof()));
    const voxel::Octree own = convert::voxelise(universe, alone.linked());
    if (!has(own, part.front())) continue;
    const voxel::Octree joined =
        voxel::combine(universe, voxel::Expression(own) & voxel::Expression(*common_));
    if (joined.is_empty()) return std::nullopt;
    // Walks along the surface from the part. The first place beside voxels of both answers is beyond the neck.
    std::vector<bool> seen(triangles.faces.size(), false);
    for (const std::uint32_t face : next) seen[face] = true;
    for (std::size_t i = 0; i < next.size(); ++i) {
      const std::uint32_t face = next[i];
      if (is_beside(voxel_of(face), [&](const glm::ivec3& at) { return has(joined, at); }))
        return triangles.points_mm[triangles.faces[face].front()];
      for (std::uint32_t side = 3 * face; side < 3 * face + 3; ++side) {
        const std::uint32_t neighbour = solid_->linked().opposite[side] / 3;
        if (seen[neighbour]) continue;
        seen[neighbour] = true;
        next.push_back(neighbour);
      }
    }
    return universe.lattice().lps_mm(glm::dvec3(part.front()));
  }
  return std::nullopt;
}

bool Necks::is_near_any(const std::vector<glm::dvec3>& places_mm, const glm::dvec3& neck_mm) const {
  const glm::dvec3 voxel_mm = octree_.universe().lattice().spacing_mm();
  const double near_mm = 2.0 * bridge_voxels * std::max({voxel_mm.x, voxel_mm.y, voxel_mm.z});
  return std::any_of(places_mm.begin(), places_mm.end(),
                     [&](const glm::dvec3& at_mm) { return glm::distance(at_mm, neck_mm) <= near_mm; });
}

std::optional<glm::dvec3> Necks::any_neck_mm(const std::vector<glm::dvec3>& part_mm) const {
  const std::lock_guard lock(mutex_);
  // Isolated: a thread that waits for the parallel loops below must not start another task, which could wait
  // for this mutex.
  return tbb::this_task_arena::isolate([&]() -> std::optional<glm::dvec3> {
    prepare();
    const voxel::Lattice lattice = octree_.universe().lattice();
    std::vector<glm::ivec3> part;
    Side* side = nullptr;
    for (const glm::dvec3& p_mm : part_mm) {
      part.emplace_back(glm::round(lattice.voxel(p_mm)));
      Side* near = side_near(part.back());
      if (near == nullptr) return std::nullopt;
      if (side == nullptr) side = near;
    }
    if (side == nullptr) return std::nullopt;
    const bool is_thin = !is_thick(*side, part);
    if (!is_thin && is_surely_connected(part)) return std::nullopt;
    std::optional<glm::dvec3> neck = neck_by_voxels(*side, part);
    if (!neck && is_thin) neck = neck_by_reading(part.front());
    if (!neck && is_thin && side == &by_mesh_) {
      std::sort(part.begin(), part.end(), before);
      neck = neck_by_mesh(part);
    }
    return neck;
  });
}

std::optional<glm::dvec3> Necks::neck_mm(const std::vector<glm::dvec3>& part_mm) const {
  const std::optional<glm::dvec3> neck = any_neck_mm(part_mm);
  return neck && is_near_any(decided_mm_, *neck) ? std::nullopt : neck;
}

bool Necks::keeps(const std::vector<glm::dvec3>& part_mm, const glm::dvec3& found_mm) const {
  if (kept_mm_.empty()) return false;
  if (is_near_any(kept_mm_, found_mm)) return true;
  const std::optional<glm::dvec3> neck = any_neck_mm(part_mm);
  return neck && is_near_any(kept_mm_, *neck);
}

namespace {

/// The place of the thin neck by which one of the choices connects a part; none if there is no such neck.
/// `part_mm` is in the frame of the judged object.
std::optional<WorstPlace> bridge_of(const std::vector<glm::dvec3>& part_mm, bool in_voxels, double volume_mm3,
                                    const std::vector<PartChoice>& choices) {
  for (const PartChoice& choice : choices) {
    std::vector<glm::dvec3> chosen_mm;
    for (const glm::dvec3& p_mm : part_mm)
      chosen_mm.emplace_back(choice.chosen_from_made * glm::dvec4(p_mm, 1.0));
    if (const std::optional<glm::dvec3> neck = choice.necks->neck_mm(chosen_mm))
      return WorstPlace{glm::dvec3(glm::inverse(choice.chosen_from_made) * glm::dvec4(*neck, 1.0)),
                        std::cbrt(volume_mm3),
                        in_voxels ? "the voxel kernel keeps a part beyond a thin neck"
                                  : "the mesh kernel keeps a part beyond a thin neck",
                        volume_mm3};
  }
  return std::nullopt;
}

}  // namespace

bool before(const glm::ivec3& a, const glm::ivec3& b) {
  return a.z != b.z ? a.z < b.z : a.y != b.y ? a.y < b.y : a.x < b.x;
}

std::vector<std::vector<std::size_t>> groups_of(const std::vector<glm::ivec3>& voxels) {
  const auto index_of = [&](const glm::ivec3& at) {
    const auto found = std::lower_bound(voxels.begin(), voxels.end(), at, before);
    return found != voxels.end() && *found == at ? static_cast<std::size_t>(found - voxels.begin())
                                                 : voxels.size();
  };
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::uint8_t> seen(voxels.size(), 0);
  for (std::size_t first = 0; first < voxels.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = 1;
    std::vector<std::size_t> group{first};
    for (std::size_t next = 0; next < group.size(); ++next)
      for (int neighbour = 0; neighbour < 27; ++neighbour) {
        const glm::ivec3 by(neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1);
        const std::size_t i = index_of(voxels[group[next]] + by);
        if (i == voxels.size() || seen[i]) continue;
        seen[i] = 1;
        group.push_back(i);
      }
    groups.push_back(std::move(group));
  }
  return groups;
}

// The two judged answers count as a choice, too, because they may differ by a thin neck.
Bridges::Bridges(const voxel::Octree& octree, const voxel::Octree& digitised, const Witness& witness)
    : octree_(octree) {
  if (witness.choices().empty()) return;
  for (const PartChoice& choice : witness.choices())
    if (choice.necks) choices_.push_back(choice);
  choices_.push_back({std::make_shared<const Necks>(octree, digitised, witness)});
}

std::vector<OpenPart> Bridges::take_from(std::vector<glm::ivec3>& voxels) const {
  if (choices_.empty()) return {};
  const voxel::Lattice lattice = octree_.universe().lattice();
  std::vector<OpenPart> open;
  std::vector<glm::ivec3> rest;
  for (const bool in_voxels : {true, false}) {
    std::vector<glm::ivec3> side;
    std::copy_if(voxels.begin(), voxels.end(), std::back_inserter(side),
                 [&](const glm::ivec3& at) { return octree_.contains(at) == in_voxels; });
    for (const std::vector<std::size_t>& part : groups_of(side)) {
      std::vector<glm::dvec3> part_mm;
      for (const std::size_t i : part) part_mm.push_back(lattice.lps_mm(glm::dvec3(side[i])));
      const double volume_mm3 = static_cast<double>(part.size()) * lattice.voxel_mm3();
      if (const std::optional<WorstPlace> bridge = bridge_of(part_mm, in_voxels, volume_mm3, choices_))
        open.push_back({*bridge, std::move(part_mm)});
      else
        for (const std::size_t i : part) rest.push_back(side[i]);
    }
  }
  voxels = std::move(rest);
  return open;
}

Witness witness_of_parts(Witness whole) {
  if (!whole) return {};
  std::vector<PartChoice> choices = whole.choices();
  choices.push_back({});
  return Witness([whole = std::move(whole)](const glm::dvec3& p_mm, double slack_mm,
                                            ReadingNeeds asked) -> Reading {
           const auto part = [](const AllowedSides& allowed) {
             return allowed == certainly_in ? either_by_choice : allowed;
           };
           const Reading reading = whole(p_mm, slack_mm, asked);
           return {part(reading.voxel), part(reading.mesh), reading.surfaces};
         })
      .with_choices(std::move(choices));
}

Witness witness_of_parts(Witness whole, ChosenParts chosen) {
  if (!whole) return {};
  const auto necks = std::make_shared<const Necks>(std::move(chosen), whole);
  Witness parts = witness_of_parts(std::move(whole));
  std::vector<PartChoice> choices = parts.choices();
  choices.back().necks = necks;
  return std::move(parts).with_choices(std::move(choices));
}

Witness witness_of_filled(Witness hollow) {
  if (!hollow) return {};
  std::vector<PartChoice> choices = hollow.choices();
  return Witness([hollow = std::move(hollow)](const glm::dvec3& p_mm, double slack_mm,
                                              ReadingNeeds asked) -> Reading {
           const auto filled = [](const AllowedSides& allowed) {
             return allowed == certainly_out ? either_by_choice : allowed;
           };
           const Reading reading = hollow(p_mm, slack_mm, asked);
           return {filled(reading.voxel), filled(reading.mesh), reading.surfaces};
         })
      .with_choices(std::move(choices));
}

}  // namespace octotomy::verify

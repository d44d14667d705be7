// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A neck may be thinner than the voxels are apart, and then no path of voxels leads through it. So a part
// that hangs on by no voxel is followed through the reading itself, at `fine` points to a voxel's edge, by
// whatever either kernel may call inside there.
#include "verify/necks.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <tbb/task_arena.h>
#include <unordered_set>

#include "convert/voxel/voxelise.h"
#include "voxel/filter/components.h"
#include "voxel/filter/morphology.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

constexpr int fine = 4;
/// A part that holds more of these points is followed no further: a few thousand voxels without a contact.
constexpr std::size_t most_followed = 200000;

bool is_within(const voxel::Octree& octree, const glm::ivec3& at) {
  return glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) &&
         glm::all(glm::lessThan(at, glm::ivec3(octree.universe().side())));
}
bool has(const voxel::Octree& octree, const glm::ivec3& at) {
  return is_within(octree, at) && octree.contains(at);
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

Necks::Necks(voxel::Octree octree, brep::Solid solid, Witness whole, std::vector<glm::dvec3> decided_mm)
    : octree_(std::move(octree)),
      solid_(std::move(solid)),
      whole_(std::move(whole)),
      decided_mm_(std::move(decided_mm)) {}

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
    constexpr double past_one_voxel = 1.01;
    const double radius_mm = past_one_voxel * std::max({voxel_mm.x, voxel_mm.y, voxel_mm.z});
    side.eroded = connected(voxel::erode(*side.set, radius_mm), *common_);
  }
  return std::any_of(part.begin(), part.end(), [&](const glm::ivec3& at) { return has(*side.eroded, at); });
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

bool Necks::is_decided(const glm::dvec3& neck_mm) const {
  const glm::dvec3 voxel_mm = octree_.universe().lattice().spacing_mm();
  const double near_mm = 2.0 * bridge_voxels * std::max({voxel_mm.x, voxel_mm.y, voxel_mm.z});
  return std::any_of(decided_mm_.begin(), decided_mm_.end(),
                     [&](const glm::dvec3& at_mm) { return glm::distance(at_mm, neck_mm) <= near_mm; });
}

std::optional<glm::dvec3> Necks::neck_mm(const std::vector<glm::dvec3>& part_mm) const {
  const std::lock_guard lock(mutex_);
  // A thread that waits for its own loops here must not begin a certificate that waits for this lock.
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
    if (side == nullptr || is_thick(*side, part)) return std::nullopt;
    std::optional<glm::dvec3> neck = neck_by_voxels(*side, part);
    if (!neck) neck = neck_by_reading(part.front());
    return neck && is_decided(*neck) ? std::nullopt : neck;
  });
}

}  // namespace octotomy::verify

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Voxels. A kernel's answer at a voxel's centre must be one that the witness allows for this kernel. Where
//   the witness cannot decide the side away from any surface, the kernels must agree.
//   Voxels at which the witness agrees with the mesh alone, where the voxel kernel could not know better, are
//   listed as lost by resampling.
// 2 Triangles. A triangle's centroid must lie where the witness has a surface, each vertex where a surface
//   has a vertex of its own or two surfaces cross.
// 3 Inside. A part that both kernels lack, or that both add, has no boundary, so step 1 does not compare it.
//   So the witness is read at every eighth voxel wherever the object may be: at the voxels with x + 2y + 4z a
//   multiple of 8, one in each block of two voxels a side.
// 4 Groups. Voxels that fail, joined by faces, edges and corners; the largest is the worst place.
// 5 Detection limit, by place_limit.h.
#include "verify/certificate/places.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "brep/mesh/triangles.h"
#include "convert/voxel/voxelise.h"
#include "verify/certificate/necks.h"
#include "verify/certificate/place_fault.h"
#include "verify/certificate/place_limit.h"
#include "voxel/measure/distance_map.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/octree_node.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::verify {
namespace {

/// WorstPlace::what for each PlaceFault.
constexpr std::array<const char*, 7> clauses{
    "",
    "the scan has a part there that the voxels lack",
    "the voxels have a part there that the scan lacks",
    "the scan has a part there that the mesh lacks",
    "the mesh has a part there that the scan lacks",
    "only one kernel has a part there",
    "walls or gaps thinner than a voxel were lost there by resampling"};

/// Whether resampling lost or filled a voxel. If only the choice of parts leaves the mesh's side open, that side
/// counts as decided: the mesh kernel's own interpolation decided it for the whole object.
bool is_lost(const Reading& reading, bool in_voxels, bool in_mesh) {
  return in_voxels != in_mesh && reading.voxel == either_side && !reading.mesh.is_open() &&
         reading.mesh.allows(in_mesh);
}

/// Lost voxels in a smaller group are left out, because chance decides about them.
constexpr std::size_t lost_voxels = 8;

struct FailedVoxel {
  glm::ivec3 at{0};
  PlaceFault fault = PlaceFault::None;
};

/// Appends the voxels of a block to `voxels`, child by child. The block's side is 4^height voxels; `low` is
/// its lowest voxel.
void collect(const voxel::BlockRef& block, int height, const glm::ivec3& low,
             std::vector<glm::ivec3>& voxels) {
  if (block.is_empty()) return;
  const int side = 1 << (2 * height);
  if (block.is_full()) {
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) voxels.push_back(low + glm::ivec3(x, y, z));
    return;
  }
  for (int child = 0; child < 64; ++child) {
    const glm::ivec3 at = low + glm::ivec3(child & 3, (child >> 2) & 3, child >> 4) * (side / 4);
    if (height > 2) {
      collect(block.child(child), height - 1, at, voxels);
      continue;
    }
    for (std::uint64_t word = block.word(child); word != 0; word &= word - 1) {
      const int bit = std::countr_zero(word);
      voxels.push_back(at + glm::ivec3(bit & 3, (bit >> 2) & 3, bit >> 4));
    }
  }
}

/// Sorts voxels of a universe by z, y, x and removes duplicates: a counting sort by slice, then a sort of
/// each slice.
void sort_and_unify(std::vector<glm::ivec3>& voxels, int side) {
  std::vector<std::size_t> end(static_cast<std::size_t>(side) + 1, 0);
  for (const glm::ivec3& at : voxels) ++end[static_cast<std::size_t>(at.z) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<std::size_t> next(end.begin(), end.end() - 1);
  // A voxel's place in its slice: rows of the universe one after the other.
  std::vector<std::uint32_t> places(voxels.size());
  for (const glm::ivec3& at : voxels)
    places[next[static_cast<std::size_t>(at.z)]++] = static_cast<std::uint32_t>(at.y * side + at.x);
  tbb::parallel_for(std::size_t{0}, next.size(), [&](std::size_t z) {
    const auto begin = places.begin() + static_cast<std::ptrdiff_t>(end[z]);
    std::sort(begin, places.begin() + static_cast<std::ptrdiff_t>(end[z + 1]));
    next[z] = static_cast<std::size_t>(
        std::unique(begin, places.begin() + static_cast<std::ptrdiff_t>(end[z + 1])) - places.begin());
  });
  voxels.clear();
  for (std::size_t z = 0; z < next.size(); ++z)
    for (std::size_t i = end[z]; i < next[z]; ++i) {
      const auto place = static_cast<int>(places[i]);
      voxels.emplace_back(place % side, place / side, static_cast<int>(z));
    }
}

/// The voxels to compare: those at which the kernels differ, and those on both sides of the octree's
/// boundary.
std::vector<glm::ivec3> compared_voxels(const voxel::Octree& octree, const voxel::Octree& digitised,
                                        const std::vector<voxel::VoxelFace>& boundary) {
  const voxel::Octree differing =
      voxel::combine(octree.universe(), voxel::Expression(octree) ^ voxel::Expression(digitised));
  std::vector<glm::ivec3> voxels;
  collect(differing.root(), differing.root_height(), glm::ivec3(0), voxels);
  const int side = octree.universe().side();
  for (const voxel::VoxelFace& face : boundary) {
    voxels.push_back(face.voxel);
    glm::ivec3 beyond = face.voxel;
    beyond[face.axis] += face.side;
    if (beyond[face.axis] >= 0 && beyond[face.axis] < side) voxels.push_back(beyond);
  }
  sort_and_unify(voxels, side);
  return voxels;
}

std::vector<FailedVoxel> failed_voxels(const voxel::Octree& octree, const voxel::Octree& digitised,
                                       const std::vector<glm::ivec3>& voxels, const Witness& witness,
                                       const voxel::Progress& progress) {
  const glm::dmat4& lps_from_voxel = octree.universe().lps_from_voxel;
  std::vector<PlaceFault> faults(voxels.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, voxels.size(), 1024), [&](const auto& range) {
    if (progress.stop.stop_requested()) return;
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const glm::dvec3 p_mm(lps_from_voxel * glm::dvec4(glm::dvec3(voxels[i]), 1.0));
      const Reading reading = witness.allowed_sides(p_mm);
      const bool in_voxels = octree.contains(voxels[i]), in_mesh = digitised.contains(voxels[i]);
      faults[i] = fault_of(reading, in_voxels, in_mesh);
      if (faults[i] == PlaceFault::None && is_lost(reading, in_voxels, in_mesh)) faults[i] = PlaceFault::Lost;
    }
  });
  progress.at(0.5);
  std::vector<FailedVoxel> failed;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (faults[i] != PlaceFault::None) failed.push_back({voxels[i], faults[i]});
  return failed;
}

/// The voxels of a leaf as bits: those of the octree, and those that step 3 samples.
constexpr int leaf_side = 4;
std::uint64_t leaf_word(const voxel::Octree& octree, const glm::ivec3& low) {
  const glm::ivec3 leaf = (low / leaf_side) % leaf_side;
  return octree.leaf_block(low / 16).word(voxel::child_index(leaf.x, leaf.y, leaf.z));
}
std::uint64_t sampled_word(const glm::ivec3& low) {
  constexpr auto at_even_and_odd_leaves = [] {
    std::array<std::uint64_t, 2> words{};
    for (int bit = 0; bit < 64; ++bit)
      for (int odd = 0; odd < 2; ++odd)
        if (is_sampled(leaf_side * odd + (bit & 3), (bit >> 2) & 3, bit >> 4))
          words[static_cast<std::size_t>(odd)] |= std::uint64_t{1} << bit;
    return words;
  }();
  return at_even_and_odd_leaves[static_cast<std::size_t>(low.x / leaf_side % 2)];
}

/// The lowest voxels of all blocks that meet the box of the object's reading along lines or the box of the
/// octree's voxels.
constexpr int block_side = 8;
std::vector<glm::ivec3> blocks_of(const voxel::Octree& octree, const LineReading& lines) {
  const voxel::Lattice lattice = octree.universe().lattice();
  glm::dvec3 low(octree.universe().side()), high(-1.0);
  // A box with infinite sides has no corners; the whole universe replaces it.
  const bool is_bounded = glm::all(glm::lessThan(glm::abs(lines.box_mm.low_mm), glm::dvec3(1e9))) &&
                          glm::all(glm::lessThan(glm::abs(lines.box_mm.high_mm), glm::dvec3(1e9)));
  const voxel::Box box = is_bounded ? lines.box_mm : voxel::bounds(lattice);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p_voxel =
        lattice.voxel({corner & 1 ? box.high_mm.x : box.low_mm.x, corner & 2 ? box.high_mm.y : box.low_mm.y,
                       corner & 4 ? box.high_mm.z : box.low_mm.z});
    low = glm::min(low, p_voxel);
    high = glm::max(high, p_voxel);
  }
  if (!octree.is_empty()) {
    const voxel::VoxelRange range = voxel::range_of(octree);
    low = glm::min(low, glm::dvec3(range.low));
    high = glm::max(high, glm::dvec3(range.high));
  }
  const glm::ivec3 first(
      glm::clamp(glm::floor(low), glm::dvec3(0.0), glm::dvec3(octree.universe().side() - 1))),
      last(glm::clamp(glm::ceil(high), glm::dvec3(0.0), glm::dvec3(octree.universe().side() - 1)));
  std::vector<glm::ivec3> blocks;
  for (int z = first.z / block_side * block_side; z <= last.z; z += block_side)
    for (int y = first.y / block_side * block_side; y <= last.y; y += block_side)
      for (int x = first.x / block_side * block_side; x <= last.x; x += block_side)
        blocks.emplace_back(x, y, z);
  return blocks;
}

/// Sampled voxels on which both kernels agree and at which the witness's sides for the mesh contradict them.
/// Leaves out voxels in `compared`, which is sorted. Empty if the object has no reading along lines, because
/// that reading bounds the search.
std::vector<FailedVoxel> failed_inside(const voxel::Octree& octree, const voxel::Octree& digitised,
                                       const std::vector<glm::ivec3>& compared, const Witness& witness,
                                       const voxel::Progress& progress) {
  if (!witness.lines()) return {};
  const voxel::Lattice lattice = octree.universe().lattice();
  const std::vector<glm::ivec3> blocks = blocks_of(octree, witness.lines());
  std::vector<std::vector<FailedVoxel>> found(blocks.size());
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
    if (progress.stop.stop_requested()) return;
    const glm::dvec3 a = lattice.lps_mm(glm::dvec3(blocks[i]) - 0.5),
                     b = lattice.lps_mm(glm::dvec3(blocks[i] + block_side) - 0.5);
    const bool may_meet = witness.lines().may_meet({glm::min(a, b), glm::max(a, b)});
    for (int leaf = 0; leaf < 8; ++leaf) {
      const glm::ivec3 low = blocks[i] + leaf_side * glm::ivec3(leaf & 1, (leaf >> 1) & 1, leaf >> 2);
      const std::uint64_t voxels = leaf_word(octree, low);
      std::uint64_t tried = sampled_word(low) & ~(voxels ^ leaf_word(digitised, low));
      if (!may_meet) tried &= voxels;
      for (; tried != 0; tried &= tried - 1) {
        const int bit = std::countr_zero(tried);
        const glm::ivec3 at = low + voxel::child_place(bit);
        const bool inside = ((voxels >> bit) & 1) != 0;
        // The mesh's interpolation suffices, because the voxel kernel's interpolation differs from it only at
        // surfaces.
        if (!is_within(at, octree) || witness.mesh_sides(lattice.lps_mm(glm::dvec3(at))).allows(inside) ||
            std::binary_search(compared.begin(), compared.end(), at, before))
          continue;
        found[i].push_back({at, inside ? PlaceFault::MeshHas : PlaceFault::MeshLacks});
      }
    }
  });
  std::vector<FailedVoxel> failed;
  for (const std::vector<FailedVoxel>& part : found) failed.insert(failed.end(), part.begin(), part.end());
  return failed;
}

/// Adds failed samples of step 3. Each counts as the eight voxels of its block.
void add_inside(const std::vector<FailedVoxel>& failed, const voxel::Octree& octree, Places& places) {
  if (failed.empty()) return;
  const voxel::Lattice lattice = octree.universe().lattice();
  const std::uint64_t count = failed.size() * static_cast<std::uint64_t>(sampled_one_in);
  places.voxel_count += count;
  if (count <= places.largest_count) return;
  places.largest_count = count;
  const double volume_mm3 = static_cast<double>(count) * lattice.voxel_mm3();
  const FailedVoxel& middle = failed[failed.size() / 2];
  const bool lacks = middle.fault == PlaceFault::VoxelsLack || middle.fault == PlaceFault::MeshLacks;
  places.worst = WorstPlace{lattice.lps_mm(glm::dvec3(middle.at)), std::cbrt(volume_mm3),
                            lacks ? "the scan has a part there that both kernels lack"
                                  : "both kernels have a part there that the scan lacks",
                            volume_mm3};
}

/// Whether no voxel of the kernel that lacks this voxel shares a face with it. Neighbours whose side the
/// witness decides do not count, because a part that is certainly present belongs to another object.
bool hangs_on_no_face(const glm::ivec3& voxel, const voxel::Octree& octree, const voxel::Octree& digitised,
                      const Witness& witness) {
  const bool in_voxels = octree.contains(voxel);
  const voxel::Octree& lacking = in_voxels ? digitised : octree;
  for (int axis = 0; axis < 3; ++axis)
    for (const int by : {-1, 1}) {
      glm::ivec3 neighbour = voxel;
      neighbour[axis] += by;
      if (!is_within(neighbour, octree) || !lacking.contains(neighbour)) continue;
      const Reading reading =
          witness.allowed_sides(octree.universe().lattice().lps_mm(glm::dvec3(neighbour)));
      if ((in_voxels ? reading.mesh : reading.voxel).is_open()) return false;
    }
  return true;
}

/// The place of a group of failed voxels, described by the group's most frequent fault.
WorstPlace place_of(const std::vector<FailedVoxel>& group, const voxel::Lattice& lattice) {
  glm::dvec3 middle(0.0);
  std::array<std::size_t, clauses.size()> votes{};
  for (const FailedVoxel& voxel : group) {
    middle += glm::dvec3(voxel.at) / static_cast<double>(group.size());
    ++votes[static_cast<std::size_t>(voxel.fault)];
  }
  // The voxel nearest to the group's middle, so that the place lies in the group.
  const auto nearest =
      std::min_element(group.begin(), group.end(), [&](const FailedVoxel& a, const FailedVoxel& b) {
        return glm::distance(glm::dvec3(a.at), middle) < glm::distance(glm::dvec3(b.at), middle);
      });
  const auto fault = std::max_element(votes.begin(), votes.end()) - votes.begin();
  const double volume_mm3 = static_cast<double>(group.size()) * lattice.voxel_mm3();
  return {lattice.lps_mm(glm::dvec3(nearest->at)), std::cbrt(volume_mm3),
          clauses[static_cast<std::size_t>(fault)], volume_mm3};
}

/// Removes the lost voxels from `failed`, which is sorted. Adds them to `places.lost` in groups of
/// lost_voxels or more.
void take_lost(std::vector<FailedVoxel>& failed, const voxel::Octree& octree, Places& places) {
  std::vector<FailedVoxel> lost, rest;
  for (const FailedVoxel& voxel : failed) (voxel.fault == PlaceFault::Lost ? lost : rest).push_back(voxel);
  failed = std::move(rest);
  std::vector<glm::ivec3> voxels;
  for (const FailedVoxel& voxel : lost) voxels.push_back(voxel.at);
  std::size_t largest = 0;
  for (const std::vector<std::size_t>& members : groups_of(voxels)) {
    if (members.size() < lost_voxels) continue;
    std::vector<FailedVoxel> group;
    for (const std::size_t i : members) {
      group.push_back(lost[i]);
      places.lost.push_back(lost[i].at);
    }
    if (group.size() <= largest) continue;
    largest = group.size();
    places.worst_lost = place_of(group, octree.universe().lattice());
  }
  std::sort(places.lost.begin(), places.lost.end(), before);
}

/// Whether a small group that chance may explain is left out (Allowed) or kept (Excluded).
enum class Chance : std::uint8_t { Allowed, Excluded };

/// Joins the failed voxels, which are sorted, into groups. With `Chance::Allowed`, first leaves out groups
/// that chance explains. Moves parts beyond thin necks to `places.open`, and keeps the largest remaining
/// group as the worst place.
void add_groups(const std::vector<FailedVoxel>& failed, const voxel::Octree& octree,
                const voxel::Octree& digitised, const Witness& witness, Chance chance, Places& places) {
  const Bridges bridges(octree, digitised, witness);
  std::vector<glm::ivec3> voxels;
  for (const FailedVoxel& voxel : failed) voxels.push_back(voxel.at);
  for (std::vector<std::size_t>& members : groups_of(voxels)) {
    std::sort(members.begin(), members.end());
    std::vector<FailedVoxel> group;
    for (const std::size_t i : members) group.push_back(failed[i]);
    if (std::all_of(group.begin(), group.end(),
                    [](const FailedVoxel& voxel) { return voxel.fault == PlaceFault::Apart; })) {
      if (chance == Chance::Allowed && group.size() < chance_voxels &&
          std::all_of(group.begin(), group.end(), [&](const FailedVoxel& voxel) {
            return hangs_on_no_face(voxel.at, octree, digitised, witness);
          }))
        continue;
      std::vector<glm::ivec3> rest;
      for (const FailedVoxel& voxel : group) rest.push_back(voxel.at);
      for (OpenPart& part : bridges.take_from(rest)) places.open.push_back(std::move(part));
      group.clear();
      for (const glm::ivec3& at : rest) group.push_back({at, PlaceFault::Apart});
      if (group.empty()) continue;
    }
    places.voxel_count += group.size();
    if (group.size() <= places.largest_count) continue;
    places.largest_count = group.size();
    places.worst = place_of(group, octree.universe().lattice());
  }
  std::stable_sort(places.open.begin(), places.open.end(), [](const OpenPart& a, const OpenPart& b) {
    return a.bridge.volume_mm3 > b.bridge.volume_mm3;
  });
}

void add_stray_triangles(const brep::Triangles& mesh, const Witness& witness, const voxel::Progress& progress,
                         Places& places) {
  const auto for_all = [&](std::size_t count, const auto& judge) {
    std::vector<std::uint8_t> wrong(count, 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024), [&](const auto& range) {
      if (progress.stop.stop_requested()) return;
      for (std::size_t i = range.begin(); i != range.end(); ++i) wrong[i] = judge(i) ? 0 : 1;
    });
    return wrong;
  };
  const std::vector<std::uint8_t> stray_vertex = for_all(mesh.points_mm.size(), [&](std::size_t i) {
    const Reading reading = witness.of_mesh(mesh.points_mm[i]);
    return reading.mesh.near && reading.surfaces >= 2;
  });
  const std::vector<std::uint8_t> stray = for_all(mesh.faces.size(), [&](std::size_t i) {
    const auto& face = mesh.faces[i];
    return std::none_of(face.begin(), face.end(),
                        [&](std::uint32_t vertex) { return stray_vertex[vertex] != 0; }) &&
           witness.mesh_sides(centred_face(mesh, i).centroid_mm).near;
  });
  progress.at(0.8);
  double largest_mm2 = 0.0;
  for (std::size_t i = 0; i < stray.size(); ++i) {
    if (!stray[i]) continue;
    const CentredFace facet = centred_face(mesh, i);
    places.stray_mm2 += facet.area_mm2;
    if (places.voxel_count > 0 || facet.area_mm2 <= largest_mm2) continue;
    largest_mm2 = facet.area_mm2;
    places.worst = WorstPlace{facet.centroid_mm, std::sqrt(facet.area_mm2),
                              "the mesh has a surface there that the scan lacks", 0.0};
  }
}

/// Steps 1 to 4 above. The limit stays zero.
Places contradictions(const voxel::Octree& octree, const voxel::Octree& digitised, const brep::Solid& solid,
                      const std::vector<voxel::VoxelFace>& boundary, const Witness& witness,
                      const voxel::Progress& progress) {
  Places places;
  const std::vector<glm::ivec3> voxels = compared_voxels(octree, digitised, boundary);
  progress.at(0.2);
  std::vector<FailedVoxel> failed = failed_voxels(octree, digitised, voxels, witness, progress);
  take_lost(failed, octree, places);
  add_groups(failed, octree, digitised, witness, Chance::Allowed, places);
  add_inside(failed_inside(octree, digitised, voxels, witness, progress), octree, places);
  add_stray_triangles(solid.triangles(), witness, progress, places);
  return places;
}

}  // namespace

Places contradicted_places(const voxel::Octree& octree, const voxel::Octree& digitised,
                           const brep::Solid& solid, const Witness& witness) {
  return contradictions(octree, digitised, solid, voxel::voxel_boundary(octree), witness, {});
}

std::vector<OpenPart> open_parts(const voxel::Octree& octree, const brep::Solid& solid,
                                 const Witness& witness) {
  if (!witness) return {};
  const voxel::Octree digitised = convert::voxelise(octree.universe(), solid.linked());
  Places places;
  std::vector<FailedVoxel> failed =
      failed_voxels(octree, digitised, compared_voxels(octree, digitised, {}), witness, {});
  take_lost(failed, octree, places);
  // Small groups count, too: they stay in objects that later steps make from this one, and a motion may
  // expose them there.
  add_groups(failed, octree, digitised, witness, Chance::Excluded, places);
  return std::move(places.open);
}

Places judge_places(const voxel::Octree& octree, const voxel::Octree& digitised, const brep::Solid& solid,
                    const Witness& witness, const voxel::Progress& progress) {
  const std::vector<voxel::VoxelFace> boundary = voxel::voxel_boundary(octree);
  Places places = contradictions(octree, digitised, solid, boundary, witness, progress);
  places.limit = place_limit(octree, digitised, solid, boundary, witness);
  progress.at(1.0);
  return places;
}

}  // namespace octotomy::verify

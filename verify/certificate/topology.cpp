// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/topology.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/components.h"
#include "voxel/filter/components.h"
#include "voxel/filter/morphology.h"
#include "voxel/measure/cell_counts.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/space/rounded.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::verify {
namespace {

using voxel::Expression;
using voxel::Neighbours;
using voxel::Octree;
using voxel::SliceBits;

Octree difference(const Octree& a, const Octree& b) {
  return voxel::combine(a.universe(), Expression(a) - Expression(b));
}
Octree cavities_of(const Octree& octree) {
  return difference(voxel::fill_cavities(octree), octree);
}
/// Sets in `centres` the voxels of the middle slice that are set with all their 26 neighbours. Returns
/// whether there is one.
bool set_centres_of_blocks(const std::array<SliceBits, 3>& slices, SliceBits& centres) {
  bool any = false;
  std::vector<std::uint64_t> all(static_cast<std::size_t>(centres.words_per_row) + 2, 0);
  for (int y = 1; y + 1 < centres.side; ++y) {
    for (int w = 0; w < centres.words_per_row; ++w) {
      std::uint64_t& word = all[static_cast<std::size_t>(w) + 1];
      word = ~std::uint64_t{0};
      for (const SliceBits& slice : slices)
        for (int by = -1; by <= 1; ++by) word &= slice.row(y + by)[w];
    }
    std::uint64_t* row =
        centres.words.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(centres.words_per_row);
    for (std::size_t w = 1; w + 1 < all.size(); ++w) {
      row[w - 1] = all[w] & ((all[w] << 1) | (all[w - 1] >> 63)) & ((all[w] >> 1) | (all[w + 1] << 63));
      any = any || row[w - 1] != 0;
    }
  }
  return any;
}

/// Returns the parts of an octree that hold a block of three voxels a side.
Octree with_blocks(const Octree& octree, Neighbours neighbours) {
  Octree large = voxel::components_of_at_least(octree, 27, neighbours);
  if (large.is_empty()) return large;
  const int side = large.universe().side();
  std::array<SliceBits, 3> slices;  // below, middle and above
  voxel::read_slice(large, 0, slices[2]);
  slices[1] = slices[2];
  std::fill(slices[1].words.begin(), slices[1].words.end(), 0);
  const Octree centres = voxel::octree_of_slices(large.universe(), [&](int z, SliceBits& drawn) {
    std::rotate(slices.begin(), slices.begin() + 1, slices.end());
    if (z + 1 == side) return false;
    voxel::read_slice(large, z + 1, slices[2]);
    return set_centres_of_blocks(slices, drawn);
  });
  return voxel::components_that_meet(large, centres, neighbours);
}

Unmatched told(const Octree& of_voxels, const Octree& of_mesh, Neighbours neighbours,
               const std::array<const char*, 2>& words) {
  Unmatched found;
  for (std::size_t i = 0; i < 2; ++i) {
    const Octree counted = with_blocks(i == 0 ? of_voxels : of_mesh, neighbours);
    const voxel::Components parts = voxel::components(counted, neighbours);
    if (parts.voxel_counts.empty()) continue;
    found.count += parts.voxel_counts.size();
    const voxel::Measures largest = voxel::measure(parts.largest);
    if (found.largest && found.largest->volume_mm3 >= largest.volume_mm3) continue;
    const glm::dvec3 extent_mm = largest.extents->high_mm - largest.extents->low_mm;
    found.largest = {0.5 * (largest.extents->low_mm + largest.extents->high_mm),
                     std::max({extent_mm.x, extent_mm.y, extent_mm.z}), words[i], largest.volume_mm3};
  }
  return found;
}

/// Returns the components of `parts` that share no voxel with `set`.
Octree apart_from(const Octree& parts, const Octree& set, Neighbours neighbours) {
  return parts.is_empty() ? parts : difference(parts, voxel::components_that_meet(parts, set, neighbours));
}

Topology topology(const Octree& octree, const Octree& cavities) {
  Topology found;
  found.parts = static_cast<std::int64_t>(voxel::component_count(octree, Neighbours::Corners));
  found.cavities = static_cast<std::int64_t>(voxel::component_count(cavities, Neighbours::Faces));
  found.tunnels = found.parts + found.cavities - voxel::euler_numbers(octree).by_corners;
  return found;
}

struct Hollow {
  const Octree& set;
  Octree cavities;
};

Unmatched unmatched_cavities(const Hollow& voxels, const Hollow& mesh) {
  const auto filled_by = [](const Hollow& own, const Octree& other) {
    return apart_from(own.cavities, difference(own.cavities, other), Neighbours::Faces);
  };
  return told(filled_by(voxels, mesh.set), filled_by(mesh, voxels.set), Neighbours::Faces,
              {"the mesh has filled a cavity there", "the voxels have filled a cavity there"});
}

}  // namespace

Topology topology(const Octree& octree) {
  return topology(octree, cavities_of(octree));
}

Unmatched unmatched_parts(const Octree& voxels, const Octree& mesh) {
  return told(apart_from(voxels, mesh, Neighbours::Corners), apart_from(mesh, voxels, Neighbours::Corners),
              Neighbours::Corners, {part_of_voxels_only, part_of_mesh_only});
}

Unmatched unmatched_cavities(const Octree& voxels, const Octree& mesh) {
  return unmatched_cavities({voxels, cavities_of(voxels)}, {mesh, cavities_of(mesh)});
}

void compare_topology(Certificate& certificate, const Octree& octree, const Octree& digitised) {
  const bool are_equal = octree == digitised;
  const Hollow voxels{octree, cavities_of(octree)};
  const Hollow mesh{digitised, are_equal ? voxels.cavities : cavities_of(digitised)};
  const Topology of_voxels = topology(octree, voxels.cavities);
  const Topology of_mesh = are_equal ? of_voxels : topology(digitised, mesh.cavities);
  const auto add = [&](const char* quantity, std::int64_t in_voxels, std::int64_t in_mesh,
                       const Unmatched& unmatched, const std::string& of_one_alone) {
    const std::string where =
        unmatched.largest ? ", the largest near " + voxel::rounded(unmatched.largest->at_mm) : "";
    add_comparison(certificate,
                   {quantity, "", static_cast<double>(in_voxels), static_cast<double>(in_mesh),
                    static_cast<double>(unmatched.count), 0.0,
                    "0: each part of three voxels a side must share a voxel with a part of the other kernel",
                    of_one_alone + where + ": %"});
  };
  add("parts", of_voxels.parts, of_mesh.parts, are_equal ? Unmatched() : unmatched_parts(octree, digitised),
      "Parts that one kernel alone has");
  add("cavities", of_voxels.cavities, of_mesh.cavities,
      are_equal ? Unmatched() : unmatched_cavities(voxels, mesh), "Cavities that one kernel alone has");
  add_comparison(certificate,
                 {.quantity = "tunnels",
                  .unit = "",
                  .voxel = static_cast<double>(of_voxels.tunnels),
                  .mesh = static_cast<double>(of_mesh.tunnels),
                  .difference = static_cast<double>(std::abs(of_voxels.tunnels - of_mesh.tunnels)),
                  .formula = "none: one voxel opens or closes a tunnel"});
}

// In a cell of the isosurface, inside samples that meet only at edges or corners are separate, and so are
// outside samples that meet only at the cell's corners. In the voxels' Euler number by faces a tunnel
// connects two such outside samples, so each of those cells adds one.
void compare_same_topology(Certificate& certificate, const Octree& octree, const brep::Solid& solid) {
  std::int64_t solid_euler = voxel::euler_numbers(octree).by_faces;
  const std::array<std::uint64_t, 256> cells = voxel::cell_counts(octree);
  for (unsigned corner = 0; corner < 4; ++corner)
    solid_euler += static_cast<std::int64_t>(cells[255U - (1U << corner) - (1U << (7U - corner))]);
  const auto twice = 2.0 * static_cast<double>(solid_euler);
  const auto surface = static_cast<double>(brep::euler_number(solid.triangles()));
  add_comparison(certificate, {"euler", "", twice, surface, std::abs(twice - surface), 0.0,
                               "0: one topology; a surface has twice its solid's Euler number",
                               "The Euler numbers of the two surfaces differ by %"});
  const auto parts = static_cast<double>(voxel::component_count(octree));
  const std::vector<brep::Component>& shells = solid.components();
  const auto solids = static_cast<double>(std::count_if(
      shells.begin(), shells.end(), [](const brep::Component& shell) { return shell.volume_mm3 > 0.0; }));
  add_comparison(certificate, {"components", "", parts, solids, std::abs(parts - solids), 0.0,
                               "0: parts of voxels that touch by faces, and outer shells",
                               "The numbers of connected parts differ by %"});
}

}  // namespace octotomy::verify

// SPDX-License-Identifier: AGPL-3.0-or-later
// The voxels' order of sizes decides. The mesh keeps every component that contains a place of the voxels' chosen
// parts at which both kernels must be inside. So a part that the mesh divides into several components stays whole.
#include "planner/operation/object/part_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "brep/mesh/components.h"
#include "brep/mesh/triangles.h"
#include "convert/voxel/voxelise.h"
#include "planner/operation/object/provenance.h"
#include "verify/certificate/certify_bounded.h"
#include "verify/witness/witness.h"
#include "voxel/filter/components.h"
#include "voxel/measure/distance_map.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/space/rounded.h"

namespace octotomy::planner {
namespace {

voxel::Octree common_of(const voxel::Octree& a, const voxel::Octree& b) {
  return voxel::combine(a.universe(), voxel::Expression(a) & voxel::Expression(b));
}

voxel::Octree without(const voxel::Octree& a, const voxel::Octree& b) {
  return voxel::combine(a.universe(), voxel::Expression(a) - voxel::Expression(b));
}

/// The pieces of `set` that share no voxel with `other`.
voxel::Octree pieces_apart(const voxel::Octree& set, const voxel::Octree& other) {
  return without(set, voxel::components_that_meet(set, common_of(set, other), voxel::Neighbours::Corners));
}

/// The least corner of a component. It identifies the component, because selecting components does not move
/// them.
using Corner = std::array<double, 3>;
Corner corner_of(const brep::Triangles& triangles, const brep::Component& component) {
  Corner least{std::numeric_limits<double>::infinity()};
  for (const std::uint32_t face : component.faces)
    for (const std::uint32_t corner : triangles.faces[face]) {
      const glm::dvec3& p = triangles.points_mm[corner];
      least = std::min(least, Corner{p.x, p.y, p.z});
    }
  return least;
}

/// The voxels of one component. Only the component's points are copied, because a solid may have thousands of
/// components.
voxel::Octree digitised_part(const brep::Solid& solid, const brep::Component& component,
                             const voxel::Universe& universe) {
  const brep::Triangles& whole = solid.triangles();
  brep::Triangles part;
  std::unordered_map<std::uint32_t, std::uint32_t> numbers;
  for (const std::uint32_t face : component.faces) {
    auto corners = whole.faces[face];
    for (std::uint32_t& corner : corners) {
      const auto [at, is_new] =
          numbers.try_emplace(corner, static_cast<std::uint32_t>(part.points_mm.size()));
      if (is_new) part.points_mm.push_back(whole.points_mm[corner]);
      corner = at->second;
    }
    part.faces.push_back(corners);
  }
  return convert::voxelise(
      universe, brep::trusted_solid(brep::mesh_of(part), brep::proof_of_part(solid.proof())).linked());
}

/// The components of a solid that contain a voxel of a set. Components below a quarter of the set's smallest
/// part or above four times its largest part are skipped.
std::vector<std::size_t> components_in(const brep::Solid& solid, const voxel::Octree& set) {
  if (set.is_empty()) return {};
  const std::vector<std::uint64_t> counts = voxel::components(set).voxel_counts;
  const double voxel_mm3 = set.universe().lattice().voxel_mm3();
  const double least_mm3 = 0.25 * voxel_mm3 * static_cast<double>(counts.back());
  const double most_mm3 = 4.0 * voxel_mm3 * static_cast<double>(counts.front());
  std::vector<std::size_t> found;
  const std::vector<brep::Component>& all = solid.components();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].volume_mm3 < least_mm3 || all[i].volume_mm3 > most_mm3) continue;
    if (!common_of(digitised_part(solid, all[i], set.universe()), set).is_empty()) found.push_back(i);
  }
  return found;
}

brep::Solid solid_of(const brep::Solid& whole, const std::vector<std::size_t>& components) {
  std::vector<std::uint32_t> faces;
  for (const std::size_t i : components) {
    const std::vector<std::uint32_t>& own = whole.components()[i].faces;
    faces.insert(faces.end(), own.begin(), own.end());
  }
  std::sort(faces.begin(), faces.end());
  return faces.empty() ? brep::Solid()
                       : brep::trusted_solid(brep::part_of(whole, faces), brep::proof_of_part(whole.proof()));
}

/// Whether the voxels and the mesh pass as the same parts: their certificate does not fail.
bool is_same(const voxel::Octree& voxels, const brep::Solid& mesh, const verify::Witness& parts,
             const Object& made) {
  verify::BoundInputs inputs;
  inputs.scan_spacing_mm = made.bound.spacing_mm;
  inputs.flat_cut_mm2 = area_on_planes(mesh.triangles(), made.bound.planes);
  inputs.scan_box_mm = made.bound.scan_box_mm;
  inputs.witness = verify::both(parts, verify::witness_of_box(voxel::bounds(voxels.universe().lattice())));
  if (made.bound.shift_mm > 0.0) inputs.witness = verify::loosened(inputs.witness, made.bound.shift_mm);
  return verify::certify_bounded(voxels, mesh, inputs).verdict != voxel::Verdict::Fail;
}

std::string size_and_place(const voxel::Octree& parts) {
  const voxel::Measures measures = voxel::measure(parts);
  return voxel::rounded(measures.volume_mm3) + " mm\u00b3 about " + voxel::rounded(*measures.centroid_mm);
}

/// Parts that only one of the kernels selected. `wanted` and `unwanted` are such parts as components of the
/// whole mesh.
struct Differing {
  voxel::Octree by_voxels, passed_over;  ///< selected only by the voxels; and selected only by the mesh
  std::vector<std::size_t> wanted, unwanted;
};

/// Whether each kernel was right by its own volumes in which parts reach `least_mm3`. Components are sorted
/// by volume.
bool is_by_measure(const Differing& parts, const std::vector<brep::Component>& all, double least_mm3) {
  const double voxel_mm3 = parts.by_voxels.universe().lattice().voxel_mm3();
  return parts.wanted.empty() == parts.by_voxels.is_empty() &&
         parts.unwanted.empty() == parts.passed_over.is_empty() &&
         !(parts.wanted.empty() && parts.unwanted.empty()) &&
         (parts.wanted.empty() || all[parts.wanted.front()].volume_mm3 < least_mm3) &&
         (parts.unwanted.empty() ||
          (all[parts.unwanted.back()].volume_mm3 >= least_mm3 &&
           static_cast<double>(voxel::components(parts.passed_over).voxel_counts.front()) * voxel_mm3 <
               least_mm3));
}

/// Each connected piece of a set; if there are more than 32, the whole set as one piece.
std::vector<voxel::Octree> pieces_of(voxel::Octree set) {
  constexpr std::size_t most = 32;
  if (set.is_empty()) return {};
  if (voxel::component_count(set) > most) return {std::move(set)};
  std::vector<voxel::Octree> pieces;
  while (!set.is_empty()) {
    pieces.push_back(voxel::components(set).largest);
    set = without(set, pieces.back());
  }
  return pieces;
}

/// The sizes and positions of the three largest parts, such as "120 mm3 about (1, 2, 3)", and the number of
/// the others.
std::string sizes_and_places(const voxel::Octree& parts) {
  constexpr std::size_t most_named = 3;
  const std::vector<voxel::Octree> pieces = pieces_of(parts);
  std::string text;
  for (std::size_t i = 0; i < std::min(pieces.size(), most_named); ++i)
    text += (i == 0 ? "" : " and ") + size_and_place(pieces[i]);
  if (pieces.size() > most_named) text += " and " + std::to_string(pieces.size() - most_named) + " smaller";
  return text;
}

/// Whether each set is a single part and the two differ by less than a tenth in volume.
bool are_nearly_equal(const voxel::Octree& a, const voxel::Octree& b) {
  constexpr double least_share = 0.9;
  if (a.is_empty() || b.is_empty()) return false;
  if (voxel::component_count(a) != 1 || voxel::component_count(b) != 1) return false;
  const auto [less, more] = std::minmax(a.voxel_count(), b.voxel_count());
  return static_cast<double>(less) >= least_share * static_cast<double>(more);
}

std::string doubt_of_rank(const Differing& parts, std::size_t count) {
  if (are_nearly_equal(parts.by_voxels, parts.passed_over))
    return "Two parts have nearly the same size: " + size_and_place(parts.by_voxels) + " is kept, " +
           size_and_place(parts.passed_over) +
           " is not, although it is larger in the mesh kernel. Choose the right part by 'parts' with "
           "'at_mm'.";
  std::string kept, left;
  if (!parts.by_voxels.is_empty()) kept = "both keep " + sizes_and_places(parts.by_voxels);
  if (!parts.passed_over.is_empty()) left = "both leave out " + sizes_and_places(parts.passed_over);
  return "The kernels select different parts " +
         (count == 1 ? std::string("as the largest") : "among the " + std::to_string(count) + " largest") +
         ", because some parts have nearly equal sizes or only one kernel joins them by a neck: " + kept +
         (kept.empty() || left.empty() ? "" : ", ") + left +
         ", following the voxels. Choose the right parts by 'parts' with 'at_mm'.";
}

std::string doubt_of_bound(const std::vector<Differing>& settled) {
  std::string kept, left;
  for (const Differing& parts : settled) {
    if (kept.empty() && !parts.by_voxels.is_empty()) kept = size_and_place(parts.by_voxels) + " is kept";
    if (left.empty() && !parts.passed_over.is_empty()) left = size_and_place(parts.passed_over) + " is not";
  }
  return "The kernels find " + std::to_string(settled.size()) + (settled.size() == 1 ? " part" : " parts") +
         " on different sides of 'at_least_mm3': " + kept + (kept.empty() || left.empty() ? "" : ", ") +
         left + ", following the voxels. Choose a volume that is farther from that of any part.";
}

/// Whether a test holds at all voxels of a set. Its arguments are the voxel and its centre, LPS.
template <typename Test>
bool at_all(const voxel::Octree& set, const Test& test) {
  if (set.is_empty()) return true;
  constexpr int block = 16;
  const voxel::VoxelRange range = voxel::range_of(set);
  const voxel::Lattice lattice = set.universe().lattice();
  const auto holds_in_block = [&](const glm::ivec3& low) {
    for (int i = 0; i < block * block * block; ++i) {
      const glm::ivec3 at = low + glm::ivec3(i % block, i / block % block, i / (block * block));
      if (set.contains(at) && !test(at, lattice.lps_mm(glm::dvec3(at)))) return false;
    }
    return true;
  };
  for (int z = range.low.z / block; z <= range.high.z / block; ++z)
    for (int y = range.low.y / block; y <= range.high.y / block; ++y)
      for (int x = range.low.x / block; x <= range.high.x / block; ++x)
        if (!set.leaf_block({x, y, z}).is_empty() && !holds_in_block(block * glm::ivec3(x, y, z)))
          return false;
  return true;
}

/// The range of voxels whose centres lie in the bounding box of a component.
voxel::VoxelRange voxels_in_box(const brep::Solid& solid, const brep::Component& component,
                                const voxel::Universe& universe) {
  const voxel::Lattice lattice = universe.lattice();
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const std::uint32_t face : component.faces)
    for (const std::uint32_t corner : solid.triangles().faces[face]) {
      const glm::dvec3 p = lattice.voxel(solid.triangles().points_mm[corner]);
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  const glm::dvec3 last(universe.side() - 1);
  return {glm::ivec3(glm::ceil(glm::max(low, glm::dvec3(0.0)))),
          glm::ivec3(glm::floor(glm::min(high, last)))};
}

bool has_voxel_in(const voxel::Octree& set, const voxel::VoxelRange& set_range,
                  const voxel::VoxelRange& range) {
  const glm::ivec3 low = glm::max(range.low, set_range.low), high = glm::min(range.high, set_range.high);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        if (set.contains({x, y, z})) return true;
  return false;
}

/// The components of a solid that contain a voxel of a set: their numbers and their voxels.
std::vector<std::pair<std::size_t, voxel::Octree>> components_of(const brep::Solid& solid,
                                                                 const voxel::Octree& set) {
  std::vector<std::pair<std::size_t, voxel::Octree>> found;
  if (set.is_empty()) return found;
  const voxel::VoxelRange set_range = voxel::range_of(set);
  const std::vector<brep::Component>& all = solid.components();
  for (std::size_t i = 0; i < all.size() && all[i].volume_mm3 > 0.0; ++i) {
    if (!has_voxel_in(set, set_range, voxels_in_box(solid, all[i], set.universe()))) continue;
    voxel::Octree digitised = digitised_part(solid, all[i], set.universe());
    if (!common_of(digitised, set).is_empty()) found.emplace_back(i, std::move(digitised));
  }
  return found;
}

/// The parts that only one kernel selected as its largest. None if there are no such parts, if a kernel
/// selected other parts than the largest of its own, or if the witness contradicts one: a kernel lacks a part
/// where the witness requires it, or the mesh kernel has a part where the witness excludes it.
std::optional<Differing> ranked(const WholeObject& whole, const brep::Solid& solid,
                                const voxel::Octree& chosen, const voxel::Octree& by_voxels,
                                const voxel::Octree& apart_in_mesh) {
  const voxel::Octree voxels = whole.voxels();
  const auto counts = [](const voxel::Octree& set) { return voxel::components(set).voxel_counts; };
  // Without a witness, both sides are allowed at every point here, because settle_choice() certifies the
  // parts afterwards.
  const auto words = [&](const glm::dvec3& p_mm) {
    return whole.witness ? whole.witness.allowed_sides(p_mm)
                         : verify::Reading{verify::either_side, verify::either_side};
  };
  // A thin component between voxels' centres may be several pieces of voxels. It stays if the voxels'
  // selection contains one of them.
  std::vector<std::size_t> unwanted;
  voxel::Octree by_mesh = voxel::Octree::empty(by_voxels.universe());
  for (const auto& [i, digitised] : components_of(solid, apart_in_mesh)) {
    if (i >= whole.count || !common_of(digitised, chosen).is_empty()) continue;
    unwanted.push_back(i);
    by_mesh = voxel::combine(by_mesh.universe(), voxel::Expression(by_mesh) | voxel::Expression(digitised));
  }
  const std::vector<std::uint64_t> sizes = counts(voxels);
  if (sizes.empty()) return std::nullopt;
  Differing parts{by_voxels, voxel::components_that_meet(voxels, by_mesh), {}, std::move(unwanted)};
  const std::uint64_t last = sizes[std::min(whole.count, sizes.size()) - 1];
  const bool is_whole =
      voxel::components_that_meet(voxels, by_voxels).voxel_count() == by_voxels.voxel_count();
  if (!is_whole || (!by_voxels.is_empty() && counts(by_voxels).back() < last) ||
      (!parts.passed_over.is_empty() && counts(parts.passed_over).front() > last))
    return std::nullopt;
  // The certificate compares the parts that stay with the witness. Parts of the mesh that are left out are
  // compared here.
  voxel::Octree of_mesh = voxel::Octree::empty(by_voxels.universe());
  for (auto& [i, digitised] : components_of(solid, by_voxels)) {
    const bool is_surely_shared =
        !at_all(common_of(digitised, by_voxels), [&](const glm::ivec3&, const glm::dvec3& p_mm) {
          const verify::Reading reading = words(p_mm);
          return reading.voxel.near || reading.mesh.near;
        });
    if (!is_surely_shared) continue;
    if (i < whole.count) return std::nullopt;
    parts.wanted.push_back(i);
    of_mesh = voxel::combine(of_mesh.universe(), voxel::Expression(of_mesh) | voxel::Expression(digitised));
  }
  if (parts.wanted.empty() && parts.unwanted.empty()) return std::nullopt;
  const auto mesh_may_lack = [&](const glm::ivec3&, const glm::dvec3& p_mm) {
    return words(p_mm).mesh.allows(false);
  };
  const auto voxels_may_lack = [&](const glm::ivec3& at, const glm::dvec3& p_mm) {
    return voxels.contains(at) || words(p_mm).voxel.allows(false);
  };
  const auto mesh_may_have = [&](const glm::ivec3&, const glm::dvec3& p_mm) {
    return words(p_mm).mesh.allows(true);
  };
  const bool is_right = at_all(without(by_voxels, of_mesh), mesh_may_lack) &&
                        at_all(of_mesh, voxels_may_lack) && at_all(by_mesh, voxels_may_lack) &&
                        at_all(by_mesh, mesh_may_have);
  return is_right ? std::optional(std::move(parts)) : std::nullopt;
}

/// The parts whose volumes lie on different sides of a least volume in the two kernels, one group each.
/// `chosen` are the parts that the voxels keep.
std::vector<Differing> differing(const WholeObject& whole, const brep::Solid& solid,
                                 const voxel::Octree& chosen, const voxel::Octree& by_voxels,
                                 const voxel::Octree& by_mesh, double least_mm3) {
  const voxel::Octree none = voxel::Octree::empty(by_voxels.universe());
  const voxel::Octree voxels = by_mesh.is_empty() ? none : whole.voxels();
  const auto over = [&](const voxel::Octree& piece) { return voxel::components_that_meet(voxels, piece); };
  std::vector<Differing> all;
  for (voxel::Octree& piece : pieces_of(by_voxels)) {
    std::vector<std::size_t> wanted = components_in(solid, piece);
    all.push_back({std::move(piece), none, std::move(wanted), {}});
  }
  // A thin part of the mesh may be several parts of voxels, each too small. Components are sorted by volume.
  const double most_mm3 =
      4.0 * by_mesh.universe().lattice().voxel_mm3() * static_cast<double>(by_mesh.voxel_count());
  const std::vector<brep::Component>& components = solid.components();
  for (std::size_t i = 0; i < components.size() && components[i].volume_mm3 >= least_mm3; ++i) {
    if (components[i].volume_mm3 > most_mm3) continue;
    const voxel::Octree digitised = digitised_part(solid, components[i], by_mesh.universe());
    const voxel::Octree own = common_of(digitised, by_mesh);
    // If the voxels keep a piece of a part, a thin neck holds the part together, so it is not listed here.
    if (!own.is_empty() && common_of(digitised, chosen).is_empty()) all.push_back({none, over(own), {}, {i}});
  }
  return all;
}

}  // namespace

void settle_choice(const WholeObject& whole, const voxel::Universe& universe,
                   const std::optional<double>& least_mm3, Object& made) {
  const voxel::Octree& chosen = made.voxel.octree;
  const voxel::Octree digitised = convert::voxelise(universe, made.mesh.whole->linked());
  const voxel::Octree by_voxels = pieces_apart(chosen, digitised), by_mesh = pieces_apart(digitised, chosen);
  if (by_voxels.is_empty() && by_mesh.is_empty()) return;
  const brep::Solid solid = whole.mesh();
  const std::vector<brep::Component>& all = solid.components();
  const verify::Witness reading = verify::witness_of_parts(whole.witness);
  const auto agrees = [&](const voxel::Octree& voxels, const std::vector<std::size_t>& components) {
    return components.empty() || is_same(voxels, solid_of(solid, components), reading, made);
  };
  std::vector<Differing> settled;
  if (least_mm3) {
    settled = differing(whole, solid, chosen, by_voxels, by_mesh, *least_mm3);
    std::erase_if(settled, [&](const Differing& parts) {
      return !is_by_measure(parts, all, *least_mm3) || !agrees(parts.by_voxels, parts.wanted) ||
             !agrees(parts.passed_over, parts.unwanted);
    });
  } else if (std::optional<Differing> parts = ranked(whole, solid, chosen, by_voxels, by_mesh)) {
    if (whole.witness ||
        (agrees(parts->by_voxels, parts->wanted) && agrees(parts->passed_over, parts->unwanted)))
      settled.push_back(std::move(*parts));
  }
  if (settled.empty()) return;
  std::set<Corner> kept;
  for (const brep::Component& component : made.mesh.whole->components())
    kept.insert(corner_of(made.mesh.whole->triangles(), component));
  for (const Differing& parts : settled) {
    for (const std::size_t i : parts.unwanted) kept.erase(corner_of(solid.triangles(), all[i]));
    for (const std::size_t i : parts.wanted) kept.insert(corner_of(solid.triangles(), all[i]));
  }
  std::vector<std::size_t> inside, others;
  for (std::size_t i = 0; i < all.size(); ++i)
    (kept.contains(corner_of(solid.triangles(), all[i])) ? inside : others).push_back(i);
  made.mesh.whole = solid_of(solid, inside);
  if (made.mesh.parts_of) made.mesh.parts_of->second = solid_of(solid, others);
  made.caveats.push_back({voxel::Verdict::Warn,
                          least_mm3 ? doubt_of_bound(settled) : doubt_of_rank(settled.front(), whole.count),
                          false});
  made.findings.push_back(made.caveats.back().reason);
  made.shared_values.push_back(made.kind + ": the choice of parts at its limit, made by the voxels");
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/attach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "brep/disjoint_sets.h"
#include "convert/octree_tetrahedra.h"
#include "planner/figures.h"
#include "voxel/combine.h"

namespace octotomy::planner {
namespace {

/// Bone as it lay when the tissue was attached to it, and where the plan takes it.
struct Holder {
  std::string id;
  voxel::Octree octree;
  std::optional<glm::dmat4> motion;  ///< LPS to LPS; none: it stays
};

Holder moved_holder(const Evaluation& evaluation, const std::string& id) {
  const Object* object = &evaluation.object(id);
  glm::dmat4 motion(1.0);
  while (object->moved) {
    motion = motion * object->moved->motion;
    object = &evaluation.object(object->moved->object);
  }
  return {id, object->octree, motion};
}

/// The tissue's elements, and which holder each node lies on, -1: none.
struct Held {
  convert::Tetrahedra tetrahedra;
  std::vector<int> holder_of_node;
};

/// Whether a node lies on an object's voxels or between two of them.
bool touches(const voxel::Octree& octree, const glm::dvec3& p_voxel) {
  // Rounding may put a corner on either side of where it is.
  constexpr double slack = 1e-6;
  const glm::ivec3 low(glm::floor(p_voxel + 0.5 - slack)), high(glm::floor(p_voxel + 0.5 + slack));
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        if (octree.contains({x, y, z})) return true;
  return false;
}

std::vector<int> holders_of(const convert::Tetrahedra& tetrahedra, const std::vector<Holder>& holders) {
  std::vector<int> of_node(tetrahedra.nodes_mm.size(), -1);
  const glm::dmat4 voxel_from_lps = glm::inverse(holders.front().octree.universe().lps_from_voxel);
  for (const std::uint32_t node : tetrahedra.boundary_nodes) {
    const glm::dvec3 p_voxel(voxel_from_lps * glm::dvec4(tetrahedra.nodes_mm[node], 1.0));
    const auto found = std::find_if(holders.begin(), holders.end(),
                                    [&](const Holder& holder) { return touches(holder.octree, p_voxel); });
    if (found != holders.end()) of_node[node] = static_cast<int>(found - holders.begin());
  }
  return of_node;
}

/// Takes away the parts that nothing holds; answers their volume.
double keep_held(Held& held) {
  convert::Tetrahedra& all = held.tetrahedra;
  brep::DisjointSets parts(all.nodes_mm.size());
  for (const auto& tet : all.tets)
    for (std::size_t i = 1; i < 4; ++i) parts.join(tet[0], tet[i]);
  std::vector<bool> is_held(all.nodes_mm.size(), false);
  for (std::uint32_t node = 0; node < is_held.size(); ++node)
    if (held.holder_of_node[node] >= 0) is_held[parts.set_of(node)] = true;

  constexpr std::uint32_t none = ~0u;
  std::vector<std::uint32_t> renumbered(all.nodes_mm.size(), none);
  Held kept;
  for (std::uint32_t node = 0; node < is_held.size(); ++node) {
    if (!is_held[parts.set_of(node)]) continue;
    renumbered[node] = static_cast<std::uint32_t>(kept.tetrahedra.nodes_mm.size());
    kept.tetrahedra.nodes_mm.push_back(all.nodes_mm[node]);
    kept.holder_of_node.push_back(held.holder_of_node[node]);
  }
  double left_out_mm3 = 0.0;
  for (std::size_t t = 0; t < all.tets.size(); ++t) {
    std::array<std::uint32_t, 4> tet = all.tets[t];
    if (renumbered[tet[0]] == none) {
      left_out_mm3 += convert::six_volumes(convert::corners_mm(all, t)) / 6.0;
      continue;
    }
    for (std::uint32_t& node : tet) node = renumbered[node];
    kept.tetrahedra.tets.push_back(tet);
  }
  for (const std::uint32_t node : all.boundary_nodes)
    if (renumbered[node] != none) kept.tetrahedra.boundary_nodes.push_back(renumbered[node]);
  kept.tetrahedra.method = all.method;
  held = std::move(kept);
  return left_out_mm3;
}

void prescribe(const Held& held, const std::vector<Holder>& holders, Attached& attached) {
  for (std::size_t h = 0; h < holders.size(); ++h) {
    convert::NodeSet set{(holders[h].motion ? "MOVED_" : "FIXED_") + holders[h].id, {}};
    convert::Prescribed prescribed{set.name, {}};
    for (std::uint32_t node = 0; node < held.holder_of_node.size(); ++node) {
      if (held.holder_of_node[node] != static_cast<int>(h)) continue;
      set.nodes.push_back(node);
      if (!holders[h].motion) continue;
      const glm::dvec3& p_mm = held.tetrahedra.nodes_mm[node];
      prescribed.displacement_mm.push_back(glm::dvec3(*holders[h].motion * glm::dvec4(p_mm, 1.0)) - p_mm);
    }
    if (set.nodes.empty())
      throw std::runtime_error(
          "'" + holders[h].id +
          "' touches nothing of the object: attach what it lies on, or take the bone out "
          "of the tissue, as in skin - skull");
    attached.node_sets.push_back(std::move(set));
    attached.prescribed.push_back(std::move(prescribed));
  }
}

std::vector<convert::DeckSurface> surfaces_of(const Held& held, const std::vector<Holder>& holders) {
  std::vector<convert::DeckSurface> surfaces;
  surfaces.reserve(holders.size() + 1);
  for (const Holder& holder : holders) surfaces.push_back({"ON_" + holder.id, {}});
  surfaces.push_back({"FREE", {}});
  for (const convert::ElementFace& face : convert::surface_faces(held.tetrahedra)) {
    const auto corners = convert::corners_of(held.tetrahedra, face);
    const int holder = held.holder_of_node[corners[0]];
    const bool on = holder >= 0 && std::all_of(corners.begin(), corners.end(), [&](std::uint32_t node) {
                      return held.holder_of_node[node] == holder;
                    });
    (on ? surfaces[static_cast<std::size_t>(holder)] : surfaces.back()).faces.push_back(face);
  }
  std::erase_if(surfaces, [](const convert::DeckSurface& surface) { return surface.faces.empty(); });
  return surfaces;
}

}  // namespace

Attached attach(const Evaluation& evaluation, const Object& object, const Attachment& attachment,
                const voxel::Progress& progress) {
  std::vector<Holder> holders;
  for (const std::string& id : attachment.moved) holders.push_back(moved_holder(evaluation, id));
  for (const std::string& id : attachment.fixed)
    holders.push_back({id, evaluation.object(id).octree, std::nullopt});
  voxel::Octree tissue = object.octree;
  if (attachment.element_mm) {
    const voxel::Universe coarse =
        voxel::universe_around(voxel::bounds(evaluation.universe.lattice()), *attachment.element_mm);
    tissue = voxel::combine(coarse, voxel::Expression(tissue));
    for (Holder& holder : holders) holder.octree = voxel::combine(coarse, voxel::Expression(holder.octree));
  }
  if (tissue.is_empty()) throw std::runtime_error("nothing is left of it in voxels of that size");
  Held held{convert::tetrahedra_of(tissue, convert::BoundaryCells::Voxels, progress), {}};
  held.holder_of_node = holders_of(held.tetrahedra, holders);
  const double left_out_mm3 = keep_held(held);
  Attached attached;
  prescribe(held, holders, attached);
  attached.surfaces = surfaces_of(held, holders);
  if (left_out_mm3 > 0.0)
    attached.findings.push_back("parts that nothing holds, " + grouped(left_out_mm3, 1) +
                                " mm\u00b3 together, are left out");
  attached.tetrahedra = std::move(held.tetrahedra);
  return attached;
}

}  // namespace octotomy::planner

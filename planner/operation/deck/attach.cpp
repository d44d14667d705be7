// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/attach.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "brep/mesh/disjoint_sets.h"
#include "planner/operation/table/number_format.h"

namespace octotomy::planner {
namespace {

constexpr int nobody = -1;

Holder moved_holder(const Objects& objects, const std::string& id) {
  const Object* object = &objects.at(id);
  glm::dmat4 motion(1.0);
  while (object->moved) {
    motion = motion * object->moved->motion;
    object = &objects.at(object->moved->object);
  }
  return {id, object->voxel.octree, motion};
}

/// Whether a node lies in one of an object's voxels or on the border of one. `p_voxel` is in voxels.
bool touches(const voxel::Octree& octree, const glm::dvec3& p_voxel) {
  // Rounding may move a voxel's corner to either side of its exact position.
  constexpr double slack = 1e-6;
  const glm::ivec3 low(glm::floor(p_voxel + 0.5 - slack)), high(glm::floor(p_voxel + 0.5 + slack));
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        if (octree.contains({x, y, z})) return true;
  return false;
}

/// Attaches a deck's elements to their holders.
class Attacher {
 public:
  Attacher(const std::vector<Holder>& holders, const std::vector<std::string>& names,
           convert::Tetrahedra& tetrahedra, convert::DeckOptions& options)
      : holders_(holders), names_(names), tetrahedra_(tetrahedra), options_(options) {}

  std::vector<std::string> run() {
    find_holders();
    std::vector<std::string> findings = lift_off();
    const double left_out_mm3 = keep_held();
    prescribe();
    part_surfaces();
    if (left_out_mm3 > 0.0)
      findings.push_back("parts that no object holds are left out, " + grouped(left_out_mm3, 1) +
                         " mm\u00b3 together: attach an object that touches them if they are needed");
    return findings;
  }

 private:
  void find_holders() {
    for (const Holder& holder : holders_) {
      const auto found = std::find(names_.begin(), names_.end(), holder.id);
      region_of_holder_.push_back(found != names_.end() ? static_cast<int>(found - names_.begin()) : nobody);
    }
    holder_of_node_.assign(tetrahedra_.nodes_mm.size(), nobody);
    for (std::size_t h = 0; h < holders_.size(); ++h)
      if (const int region = region_of_holder_[h]; region != nobody)
        hold_region(static_cast<int>(h), static_cast<std::uint32_t>(region));
      else
        hold_boundary(static_cast<int>(h));
  }

  void hold(std::uint32_t node, int holder) {
    if (holder_of_node_[node] == nobody) holder_of_node_[node] = holder;
  }

  void hold_region(int holder, std::uint32_t region) {
    for (std::size_t t = 0; t < tetrahedra_.tets.size(); ++t)
      if (convert::region_of(tetrahedra_, t) == region)
        for (const std::uint32_t node : tetrahedra_.tets[t]) hold(node, holder);
  }

  void hold_boundary(int holder) {
    const voxel::Octree& octree = holders_[static_cast<std::size_t>(holder)].octree;
    const glm::dmat4 voxel_from_lps = glm::inverse(octree.universe().lps_from_voxel);
    for (const std::uint32_t node : tetrahedra_.boundary_nodes)
      if (touches(octree, glm::dvec3(voxel_from_lps * glm::dvec4(tetrahedra_.nodes_mm[node], 1.0))))
        hold(node, holder);
  }

  glm::dvec3 displacement_mm(const Holder& holder, std::uint32_t node) const {
    const glm::dvec3& p_mm = tetrahedra_.nodes_mm[node];
    return glm::dvec3(*holder.motion * glm::dvec4(p_mm, 1.0)) - p_mm;
  }

  /// Frees nodes on stationary bone that lie near moved bone, because the tissue between would be torn or its
  /// elements inverted. This models the surgeon, who lifts the tissue off the bone along a cut. Returns
  /// findings.
  std::vector<std::string> lift_off() {
    struct MovedNode {
      glm::dvec3 p_mm;
      double reach_mm;
    };
    // Tissue between bones is then strained by at most one half: its length is at least twice the
    // displacement.
    constexpr double reach_of_displacement = 2.0;
    std::vector<MovedNode> moved;
    double farthest_mm = 0.0;
    for (std::uint32_t node = 0; node < holder_of_node_.size(); ++node) {
      if (holder_of_node_[node] == nobody) continue;
      const Holder& holder = holders_[static_cast<std::size_t>(holder_of_node_[node])];
      if (!holder.motion) continue;
      const double reach_mm = reach_of_displacement * glm::length(displacement_mm(holder, node));
      farthest_mm = std::max(farthest_mm, reach_mm);
      moved.push_back({tetrahedra_.nodes_mm[node], reach_mm});
    }
    std::sort(moved.begin(), moved.end(),
              [](const MovedNode& a, const MovedNode& b) { return a.p_mm.x < b.p_mm.x; });
    std::vector<std::size_t> freed(holders_.size(), 0), held(holders_.size(), 0);
    for (std::uint32_t node = 0; node < holder_of_node_.size(); ++node) {
      const int number = holder_of_node_[node];
      if (number == nobody) continue;
      const auto h = static_cast<std::size_t>(number);
      if (holders_[h].motion || region_of_holder_[h] != nobody) continue;
      ++held[h];
      const glm::dvec3& p_mm = tetrahedra_.nodes_mm[node];
      const auto first =
          std::lower_bound(moved.begin(), moved.end(), p_mm.x - farthest_mm,
                           [](const MovedNode& other, double x_mm) { return other.p_mm.x < x_mm; });
      for (auto other = first; other != moved.end() && other->p_mm.x <= p_mm.x + farthest_mm; ++other)
        if (glm::distance(other->p_mm, p_mm) < other->reach_mm) {
          holder_of_node_[node] = nobody;
          ++freed[h];
          break;
        }
    }
    std::vector<std::string> findings;
    for (std::size_t h = 0; h < holders_.size(); ++h)
      if (freed[h] > 0)
        findings.push_back("the tissue is not attached to '" + holders_[h].id + "' at " +
                           std::to_string(freed[h]) + " of " + std::to_string(held[h]) +
                           " nodes: they lie nearer to a moved piece than twice its displacement, where "
                           "attached tissue would tear");
    return findings;
  }

  /// Removes the parts of the deck without an attached node. Returns their total volume in mm3.
  double keep_held() {
    brep::DisjointSets parts(tetrahedra_.nodes_mm.size());
    for (const auto& tet : tetrahedra_.tets)
      for (std::size_t i = 1; i < 4; ++i) parts.join(tet[0], tet[i]);
    std::vector<bool> is_held(tetrahedra_.nodes_mm.size(), false);
    for (std::uint32_t node = 0; node < is_held.size(); ++node)
      if (holder_of_node_[node] != nobody) is_held[parts.set_of(node)] = true;

    std::vector<std::uint32_t> number_of_node(tetrahedra_.nodes_mm.size(), gone);
    convert::Tetrahedra kept;
    std::vector<int> holder_of_kept;
    for (std::uint32_t node = 0; node < is_held.size(); ++node) {
      if (!is_held[parts.set_of(node)]) continue;
      number_of_node[node] = static_cast<std::uint32_t>(kept.nodes_mm.size());
      kept.nodes_mm.push_back(tetrahedra_.nodes_mm[node]);
      holder_of_kept.push_back(holder_of_node_[node]);
    }
    double left_out_mm3 = 0.0;
    std::vector<std::uint32_t> number_of_tet(tetrahedra_.tets.size(), gone);
    std::vector<std::uint32_t> material_of_kept;
    for (std::size_t t = 0; t < tetrahedra_.tets.size(); ++t) {
      std::array<std::uint32_t, 4> tet = tetrahedra_.tets[t];
      if (number_of_node[tet[0]] == gone) {
        left_out_mm3 += convert::six_volumes(convert::corners_mm(tetrahedra_, t)) / 6.0;
        continue;
      }
      for (std::uint32_t& node : tet) node = number_of_node[node];
      number_of_tet[t] = static_cast<std::uint32_t>(kept.tets.size());
      kept.tets.push_back(tet);
      if (!tetrahedra_.region_of_tet.empty()) kept.region_of_tet.push_back(tetrahedra_.region_of_tet[t]);
      if (!options_.material_of_tet.empty()) material_of_kept.push_back(options_.material_of_tet[t]);
    }
    for (const std::uint32_t node : tetrahedra_.boundary_nodes)
      if (number_of_node[node] != gone) kept.boundary_nodes.push_back(number_of_node[node]);
    kept.method = tetrahedra_.method;
    kept.findings = tetrahedra_.findings;
    tetrahedra_ = std::move(kept);
    holder_of_node_ = std::move(holder_of_kept);
    options_.material_of_tet = std::move(material_of_kept);
    renumber_surfaces(number_of_tet);
    return left_out_mm3;
  }

  void renumber_surfaces(const std::vector<std::uint32_t>& number_of_tet) {
    for (convert::DeckSurface& surface : options_.surfaces) {
      std::erase_if(surface.faces,
                    [&](const convert::ElementFace& face) { return number_of_tet[face.tet] == gone; });
      for (convert::ElementFace& face : surface.faces) face.tet = number_of_tet[face.tet];
    }
  }

  void prescribe() {
    for (std::size_t h = 0; h < holders_.size(); ++h) {
      const Holder& holder = holders_[h];
      convert::NodeSet set{(holder.motion ? "MOVED_" : "FIXED_") + holder.id, {}};
      convert::Prescribed prescribed{set.name, {}};
      for (std::uint32_t node = 0; node < holder_of_node_.size(); ++node) {
        if (holder_of_node_[node] != static_cast<int>(h)) continue;
        set.nodes.push_back(node);
        if (!holder.motion) continue;
        prescribed.displacement_mm.push_back(displacement_mm(holder, node));
      }
      if (set.nodes.empty())
        throw std::runtime_error("'" + holder.id +
                                 "' does not touch the object: name the object on which the tissue lies, or "
                                 "subtract the bone from the tissue, for example skin - skull");
      options_.node_sets.push_back(std::move(set));
      options_.prescribed.push_back(std::move(prescribed));
    }
  }

  /// The number of the holder outside of the deck on which all nodes of a face lie, or `nobody`.
  int holder_of(const convert::ElementFace& face) const {
    const auto corners = convert::corners_of(tetrahedra_, face);
    const int holder = holder_of_node_[corners[0]];
    if (holder == nobody || region_of_holder_[static_cast<std::size_t>(holder)] != nobody) return nobody;
    const bool all = std::all_of(corners.begin(), corners.end(),
                                 [&](std::uint32_t node) { return holder_of_node_[node] == holder; });
    return all ? holder : nobody;
  }

  bool is_in_contact(const std::string& surface) const {
    return std::any_of(
        options_.contacts.begin(), options_.contacts.end(),
        [&](const convert::ContactPair& pair) { return pair.slave == surface || pair.master == surface; });
  }

  void part_surfaces() {
    std::vector<convert::DeckSurface> surfaces;
    for (const Holder& holder : holders_) surfaces.push_back({"ON_" + holder.id, {}});
    for (convert::DeckSurface& surface : options_.surfaces) {
      if (!is_in_contact(surface.name))
        std::erase_if(surface.faces, [&](const convert::ElementFace& face) {
          const int holder = holder_of(face);
          if (holder != nobody) surfaces[static_cast<std::size_t>(holder)].faces.push_back(face);
          return holder != nobody;
        });
      surfaces.push_back(std::move(surface));
    }
    std::erase_if(surfaces, [](const convert::DeckSurface& surface) { return surface.faces.empty(); });
    options_.surfaces = std::move(surfaces);
    std::erase_if(options_.contacts, [&](const convert::ContactPair& pair) {
      const auto is_there = [&](const std::string& name) {
        return std::any_of(options_.surfaces.begin(), options_.surfaces.end(),
                           [&](const convert::DeckSurface& surface) { return surface.name == name; });
      };
      return !is_there(pair.slave) || !is_there(pair.master);
    });
  }

  static constexpr std::uint32_t gone = ~0U;

  const std::vector<Holder>& holders_;
  const std::vector<std::string>& names_;
  convert::Tetrahedra& tetrahedra_;
  convert::DeckOptions& options_;
  std::vector<int> region_of_holder_;  ///< for each holder its region's number, or `nobody` if it is outside
                                       ///< of the deck
  std::vector<int> holder_of_node_;
};

}  // namespace

std::vector<Holder> holders_of(const Objects& objects, const Deck& step) {
  std::vector<Holder> holders;
  for (const ObjectName& moved : step.moved) holders.push_back(moved_holder(objects, moved.name));
  for (const ObjectName& fixed : step.fixed)
    holders.push_back({fixed.name, objects.at(fixed.name).voxel.octree, std::nullopt});
  return holders;
}

std::vector<std::string> attach(const std::vector<Holder>& holders, const std::vector<std::string>& names,
                                convert::Tetrahedra& tetrahedra, convert::DeckOptions& options) {
  return Attacher(holders, names, tetrahedra, options).run();
}

}  // namespace octotomy::planner

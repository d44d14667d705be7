// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/second_order.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tbb/parallel_sort.h>

#include "voxel/space/error.h"

namespace octotomy::convert {
namespace {

/// A side's key: the lower end in the upper 32 bits, the higher end in the lower ones.
std::uint64_t side_of(std::uint32_t a, std::uint32_t b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
}
std::uint32_t lower_end(std::uint64_t side) {
  return static_cast<std::uint32_t>(side >> 32);
}
std::uint32_t upper_end(std::uint64_t side) {
  return static_cast<std::uint32_t>(side);
}

/// All sides, ascending. Side n gets the n-th node after the corners.
std::vector<std::uint64_t> sides_of(const Tetrahedra& tetrahedra) {
  std::vector<std::uint64_t> sides;
  sides.reserve(6 * tetrahedra.tets.size());
  for (const auto& tet : tetrahedra.tets)
    for (const auto& [a, b] : sides_of_tet) sides.push_back(side_of(tet.at(a), tet.at(b)));
  tbb::parallel_sort(sides.begin(), sides.end());
  sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
  return sides;
}

class Refining {
 public:
  explicit Refining(const Tetrahedra& linear) : linear_(linear), sides_(sides_of(linear)) {
    if (sides_.size() > std::numeric_limits<std::uint32_t>::max() - linear.nodes_mm.size())
      throw voxel::Error(voxel::ErrorCode::Resource,
                         "second_order: more nodes than 32-bit numbers can name: take larger elements");
    for (const ElementFace& face : surface_faces(linear)) outer_.push_back(corners_of(linear, face));
    outer_and_between_ = outer_;
    for (const Interface& between : interfaces(linear))
      for (const ElementFace& face : between.faces) outer_and_between_.push_back(corners_of(linear, face));
  }

  Tetrahedra tetrahedra() const {
    Tetrahedra made = linear_;
    for (const std::uint64_t side : sides_)
      made.nodes_mm.push_back(0.5 * (linear_.nodes_mm[lower_end(side)] + linear_.nodes_mm[upper_end(side)]));
    for (const auto& tet : linear_.tets) {
      std::array<std::uint32_t, 6> middles{};
      for (std::size_t i = 0; i < middles.size(); ++i)
        middles.at(i) = middle(tet.at(sides_of_tet.at(i).first), tet.at(sides_of_tet.at(i).second));
      made.mid_nodes.push_back(middles);
    }
    for (const auto& triangle : outer_) add_middles(triangle, made.boundary_nodes);
    tidy(made.boundary_nodes);
    return made;
  }

  std::vector<std::uint32_t> with_middles(const std::vector<std::uint32_t>& nodes) const {
    std::vector<bool> in_set(linear_.nodes_mm.size(), false);
    for (const std::uint32_t node : nodes) in_set[node] = true;
    const auto has_all = [&](const auto& corners) {
      return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return in_set[v]; });
    };
    std::vector<std::uint32_t> all = nodes;
    std::vector<bool> on_faces(linear_.nodes_mm.size(), false);
    for (const auto& triangle : outer_and_between_) {
      for (const std::uint32_t v : triangle) on_faces[v] = true;
      if (has_all(triangle)) add_middles(triangle, all);
    }
    const bool reaches_within =
        std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t v) { return !on_faces[v]; });
    if (reaches_within)
      for (const auto& tet : linear_.tets)
        if (has_all(tet))
          for (const auto& [a, b] : sides_of_tet) all.push_back(middle(tet.at(a), tet.at(b)));
    tidy(all);
    return all;
  }

  /// The displacements of all nodes of a set, its middles included.
  std::vector<glm::dvec3> with_means(const std::vector<std::uint32_t>& nodes,
                                     const std::vector<std::uint32_t>& all,
                                     const std::vector<glm::dvec3>& displacement_mm) const {
    std::vector<glm::dvec3> of_node(linear_.nodes_mm.size(), glm::dvec3(0.0));
    for (std::size_t i = 0; i < nodes.size(); ++i) of_node[nodes[i]] = displacement_mm[i];
    std::vector<glm::dvec3> result;
    for (const std::uint32_t node : all) {
      if (node < of_node.size()) {
        result.push_back(of_node[node]);
        continue;
      }
      const std::uint64_t side = sides_[node - of_node.size()];
      result.push_back(0.5 * (of_node[lower_end(side)] + of_node[upper_end(side)]));
    }
    return result;
  }

 private:
  std::uint32_t middle(std::uint32_t a, std::uint32_t b) const {
    const auto at = std::lower_bound(sides_.begin(), sides_.end(), side_of(a, b));
    return static_cast<std::uint32_t>(linear_.nodes_mm.size()) +
           static_cast<std::uint32_t>(at - sides_.begin());
  }
  void add_middles(const std::array<std::uint32_t, 3>& triangle, std::vector<std::uint32_t>& nodes) const {
    for (std::size_t i = 0; i < 3; ++i) nodes.push_back(middle(triangle.at(i), triangle.at((i + 1) % 3)));
  }
  static void tidy(std::vector<std::uint32_t>& nodes) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }

  const Tetrahedra& linear_;
  std::vector<std::uint64_t> sides_;
  std::vector<std::array<std::uint32_t, 3>> outer_, outer_and_between_;
};

}  // namespace

SecondOrder second_order(const Tetrahedra& tetrahedra, const DeckOptions& options) {
  if (!tetrahedra.mid_nodes.empty())
    throw std::invalid_argument("second_order: the elements have nodes on their sides already");
  const Refining refining(tetrahedra);
  SecondOrder made{refining.tetrahedra(), options};
  made.options.second_order = false;
  for (NodeSet& set : made.options.node_sets) {
    std::vector<std::uint32_t> all = refining.with_middles(set.nodes);
    for (Prescribed& prescribed : made.options.prescribed)
      if (prescribed.node_set == set.name && !prescribed.displacement_mm.empty())
        prescribed.displacement_mm = refining.with_means(set.nodes, all, prescribed.displacement_mm);
    set.nodes = std::move(all);
  }
  return made;
}

}  // namespace octotomy::convert

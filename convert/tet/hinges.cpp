// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/hinges.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "brep/mesh/disjoint_sets.h"
#include "voxel/space/rounded.h"

namespace octotomy::convert {
namespace {

/// Sets of elements that are linked by faces.
brep::DisjointSets linked_by_faces(const Tetrahedra& tetrahedra) {
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::uint32_t>> faces;
  faces.reserve(4 * tetrahedra.tets.size());
  for (std::uint32_t t = 0; t < tetrahedra.tets.size(); ++t) {
    const auto& [a, b, c, d] = tetrahedra.tets[t];
    for (std::array<std::uint32_t, 3> face : {std::array{a, b, c}, {a, b, d}, {a, c, d}, {b, c, d}}) {
      std::sort(face.begin(), face.end());
      faces.emplace_back(face, t);
    }
  }
  std::sort(faces.begin(), faces.end());
  brep::DisjointSets sets(tetrahedra.tets.size());
  for (std::size_t i = 1; i < faces.size(); ++i)
    if (faces[i].first == faces[i - 1].first) sets.join(faces[i].second, faces[i - 1].second);
  return sets;
}

}  // namespace

std::optional<std::string> hinge_in(const Tetrahedra& tetrahedra) {
  brep::DisjointSets sets = linked_by_faces(tetrahedra);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> parts_of_nodes;
  parts_of_nodes.reserve(4 * tetrahedra.tets.size());
  for (std::uint32_t t = 0; t < tetrahedra.tets.size(); ++t)
    for (const std::uint32_t node : tetrahedra.tets[t]) parts_of_nodes.emplace_back(node, sets.set_of(t));
  std::sort(parts_of_nodes.begin(), parts_of_nodes.end());
  parts_of_nodes.erase(std::unique(parts_of_nodes.begin(), parts_of_nodes.end()), parts_of_nodes.end());
  std::vector<std::uint32_t> nodes, parts;
  for (std::size_t i = 1; i < parts_of_nodes.size(); ++i) {
    if (parts_of_nodes[i].first != parts_of_nodes[i - 1].first) continue;
    nodes.push_back(parts_of_nodes[i].first);
    parts.insert(parts.end(), {parts_of_nodes[i].second, parts_of_nodes[i - 1].second});
  }
  if (nodes.empty()) return std::nullopt;
  std::sort(parts.begin(), parts.end());
  const auto part_count = std::unique(parts.begin(), parts.end()) - parts.begin();
  const auto node_count = std::unique(nodes.begin(), nodes.end()) - nodes.begin();
  return std::to_string(part_count) + " parts are connected only by edges or nodes, at " +
         std::to_string(node_count) + (node_count == 1 ? " node, at " : " nodes, the first at ") +
         voxel::rounded(tetrahedra.nodes_mm[nodes.front()]) +
         " mm: they turn there as on a hinge; close the gap beside it in the object, or hold each part";
}

}  // namespace octotomy::convert

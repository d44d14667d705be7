// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/element_faces.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <tuple>
#include <utility>

namespace octotomy::convert {
namespace {

/// A face of an element by its corners, ascending.
struct Sided {
  std::array<std::uint32_t, 3> corners;
  ElementFace face;
};

/// All elements' faces; those of the same corners stand together, in the elements' order.
std::vector<Sided> sided_faces(const Tetrahedra& tetrahedra) {
  std::vector<Sided> all;
  all.reserve(4 * tetrahedra.tets.size());
  for (std::uint32_t t = 0; t < tetrahedra.tets.size(); ++t)
    for (std::uint8_t i = 0; i < 4; ++i) {
      std::array<std::uint32_t, 3> corners = corners_of(tetrahedra, {t, i});
      std::sort(corners.begin(), corners.end());
      all.push_back({corners, {t, i}});
    }
  std::sort(all.begin(), all.end(), [](const Sided& a, const Sided& b) {
    return std::tie(a.corners, a.face.tet) < std::tie(b.corners, b.face.tet);
  });
  return all;
}

bool in_order(const ElementFace& a, const ElementFace& b) {
  return std::pair(a.tet, a.opposite) < std::pair(b.tet, b.opposite);
}

}  // namespace

std::array<std::uint32_t, 3> corners_of(const Tetrahedra& tetrahedra, const ElementFace& face) {
  assert(face.tet < tetrahedra.tets.size() && face.opposite < 4);
  const auto& [a, b, c, d] = tetrahedra.tets[face.tet];
  switch (face.opposite) {
    case 0:
      return {b, c, d};
    case 1:
      return {a, d, c};
    case 2:
      return {a, b, d};
    default:
      return {a, c, b};
  }
}

std::array<std::uint32_t, 3> middles_of(const Tetrahedra& tetrahedra, const ElementFace& face) {
  assert(face.tet < tetrahedra.mid_nodes.size() && face.opposite < 4);
  const auto& middles = tetrahedra.mid_nodes[face.tet];
  switch (face.opposite) {
    case 0:
      return {middles[1], middles[5], middles[4]};
    case 1:
      return {middles[3], middles[5], middles[2]};
    case 2:
      return {middles[0], middles[4], middles[3]};
    default:
      return {middles[2], middles[1], middles[0]};
  }
}

std::vector<ElementFace> surface_faces(const Tetrahedra& tetrahedra) {
  const std::vector<Sided> all = sided_faces(tetrahedra);
  std::vector<ElementFace> faces;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i + 1;
    while (end < all.size() && all[end].corners == all[i].corners) ++end;
    if (end == i + 1) faces.push_back(all[i].face);
    i = end;
  }
  std::sort(faces.begin(), faces.end(), in_order);
  return faces;
}

brep::Triangles surface_of(const Tetrahedra& tetrahedra) {
  brep::Triangles surface{tetrahedra.nodes_mm, {}};
  for (const ElementFace& face : surface_faces(tetrahedra))
    surface.faces.push_back(corners_of(tetrahedra, face));
  return surface;
}

std::vector<Interface> interfaces(const Tetrahedra& tetrahedra) {
  const std::vector<Sided> all = sided_faces(tetrahedra);
  using Sides = std::pair<ElementFace, ElementFace>;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Sides>> found;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    if (all[i].corners != all[i + 1].corners) continue;
    const std::uint32_t one = region_of(tetrahedra, all[i].face.tet);
    const std::uint32_t other = region_of(tetrahedra, all[i + 1].face.tet);
    if (one < other) found[{one, other}].emplace_back(all[i].face, all[i + 1].face);
    if (other < one) found[{other, one}].emplace_back(all[i + 1].face, all[i].face);
  }
  std::vector<Interface> result;
  for (auto& [regions, sides] : found) {
    std::sort(sides.begin(), sides.end(),
              [](const Sides& a, const Sides& b) { return in_order(a.first, b.first); });
    result.push_back({regions.first, regions.second, {}, {}});
    for (const auto& [face, opposite] : sides) {
      result.back().faces.push_back(face);
      result.back().opposite.push_back(opposite);
    }
  }
  return result;
}

}  // namespace octotomy::convert

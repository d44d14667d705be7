// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/element_faces.h"

#include <algorithm>
#include <cassert>
#include <functional>
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

/// Calls `visit(begin, end)` for each set of faces with the same three corners, in the elements' order;
/// corners ascend from call to call. Faces are gathered for one range of smallest corners at a time, because
/// all faces at once need five times the elements' memory.
template <typename Visit>
void for_each_corners(const Tetrahedra& tetrahedra, const Visit& visit) {
  constexpr std::size_t faces_at_once = std::size_t{1} << 22;
  // Three faces of an element contain its smallest corner; the fourth contains the second smallest.
  const auto two_smallest = [](std::array<std::uint32_t, 4> tet) {
    std::partial_sort(tet.begin(), tet.begin() + 2, tet.end());
    return std::pair(tet[0], tet[1]);
  };
  std::vector<std::uint32_t> face_count;
  for (const auto& tet : tetrahedra.tets) {
    const auto [smallest, next] = two_smallest(tet);
    if (next >= face_count.size()) face_count.resize(std::size_t{next} + 1, 0);
    face_count[smallest] += 3;
    ++face_count[next];
  }
  std::vector<Sided> faces;
  std::vector<std::size_t> ends;  // for each smallest corner of the range: where its faces end
  for (std::size_t first = 0, last = 0; first < face_count.size(); first = last) {
    ends.clear();
    std::size_t count = 0;
    for (; last < face_count.size() && (last == first || count + face_count[last] <= faces_at_once); ++last) {
      ends.push_back(count);
      count += face_count[last];
    }
    faces.resize(count);
    const auto in_range = [&](std::uint32_t corner) { return corner >= first && corner < last; };
    for (std::uint32_t t = 0; t < tetrahedra.tets.size(); ++t) {
      const auto [smallest, next] = two_smallest(tetrahedra.tets[t]);
      if (!in_range(smallest) && !in_range(next)) continue;
      for (std::uint8_t i = 0; i < 4; ++i) {
        std::array<std::uint32_t, 3> corners = corners_of(tetrahedra, {t, i});
        std::sort(corners.begin(), corners.end());
        if (in_range(corners[0])) faces[ends[corners[0] - first]++] = {corners, {t, i}};
      }
    }
    for (std::size_t n = 0, begin = 0; n < ends.size(); begin = ends[n++]) {
      const auto from = faces.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto to = faces.begin() + static_cast<std::ptrdiff_t>(ends[n]);
      std::sort(from, to, [](const Sided& a, const Sided& b) {
        return std::tie(a.corners, a.face.tet) < std::tie(b.corners, b.face.tet);
      });
      for (auto same = from, end = from; same != to; same = end) {
        end = std::find_if(same, to, [same](const Sided& f) { return f.corners != same->corners; });
        visit(same, end);
      }
    }
  }
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
  std::vector<ElementFace> faces;
  for_each_corners(tetrahedra, [&](auto begin, auto end) {
    if (end - begin == 1) faces.push_back(begin->face);
  });
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
  const auto& regions_of = tetrahedra.region_of_tet;
  if (std::adjacent_find(regions_of.begin(), regions_of.end(), std::not_equal_to<>()) == regions_of.end())
    return {};
  using Sides = std::pair<ElementFace, ElementFace>;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Sides>> found;
  for_each_corners(tetrahedra, [&](auto begin, auto end) {
    for (auto face = begin; face + 1 != end; ++face) {
      const std::uint32_t one = region_of(tetrahedra, face->face.tet);
      const std::uint32_t other = region_of(tetrahedra, (face + 1)->face.tet);
      if (one < other) found[{one, other}].emplace_back(face->face, (face + 1)->face);
      if (other < one) found[{other, one}].emplace_back((face + 1)->face, face->face);
    }
  });
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

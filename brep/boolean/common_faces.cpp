// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/common_faces.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "brep/mesh/equal_points.h"
#include "brep/mesh/health.h"
#include "brep/mesh/split_fans.h"

namespace octotomy::brep {
namespace {

using Face = std::array<std::uint32_t, 3>;

struct FaceHash {
  std::size_t operator()(const Face& f) const {
    std::uint64_t mixed = 0;
    for (const std::uint32_t v : f) mixed = (mixed ^ v) * 0x9E3779B97F4A7C15U;
    return mixed ^ (mixed >> 29);
  }
};

/// The face with its corners rotated so that the lowest number comes first.
Face turned(const Face& f) {
  const auto least = static_cast<std::size_t>(std::min_element(f.begin(), f.end()) - f.begin());
  return {f[least], f[(least + 1) % 3], f[(least + 2) % 3]};
}

}  // namespace

std::optional<Solid> united_at_common_faces(const Solid& a, const Solid& b) {
  const Triangles &of_a = a.triangles(), &of_b = b.triangles();
  Triangles both{of_a.points_mm, {}};
  both.points_mm.insert(both.points_mm.end(), of_b.points_mm.begin(), of_b.points_mm.end());
  const auto shift = static_cast<std::uint32_t>(of_a.points_mm.size());
  const std::vector<std::uint32_t> first = first_equal_points(both.points_mm);
  // The second solid's faces, reversed, by the numbers that their corners have in the first solid.
  std::unordered_map<Face, std::uint32_t, FaceHash> opposite;
  for (std::uint32_t f = 0; f < of_b.faces.size(); ++f) {
    const Face& face = of_b.faces[f];
    opposite[turned({first[face[0] + shift], first[face[2] + shift], first[face[1] + shift]})] = f;
  }
  std::vector<bool> goes(of_b.faces.size(), false);
  for (const Face& face : of_a.faces) {
    const auto found = opposite.find(turned({first[face[0]], first[face[1]], first[face[2]]}));
    if (found != opposite.end() && !goes[found->second])
      goes[found->second] = true;
    else
      both.faces.push_back(face);
  }
  if (both.faces.size() == of_a.faces.size()) return std::nullopt;
  for (std::uint32_t f = 0; f < of_b.faces.size(); ++f) {
    const Face& face = of_b.faces[f];
    if (!goes[f]) both.faces.push_back({face[0] + shift, face[1] + shift, face[2] + shift});
  }
  Triangles joined = joined_surface(both).surface;
  const Health found = health(joined, {false});
  if (!found.closed || !found.manifold || !found.oriented) return std::nullopt;
  return trusted_solid(std::move(joined), Proof::Rounded);
}

}  // namespace octotomy::brep

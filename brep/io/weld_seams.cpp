// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 leave out triangles that repeat a point; 2 find points that coincide; 3 pair open sides by the positions
// of their ends; 4 join the ends of each pair; 5 undo this if an edge became worse.
#include "brep/io/weld_seams.h"

#include <algorithm>
#include <array>
#include <string>
#include <tuple>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/sides.h"

namespace octotomy::brep {
namespace {

using FaceCorners = std::array<std::uint32_t, 3>;

bool repeats(const FaceCorners& face) {
  return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
}

std::size_t erase_repeating(Triangles& triangles) {
  return std::erase_if(triangles.faces, repeats);
}

void tell_left_out(std::size_t count, std::vector<MeshFinding>& findings) {
  if (count == 0) return;
  findings.push_back({"polygons", MeshVerdict::Pass,
                      std::to_string(count) +
                          (count == 1 ? " triangle that repeats" : " triangles that repeat") +
                          " a corner, so that it has no area, left out"});
}

/// Counts over all edges: sides without an opposite side, edges of more than two triangles, and edges of two
/// triangles with the same direction.
struct EdgeState {
  std::vector<Side> open;
  std::size_t crowded = 0, contrary = 0;
};
EdgeState edge_state(const Triangles& triangles) {
  EdgeState state;
  each_edge(sorted_sides(triangles), [&](const Side* begin, const Side* end) {
    if (end - begin == 1) state.open.push_back(*begin);
    if (end - begin > 2) ++state.crowded;
    if (end - begin == 2 && begin[0].upward == begin[1].upward) ++state.contrary;
  });
  return state;
}

/// Removes triangles with coinciding corners that share no side with another triangle.
std::size_t erase_islands(Triangles& triangles, const std::vector<std::uint32_t>& first,
                          const std::vector<Side>& open) {
  std::vector<std::uint8_t> open_count(triangles.faces.size(), 0);
  for (const Side& side : open) ++open_count[side.corner / 3];
  std::vector<FaceCorners> kept;
  for (std::size_t f = 0; f < triangles.faces.size(); ++f) {
    const FaceCorners& face = triangles.faces[f];
    if (open_count[f] < 3 || !repeats({first[face[0]], first[face[1]], first[face[2]]})) kept.push_back(face);
  }
  const std::size_t count = triangles.faces.size() - kept.size();
  triangles.faces = std::move(kept);
  return count;
}

/// Joins the ends of open sides that coincide. Returns the number of paired sides.
std::size_t join_seams(const Triangles& triangles, const std::vector<std::uint32_t>& first,
                       const std::vector<Side>& open, DisjointSets& points) {
  struct Placed {
    std::uint32_t low, high;  ///< first points at the positions of the ends
    bool upward;
    std::uint32_t from, to;
  };
  std::vector<Placed> placed;
  for (const Side& side : open) {
    const FaceCorners& face = triangles.faces[side.corner / 3];
    const std::uint32_t from = face[side.corner % 3], to = face[next_corner(side.corner) % 3];
    const auto [low, high] = std::minmax(first[from], first[to]);
    if (low != high) placed.push_back({low, high, first[from] == low, from, to});
  }
  const auto place = [](const Placed& side) {
    return std::tuple(side.low, side.high, side.upward, side.from);
  };
  std::sort(placed.begin(), placed.end(),
            [&](const Placed& a, const Placed& b) { return place(a) < place(b); });
  std::size_t paired = 0;
  for (std::size_t i = 0, j; i < placed.size(); i = j) {
    for (j = i + 1; j < placed.size() && placed[j].low == placed[i].low && placed[j].high == placed[i].high;)
      ++j;
    if (j - i != 2 || placed[i].upward == placed[i + 1].upward) continue;
    points.join(placed[i].from, placed[i + 1].to);
    points.join(placed[i].to, placed[i + 1].from);
    paired += 2;
  }
  return paired;
}

/// The triangles with joined points; points that were joined to an earlier one are removed.
Triangles on_joined(const Triangles& triangles, DisjointSets& points) {
  Triangles made;
  std::vector<std::uint32_t> number(triangles.points_mm.size());
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    const std::uint32_t set = points.set_of(v);
    number[v] = set == v ? static_cast<std::uint32_t>(made.points_mm.size()) : number[set];
    if (set == v) made.points_mm.push_back(triangles.points_mm[v]);
  }
  made.faces.reserve(triangles.faces.size());
  for (const FaceCorners& face : triangles.faces)
    made.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
  return made;
}

}  // namespace

std::vector<MeshFinding> drop_repeating(Triangles& triangles) {
  std::vector<MeshFinding> findings;
  tell_left_out(erase_repeating(triangles), findings);
  return findings;
}

std::vector<MeshFinding> weld_seams(Triangles& triangles) {
  std::vector<MeshFinding> findings;
  std::size_t left_out = erase_repeating(triangles);
  const std::vector<std::uint32_t> first = first_equal_points(triangles.points_mm);
  bool any_coincide = false;
  for (std::uint32_t v = 0; v < first.size() && !any_coincide; ++v) any_coincide = first[v] != v;
  if (any_coincide) {
    EdgeState before = edge_state(triangles);
    if (const std::size_t islands = erase_islands(triangles, first, before.open); islands > 0) {
      left_out += islands;
      before = edge_state(triangles);
    }
    DisjointSets points(triangles.points_mm.size());
    if (const std::size_t paired = join_seams(triangles, first, before.open, points); paired > 0) {
      Triangles joined = on_joined(triangles, points);
      const std::size_t closed_up = erase_repeating(joined);
      const EdgeState after = edge_state(joined);
      if (after.crowded <= before.crowded && after.contrary <= before.contrary &&
          after.open.size() < before.open.size()) {
        findings.push_back({"points", MeshVerdict::Pass,
                            std::to_string(triangles.points_mm.size() - joined.points_mm.size()) +
                                " points that the file repeats, as for normals, colours or textures, were "
                                "merged with those at the same positions: " +
                                std::to_string(paired) + " open sides close"});
        left_out += closed_up;
        triangles = std::move(joined);
      }
    }
  }
  tell_left_out(left_out, findings);
  return findings;
}

}  // namespace octotomy::brep

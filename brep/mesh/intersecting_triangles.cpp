// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 keep the triangles that reach into the common box of both surfaces; 2 build a tree of boxes over those of
// each; 3 descend both trees together to pairs of overlapping boxes; 4 test those pairs by exact predicates.
#include "brep/mesh/intersecting_triangles.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/mesh/morton_tree.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Pair = std::pair<std::uint32_t, std::uint32_t>;

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
  void add(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  bool overlaps(const Box& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y &&
           low.z <= other.high.z && other.low.z <= high.z;
  }
};

Box box_of(const Triangles& surface, std::uint32_t face) {
  assert(face < surface.faces.size());
  Box box;
  for (const std::uint32_t v : surface.faces[face]) box.add(surface.points_mm[v]);
  return box;
}

Box box_of(const Triangles& surface) {
  Box box;
  for (const auto& face : surface.faces)
    for (const std::uint32_t v : face) box.add(surface.points_mm[v]);
  return box;
}

std::vector<std::uint32_t> marked(const std::vector<std::uint8_t>& marks) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t f = 0; f < marks.size(); ++f)
    if (marks[f]) numbers.push_back(f);
  return numbers;
}

/// The triangles whose boxes overlap `room`.
std::vector<std::uint32_t> reaching(const Triangles& surface, const Box& room) {
  std::vector<std::uint8_t> reaches(surface.faces.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(reaches.size()), 4096),
                    [&](const auto& range) {
                      for (std::uint32_t f = range.begin(); f != range.end(); ++f)
                        reaches[f] = box_of(surface, f).overlaps(room);
                    });
  return marked(reaches);
}

Kernel::Triangle_3 exact(const Triangles& surface, std::uint32_t face) {
  const auto point = [&](std::size_t k) {
    const glm::dvec3& p = surface.points_mm[surface.faces[face][k]];
    return Kernel::Point_3(p.x, p.y, p.z);
  };
  return {point(0), point(1), point(2)};
}

}  // namespace

IntersectingTriangles intersecting_triangles(const Triangles& a, const Triangles& b) {
  Box room = box_of(a);
  const Box box_b = box_of(b);
  if (!room.overlaps(box_b)) return {};
  room.low = glm::max(room.low, box_b.low);
  room.high = glm::min(room.high, box_b.high);
  const MortonTree of_a(a, reaching(a, room)), of_b(b, reaching(b, room));
  tbb::enumerable_thread_specific<std::vector<Pair>> found;
  of_a.visit_pairs(of_b, [&](std::uint32_t f, std::uint32_t g) { found.local().emplace_back(f, g); });
  std::vector<Pair> pairs;
  for (const std::vector<Pair>& part : found) pairs.insert(pairs.end(), part.begin(), part.end());

  std::vector<std::uint8_t> meets(pairs.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      assert(pairs[i].first < a.faces.size() && pairs[i].second < b.faces.size());
      const Kernel::Triangle_3 s = exact(a, pairs[i].first), t = exact(b, pairs[i].second);
      // Tests the triangles' own boxes, because the trees' boxes are larger.
      meets[i] = s.is_degenerate() || t.is_degenerate()
                     ? box_of(a, pairs[i].first).overlaps(box_of(b, pairs[i].second))
                     : CGAL::do_intersect(s, t);
    }
  });
  std::vector<std::uint8_t> marks_a(a.faces.size(), 0), marks_b(b.faces.size(), 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!meets[i]) continue;
    marks_a[pairs[i].first] = 1;
    marks_b[pairs[i].second] = 1;
  }
  return {marked(marks_a), marked(marks_b)};
}

}  // namespace octotomy::brep

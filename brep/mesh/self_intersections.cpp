// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 separate the triangles around hubs, points where many meet, from the others; 2 find the pairs that may
// meet: triangles around one hub by the arcs that they cover as seen from the hub, all others by their boxes;
// 3 test each pair by exact predicates, after filters in doubles that exclude most; 4 where sheets touch
// along an edge, test whether they also cross there. Points with equal coordinates count as one corner.
// Invariant: two triangles with a common corner meet elsewhere only in a direction that both cover as seen
// from that corner.
#include "brep/mesh/self_intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tuple>

#include "brep/mesh/equal_points.h"
#include "brep/mesh/sure_plane.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// From this number of triangles on, a point is a hub. Around a point with fewer triangles there are at most
/// 32 pairs for each triangle.
constexpr std::uint32_t least_of_hub = 64;

/// Tests whether two triangles meet outside the corners or the side that they share.
class MeetsElsewhere {
 public:
  explicit MeetsElsewhere(const Triangles& triangles) : triangles_(triangles) {}

  bool operator()(std::uint32_t f, std::uint32_t g) const {
    const auto &a = triangles_.faces[f], &b = triangles_.faces[g];
    // The number of shared corners, and a corner of each triangle that the other does not have.
    std::size_t shared = 0, own_a = 0, own_b = 0, shared_a = 0, shared_b = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = std::find(b.begin(), b.end(), a[i]);
      if (at == b.end()) {
        own_a = i;
        continue;
      }
      ++shared;
      shared_a = i;
      shared_b = static_cast<std::size_t>(at - b.begin());
    }
    if (shared == 3) return true;
    // If one triangle does not reach through the other's plane, they meet at most in the shared corner.
    if (shared < 2 &&
        (is_beside(b, shared == 1 ? shared_b : 3, a) || is_beside(a, shared == 1 ? shared_a : 3, b)))
      return false;
    if (shared < 2 && (is_apart(a, b) || is_apart(b, a))) return false;
    if (shared == 0) return CGAL::do_intersect(triangle(a), triangle(b));
    if (shared == 1)
      return CGAL::do_intersect(triangle(a), opposite(b, shared_b)) ||
             CGAL::do_intersect(triangle(b), opposite(a, shared_a));
    assert(shared == 2);
    for (std::size_t i = 0; i < 3; ++i)
      if (std::find(a.begin(), a.end(), b[i]) == a.end()) own_b = i;
    if (plane_of(a).side(at(b[own_b])) != 0 || is_apart(b, a)) return false;
    // Folded flat onto each other: coplanar, with both free corners on one side of the shared edge.
    const Kernel::Point_3 p = point(a[(own_a + 1) % 3]), q = point(a[(own_a + 2) % 3]);
    const Kernel::Point_3 r = point(a[own_a]), s = point(b[own_b]);
    return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
  }

 private:
  using Face = std::array<std::uint32_t, 3>;
  const glm::dvec3& at(std::uint32_t v) const { return triangles_.points_mm[v]; }
  SurePlane plane_of(const Face& f) const { return {at(f[0]), at(f[1]), at(f[2])}; }
  /// Whether all corners of f but one are certainly on one side of g's plane.
  bool is_beside(const Face& f, std::size_t but, const Face& g) const {
    const SurePlane plane = plane_of(g);
    int side = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == but) continue;
      const int of_corner = plane.side(at(f[k]));
      if (of_corner == 0 || of_corner == -side) return false;
      side = of_corner;
    }
    return true;
  }
  /// The side of the line from p to q on which another point certainly is, as seen along an axis.
  static int seen_side(int axis, const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& other) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const double one = (q[i] - p[i]) * (other[j] - p[j]), two = (q[j] - p[j]) * (other[i] - p[i]);
    return sure_sign(one - two, std::abs(one) + std::abs(two));
  }
  /// Whether the line of one of g's sides certainly separates g from f, as seen along the axis along which g
  /// has the largest outline. Corners that f shares with that side do not count.
  bool is_apart(const Face& f, const Face& g) const {
    const glm::dvec3 seen = glm::abs(glm::cross(at(g[1]) - at(g[0]), at(g[2]) - at(g[0])));
    const int axis = seen.x >= seen.y && seen.x >= seen.z ? 0 : seen.y >= seen.z ? 1 : 2;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = g[k], q = g[(k + 1) % 3], third = g[(k + 2) % 3];
      if (std::find(f.begin(), f.end(), third) != f.end()) continue;
      const int own = seen_side(axis, at(p), at(q), at(third));
      if (own != 0 && std::all_of(f.begin(), f.end(), [&](std::uint32_t v) {
            return v == p || v == q || seen_side(axis, at(p), at(q), at(v)) == -own;
          }))
        return true;
    }
    return false;
  }
  Kernel::Point_3 point(std::uint32_t v) const {
    const glm::dvec3& p = at(v);
    return {p.x, p.y, p.z};
  }
  Kernel::Triangle_3 triangle(const Face& f) const { return {point(f[0]), point(f[1]), point(f[2])}; }
  Kernel::Segment_3 opposite(const Face& f, std::size_t corner) const {
    return {point(f[(corner + 1) % 3]), point(f[(corner + 2) % 3])};
  }

  const Triangles& triangles_;
};

/// Counts pairs of triangles and stores only the first ones, because their number may be the square of the
/// number of triangles.
class FirstPairs {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  explicit FirstPairs(std::size_t most) : most_(most) {}

  void add(const Pair& pair) {
    ++count_;
    if (!(pair < bound_)) return;
    first_.push_back(pair);
    if (first_.size() >= 2 * most_) keep_first();
  }
  void add(const FirstPairs& other) {
    count_ += other.count_;
    first_.insert(first_.end(), other.first_.begin(), other.first_.end());
    keep_first();
  }
  /// Puts the first pairs in ascending order.
  void sort() { keep_first(); }
  std::size_t count() const { return count_; }
  const std::vector<Pair>& first() const { return first_; }  ///< ascending after sort()

 private:
  void keep_first() {
    std::sort(first_.begin(), first_.end());
    if (first_.size() < most_) return;
    first_.resize(most_);
    if (most_ > 0) bound_ = first_.back();
  }

  std::size_t most_, count_ = 0;
  /// This pair and larger ones are not among the first.
  Pair bound_{std::numeric_limits<std::uint32_t>::max(), std::numeric_limits<std::uint32_t>::max()};
  std::vector<Pair> first_;
};

/// A point where many triangles meet, and the triangles around it.
struct Hub {
  std::uint32_t point = 0;
  std::vector<std::uint32_t> faces;
};

/// Triangles with area, each of one hub or of none.
struct Parted {
  std::vector<Hub> hubs;
  std::vector<std::uint32_t> others;
};

Parted parted_by_hubs(const Triangles& triangles, const std::vector<std::uint8_t>& degenerate) {
  std::vector<std::uint32_t> count(triangles.points_mm.size(), 0);
  for (std::size_t f = 0; f < triangles.faces.size(); ++f)
    for (const std::uint32_t v : triangles.faces[f]) count[v] += degenerate[f] == 0;
  Parted parted;
  std::vector<std::size_t> hub_of(count.size());
  for (std::uint32_t v = 0; v < count.size(); ++v) {
    if (count[v] < least_of_hub) continue;
    hub_of[v] = parted.hubs.size();
    parted.hubs.push_back({v, {}});
  }
  if (parted.hubs.empty()) return parted;
  for (std::uint32_t f = 0; f < triangles.faces.size(); ++f) {
    if (degenerate[f] != 0) continue;
    const auto& face = triangles.faces[f];
    const std::uint32_t v = *std::max_element(
        face.begin(), face.end(), [&](std::uint32_t a, std::uint32_t b) { return count[a] < count[b]; });
    (count[v] < least_of_hub ? parted.others : parted.hubs[hub_of[v]].faces).push_back(f);
  }
  std::erase_if(parted.hubs, [](const Hub& hub) { return hub.faces.empty(); });
  return parted;
}

/// Boxes for a tree, each stored as a triangle between its opposite corners.
class BoxList {
 public:
  void add(const glm::dvec3& low, const glm::dvec3& high) {
    const auto v = static_cast<std::uint32_t>(boxes_.points_mm.size());
    boxes_.points_mm.insert(boxes_.points_mm.end(), {low, high});
    boxes_.faces.push_back({v, v + 1, v});
  }
  MortonTree tree() const { return MortonTree(boxes_); }

 private:
  Triangles boxes_;
};

/// The direction of one point from another as a unit vector; none if their difference is not a finite double
/// or is zero.
std::optional<glm::dvec3> direction(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 apart = to - from, size = glm::abs(apart);
  const double largest = std::max({size.x, size.y, size.z});
  if (!std::isfinite(largest) || !(largest > 0.0)) return std::nullopt;
  return glm::normalize(apart / largest);
}

/// A tree over boxes of the arcs of great circles that triangles cover as seen from a hub. An arc deviates
/// from its chord c by at most 1 - sqrt(1 - c^2 / 4), which is at most c^2 / 4. The error of a direction is
/// less than eight epsilons: one for the difference and the quotient, the others for the unit length.
MortonTree tree_of_arcs(const Triangles& triangles, const Hub& hub) {
  constexpr double off = 16.0 * std::numeric_limits<double>::epsilon();
  const glm::dvec3& centre = triangles.points_mm[hub.point];
  BoxList boxes;
  for (const std::uint32_t f : hub.faces) {
    const auto& face = triangles.faces[f];
    const auto at = std::find(face.begin(), face.end(), hub.point) - face.begin();
    const auto one = direction(centre, triangles.points_mm[face[static_cast<std::size_t>(at + 1) % 3]]);
    const auto other = direction(centre, triangles.points_mm[face[static_cast<std::size_t>(at + 2) % 3]]);
    if (!one || !other) {
      boxes.add(glm::dvec3(-1.0), glm::dvec3(1.0));
      continue;
    }
    const glm::dvec3 chord = *other - *one, beyond(0.25 * glm::dot(chord, chord) + off);
    boxes.add(glm::min(*one, *other) - beyond, glm::max(*one, *other) + beyond);
  }
  return boxes.tree();
}

/// Calls visit(face, other) once for each pair of triangles that may meet, in parallel.
template <typename Visit>
void visit_parted_pairs(const Triangles& triangles, const Parted& parted, const Visit& visit) {
  std::vector<std::uint32_t> about_hubs;
  std::vector<MortonTree> trees;
  BoxList boxes;
  for (const Hub& hub : parted.hubs) {
    about_hubs.insert(about_hubs.end(), hub.faces.begin(), hub.faces.end());
    trees.emplace_back(triangles, hub.faces);
    glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
    for (const std::uint32_t f : hub.faces)
      for (const std::uint32_t v : triangles.faces[f]) {
        low = glm::min(low, triangles.points_mm[v]);
        high = glm::max(high, triangles.points_mm[v]);
      }
    boxes.add(glm::min(low, high), high);
  }
  const MortonTree others(triangles, parted.others);
  others.visit_own_pairs(visit);
  others.visit_pairs(MortonTree(triangles, about_hubs), visit);
  boxes.tree().visit_own_pairs(
      [&](std::uint32_t i, std::uint32_t j) { trees[i].visit_pairs(trees[j], visit); });
  tbb::parallel_for(std::size_t{0}, parted.hubs.size(), [&](std::size_t i) {
    const std::vector<std::uint32_t>& faces = parted.hubs[i].faces;
    tree_of_arcs(triangles, parted.hubs[i]).visit_own_pairs([&](std::uint32_t f, std::uint32_t g) {
      visit(faces[f], faces[g]);
    });
  });
}

/// A triangle at an edge from point `from` to `to`, the lower number first.
struct EdgeUse {
  std::uint32_t from = 0, to = 0, face = 0, apex = 0;
  bool is_forward = false;
};

/// The sides of triangles whose two ends are points that had several numbers, sorted by edge. Sides of
/// triangles without area are left out.
std::vector<EdgeUse> uses_of_shared_edges(const Triangles& triangles,
                                          const std::vector<std::uint8_t>& is_copied,
                                          const std::vector<std::uint8_t>& degenerate) {
  std::vector<EdgeUse> uses;
  for (std::uint32_t f = 0; f < triangles.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& face = triangles.faces[f];
      const std::uint32_t v = face[k], w = face[(k + 1) % 3];
      if (is_copied[v] && is_copied[w] && degenerate[f] == 0)
        uses.push_back({std::min(v, w), std::max(v, w), f, face[(k + 2) % 3], v < w});
    }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& p, const EdgeUse& q) {
    return std::tie(p.from, p.to, p.face) < std::tie(q.from, q.to, q.face);
  });
  return uses;
}

/// Sorts triangles by their angle around their common edge, exactly.
void sort_around(const Triangles& triangles, std::span<EdgeUse> uses) {
  const auto point = [&](std::uint32_t v) {
    const glm::dvec3& p = triangles.points_mm[v];
    return Kernel::Point_3(p.x, p.y, p.z);
  };
  const Kernel::Point_3 p = point(uses[0].from), q = point(uses[0].to), first = point(uses[0].apex);
  // 0: at the first triangle's angle; 1: up to half a turn further; 2: half a turn; 3: beyond.
  const auto quarter = [&](const EdgeUse& use) {
    const Kernel::Point_3 apex = point(use.apex);
    const auto side = CGAL::orientation(p, q, first, apex);
    if (side != CGAL::COPLANAR) return side == CGAL::POSITIVE ? 1 : 3;
    return CGAL::coplanar_orientation(p, q, first, apex) == CGAL::POSITIVE ? 0 : 2;
  };
  std::stable_sort(uses.begin(), uses.end(), [&](const EdgeUse& one, const EdgeUse& other) {
    const int of_one = quarter(one), of_other = quarter(other);
    if (of_one != of_other) return of_one < of_other;
    return of_one % 2 == 1 && CGAL::orientation(p, q, point(one.apex), point(other.apex)) == CGAL::POSITIVE;
  });
}

/// Pairs of triangles that are neighbours around an edge of several sheets and have the same winding there, so
/// that one sheet runs into another one. Around an edge where sheets only touch, windings alternate.
std::vector<FirstPairs::Pair> crossings_at_edges(const Triangles& triangles,
                                                 const std::vector<std::uint8_t>& is_copied,
                                                 const std::vector<std::uint8_t>& degenerate) {
  std::vector<FirstPairs::Pair> pairs;
  std::vector<EdgeUse> uses = uses_of_shared_edges(triangles, is_copied, degenerate);
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].from == uses[begin].from && uses[end].to == uses[begin].to) ++end;
    const std::span<EdgeUse> around(uses.data() + begin, end - begin);
    const auto forward = static_cast<std::size_t>(
        std::count_if(around.begin(), around.end(), [](auto& use) { return use.is_forward; }));
    if (around.size() < 4 || 2 * forward != around.size()) continue;
    sort_around(triangles, around);
    for (std::size_t i = 0; i < around.size(); ++i) {
      const EdgeUse &one = around[i], &next = around[(i + 1) % around.size()];
      if (one.is_forward != next.is_forward) continue;
      pairs.push_back(std::minmax(one.face, next.face));
      break;
    }
  }
  return pairs;
}

/// The surface in which corners with equal coordinates have one number; `is_copied` is 1 for each point that
/// had several.
struct Joined {
  Triangles triangles;
  std::vector<std::uint8_t> is_copied;
};

/// None if no two points coincide.
std::optional<Joined> joined_at_equal_points(const Triangles& triangles) {
  const std::vector<std::uint32_t> first = first_equal_points(triangles.points_mm);
  Joined joined;
  bool has_copy = false;
  for (std::uint32_t v = 0; v < first.size(); ++v) has_copy = has_copy || first[v] != v;
  if (!has_copy) return std::nullopt;
  joined.is_copied.resize(first.size(), 0);
  for (std::uint32_t v = 0; v < first.size(); ++v)
    if (first[v] != v) joined.is_copied[first[v]] = 1;
  joined.triangles = triangles;
  for (auto& face : joined.triangles.faces)
    for (std::uint32_t& v : face) v = first[v];
  return joined;
}

}  // namespace

SelfIntersections self_intersections(const IntersectionSearch& given) {
  assert(given.degenerate.size() == given.triangles.faces.size());
  const std::optional<Joined> joined = joined_at_equal_points(given.triangles);
  const IntersectionSearch search{joined ? joined->triangles : given.triangles, given.tree, given.degenerate,
                                  given.most_first};
  tbb::enumerable_thread_specific<FirstPairs> found(FirstPairs{search.most_first});
  const MeetsElsewhere meets_elsewhere(search.triangles);
  const auto test = [&](std::uint32_t f, std::uint32_t g) {
    if (search.degenerate[f] != 0 || search.degenerate[g] != 0) return;
    const FirstPairs::Pair pair = std::minmax(f, g);
    if (meets_elsewhere(pair.first, pair.second)) found.local().add(pair);
  };
  const Parted parted = parted_by_hubs(search.triangles, search.degenerate);
  if (parted.hubs.empty())
    search.tree.visit_own_pairs(test);
  else
    visit_parted_pairs(search.triangles, parted, test);
  FirstPairs meeting(search.most_first);
  for (const FirstPairs& part : found) meeting.add(part);
  if (joined)
    for (const FirstPairs::Pair& pair :
         crossings_at_edges(search.triangles, joined->is_copied, search.degenerate))
      meeting.add(pair);
  meeting.sort();
  return {meeting.count(), meeting.first()};
}

}  // namespace octotomy::brep

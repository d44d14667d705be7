// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 level by level, drop tetrahedra whose middle is farther from the surface than from their corners, where
// possible by the distances at their corners alone; keep those in which distances are linear, and bisect the
// others; 2 bisect kept tetrahedra if a neighbour was bisected at the middle of one of their edges, until
// there are none. All corners of a dropped tetrahedron lie on one side of the surface, and so do the corners
// that neighbours have within its faces. So the surface is closed although dropped tetrahedra are not
// bisected.
#include "brep/shape/bisected_lattice.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t most_simplices = std::size_t{1} << 22;
constexpr double most_narrow = 64.0;  ///< longest edge of a flat tetrahedron, in multiples of narrowest_mm
constexpr std::array<std::array<std::size_t, 2>, 6> sides = {
    {{{0, 1}}, {{0, 2}}, {{0, 3}}, {{1, 2}}, {{1, 3}}, {{2, 3}}}};

glm::dvec3 at(std::uint64_t key) {
  return glm::dvec3(place_of(key));
}

/// The middle of two places is a place if the sum of both is even on every axis. Its key is then half the sum
/// of both keys.
bool has_middle(std::uint64_t a, std::uint64_t b) {
  return glm::all(glm::equal((place_of(a) + place_of(b)) & 1, LatticePoint(0)));
}
std::uint64_t middle_of(std::uint64_t a, std::uint64_t b) {
  return key_of((place_of(a) + place_of(b)) / 2);
}

std::uint64_t middle_of(const Simplex& simplex) {
  return middle_of(simplex.corners[0], simplex.corners[simplex.tag]);
}
bool can_be_bisected(const Simplex& simplex) {
  return has_middle(simplex.corners[0], simplex.corners[simplex.tag]);
}

std::array<Simplex, 2> halves(const Simplex& simplex) {
  const std::uint64_t middle = middle_of(simplex);
  std::array<Simplex, 2> made{simplex, simplex};
  made[0].corners[simplex.tag] = middle;
  for (std::size_t i = 0; i < simplex.tag; ++i) made[1].corners[i] = simplex.corners[i + 1];
  made[1].corners[simplex.tag] = middle;
  for (Simplex& half : made) {
    half.tag = simplex.tag > 1 ? static_cast<std::uint8_t>(simplex.tag - 1) : 3;
    ++half.level;
  }
  return made;
}

std::vector<Simplex> whole_cube(int side) {
  std::vector<Simplex> simplices;
  for (const auto& order : {std::array{0, 1, 2}, std::array{0, 2, 1}, std::array{1, 0, 2},
                            std::array{1, 2, 0}, std::array{2, 0, 1}, std::array{2, 1, 0}}) {
    Simplex simplex;
    LatticePoint corner(0);
    simplex.corners[0] = key_of(corner);
    for (std::size_t i = 0; i < 3; ++i) {
      corner[order[i]] = side;
      simplex.corners[i + 1] = key_of(corner);
    }
    simplices.push_back(simplex);
  }
  return simplices;
}

class Bisection {
 public:
  Bisection(const BisectionOptions& options, const DistancesAt& distances_at)
      : options_(options), distances_at_(distances_at) {}

  BisectedLattice run(const std::function<void()>& report) {
    std::vector<Open> level = whole_level();
    while (!level.empty()) {
      report();
      level = refined(level);
    }
    // The first round searches all middles; each further round only those that the round before added.
    for (std::vector<std::uint64_t> added = close(middles_); !added.empty();) {
      report();
      Middles middles;
      for (const std::uint64_t middle : added) middles.insert(middle, {});
      added = close(middles);
    }
    keep_passed();
    return std::move(found_);
  }

 private:
  struct Nothing {};
  using Middles = KeyTable<Nothing>;

  /// A tetrahedron that may be bisected, with the distances at its corners: halves inherit them, so that
  /// few are looked up.
  struct Open {
    Simplex simplex;
    std::array<double, 4> at_corners_mm{};
  };

  /// For each item, whether it satisfies a condition; in parallel.
  template <typename Condition>
  static std::vector<std::uint8_t> where(std::size_t count, const Condition& condition) {
    std::vector<std::uint8_t> is(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) is[i] = condition(i) ? 1 : 0;
    });
    return is;
  }

  /// Computes the distances at places that have none yet.
  void learn(const std::vector<std::uint64_t>& keys) {
    const std::vector<std::uint8_t> is_known =
        where(keys.size(), [&](std::size_t i) { return found_.distances_mm.contains(keys[i]); });
    std::vector<std::uint64_t> unknown;
    std::vector<glm::dvec3> places;
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (is_known[i] == 0 && found_.distances_mm.insert(keys[i], 0.0)) {
        unknown.push_back(keys[i]);
        places.push_back(at(keys[i]));
      }
    const std::vector<double> distances = distances_at_(places);
    for (std::size_t i = 0; i < unknown.size(); ++i) found_.distances_mm.set(unknown[i], distances[i]);
  }
  double known(std::uint64_t key) const { return found_.distances_mm.at(key); }

  void check_count(std::size_t more) const {
    if (found_.simplices.size() + more > most_simplices)
      throw TooLarge("the offset surface passes more than 2^22 tetrahedra of a lattice with steps of " +
                     std::to_string(options_.step_mm) + " mm: take larger cells");
  }

  static glm::dvec3 centre_of(const Simplex& simplex) {
    return 0.25 * (at(simplex.corners[0]) + at(simplex.corners[1]) + at(simplex.corners[2]) +
                   at(simplex.corners[3]));
  }
  double longest_mm(const Simplex& simplex) const {
    double longest = 0.0;
    for (const auto& [i, j] : sides)
      longest = std::max(longest, glm::distance(at(simplex.corners[i]), at(simplex.corners[j])));
    return longest * options_.step_mm;
  }
  /// The distance from the middle of a tetrahedron to its farthest corner.
  static double reach_of(const Simplex& simplex) {
    const glm::dvec3 centre = centre_of(simplex);
    double reach = 0.0;
    for (const std::uint64_t corner : simplex.corners)
      reach = std::max(reach, glm::distance(centre, at(corner)));
    return reach;
  }
  bool may_be_passed(const Simplex& simplex, double at_centre_mm) const {
    return std::abs(at_centre_mm) <= options_.step_mm * reach_of(simplex) * (1.0 + 1e-9);
  }
  static bool is_passed(const std::array<double, 4>& at_corners_mm) {
    const auto inside = std::count_if(at_corners_mm.begin(), at_corners_mm.end(),
                                      [](double distance_mm) { return distance_mm < 0.0; });
    return inside != 0 && inside != 4;
  }
  /// Whether a corner alone shows that the middle is too far from the surface for may_be_passed(). The margin
  /// is above the rounding of both distances.
  bool is_surely_beside(const Open& open) const {
    const glm::dvec3 centre = centre_of(open.simplex);
    const double reach = reach_of(open.simplex) * (1.0 + 1e-8);
    for (std::size_t i = 0; i < 4; ++i)
      if (std::abs(open.at_corners_mm[i]) >
          options_.step_mm * (reach + glm::distance(centre, at(open.simplex.corners[i]))))
        return true;
    return false;
  }
  bool is_linear_between(std::uint64_t a, std::uint64_t b) const {
    return std::abs(0.5 * (known(a) + known(b)) - known(middle_of(a, b))) <= options_.tolerance_mm;
  }
  bool is_linear_on_edges(const Simplex& simplex) const {
    return std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
      const std::uint64_t a = simplex.corners[side[0]], b = simplex.corners[side[1]];
      return !has_middle(a, b) || is_linear_between(a, b);
    });
  }
  bool is_linear_at_centre(const Open& open, double at_centre_mm) const {
    double sum = 0.0;
    for (const double distance_mm : open.at_corners_mm) sum += distance_mm;
    return std::abs(0.25 * sum - at_centre_mm) <= options_.tolerance_mm;
  }

  /// Appends points of a tetrahedron's flat piece of surface: where the distance is 0 if distances are
  /// linear in the tetrahedron. The points are `narrowest_mm` apart at most. Appends none if no edge of the
  /// tetrahedron is longer than twice `narrowest_mm`.
  void add_piece(const Simplex& simplex, std::vector<glm::dvec3>& places) const {
    if (longest_mm(simplex) <= 2.0 * options_.narrowest_mm) return;
    std::vector<glm::dvec3> corners;
    for (const auto& [i, j] : sides) {
      const std::uint64_t a = simplex.corners[i], b = simplex.corners[j];
      const double at_a = known(a), at_b = known(b);
      if ((at_a < 0.0) != (at_b < 0.0)) corners.push_back(at(a) + at_a / (at_a - at_b) * (at(b) - at(a)));
    }
    // Any three of four corners make a triangle; together these triangles cover the piece.
    for (std::size_t left_out = 0; left_out < (corners.size() == 4 ? 4 : corners.size() / 3); ++left_out) {
      std::array<glm::dvec3, 3> triangle{};
      std::size_t count = 0;
      for (std::size_t i = 0; i < corners.size() && count < 3; ++i)
        if (corners.size() == 3 || i != left_out) triangle[count++] = corners[i];
      const glm::dvec3 u = triangle[1] - triangle[0], v = triangle[2] - triangle[0];
      const double longest = std::max({glm::length(u), glm::length(v), glm::length(v - u)});
      const int steps = 1 + static_cast<int>(longest * options_.step_mm / options_.narrowest_mm);
      for (int i = 0; i <= steps; ++i)
        for (int j = 0; i + j <= steps; ++j)
          places.push_back(triangle[0] + (double(i) * u + double(j) * v) / double(steps));
    }
  }

  /// Among tetrahedra in which distances seem linear, drops those whose flat piece differs from the surface.
  void drop_bumpy(const std::vector<Open>& level, std::vector<std::uint8_t>& is_kept) const {
    std::vector<glm::dvec3> places;
    std::vector<std::size_t> owners;
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (is_kept[i] == 0) continue;
      add_piece(level[i].simplex, places);
      owners.resize(places.size(), i);
    }
    const std::vector<double> distances = distances_at_(places);
    for (std::size_t k = 0; k < distances.size(); ++k)
      if (std::abs(distances[k]) > 2.0 * options_.tolerance_mm) is_kept[owners[k]] = 0;
  }

  std::vector<Open> whole_level() {
    std::vector<Open> level;
    std::vector<std::uint64_t> keys;
    for (const Simplex& simplex : whole_cube(options_.side)) {
      level.push_back({simplex, {}});
      keys.insert(keys.end(), simplex.corners.begin(), simplex.corners.end());
    }
    learn(keys);
    for (Open& open : level)
      for (std::size_t i = 0; i < 4; ++i) open.at_corners_mm[i] = known(open.simplex.corners[i]);
    return level;
  }

  /// Computes the distances at the centres of some tetrahedra of a level, given by their numbers, and stores
  /// them at these numbers.
  void learn_centres(const std::vector<Open>& level, const std::vector<std::size_t>& numbers,
                     std::vector<double>& at_centres_mm) const {
    std::vector<glm::dvec3> centres(numbers.size());
    tbb::parallel_for(std::size_t{0}, numbers.size(),
                      [&](std::size_t k) { centres[k] = centre_of(level[numbers[k]].simplex); });
    const std::vector<double> distances = distances_at_(centres);
    for (std::size_t k = 0; k < numbers.size(); ++k) at_centres_mm[numbers[k]] = distances[k];
  }

  /// Those of the given tetrahedra for which a condition is true, in their order.
  template <typename Condition>
  static std::vector<std::size_t> those(const std::vector<std::size_t>& numbers, const Condition& condition) {
    const std::vector<std::uint8_t> is =
        where(numbers.size(), [&](std::size_t k) { return condition(numbers[k]); });
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < numbers.size(); ++k)
      if (is[k] != 0) kept.push_back(numbers[k]);
    return kept;
  }

  /// The tetrahedra of a level that the surface may pass. Corners inside and outside prove that it does; only
  /// other tetrahedra need the distance at their centre.
  std::vector<std::size_t> passed(const std::vector<Open>& level, std::vector<double>& at_centres_mm) const {
    std::vector<std::size_t> all(level.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    learn_centres(level, those(all, [&](std::size_t i) { return !is_passed(level[i].at_corners_mm); }),
                  at_centres_mm);
    return those(all, [&](std::size_t i) {
      return is_passed(level[i].at_corners_mm) || may_be_passed(level[i].simplex, at_centres_mm[i]);
    });
  }

  /// The tetrahedra in which distances seem linear. Most tetrahedra are not linear on the edge at which they
  /// would be bisected; further distances are computed only for the rest.
  std::vector<std::size_t> linear(const std::vector<Open>& level, const std::vector<std::size_t>& numbers,
                                  std::vector<double>& at_centres_mm) {
    const std::vector<std::size_t> short_enough = those(numbers, [&](std::size_t i) {
      const Simplex& simplex = level[i].simplex;
      return longest_mm(simplex) <= most_narrow * options_.narrowest_mm &&
             is_linear_between(simplex.corners[0], simplex.corners[simplex.tag]);
    });
    std::vector<std::uint64_t> keys;
    for (const std::size_t i : short_enough)
      for (const auto& [a, b] : sides)
        if (has_middle(level[i].simplex.corners[a], level[i].simplex.corners[b]))
          keys.push_back(middle_of(level[i].simplex.corners[a], level[i].simplex.corners[b]));
    learn(keys);
    const std::vector<std::size_t> on_edges =
        those(short_enough, [&](std::size_t i) { return is_linear_on_edges(level[i].simplex); });
    learn_centres(level, those(on_edges, [&](std::size_t i) { return is_passed(level[i].at_corners_mm); }),
                  at_centres_mm);
    return those(on_edges, [&](std::size_t i) { return is_linear_at_centre(level[i], at_centres_mm[i]); });
  }

  /// Adds both halves of a tetrahedron, except halves that a corner's distance shows to be beside the
  /// surface. Of the finest halves, adds only those that the surface passes.
  void add_halves(const Open& open, std::vector<Open>& made) const {
    const double at_middle_mm = known(middle_of(open.simplex));
    const std::array<Simplex, 2> simplices = halves(open.simplex);
    const std::size_t tag = open.simplex.tag;
    std::array<double, 4> first = open.at_corners_mm, second = open.at_corners_mm;
    first[tag] = at_middle_mm;
    std::rotate(second.begin(), second.begin() + 1, second.begin() + static_cast<std::ptrdiff_t>(tag) + 1);
    second[tag] = at_middle_mm;
    for (const Open& half : {Open{simplices[0], first}, Open{simplices[1], second}})
      if (is_passed(half.at_corners_mm) || (can_be_bisected(half.simplex) && !is_surely_beside(half)))
        made.push_back(half);
  }

  /// Stores the tetrahedra of a level that are fine enough, and returns the halves of the others.
  std::vector<Open> refined(const std::vector<Open>& level) {
    check_count(level.size());
    std::vector<double> at_centres_mm(level.size());
    const std::vector<std::size_t> on_surface = passed(level, at_centres_mm);
    const std::vector<std::size_t> divisible =
        those(on_surface, [&](std::size_t i) { return can_be_bisected(level[i].simplex); });
    std::vector<std::uint64_t> keys(divisible.size());
    for (std::size_t k = 0; k < divisible.size(); ++k) keys[k] = middle_of(level[divisible[k]].simplex);
    learn(keys);
    std::vector<std::uint8_t> is_kept(level.size(), 0);
    for (const std::size_t i : linear(level, divisible, at_centres_mm)) is_kept[i] = 1;
    drop_bumpy(level, is_kept);
    std::vector<Open> to_halve;
    for (const std::size_t i : on_surface) {
      if (is_kept[i] != 0 || !can_be_bisected(level[i].simplex)) {
        found_.simplices.push_back(level[i].simplex);
        continue;
      }
      middles_.insert(middle_of(level[i].simplex), {});
      to_halve.push_back(level[i]);
    }
    return appended<Open>(to_halve,
                          [&](const Open& open, std::vector<Open>& made) { add_halves(open, made); });
  }

  /// Sorts tetrahedra: the finest level first, those of one level in their given order.
  static std::vector<Simplex> finest_first(const std::vector<Simplex>& simplices) {
    std::array<std::size_t, 257> first{};
    for (const Simplex& simplex : simplices) ++first[256U - simplex.level];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<Simplex> sorted(simplices.size());
    for (const Simplex& simplex : simplices) sorted[first[255U - simplex.level]++] = simplex;
    return sorted;
  }

  static bool hangs(const Simplex& simplex, const Middles& middles) {
    return can_be_bisected(simplex) && std::any_of(sides.begin(), sides.end(), [&](const auto& side) {
             const std::uint64_t a = simplex.corners[side[0]], b = simplex.corners[side[1]];
             return has_middle(a, b) && middles.contains(middle_of(a, b));
           });
  }

  /// Bisects a tetrahedron and then its halves, until no edge has a hanging node.
  void bisect(const Simplex& simplex, std::vector<Simplex>& closed, std::vector<std::uint64_t>& added) {
    if (middles_.insert(middle_of(simplex), {})) added.push_back(middle_of(simplex));
    for (const Simplex& half : halves(simplex))
      hangs(half, middles_) ? bisect(half, closed, added) : closed.push_back(half);
  }

  /// Bisects the tetrahedra that have one of these middles on an edge. Returns the middles that these
  /// bisections add. A middle concerns tetrahedra of its own level and coarser ones, so the finest are
  /// processed first, which needs few rounds.
  std::vector<std::uint64_t> close(const Middles& middles) {
    check_count(0);
    const std::vector<Simplex> open = finest_first(found_.simplices);
    const bool is_of_all = &middles == &middles_;
    const std::vector<std::uint8_t> is_hanging =
        where(open.size(), [&](std::size_t i) { return hangs(open[i], middles); });
    std::vector<std::uint64_t> added;
    Middles added_here;  // middles that this call adds; its first round searches these, too
    found_.simplices.clear();
    found_.simplices.reserve(open.size() + open.size() / 2);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const std::size_t before = added.size();
      if (is_hanging[i] == 0 && !(is_of_all && hangs(open[i], added_here))) {
        found_.simplices.push_back(open[i]);
        continue;
      }
      bisect(open[i], found_.simplices, added);
      if (is_of_all)
        for (std::size_t k = before; k < added.size(); ++k) added_here.insert(added[k], {});
    }
    learn(added);
    return added;
  }

  void keep_passed() {
    std::vector<Simplex>& simplices = found_.simplices;
    const std::vector<std::uint8_t> is_wanted = where(simplices.size(), [&](std::size_t i) {
      const auto& corners = simplices[i].corners;
      return is_passed({known(corners[0]), known(corners[1]), known(corners[2]), known(corners[3])});
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < simplices.size(); ++i)
      if (is_wanted[i] != 0) simplices[kept++] = simplices[i];
    simplices.resize(kept);
  }

  const BisectionOptions& options_;
  const DistancesAt& distances_at_;
  Middles middles_;  ///< middles of the edges that were bisected
  BisectedLattice found_;
};

CutEdge edge_between(std::uint64_t a, std::uint64_t b) {
  return a < b ? CutEdge{a, b} : CutEdge{b, a};
}

/// Six times the volume, exactly: coordinates have 20 bits, products of three 60.
std::int64_t volume_of(std::uint64_t a, std::uint64_t b, std::uint64_t c, std::uint64_t d) {
  const glm::i64vec3 from(place_of(a)), u = glm::i64vec3(place_of(b)) - from,
                                        v = glm::i64vec3(place_of(c)) - from,
                                        w = glm::i64vec3(place_of(d)) - from;
  return u.x * (v.y * w.z - v.z * w.y) - u.y * (v.x * w.z - v.z * w.x) + u.z * (v.x * w.y - v.y * w.x);
}

}  // namespace

BisectedLattice bisected_lattice(const BisectionOptions& options, const DistancesAt& distances_at,
                                 const std::function<void()>& report) {
  return Bisection(options, distances_at).run(report);
}

std::vector<std::array<CutEdge, 3>> triangles_of(const BisectedLattice& lattice) {
  using Triangle = std::array<CutEdge, 3>;
  const auto add = [&](const Simplex& simplex, std::vector<Triangle>& triangles) {
    std::array<std::uint64_t, 4> in_order = simplex.corners;
    const auto outside = std::partition(in_order.begin(), in_order.end(), [&](std::uint64_t corner) {
      return lattice.distances_mm.at(corner) < 0.0;
    });
    const auto inside = outside - in_order.begin();
    auto [a, b, c, d] = in_order;
    // The corners inside come first, in an order that makes the tetrahedron positive.
    if (volume_of(a, b, c, d) < 0) inside == 3 ? std::swap(a, b) : std::swap(c, d);
    if (inside == 1) {
      triangles.push_back({edge_between(a, b), edge_between(a, c), edge_between(a, d)});
    } else if (inside == 3) {
      triangles.push_back({edge_between(d, a), edge_between(d, b), edge_between(d, c)});
    } else if (inside == 2) {
      triangles.push_back({edge_between(a, c), edge_between(a, d), edge_between(b, d)});
      triangles.push_back({edge_between(a, c), edge_between(b, d), edge_between(b, c)});
    }
  };
  return appended<Triangle>(lattice.simplices, add);
}

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 A push is held if its opposite lies in the cone of the contacts' wrenches: if the cone's nearest point is
//   that wrench itself (Lawson and Hanson, Solving Least Squares Problems, 1974, chapter 23).
// 2 If not, the difference to the nearest point is a motion that no contact resists, in which the push does
//   work. It bounds the angle: no push beyond the plane across the pushed point's velocity is held.
// 3 Test pushes around a circle of the angle found so far, which begins at the largest. Each one that is not
//   held makes the angle smaller. The held pushes form a convex cone, so what lies between the held ones is
//   held.
#include "voxel/filter/docking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <tbb/parallel_for.h>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

/// A wrench and a bound: the force (3 components), the moment divided by a length (3), and the sum of the
/// reactions' sizes.
using Wrench = std::array<double, 7>;

double product(const Wrench& a, const Wrench& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6];
}
void add(Wrench& to, double factor, const Wrench& what) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += factor * what[k];
}

/// A wrench counts as being in the cone if its distance from the cone is at most this share of its length.
constexpr double held_share = 1e-7;

/// The factors with which the sum of the columns is nearest to a goal, by Gram-Schmidt orthogonalisation.
/// Precondition: the columns are linearly independent.
std::vector<double> least_squares(const std::vector<const Wrench*>& columns, const Wrench& goal) {
  const std::size_t count = columns.size();
  std::vector<Wrench> square(count);
  std::vector<std::vector<double>> upper(count, std::vector<double>(count, 0.0));
  std::vector<double> right(count);
  Wrench rest = goal;
  for (std::size_t j = 0; j < count; ++j) {
    square[j] = *columns[j];
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t i = 0; i < j; ++i) {
        const double along = product(square[i], square[j]);
        upper[i][j] += along;
        add(square[j], -along, square[i]);
      }
    upper[j][j] = std::sqrt(product(square[j], square[j]));
    if (upper[j][j] > 0.0)
      for (double& value : square[j]) value /= upper[j][j];
    right[j] = product(square[j], rest);
    add(rest, -right[j], square[j]);
  }
  std::vector<double> factors(count, 0.0);
  for (std::size_t j = count; j-- > 0;) {
    double left = right[j];
    for (std::size_t i = j + 1; i < count; ++i) left -= upper[j][i] * factors[i];
    factors[j] = upper[j][j] > 0.0 ? left / upper[j][j] : 0.0;
  }
  return factors;
}

/// The wrench minus the cone's point nearest to it; zero if the wrench is in the cone.
Wrench beyond_cone(const std::vector<Wrench>& cone, const Wrench& goal) {
  const double size = std::sqrt(product(goal, goal));
  std::vector<std::size_t> used;
  std::vector<double> factors;
  Wrench rest = goal;
  for (int turn = 0; turn < 400; ++turn) {
    if (product(rest, rest) <= held_share * held_share * size * size) return {};
    std::size_t best = cone.size();
    double most = 1e-12 * size;
    for (std::size_t i = 0; i < cone.size(); ++i)
      if (const double gain = product(rest, cone[i]);
          gain > most && std::find(used.begin(), used.end(), i) == used.end()) {
        most = gain;
        best = i;
      }
    if (best == cone.size() || used.size() == rest.size()) break;
    used.push_back(best);
    factors.push_back(0.0);
    for (;;) {
      std::vector<const Wrench*> columns;
      for (const std::size_t i : used) columns.push_back(&cone[i]);
      const std::vector<double> wanted = least_squares(columns, goal);
      double share = 1.0;
      for (std::size_t i = 0; i < used.size(); ++i)
        if (wanted[i] <= 0.0) share = std::min(share, factors[i] / std::max(factors[i] - wanted[i], 1e-300));
      for (std::size_t i = 0; i < used.size(); ++i) factors[i] += share * (wanted[i] - factors[i]);
      if (share == 1.0) break;
      for (std::size_t i = used.size(); i-- > 0;)
        if (wanted[i] <= 0.0 && factors[i] <= 1e-14 * size) {
          used.erase(used.begin() + static_cast<std::ptrdiff_t>(i));
          factors.erase(factors.begin() + static_cast<std::ptrdiff_t>(i));
        }
      if (used.empty()) break;
    }
    rest = goal;
    for (std::size_t i = 0; i < used.size(); ++i) add(rest, -factors[i], cone[used[i]]);
  }
  return product(rest, rest) <= held_share * held_share * size * size ? Wrench{} : rest;
}

/// The cone of wrenches with which the contacts can react. Moments are about a point and divided by a length.
struct Held {
  std::vector<Wrench> cone;
  glm::dvec3 about_mm{0.0};
  double length_mm = 1.0;

  explicit Held(const std::vector<DockingContact>& contacts) {
    glm::dvec3 low = contacts.front().p_mm, high = low;
    for (const DockingContact& one : contacts) {
      low = glm::min(low, one.p_mm);
      high = glm::max(high, one.p_mm);
    }
    about_mm = 0.5 * (low + high);
    if (low != high) length_mm = 0.5 * glm::distance(low, high);
    for (const DockingContact& one : contacts) {
      Wrench made = wrench(one.p_mm, one.normal, 1.0);
      const double size = std::sqrt(product(made, made));
      for (double& value : made) value /= size;
      cone.push_back(made);
    }
    cone.push_back({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0});  // the unused part of the limit on reactions
  }

  Wrench wrench(const glm::dvec3& p_mm, const glm::dvec3& force, double size) const {
    const glm::dvec3 moment = glm::cross(p_mm - about_mm, force) / length_mm;
    return {force.x, force.y, force.z, moment.x, moment.y, moment.z, size};
  }

  /// None if the contacts hold a push. Otherwise a vector that separates this push from those that are held:
  /// pushes with a positive scalar product with the vector are not held. It is the velocity of the pushed
  /// point in a motion that the contacts do not resist enough, reduced by their resistance.
  std::optional<glm::dvec3> gives_way(const glm::dvec3& p_mm, const glm::dvec3& push,
                                      const glm::dvec3& nominal) const {
    const Wrench rest = beyond_cone(cone, wrench(p_mm, -push, most_reaction * glm::dot(push, nominal)));
    if (product(rest, rest) == 0.0) return std::nullopt;
    const glm::dvec3 slide(-rest[0], -rest[1], -rest[2]),
        turn = glm::dvec3(-rest[3], -rest[4], -rest[5]) / length_mm;
    return slide + glm::cross(turn, p_mm - about_mm) + most_reaction * rest[6] * nominal;
  }

  double angle(const glm::dvec3& p_mm, const glm::dvec3& push) const {
    if (gives_way(p_mm, push, push)) return 0.0;
    const glm::dvec3 beside = std::abs(push.z) < 0.6 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(beside, push)), v = glm::cross(push, u);
    constexpr int around = 72;
    double found = glm::radians(most_docking_deg);
    for (int i = 0; i < around; ++i) {
      const double turn = 2.0 * glm::pi<double>() * i / around;
      const glm::dvec3 side = std::cos(turn) * u + std::sin(turn) * v;
      for (int again = 0; again < 100 && found > 0.0; ++again) {
        const std::optional<glm::dvec3> way =
            gives_way(p_mm, std::cos(found) * push + std::sin(found) * side, push);
        if (!way) break;
        const double least = std::asin(std::clamp(-glm::dot(push, *way) / glm::length(*way), 0.0, 1.0));
        // The angle is reduced in every round, even if rounding would leave it unchanged, so that the search
        // ends.
        found = std::min(least, found * (1.0 - 1e-6));
        if (found < 1e-7) found = 0.0;
      }
    }
    return glm::degrees(found);
  }
};

/// The indices of the points that lie farthest in at least one of about 160 directions.
std::vector<std::size_t> outermost(const std::vector<glm::dvec3>& points_mm) {
  std::set<std::size_t> found;
  constexpr int rings = 10;
  for (int ring = 0; ring <= rings; ++ring) {
    const double polar = glm::pi<double>() * ring / rings;
    const int count = std::max(1, static_cast<int>(std::lround(2.0 * rings * std::sin(polar) * 1.27)));
    for (int i = 0; i < count; ++i) {
      const double turn = 2.0 * glm::pi<double>() * i / count;
      const glm::dvec3 along(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                             std::cos(polar));
      std::size_t farthest = 0;
      for (std::size_t k = 1; k < points_mm.size(); ++k)
        if (glm::dot(along, points_mm[k]) > glm::dot(along, points_mm[farthest])) farthest = k;
      found.insert(farthest);
    }
  }
  return {found.begin(), found.end()};
}

}  // namespace

Docking docking(const std::vector<DockingContact>& contacts, const glm::dvec3& push,
                const std::vector<glm::dvec3>& points_mm, const Progress& progress) {
  if (contacts.empty())
    throw InvalidInput("a part without contacts is not held: move the part to its place on the object");
  if (points_mm.empty()) throw InvalidInput("docking needs at least one point at which the part is pushed");
  if (!(std::abs(glm::length(push) - 1.0) < 1e-9))
    throw std::invalid_argument("the push must be a unit vector");
  progress.at(0.0);
  const Held held(contacts);
  const std::vector<std::size_t> examined = outermost(points_mm);
  std::vector<double> angles(examined.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, examined.size(), [&](std::size_t i) {
    if (!progress.stop.stop_requested()) angles[i] = held.angle(points_mm[examined[i]], push);
  });
  progress.at(1.0);
  const auto worst = std::min_element(angles.begin(), angles.end()) - angles.begin();
  return {angles[static_cast<std::size_t>(worst)], points_mm[examined[static_cast<std::size_t>(worst)]]};
}

}  // namespace octotomy::voxel

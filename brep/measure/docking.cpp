// SPDX-License-Identifier: AGPL-3.0-or-later
// Source and departure: docking.h.
//
// 1 Each contact's reaction is a wrench: its force and, over the contacts' extent, its moment about their
//   middle. The wrenches that contacts can balance form a cone. A seventh row adds up the reactions, which
//   are limited.
// 2 At one point, the pushes d + x e + y f about the direction d that are held form a convex polygon in x and
//   y. A linear programme follows a ray from the origin to its border. The programme's prices are a motion
//   that no contact resists, and the border's line there: pushes beyond it do work in that motion.
// 3 Begin with the square about the largest angle. Follow the ray to each corner: it is a corner of the polygon, or
//   its line cuts it off.
// 4 The line nearest to the origin gives the angle.
#include "brep/measure/docking.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/convex_hull_3.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>
#include <tbb/parallel_for.h>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

/// A wrench: a force, its moment divided by a length, and the size of the reactions. Or a motion: a velocity,
/// its rotation times that length, and the depth by which contacts give way.
constexpr int rows = 7;
using Wrench = std::array<double, rows>;

double dot(const Wrench& a, const Wrench& b) {
  double sum = 0.0;
  for (int i = 0; i < rows; ++i) sum += a[i] * b[i];
  return sum;
}
Wrench negative(Wrench a) {
  for (double& value : a) value = -value;
  return a;
}

/// Entries of wrenches are about 1, so that smaller numbers are rounding after some pivots.
constexpr double rounding = 1e-10;

/// A linear programme of seven rows: finds shares of columns, none below 0, whose sum is a goal.
class Programme {
 public:
  Programme(const std::vector<Wrench>& columns, const Wrench& goal) : columns_(columns) {
    for (int row = 0; row < rows; ++row) {
      inverse_[row].fill(0.0);
      inverse_[row][row] = goal[row] < 0.0 ? -1.0 : 1.0;
      level_[row] = std::abs(goal[row]);
      basis_[row] = artificial;
    }
  }

  /// Whether the goal lies in the columns' cone. If not, prices() separates both.
  bool reaches_goal() {
    run(artificial);
    double missing = 0.0;
    for (int row = 0; row < rows; ++row)
      if (basis_[row] == artificial) missing += level_[row];
    return missing <= 100.0 * rounding;
  }
  /// How far the goal can move along a direction within the cone; infinity if it never leaves the cone.
  /// prices() is then the cone's side at the end. Precondition: reaches_goal().
  double reach(const Wrench& along) {
    moved_ = negative(along);
    return run(moving) ? level_of(moving) : std::numeric_limits<double>::infinity();
  }
  /// Factors for the rows: their product with each column is at most 0; with a goal outside of the cone,
  /// above 0.
  const Wrench& prices() const { return prices_; }

 private:
  static constexpr std::size_t artificial = std::numeric_limits<std::size_t>::max(), moving = artificial - 1;

  double level_of(std::size_t column) const {
    for (int row = 0; row < rows; ++row)
      if (basis_[row] == column) return level_[row];
    return 0.0;
  }

  /// Improves the basis until no column helps: fewer artificial shares, or a larger share of the moving
  /// column. Returns false if that share can grow without limit.
  bool run(std::size_t aim) {
    constexpr int bland_from = 200, most = 20000;
    for (int turn = 0; turn < most; ++turn) {
      for (int at = 0; at < rows; ++at) {
        prices_[at] = 0.0;
        for (int row = 0; row < rows; ++row)
          if (basis_[row] == aim) prices_[at] += (aim == artificial ? 1.0 : -1.0) * inverse_[row][at];
      }
      const std::size_t enters = entering(aim, turn >= bland_from);
      if (enters == artificial) return true;
      if (!pivot(enters)) return false;
    }
    throw Error(ErrorCode::Geometry,
                "rounding hides which pushes the contacts hold: change the largest gap of a contact or the "
                "push a little");
  }

  std::size_t entering(std::size_t aim, bool takes_first) const {
    const double least = rounding * (1.0 + std::sqrt(dot(prices_, prices_)));
    std::size_t found = artificial;
    double best = least;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const double gain = dot(prices_, columns_[i]);
      if (gain <= best) continue;
      found = i;
      if (takes_first) return found;
      best = gain;
    }
    if (aim == moving && std::find(basis_.begin(), basis_.end(), moving) == basis_.end()) return moving;
    return found;
  }

  bool pivot(std::size_t enters) {
    const Wrench& column = enters == moving ? moved_ : columns_[enters];
    Wrench turned{};
    for (int row = 0; row < rows; ++row) turned[row] = dot(inverse_[row], column);
    int leaves = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int row = 0; row < rows; ++row) {
      // An artificial share of 0 leaves as soon as it would change.
      const bool is_spent =
          basis_[row] == artificial && level_[row] <= rounding && std::abs(turned[row]) > 1e-7;
      if (!is_spent && turned[row] <= 10.0 * rounding) continue;
      const double ratio = is_spent ? 0.0 : std::max(0.0, level_[row]) / turned[row];
      if (ratio < least ||
          (ratio == least && (leaves < 0 || std::abs(turned[row]) > std::abs(turned[leaves])))) {
        least = ratio;
        leaves = row;
      }
    }
    if (leaves < 0) return false;
    for (int at = 0; at < rows; ++at) inverse_[leaves][at] /= turned[leaves];
    for (int row = 0; row < rows; ++row) {
      if (row == leaves) continue;
      level_[row] = std::max(0.0, level_[row] - least * turned[row]);
      for (int at = 0; at < rows; ++at) inverse_[row][at] -= turned[row] * inverse_[leaves][at];
    }
    level_[leaves] = least;
    basis_[leaves] = enters;
    return true;
  }

  const std::vector<Wrench>& columns_;
  std::array<Wrench, rows> inverse_{};  ///< of the basis, by rows
  Wrench level_{}, prices_{}, moved_{};
  std::array<std::size_t, rows> basis_{};
};

/// A line in the plane of deviations. The deviations q of held pushes satisfy across . q <= reach.
struct Line {
  glm::dvec2 across{0.0};  ///< unit
  double reach = 0.0;
  Wrench motion{};
};

class Contacts {
 public:
  Contacts(const std::vector<DockingContact>& contacts, const glm::dvec3& push) : push_(push) {
    for (const DockingContact& contact : contacts)
      middle_mm_ += contact.p_mm / static_cast<double>(contacts.size());
    double squares = 0.0;
    for (const DockingContact& contact : contacts) {
      const glm::dvec3 arm = contact.p_mm - middle_mm_;
      squares += glm::dot(arm, arm) / static_cast<double>(contacts.size());
    }
    if (squares > 0.0) length_mm_ = std::sqrt(squares);
    for (const DockingContact& contact : contacts)
      wrenches_.push_back(wrench(contact.p_mm, contact.normal, 1.0));
    // This column takes up the part of the limit that the reactions do not use.
    wrenches_.push_back({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0});
    const glm::dvec3 beside = std::abs(push.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    e_ = glm::normalize(glm::cross(push, beside));
    f_ = glm::cross(push, e_);
  }

  Docking at(const glm::dvec3& p_mm, double at_most_deg) const {
    Docking made{at_most_deg, p_mm, std::nullopt};
    const Wrench goal = balance(p_mm, push_, most_reaction);
    Programme straight(wrenches_, goal);
    if (!straight.reaches_goal()) {
      made.angle_deg = 0.0;
      made.loosening = loosening(negative(straight.prices()));
      return made;
    }
    const double most = std::tan(at_most_deg * std::numbers::pi / 180.0);
    std::vector<std::pair<glm::dvec2, bool>> polygon;  // corners, and whether a ray has reached them
    for (const glm::dvec2& corner :
         {glm::dvec2(1, 1), glm::dvec2(-1, 1), glm::dvec2(-1, -1), glm::dvec2(1, -1)})
      polygon.emplace_back(most * corner, false);
    std::optional<Line> nearest;
    constexpr double nothing = 1e-7;
    while (!nearest || nearest->reach > nothing) {
      const auto next =
          std::find_if(polygon.begin(), polygon.end(), [](const auto& corner) { return !corner.second; });
      if (next == polygon.end()) break;
      const std::optional<Line> line = line_before(straight, p_mm, next->first);
      if (!line || glm::dot(line->across, next->first) - line->reach <= 1e-6 * glm::length(next->first)) {
        next->second = true;
        continue;
      }
      if (!nearest || line->reach < nearest->reach) nearest = line;
      polygon = cut(polygon, *line);
    }
    if (!nearest || nearest->reach >= most) return made;
    made.angle_deg = nearest->reach > nothing ? std::atan(nearest->reach) * 180.0 / std::numbers::pi : 0.0;
    made.loosening = loosening(nearest->motion);
    return made;
  }

 private:
  Wrench wrench(const glm::dvec3& p_mm, const glm::dvec3& force, double size) const {
    const glm::dvec3 moment = glm::cross(p_mm - middle_mm_, force) / length_mm_;
    return {force.x, force.y, force.z, moment.x, moment.y, moment.z, size};
  }
  /// The sum that reactions must have to balance a push.
  Wrench balance(const glm::dvec3& p_mm, const glm::dvec3& force, double most) const {
    return wrench(p_mm, -force, most);
  }
  static glm::dvec3 velocity(const Wrench& motion) { return {motion[0], motion[1], motion[2]}; }
  glm::dvec3 turn(const Wrench& motion) const {
    return glm::dvec3(motion[3], motion[4], motion[5]) / length_mm_;
  }

  /// The line beyond which pushes are no longer held, on the way from the origin to a deviation; none if all
  /// pushes on the way are held.
  std::optional<Line> line_before(Programme programme, const glm::dvec3& p_mm,
                                  const glm::dvec2& deviation) const {
    const glm::dvec3 force = deviation.x * e_ + deviation.y * f_;
    if (programme.reach(balance(p_mm, force, 0.0)) >= 1.0) return std::nullopt;
    Line line{{}, 0.0, negative(programme.prices())};
    const glm::dvec3 goes = velocity(line.motion) + glm::cross(turn(line.motion), p_mm - middle_mm_);
    line.across = {glm::dot(goes, e_), glm::dot(goes, f_)};
    const double steep = glm::length(line.across);
    if (!(steep > 0.0)) return std::nullopt;
    line.across /= steep;
    line.reach = std::max(0.0, (most_reaction * line.motion.back() - glm::dot(goes, push_)) / steep);
    return line;
  }

  static std::vector<std::pair<glm::dvec2, bool>> cut(const std::vector<std::pair<glm::dvec2, bool>>& polygon,
                                                      const Line& line) {
    std::vector<std::pair<glm::dvec2, bool>> left;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const auto &here = polygon[i], &next = polygon[(i + 1) % polygon.size()];
      const double over = glm::dot(line.across, here.first) - line.reach,
                   next_over = glm::dot(line.across, next.first) - line.reach;
      if (over <= 0.0) left.push_back(here);
      if ((over < 0.0 && next_over > 0.0) || (over > 0.0 && next_over < 0.0))
        left.emplace_back(glm::mix(here.first, next.first, over / (over - next_over)), false);
    }
    return left;
  }

  Loosening loosening(const Wrench& motion) const {
    const glm::dvec3 slides = velocity(motion), turns = turn(motion);
    // About an axis ten times farther away than the contacts reach, a turn is nearly a slide at the contacts.
    if (10.0 * glm::length(turns) * length_mm_ < glm::length(slides))
      return {false, glm::normalize(slides), middle_mm_};
    return {true, glm::normalize(turns), middle_mm_ + glm::cross(turns, slides) / glm::dot(turns, turns)};
  }

  glm::dvec3 push_, e_{0.0}, f_{0.0}, middle_mm_{0.0};
  double length_mm_ = 1.0;  ///< root mean square distance of the contacts from their middle
  std::vector<Wrench> wrenches_;
};

/// The corners of the points' convex hull, in the points' order, each once.
std::vector<glm::dvec3> hull_corners(const std::vector<glm::dvec3>& points_mm) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  std::vector<Point> points, extreme;
  for (const glm::dvec3& p : points_mm) points.emplace_back(p.x, p.y, p.z);
  CGAL::extreme_points_3(points, std::back_inserter(extreme));
  std::set<Point> left(extreme.begin(), extreme.end());
  std::vector<glm::dvec3> corners;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (left.erase(points[i]) > 0) corners.push_back(points_mm[i]);
  return corners;
}

void check(const std::vector<DockingContact>& contacts, const glm::dvec3& push,
           const std::vector<glm::dvec3>& points_mm) {
  if (contacts.empty()) throw InvalidInput("there are no contacts to hold the part");
  if (points_mm.empty()) throw InvalidInput("there is no point at which to push");
  if (!(std::abs(glm::length(push) - 1.0) < 1e-9))
    throw std::invalid_argument("the push must be a unit vector");
}

}  // namespace

std::vector<Docking> dockings(const std::vector<DockingContact>& contacts, const glm::dvec3& push,
                              const std::vector<glm::dvec3>& points_mm, const Progress& progress,
                              double at_most_deg) {
  check(contacts, push, points_mm);
  if (!(at_most_deg >= 0.0 && at_most_deg <= most_docking_deg))
    throw std::invalid_argument("the largest angle must be from 0 to 89 degrees");
  progress.at(0.0);
  const Contacts held(contacts, push);
  std::vector<Docking> made(points_mm.size());
  tbb::parallel_for(std::size_t{0}, points_mm.size(), [&](std::size_t i) {
    if (!progress.stop.stop_requested()) made[i] = held.at(points_mm[i], at_most_deg);
  });
  progress.at(1.0);
  return made;
}

std::vector<Docking> worst_dockings(const std::vector<DockingContact>& contacts, const glm::dvec3& push,
                                    const std::vector<glm::dvec3>& points_mm, const Progress& progress) {
  check(contacts, push, points_mm);
  std::vector<Docking> all = dockings(contacts, push, hull_corners(points_mm), progress);
  std::stable_sort(all.begin(), all.end(),
                   [](const Docking& a, const Docking& b) { return a.angle_deg < b.angle_deg; });
  return all;
}

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/docking_dispute.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace octotomy::planner {
namespace {

using Contacts = std::vector<brep::DockingContact>;

/// How firmly contacts hold at the worst point. Without contacts the part follows the push.
struct Held {
  double angle_deg = 0.0;
  brep::Loosening gives_way;
};

glm::dvec3 velocity(const brep::Loosening& motion, const glm::dvec3& p_mm) {
  return motion.turns ? glm::cross(motion.direction, p_mm - motion.about_mm) : motion.direction;
}

/// The contact that a motion presses most into the part; none if it presses none.
const brep::DockingContact* most_resisting(const Contacts& contacts, const brep::Loosening& motion) {
  const brep::DockingContact* found = nullptr;
  double least = 0.0;
  for (const brep::DockingContact& one : contacts)
    if (const double rate = glm::dot(one.normal, velocity(motion, one.p_mm)); rate < least) {
      least = rate;
      found = &one;
    }
  return found;
}

/// The smallest angle between a contact's normal and those of contacts nearby.
std::optional<double> least_turn_deg(const Contacts& contacts, const brep::DockingContact& to,
                                     double near_mm) {
  std::optional<double> least;
  for (const brep::DockingContact& one : contacts)
    if (glm::distance(one.p_mm, to.p_mm) <= near_mm) {
      const double turn = glm::degrees(std::acos(std::clamp(glm::dot(one.normal, to.normal), -1.0, 1.0)));
      least = std::min(turn, least.value_or(turn));
    }
  return least;
}

}  // namespace

std::optional<DockingDispute> dispute(const Contacts& first, const Contacts& second, const glm::dvec3& push,
                                      const std::vector<glm::dvec3>& points_mm,
                                      const DockingDisputeOptions& options) {
  constexpr int most_places = 8;
  const auto worst = [&](const Contacts& contacts) {
    Held held{0.0, {false, push, glm::dvec3(0.0)}};
    if (contacts.empty()) return held;
    const brep::Docking found = brep::worst_dockings(contacts, push, points_mm).front();
    held.angle_deg = found.angle_deg;
    if (found.loosening) held.gives_way = *found.loosening;
    return held;
  };
  const Held by_first = worst(first), by_second = worst(second);
  DockingDispute made;
  made.first_holds = by_first.angle_deg > by_second.angle_deg;
  const double goal_deg = std::max(by_first.angle_deg, by_second.angle_deg) - options.close_deg;
  const Contacts& weaker = made.first_holds ? second : first;
  Contacts stronger = made.first_holds ? first : second, joined = weaker;
  Held now = made.first_holds ? by_second : by_first;
  while (now.angle_deg < goal_deg && made.places < most_places) {
    const brep::DockingContact* found = most_resisting(stronger, now.gives_way);
    if (found == nullptr) break;
    const brep::DockingContact one = *found;
    if (made.places++ == 0) {
      made.at_mm = one.p_mm;
      made.normals_deg = least_turn_deg(weaker, one, options.near_mm);
    }
    const auto added = std::stable_partition(stronger.begin(), stronger.end(), [&](const auto& other) {
      return glm::distance(other.p_mm, one.p_mm) > options.patch_mm;
    });
    joined.insert(joined.end(), added, stronger.end());
    stronger.erase(added, stronger.end());
    now = worst(joined);
  }
  if (made.places == 0) return std::nullopt;
  made.explained_deg = now.angle_deg;
  return made;
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/insertion.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <stdexcept>

#include "planner/operation/table/number_format.h"
#include "voxel/space/error.h"
#include "voxel/space/view.h"

namespace octotomy::planner {

void check(const Insertion& insertion, const FieldLocation& place) {
  if (insertion.direction && insertion.seen_from)
    place.at("seen_from").refuse("states the direction a second time: leave out 'direction' or 'seen_from'");
  if (!insertion.direction && !insertion.seen_from)
    place.refuse(
        "the insertion direction is missing: add 'direction', for example [0, 0, 1], or 'seen_from', the "
        "view "
        "from whose side the part is put on");
  if (insertion.seen_from) try {
      voxel::parse_view(*insertion.seen_from);
    } catch (const voxel::InvalidInput& error) {
      place.at("seen_from").refuse(error.what());
    }
}

glm::dvec3 direction_of(const Insertion& insertion, const glm::dmat3& lps_from_head) {
  if (insertion.direction) return glm::normalize(*insertion.direction);
  return glm::normalize(lps_from_head * voxel::parse_view(*insertion.seen_from).look);
}

std::vector<glm::dvec3> directions_about(const glm::dvec3& first, double within_deg, double step_deg) {
  const glm::dvec3 beside = std::abs(first.z) < 0.6 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(beside, first)), v = glm::cross(first, u);
  std::vector<glm::dvec3> found{first};
  const int rings = static_cast<int>(std::floor(within_deg / step_deg + 1e-9));
  for (int ring = 1; ring <= rings; ++ring) {
    const double tilt = glm::radians(ring * step_deg);
    const int count = std::max(4, static_cast<int>(std::round(360.0 * std::sin(tilt) / step_deg)));
    for (int i = 0; i < count; ++i) {
      const double turn = 2.0 * glm::pi<double>() * i / count;
      found.push_back(glm::normalize(std::cos(tilt) * first +
                                     std::sin(tilt) * (std::cos(turn) * u + std::sin(turn) * v)));
    }
  }
  return found;
}

std::string in_words(const Insertion& insertion) {
  if (!insertion.direction) return "the view from " + *insertion.seen_from;
  const glm::dvec3& along = *insertion.direction;
  return "(" + plain(along.x) + ", " + plain(along.y) + ", " + plain(along.z) + ")";
}

Field insertion_direction(const std::function<Insertion&(void* owner)>& insertion) {
  return Field{"direction", "The direction in which a part is put on, as an LPS vector of any length.",
               [insertion](void* owner) -> Slot { return &insertion(owner).direction; }}
      .direction();
}

Field insertion_view(const std::function<Insertion&(void* owner)>& insertion) {
  return Field{"seen_from",
               "The view from whose side a part is put on, instead of the direction, relative to the head's "
               "position: anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees.",
               [insertion](void* owner) -> Slot { return &insertion(owner).seen_from; }};
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/motion/first_contact.h"

#include <algorithm>
#include <cmath>

#include "voxel/solid/combine.h"

namespace octotomy::planner {

double voxel_mm(const Object& object) {
  const glm::dvec3 spacing = object.voxel.octree.universe().lattice().spacing_mm();
  return std::min({spacing.x, spacing.y, spacing.z});
}

FirstContact first_contact(const Object& object, const Object& against, const ContactSearch& search,
                           const std::stop_token& stop) {
  if (object.voxel.octree.is_empty() || against.voxel.octree.is_empty())
    throw std::runtime_error("'" + (object.voxel.octree.is_empty() ? object.id : against.id) +
                             "' is empty, so it cannot touch anything");
  const voxel::Expression other(against.voxel.octree);
  const auto overlap = [&](double at) {
    if (stop.stop_requested()) throw voxel::Stopped("stopped while moving to contact");
    return voxel::combine(object.voxel.octree.universe(),
                          moved(*object.voxel.symbol, search.motion(at)) & other);
  };
  const bool begins_apart = overlap(0.0).is_empty();
  double before = 0.0, after = 0.0;
  do {
    before = after;
    after += begins_apart ? search.step : -search.step;
    if (std::abs(after) > search.most)
      throw std::runtime_error("'" + object.id + "' " +
                               (begins_apart ? "meets nothing of" : "does not separate from") + " '" +
                               against.id + "' within " + search.most_said);
  } while (overlap(after).is_empty() == begins_apart);
  double apart = begins_apart ? before : after, touching = begins_apart ? after : before;
  for (int halving = 0; halving < 6; ++halving) {
    const double middle = 0.5 * (apart + touching);
    (overlap(middle).is_empty() ? apart : touching) = middle;
  }
  return {apart, voxel::measure(overlap(touching)).centroid_mm};
}

}  // namespace octotomy::planner

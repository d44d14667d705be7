// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/refinement.h"

#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace octotomy::planner {

std::vector<convert::Refinement> refinements(const Objects& objects, const Deck& step) {
  std::vector<convert::Refinement> places;
  for (const Deck::Finer& text : step.finer) {
    convert::Refinement place;
    place.size_mm = text.size_mm;
    if (text.at.object.empty()) {
      place.points_mm = {text.at.point_mm};
    } else {
      const Object& object = objects.at(text.at.object);
      if (!object.mesh.within || object.mesh.within->empty())
        throw std::runtime_error("elements cannot be refined along the surface of '" + text.at.object +
                                 "', because it has no mesh: see its findings, or name a point instead");
      place.surface = object.mesh.within->triangles();
    }
    places.push_back(std::move(place));
  }
  return places;
}

std::string refinement_key(const Deck& step) {
  std::ostringstream key;
  key << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (const Deck::Finer& text : step.finer)
    key << " finer at " << text.at.object << " " << text.at.point_mm.x << " " << text.at.point_mm.y << " "
        << text.at.point_mm.z << " by " << text.size_mm;
  return key.str();
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/finer_places.h"

#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace octotomy::planner {

std::vector<convert::Finer> finer_places(const Evaluation& evaluation, const ExportStep& step) {
  std::vector<convert::Finer> places;
  for (const FinerText& text : step.finer) {
    convert::Finer place;
    place.size_mm = text.size_mm;
    if (text.object.empty()) {
      place.points_mm = {text.point_mm};
    } else {
      const Object& object = evaluation.object(text.object);
      if (!object.mesh || object.mesh->n_faces() == 0)
        throw std::runtime_error("elements cannot be finer at '" + text.object +
                                 "', which has no mesh: see its findings, or name a point");
      place.surface = brep::triangles_of(*object.mesh);
    }
    places.push_back(std::move(place));
  }
  return places;
}

std::string finer_key(const ExportStep& step) {
  std::ostringstream key;
  key << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (const FinerText& text : step.finer)
    key << " finer at " << text.object << " " << text.point_mm.x << " " << text.point_mm.y << " "
        << text.point_mm.z << " by " << text.size_mm;
  return key.str();
}

}  // namespace octotomy::planner

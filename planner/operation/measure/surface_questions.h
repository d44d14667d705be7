// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// Requested measures of a closed surface besides its size.
struct SurfaceQuestions {
  std::vector<glm::dvec3> section = {};   ///< a point and a normal
  std::vector<glm::dvec3> distance = {};  ///< two points
  std::vector<glm::dvec3> angle = {};     ///< three points, the angle at the second
  std::vector<glm::dvec3> along = {};     ///< two points
  const brep::Mesh* to = nullptr;         ///< another surface, for the least distance to it; null: none
  bool thickness = false, curvature = false;
};

/// Values at vertices that a picture or a file shows.
struct AtVertices {
  std::string name;
  std::vector<double> values;
};

/// The answers that do not depend on the surface: the distance and the angle, if requested. Throws
/// std::runtime_error if a leg of the angle has no length.
Json point_answers(const SurfaceQuestions& questions);

/// Computes the requested measures, each with its own key and timing. `shown` is set to the values of the
/// last measure of thickness and curvature. Throws std::runtime_error if a leg of an angle has no length.
Json surface_answers(const SurfaceQuestions& questions, const brep::Solid& solid,
                     const voxel::Progress& progress, Timings& timings, AtVertices& shown);

/// The answers as rows of text, for those that exist.
std::vector<std::pair<std::string, std::string>> surface_rows(const Json& answers);

}  // namespace octotomy::planner

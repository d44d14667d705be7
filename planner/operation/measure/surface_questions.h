// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// Measures of a closed surface besides its size.
struct SurfaceQuestions {
  std::vector<glm::dvec3> section = {};   ///< a point and a normal
  std::vector<glm::dvec3> distance = {};  ///< two points
  std::vector<glm::dvec3> angle = {};     ///< three points, the angle at the second
  std::vector<glm::dvec3> along = {};     ///< two points
  const brep::Mesh* to = nullptr;         ///< another surface: the least distance
  bool thickness = false, curvature = false;
};

/// Values at vertices that a picture or a file shows.
struct AtVertices {
  std::string name;
  std::vector<double> values;
};

/// The answers that need no surface: the distance and the angle, as far as they were requested. Throws
/// std::runtime_error if a leg of the angle has no length.
Json point_answers(const SurfaceQuestions& questions);

/// Computes the measures, each under its own key and timed. Sets `shown` to the last of thickness and
/// curvature. Throws std::runtime_error if a leg of an angle has no length.
Json surface_answers(const SurfaceQuestions& questions, const brep::Solid& solid,
                     const voxel::Progress& progress, Timings& timings, AtVertices& shown);

/// The existing answers as rows of text.
std::vector<std::pair<std::string, std::string>> surface_rows(const Json& answers);

}  // namespace octotomy::planner

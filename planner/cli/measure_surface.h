// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/cli/verb.h"
#include "planner/measure/result_json.h"

namespace octotomy::planner::cli {

/// What `measure` can be asked of a mesh beyond its size, as the options say it.
struct SurfaceQuestions {
  std::vector<std::string> section;   ///< a point and a normal
  std::vector<std::string> distance;  ///< two points
  std::vector<std::string> angle;     ///< three points, the angle at the second
  std::vector<std::string> along;     ///< two points
  std::filesystem::path to;           ///< another mesh
  bool thickness = false, curvature = false;
  std::filesystem::path out;  ///< the mesh with the last of these as scalars

  bool any() const {
    return !section.empty() || !distance.empty() || !angle.empty() || !along.empty() || !to.empty() ||
           thickness || curvature || !out.empty();
  }
};

void add_surface_questions(CLI::App& verb, SurfaceQuestions& questions);

/// Answers them, each under a key of its own.
Json answer_surface_questions(const Program& program, const SurfaceQuestions& questions,
                              const brep::Solid& solid, Timings& timings);

/// The answers that are there, as rows for people.
std::vector<std::pair<std::string, std::string>> surface_rows(const Json& answers);

}  // namespace octotomy::planner::cli

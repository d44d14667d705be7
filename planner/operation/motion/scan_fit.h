// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "planner/operation/table/json.h"
#include "planner/operation/table/stopwatch.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::planner {

struct ScanFitAsked {
  bool is_correlation = false;  ///< else mutual information
  double least_overlap = 0.3, finest_mm = 2.0;
  std::filesystem::path watch;  ///< new folder for a picture of the difference at each step; empty: no
                                ///< pictures
};

struct FittedScans {
  glm::dmat4 fixed_from_moving{1.0};
  std::string verdict;  ///< PASS, WARN or FAIL
  Json details = Json::object();
  std::vector<std::string> findings;
  std::string summary;  ///< the verdict in words, for people
};

/// Registers a scan to another by voxel::register_scans(), and returns the motion with its results as
/// details. If `watch` names a folder, it gets a picture of both scans for each step, in the middle planes of
/// the fixed scan: the moving scan in magenta and the fixed scan in green, so that equal tones are grey.
/// Throws as register_scans(), and voxel::Error if the folder exists or cannot be created.
FittedScans fit_scans(const voxel::Scene& moving, const voxel::Scene& fixed, const ScanFitAsked& asked,
                      const voxel::Progress& progress, Timings& timings);

}  // namespace octotomy::planner

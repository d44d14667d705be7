// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/plan/evaluate.h"
#include "voxel/scan/read_scene.h"
#include "voxel/view/drawn_object.h"

namespace octotomy::planner::cli {

/// Files to be drawn, as the command line names them.
struct DrawnText {
  std::vector<std::filesystem::path> files;
  std::string window = "300:";       ///< of scans and grey octrees
  std::vector<std::string> colours;  ///< #RRGGBB, of the first files
  std::vector<float> opacities;      ///< 0..1, of the first files
  std::optional<double> voxel_mm;    ///< edge of a scan's voxels; none: as fine as the scan
  voxel::ReadOptions read;           ///< of scans
};

/// What the files hold, all in the first one's universe, named as the files are, without folder and ending.
/// Throws CLI::ValidationError for what is not a window, a colour or as many as there are files,
/// std::runtime_error for files that cannot be drawn, with the path.
std::vector<voxel::DrawnObject> drawn_of_files(const DrawnText& text, Timings& timings);

}  // namespace octotomy::planner::cli

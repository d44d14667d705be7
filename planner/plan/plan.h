// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/operation.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::planner {

struct ScanSource {
  std::filesystem::path path;         ///< relative to the plan's folder, unless absolute
  std::optional<std::string> sha256;  ///< verified if given
  voxel::ReadOptions read = {};       ///< which series to read, and facts that the file does not state
  /// For a label map that states another patient, study or frame of reference than the scans: true accepts
  /// it, with a FAIL in its audit; false refuses it.
  bool other_identity = false;
};

/// A step of a plan: an operation with its values, and the name of its result.
struct Step {
  std::string id;
  Action action;
};

/// A plan as pure data: ordered steps, each of which names its result.
struct Plan {
  std::string name;
  std::string text;                         ///< the JSON text that was parsed
  std::filesystem::path file;               ///< empty if the plan was not read from a file
  std::filesystem::path folder;             ///< folder of the plan
  std::map<std::string, ScanSource> scans;  ///< none if all objects are imported meshes or tiled contours
  /// Edge of the universe's voxels in mm. None: that of the scan's voxels, but so large that a side has at
  /// most 512; without scans, a 128th of the longest side of the imported meshes.
  std::optional<double> voxel_mm;
  std::vector<Step> steps;
  std::vector<NamedPoint> landmarks;  ///< landmarks that its steps define
  /// The head's orientation that a step has set (Scope). None: the head is not repositioned.
  std::optional<glm::dmat3> lps_from_head;
};

/// Reads a plan. Refuses unknown keys, operations and names, with the most similar known one, and duplicate
/// keys. A name must be defined by an earlier step before it is used. Also checks expressions, that polygons
/// have an area, and the extensions of output files. A step "export" becomes surface, deck or label_map, by
/// the extension of its path. Evaluates nothing. Throws std::runtime_error with file, step, key and a remedy.
Plan read_plan(const std::filesystem::path& path);
/// Parses the text of a plan as read_plan() does. Relative paths are relative to `folder`.
Plan parse_plan(const std::string& json, const std::filesystem::path& folder);

/// The absolute path of a scan of the plan.
std::filesystem::path scan_path(const Plan& plan, const ScanSource& scan);

/// The word that a step's `do` has.
std::string verb(const Step& step);

/// The JSON schema of plans (draft 2020-12), made from the table of operations.
nlohmann::ordered_json plan_schema();

}  // namespace octotomy::planner

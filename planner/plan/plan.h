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
  std::filesystem::path path;         ///< relative paths are relative to the plan's folder
  std::optional<std::string> sha256;  ///< verified if given
  voxel::ReadOptions read = {};       ///< the series, and facts that the file does not state
  /// For a label map: accepted, with a FAIL in its audit, even if it states a different patient, study or
  /// frame of reference than the other scans.
  bool other_identity = false;
};

/// A step: an operation with its values, and the name of its result.
struct Step {
  std::string id;
  Action action;
};

/// An operation as pure data: ordered steps, each of which names its result.
struct Plan {
  std::string name;
  std::string text;                         ///< the JSON from which it was read
  std::filesystem::path file;               ///< empty if the plan was not read from a file
  std::filesystem::path folder;             ///< folder of the plan
  std::map<std::string, ScanSource> scans;  ///< none if all objects come from imported meshes and contours
  /// Edge of the universe's voxels. None: as fine as the scan, at most 512 a side; without scans a 128th of
  /// the longest imported mesh.
  std::optional<double> voxel_mm;
  std::vector<Step> steps;
  std::vector<NamedPoint> landmarks;  ///< landmarks that its steps name
  /// The head's orientation as set by a step (Scope); none: that of the scan.
  std::optional<glm::dmat3> lps_from_head;
};

/// Reads a plan. Refuses unknown keys, steps and names, with the nearest known one, and duplicate keys; names
/// must be bound before they are used. Before anything is evaluated, parses expressions, checks that polygons
/// have an area, and that extensions of output files can be written. A step with "export" becomes surface,
/// deck or label_map, by its path's extension. Throws std::runtime_error with file, step, key and a remedy.
Plan read_plan(const std::filesystem::path& path);
/// Parses a plan's text as read_plan() does; relative paths are relative to `folder`.
Plan parse_plan(const std::string& json, const std::filesystem::path& folder);

/// The scan's path, made absolute against the plan's folder.
std::filesystem::path scan_path(const Plan& plan, const ScanSource& scan);

/// The word of a step's `do`.
std::string verb(const Step& step);

/// The JSON schema of plans (draft 2020-12), from the table of operations.
nlohmann::ordered_json plan_schema();

}  // namespace octotomy::planner

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
  std::optional<std::string> sha256;  ///< checked where given
  voxel::ReadOptions read = {};       ///< the series, and what the file does not say of itself
  /// Of a label map: taken, with a FAIL in its audit, though it states another patient, study or frame of
  /// reference than the other scans.
  bool other_identity = false;
};

/// A step: an operation with its values, and the name of what it makes.
struct Step {
  std::string id;
  Action action;
};

/// An operation as pure data: ordered steps, each of which names its result.
struct Plan {
  std::string name;
  std::string text;              ///< the JSON it was read from
  std::filesystem::path file;    ///< empty where the plan was not read from a file
  std::filesystem::path folder;  ///< where the plan lies
  std::map<std::string, ScanSource> scans;
  std::optional<double>
      voxel_mm;  ///< edge of the universe's voxels; none: as fine as the scan, at most 512 a side
  std::vector<Step> steps;
  std::vector<NamedPoint> landmarks;  ///< that its steps name
  /// How a step holds the head (Scope); none: as the scan does.
  std::optional<glm::dmat3> lps_from_head;
};

/// Reads a plan. Keys, steps and names that are not known, and keys said twice, are refused with the nearest
/// known one; names must be bound before they are used. Expressions are parsed, polygons checked to have an
/// area, paths of files to have an extension that can be written, before anything is evaluated. A step that
/// does "export" is the surface, deck or label_map that its path's extension says. Throws std::runtime_error
/// saying file, step, key and what to try.
Plan read_plan(const std::filesystem::path& path);
/// The same of a text; `folder` is what relative paths are relative to.
Plan parse_plan(const std::string& json, const std::filesystem::path& folder);

/// The scan's path, made absolute against the plan's folder.
std::filesystem::path scan_path(const Plan& plan, const ScanSource& scan);

/// The word of a step's `do`.
std::string verb(const Step& step);

/// The JSON schema of plans (draft 2020-12), from the table of operations.
nlohmann::ordered_json plan_schema();

}  // namespace octotomy::planner

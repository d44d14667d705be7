// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace octotomy::planner {

struct ScanSource {
  std::filesystem::path path;         ///< relative paths are relative to the plan's folder
  std::optional<std::string> sha256;  ///< checked where given
};

struct WindowStep {
  std::string scan;
  double low = 300.0;
  std::optional<double> high;  ///< none: no upper limit
};
struct RegionText {
  std::string view;
  std::vector<std::vector<glm::dvec2>> polygons_mm;
};
struct MaskStep {
  std::vector<RegionText> regions;
};
struct CombineStep {
  std::string expression;
};
struct RotateText {
  double degrees = 0.0;
  glm::dvec3 axis{0, 0, 1};
  glm::dvec3 about_mm{0.0};
};
/// The rotation is done first, then the translation.
struct MoveStep {
  std::string object;
  glm::dvec3 translate_mm{0.0};
  std::optional<RotateText> rotate;
};
struct MeasureStep {
  std::string object;
};
struct ExportStep {
  std::string object;
  std::filesystem::path path;  ///< within the result folder
};

struct Step {
  std::string id;
  std::variant<WindowStep, MaskStep, CombineStep, MoveStep, MeasureStep, ExportStep> action;
};

/// An operation as pure data: ordered steps, each of which names its result.
struct Plan {
  std::string name;
  std::filesystem::path folder;  ///< where the plan lies
  std::map<std::string, ScanSource> scans;
  std::optional<double>
      voxel_mm;  ///< edge of the universe's voxels; none: as fine as the scan, at most 512 a side
  std::vector<Step> steps;
};

/// Reads a plan. Unknown keys, unknown steps and unbound names are refused with the nearest known one; names
/// must be known before they are used. Throws std::runtime_error saying file, step and what to try.
Plan read_plan(const std::filesystem::path& path);
Plan parse_plan(const std::string& json, const std::filesystem::path& folder);

}  // namespace octotomy::planner

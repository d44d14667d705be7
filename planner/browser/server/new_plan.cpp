// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/new_plan.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "planner/browser/server/folders.h"
#include "planner/browser/server/message.h"
#include "planner/operation/table/json_file.h"
#include "planner/result/report/first_look.h"
#include "verify/phantom/head_phantom.h"
#include "voxel/filter/tissue.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

/// Whether a plan reads this scan and series, and no other scan.
bool is_plan_of(const fs::path& plan, const fs::path& scan, const std::string& series) {
  std::ifstream file = voxel::opened(plan);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("scans") || json["scans"].size() != 1) return false;
  const Json& entry = json["scans"].front();
  return entry.is_object() && entry.value("path", "") == scan.string() && entry.value("series", "") == series;
}

}  // namespace

double bone_low(const voxel::Scene& scene) {
  if (scene.meaning == voxel::Meaning::Hounsfield) return *voxel::tissue("bone")->low;
  if (scene.meaning == voxel::Meaning::Label) return 1.0;
  try {
    return thresholds_of(scene).upper;
  } catch (const std::runtime_error&) {
    return voxel::range(scene).high;  // all samples are equal, so no threshold divides them
  }
}

fs::path plan_of_scan(const fs::path& scan, const fs::path& folder, const voxel::Progress& progress,
                      const std::string& series) {
  const fs::path place = folder / (plain_stem(scan) + ".plan.json");
  if (is_plan_of(place, scan, series)) return place;
  voxel::ReadOptions options;
  options.progress = progress;
  options.series = series;
  const voxel::Scene scene = voxel::read_scene(scan, options);
  Json entry{{"path", scan.string()}};
  if (!series.empty()) entry["series"] = series;
  const Json plan{
      {"octotomy_plan", 1},
      {"name", plain_stem(scan)},
      {"scans", {{"ct", entry}}},
      {"steps", Json::array({{{"id", "bone"}, {"do", "window"}, {"scan", "ct"}, {"low", bone_low(scene)}}})}};
  const fs::path path = unused(place);
  write_json(plan, path);
  return path;
}

fs::path phantom_at(const fs::path& path, const voxel::Progress& progress) {
  if (!fs::exists(path)) voxel::write_scene(verify::head_phantom({}, progress), path);
  return path;
}

}  // namespace octotomy::planner::serve

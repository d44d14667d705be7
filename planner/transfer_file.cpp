// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/transfer_file.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "planner/colour.h"
#include "planner/nearest_name.h"

namespace octotomy::planner {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw std::runtime_error(where + ": " + what);
}

void check_keys(const Json& object, const std::string& where, const std::vector<std::string>& known) {
  if (!object.is_object()) refuse(where, "must be an object");
  for (const auto& [key, unused] : object.items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      refuse(where, "unknown key '" + key + "'" + suggestion(key, known));
}

double number(const Json& object, const std::string& where, const std::string& key) {
  if (!object.contains(key) || !object[key].is_number()) refuse(where, "needs '" + key + "', a number");
  return object[key].get<double>();
}

voxel::TransferPoint point_of(const Json& json, const std::string& where) {
  check_keys(json, where, {"sample", "colour", "per_mm"});
  voxel::TransferPoint point;
  point.sample = number(json, where, "sample");
  point.per_mm = number(json, where, "per_mm");
  std::optional<glm::vec3> colour;
  if (json.contains("colour") && json["colour"].is_string())
    colour = colour_of_text(json["colour"].get<std::string>());
  if (!colour) refuse(where, "needs 'colour', for example \"#cc7a29\"");
  point.colour = *colour;
  return point;
}

}  // namespace

voxel::TransferFunction read_transfer(const std::filesystem::path& path) {
  const std::string source = path.string();
  std::ifstream stream(path);
  if (!stream) refuse(source, "cannot be opened");
  Json json;
  try {
    json = Json::parse(stream);
  } catch (const Json::exception& error) {
    refuse(source, std::string("is no JSON: ") + error.what());
  }
  check_keys(json, source, {"octotomy_transfer", "surface_per_mm", "points"});
  if (!json.contains("octotomy_transfer") || json["octotomy_transfer"] != 1)
    refuse(source, "is no transfer function of version 1: begin it with \"octotomy_transfer\": 1");
  voxel::TransferFunction transfer;
  if (json.contains("surface_per_mm")) transfer.surface_per_mm = number(json, source, "surface_per_mm");
  if (!json.contains("points") || !json["points"].is_array()) refuse(source, "needs 'points', a list");
  for (const Json& point : json["points"])
    transfer.points.push_back(
        point_of(point, source + ": points[" + std::to_string(transfer.points.size()) + "]"));
  try {
    voxel::check(transfer);
  } catch (const std::invalid_argument& error) {
    refuse(source, error.what());
  }
  return transfer;
}

}  // namespace octotomy::planner

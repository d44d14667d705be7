// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/transfer_file.h"

#include <stdexcept>

#include "planner/operation/picture/colour.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

voxel::TransferPoint transfer_point(const SortedJson& json, const std::string& where) {
  check_keys(json, where, {"sample", "colour", "per_mm"});
  voxel::TransferPoint point;
  point.sample = number_of(need(json, "sample", where), where + ".sample");
  point.per_mm = number_of(need(json, "per_mm", where), where + ".per_mm");
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
  const SortedJson json = read_json(path);
  check_keys(json, source, {"octotomy_transfer", "surface_per_mm", "points"});
  if (!json.contains("octotomy_transfer") || json["octotomy_transfer"] != 1)
    refuse(source, "is not a transfer function of version 1: begin it with \"octotomy_transfer\": 1");
  voxel::TransferFunction transfer;
  if (json.contains("surface_per_mm"))
    transfer.surface_per_mm = number_of(json["surface_per_mm"], source + ": surface_per_mm");
  if (!json.contains("points") || !json["points"].is_array()) refuse(source, "needs 'points', a list");
  for (const SortedJson& point : json["points"])
    transfer.points.push_back(
        transfer_point(point, source + ": points[" + std::to_string(transfer.points.size()) + "]"));
  try {
    voxel::check(transfer);
  } catch (const voxel::InvalidInput& error) {
    refuse(source, error.what());
  }
  return transfer;
}

}  // namespace octotomy::planner

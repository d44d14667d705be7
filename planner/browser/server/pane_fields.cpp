// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/pane_fields.h"

#include <cmath>
#include <stdexcept>

#include "planner/operation/measure/result_json.h"

namespace octotomy::planner::serve {

glm::ivec2 size_px_of(const Json& said) {
  const auto size = said.find("size");
  bool fits = size != said.end() && size->is_array() && size->size() == 2;
  glm::ivec2 size_px(0);
  for (int axis = 0; fits && axis < 2; ++axis) {
    const Json& side = (*size)[static_cast<std::size_t>(axis)];
    // The comparison is in double, so that no integer of JSON overflows.
    fits = side.is_number_integer() && side.get<double>() >= 1.0 && side.get<double>() <= most_pane_px;
    if (fits) size_px[axis] = side.get<int>();
  }
  if (!fits)
    throw std::runtime_error("size: must be [width, height] of 1 to " + std::to_string(most_pane_px) +
                             " pixels");
  return size_px;
}

std::optional<glm::dvec3> point_of(const Json& said, const char* key) {
  const auto value = said.find(key);
  if (value == said.end() || value->is_null()) return {};
  glm::dvec3 point(0.0);
  bool fits = value->is_array() && value->size() == 3;
  for (int axis = 0; fits && axis < 3; ++axis) {
    const Json& part = (*value)[static_cast<std::size_t>(axis)];
    fits = part.is_number() && std::isfinite(part.get<double>());
    if (fits) point[axis] = part.get<double>();
  }
  if (!fits) throw std::runtime_error(std::string(key) + ": must be three numbers [x, y, z]");
  return point;
}

std::optional<double> number_of(const Json& said, const char* key) {
  const auto value = said.find(key);
  if (value == said.end() || value->is_null()) return {};
  if (!value->is_number() || !std::isfinite(value->get<double>()))
    throw std::runtime_error(std::string(key) + ": must be a number");
  return value->get<double>();
}

std::string exact(double value) {
  return Json(value).dump();
}

Json difference_json(const Json& preview, const Session::Preview& made) {
  const std::string to = preview.is_object() ? preview.value("difference", "") : "";
  if (to.empty() || !made.evaluation) return nullptr;
  Json difference{{"to", to}};
  for (const DifferencePart& part : difference_parts)
    difference[part.volume] = made.evaluation->object(part.id).voxel.measures.volume_mm3;
  return difference;
}

Json view_frame_json(const voxel::View& view, const glm::dvec3& centre_mm, double pixel_mm) {
  return {{"right", planner::to_json(view.right)},
          {"up", planner::to_json(view.up)},
          {"look", planner::to_json(view.look)},
          {"centre_mm", planner::to_json(centre_mm)},
          {"pixel_mm", pixel_mm}};
}

}  // namespace octotomy::planner::serve

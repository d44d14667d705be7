// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/serve/told_measurement.h"

#include <utility>

#include "planner/table/number_format.h"

namespace octotomy::planner::serve {
namespace {

/// Behind a number.
std::string unit_text(const std::string& unit) {
  if (unit == "deg") return "\u00b0";
  if (unit == "mm2") return " mm\u00b2";
  return unit == "mm3" ? " mm\u00b3" : " mm";
}

}  // namespace

Json told(const Json& value, const std::string& unit, const Json& half_width, const std::string& what) {
  const int decimals = unit == "mm" || unit == "deg" ? 2 : 0;
  std::string sentence = what + ": " + grouped(value.get<double>(), decimals) + unit_text(unit);
  if (half_width.is_number())
    sentence += " \u00b1 " + grouped(half_width.get<double>(), decimals) + unit_text(unit) + " (99 %)";
  return {{"value", value}, {"unit", unit}, {"half_width", half_width}, {"sentence", sentence}};
}

Json told_measurement(const Json& measured) {
  const auto half_width = [&](const char* key) { return measured.value(key, Json(nullptr)); };
  Json number;
  std::string says;
  if (measured.contains("distance_mm") && measured["distance_mm"].is_number()) {
    says = "Distance";
    number = told(measured["distance_mm"], "mm", half_width("distance_half_width_mm"), says);
  } else if (measured.contains("angle_deg")) {
    says = "Angle";
    number = told(measured["angle_deg"], "deg", half_width("angle_half_width_deg"), says);
  } else if (measured.contains("gap_mm")) {
    if (!measured["gap_mm"].is_number()) return nullptr;
    says = "Gap from " + measured.value("object", "") + " to " + measured.value("to", "");
    number = told(measured["gap_mm"], "mm", half_width("gap_half_width_mm"), says);
  } else if (measured.contains("along") && measured["along"].is_object()) {
    says = "Along the surface of " + measured.value("object", "");
    number = told(measured["along"].at("length_mm"), "mm", nullptr, says);
  } else if (measured.contains("volume")) {
    says = "Volume of " + measured.value("object", "");
    number = told(measured["volume"].at("value"), "mm3", measured["volume"].at("half_width"), says);
  } else {
    return nullptr;
  }
  Json json{{"id", measured.value("id", "")}, {"says", says}};
  json.update(number);
  json["details"] = measured;
  return json;
}

}  // namespace octotomy::planner::serve

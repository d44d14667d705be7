// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/told_measurement.h"

#include <utility>

#include "planner/operation/table/number_format.h"

namespace octotomy::planner::serve {
namespace {

/// The text of a unit after a number.
std::string unit_text(const std::string& unit) {
  if (unit == "deg") return "\u00b0";
  if (unit == "mm2") return " mm\u00b2";
  if (unit == "per_mm") return " per mm";
  return unit == "mm3" ? " mm\u00b3" : " mm";
}

/// A measure that only the mesh kernel's surface has, and its number to show first.
struct SurfaceQuestion {
  const char* key;
  nlohmann::json::json_pointer number;
  const char* unit;
  std::string words;
};

/// Null if the measurement needs no surface. If the surface is not computed yet, its result is null and must
/// not be replaced by the object's volume.
const SurfaceQuestion* surface_question(const Json& measured) {
  using Pointer = nlohmann::json::json_pointer;
  static const SurfaceQuestion questions[] = {
      {"along", Pointer("/length_mm"), "mm", "Way along the surface of "},
      {"section", Pointer("/area_mm2"), "mm2", "Area of the section of "},
      {"thickness", Pointer("/ball/mean_mm"), "mm", "Mean thickness of "},
      {"curvature", Pointer("/mean/mean_per_mm"), "per_mm", "Mean curvature of "}};
  const SurfaceQuestion* asked = nullptr;
  for (const SurfaceQuestion& question : questions) {
    if (!measured.contains(question.key)) continue;
    if (measured[question.key].is_object()) return &question;
    if (asked == nullptr) asked = &question;
  }
  return asked;
}

}  // namespace

Json told(const Json& value, const std::string& unit, const Json& half_width, const std::string& what) {
  const int decimals = unit == "per_mm" ? 4 : unit == "mm" || unit == "deg" ? 2 : 0;
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
  } else if (const SurfaceQuestion* asked = surface_question(measured)) {
    says = asked->words + measured.value("object", "");
    number = measured.at(asked->key).is_object()
                 ? told(measured[asked->key].at(asked->number), asked->unit, nullptr, says)
                 : Json{{"value", nullptr},
                        {"unit", asked->unit},
                        {"half_width", nullptr},
                        {"sentence", says + ": no answer yet, the surface is made by Certify"}};
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

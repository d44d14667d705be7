// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/measurement_message.h"

#include <utility>

#include "planner/operation/measure/measurement.h"
#include "planner/operation/table/number_format.h"

namespace octotomy::planner::serve {
namespace {

/// A unit as it follows a number in a sentence.
std::string unit_text(const std::string& unit) {
  if (unit == "deg") return "\u00b0";
  if (unit == "mm2") return " mm\u00b2";
  if (unit == "per_mm") return " per mm";
  return unit == "mm3" ? " mm\u00b3" : " mm";
}

/// A measure of an object's surface, which only the mesh kernel computes.
struct SurfaceQuestion {
  const char* key;
  nlohmann::json::json_pointer number;
  const char* unit;
  std::string words;
};

/// The surface measure that a measurement asks for; null for other measurements. While the surface is not
/// computed, the measurement has no number: a page must not show the object's volume in its place.
const SurfaceQuestion* surface_question(const Json& measured) {
  using Pointer = nlohmann::json::json_pointer;
  static const SurfaceQuestion questions[] = {
      {"along", Pointer("/length_mm"), "mm", "Path along the surface of "},
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

/// The number of a measurement that a page shows first, with its half-width.
struct ToldNumbers {
  std::string id, object, to;
  std::optional<double> distance_mm, distance_half_width_mm, angle_deg, angle_half_width_deg, gap_mm,
      gap_half_width_mm;
  std::optional<MeasuredInterval> volume;
};
constexpr auto members_of(const ToldNumbers&) {
  using T = ToldNumbers;
  return std::tuple(member("id", &T::id), member("object", &T::object), member("to", &T::to),
                    member("distance_mm", &T::distance_mm),
                    member("distance_half_width_mm", &T::distance_half_width_mm),
                    member("angle_deg", &T::angle_deg),
                    member("angle_half_width_deg", &T::angle_half_width_deg), member("gap_mm", &T::gap_mm),
                    member("gap_half_width_mm", &T::gap_half_width_mm), member("volume", &T::volume));
}

/// The number that a page shows for a result with a table, before the table itself. `value` is null if the
/// result has no number; then `findings` state why.
struct TableNumber {
  const char* key;  ///< key that only results of this kind have
  nlohmann::json::json_pointer value;
  const char* unit;
  std::optional<nlohmann::json::json_pointer> half_width;
  std::string says;
};

std::string spoken(const Json& json, const char* key) {
  const auto name = json.find(key);
  return name != json.end() && name->is_string() ? name->get<std::string>() : "";
}

std::optional<TableNumber> table_number(const Json& json) {
  using Pointer = nlohmann::json::json_pointer;
  if (json.contains("airway"))
    return TableNumber{"airway", Pointer("/airway/narrowest/area_mm2"), "mm2",
                       Pointer("/airway/narrowest/half_width_mm2"),
                       "Narrowest section of " + spoken(json, "object")};
  if (json.contains("contacts"))
    return TableNumber{"contacts", Pointer("/nearest_mm"), "mm", std::nullopt,
                       std::to_string(json["contacts"].size()) +
                           (json["contacts"].size() == 1 ? " contact of " : " contacts of ") +
                           spoken(json, "object") + " with " + spoken(json, "against") + ", the nearest"};
  if (json.contains("mean_mm") && json.contains("a"))
    return TableNumber{"a", Pointer("/mean_mm"), "mm", std::nullopt,
                       "Mean distance of " + spoken(json, "a") + " and " + spoken(json, "b")};
  if (json.contains("donor_used_mm"))
    return TableNumber{"flap_segments", Pointer("/donor_used_mm"), "mm", std::nullopt,
                       "Length of the donor's bone"};
  if (json.contains("doubts")) {
    std::string says = "Value under random errors";
    if (!json["doubts"].empty())
      says += ": " + spoken(json["doubts"][0], "what") + " of " + spoken(json["doubts"][0], "of");
    return TableNumber{"doubts", Pointer("/doubts/0/value"), "", Pointer("/doubts/0/half_width"), says};
  }
  return std::nullopt;
}

/// Words for a result with a table that has no number to show before it.
std::string table_words(const Json& json) {
  if (json.contains("landmarks") && json.contains("missing"))
    return "First guess of " + std::to_string(json["landmarks"].size()) + " landmarks";
  return json.contains("verdict") ? "Proof of " + spoken(json, "object") : "";
}

/// The message for a result with a table; null for other measurements.
Json table_message(const Json& json) {
  const std::optional<TableNumber> number = table_number(json);
  const std::string says = number ? number->says : table_words(json);
  if (says.empty()) return nullptr;
  Json made{{"says", says}, {"value", nullptr}, {"unit", ""}, {"half_width", nullptr}};
  if (number) {
    const bool is_trials = std::string(number->key) == "doubts";
    made["unit"] = is_trials && !json["doubts"].empty() ? spoken(json["doubts"][0], "unit") : number->unit;
    if (json.contains(number->value) && json.at(number->value).is_number()) {
      const Json half_width = number->half_width && json.contains(*number->half_width)
                                  ? json.at(*number->half_width)
                                  : Json(nullptr);
      made.update(number_message(json.at(number->value), made["unit"], half_width, says));
    }
  }
  const auto findings = json.find("findings");
  if (number && made["value"].is_null())
    made["sentence"] = says + ": no answer yet" +
                       (findings != json.end() && findings->is_array() && !findings->empty()
                            ? ", " + findings->front().get<std::string>()
                            : std::string());
  return made;
}

}  // namespace

Json number_message(const Json& value, const std::string& unit, const Json& half_width,
                    const std::string& what) {
  const int decimals = unit == "per_mm" ? 4 : unit == "mm" || unit == "deg" ? 2 : 0;
  std::string sentence = what + ": " + grouped(value.get<double>(), decimals) + unit_text(unit);
  if (half_width.is_number())
    sentence += " \u00b1 " + grouped(half_width.get<double>(), decimals) + unit_text(unit) + " (99 %)";
  return {{"value", value}, {"unit", unit}, {"half_width", half_width}, {"sentence", sentence}};
}

Json measurement_message(const Json& json) {
  const auto measured = record_of<ToldNumbers>(json);
  Json number;
  std::string says;
  if (measured.distance_mm) {
    says = "Distance";
    number = number_message(*measured.distance_mm, "mm", print_value(measured.distance_half_width_mm), says);
  } else if (measured.angle_deg) {
    says = "Angle";
    number = number_message(*measured.angle_deg, "deg", print_value(measured.angle_half_width_deg), says);
  } else if (json.contains(MeasuredGap::key)) {
    if (!measured.gap_mm) return nullptr;
    says = "Gap from " + measured.object + " to " + measured.to;
    number = number_message(*measured.gap_mm, "mm", print_value(measured.gap_half_width_mm), says);
  } else if (const SurfaceQuestion* asked = surface_question(json)) {
    says = asked->words + measured.object;
    number = json.at(asked->key).is_object()
                 ? number_message(json.at(asked->key).at(asked->number), asked->unit, nullptr, says)
                 : Json{{"value", nullptr},
                        {"unit", asked->unit},
                        {"half_width", nullptr},
                        {"sentence", says + ": no answer yet, because Certify makes the surface"}};
  } else if (measured.volume) {
    says = "Volume of " + measured.object;
    number = number_message(measured.volume->value, "mm3", print_value(measured.volume->half_width), says);
  } else if (number = table_message(json); number.is_object()) {
    says = number["says"];
  } else {
    return nullptr;
  }
  Json made{{"id", measured.id}, {"says", says}};
  made.update(number);
  made.update({{"details", json}});
  return made;
}

}  // namespace octotomy::planner::serve

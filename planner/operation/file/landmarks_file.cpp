// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/landmarks_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "planner/operation/file/mesh_in.h"
#include "planner/operation/table/csv.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"
#include "voxel/space/file_text.h"
#include "voxel/space/regular_file.h"

namespace octotomy::planner {
namespace {

glm::dvec3 position_of(const SortedJson& numbers, const std::string& name) {
  const bool three = numbers.is_array() && numbers.size() == 3 && numbers[0].is_number() &&
                     numbers[1].is_number() && numbers[2].is_number();
  if (!three) throw std::runtime_error("the point of '" + name + "' is not a list of three numbers");
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

std::vector<brep::Landmark> own_landmarks(const SortedJson& list) {
  static const std::vector<std::string> known = {"name",   "says",           "point_mm",
                                                 "weight", "uncertainty_mm", "confirmed"};
  std::vector<brep::Landmark> landmarks;
  for (const SortedJson& entry : list) {
    const std::string number = "landmark " + std::to_string(landmarks.size());
    if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string())
      throw std::runtime_error(number + " has no name");
    brep::Landmark landmark;
    landmark.name = voxel::trimmed(entry["name"].get<std::string>());
    for (const auto& [key, value] : entry.items())
      if (std::find(known.begin(), known.end(), key) == known.end())
        throw std::runtime_error("'" + landmark.name + "' has an unknown key '" + key + "'" +
                                 suggestion(key, known));
    const SortedJson confirmed = entry.value("confirmed", SortedJson(true));
    if (!confirmed.is_boolean())
      throw std::runtime_error("'confirmed' of '" + landmark.name + "' is neither true nor false");
    if (!confirmed.get<bool>())
      throw std::runtime_error("'" + landmark.name +
                               "' is a guess that nobody has confirmed: check and correct its position, then "
                               "set its 'confirmed' to true, or delete the point");
    landmark.p_mm = position_of(entry.value("point_mm", SortedJson()), landmark.name);
    const SortedJson weight = entry.value("weight", SortedJson(1.0));
    if (!weight.is_number()) throw std::runtime_error("the weight of '" + landmark.name + "' is no number");
    landmark.weight = weight.get<double>();
    landmarks.push_back(landmark);
  }
  return landmarks;
}

/// The factors by which coordinates of a system are multiplied to obtain LPS. Slicer writes the system as a
/// word or a number.
glm::dvec3 lps_of_system(const std::string& system) {
  if (system == "LPS" || system == "1") return glm::dvec3(1.0);
  if (system == "RAS" || system == "0") return {-1.0, -1.0, 1.0};
  throw std::runtime_error("the coordinate system '" + system +
                           "' is unknown: convert the points to LPS (1) or RAS (0)");
}

double mm_of_unit(const std::string& unit) {
  const std::optional<brep::LengthUnit> known = brep::length_unit(unit == "[in_i]" ? "inch" : unit);
  if (!known) throw std::runtime_error("the unit '" + unit + "' is unknown: convert the points to mm");
  return known->mm;
}

/// The length of a unit in mm. The unit is a text such as "mm", a list with one unit for each axis, or a
/// coded unit such as ["mm", "UCUM", "millimeter"], of which only the first word is read.
double mm_of_units(const SortedJson& units) {
  if (units.is_string()) return mm_of_unit(units.get<std::string>());
  if (!units.is_array() || units.empty())
    throw std::runtime_error("the unit " + units.dump() + " is not known");
  const bool is_coded = units.size() == 3 && units[1] == "UCUM";
  if (is_coded) return mm_of_units(units[0]);
  for (const SortedJson& each : units)
    if (mm_of_units(each) != mm_of_units(units[0]))
      throw std::runtime_error("the axes have different units, and only one can be read: " + units.dump());
  return mm_of_units(units[0]);
}

using Audit = std::vector<brep::MeshFinding>;

void assume(const char* check, const std::string& what, Audit& audit) {
  audit.push_back({check, brep::MeshVerdict::Warn, what});
}

/// The placed control points of all lists in the file, in LPS mm.
std::vector<brep::Landmark> slicer_landmarks(const SortedJson& markups, Audit& audit) {
  std::vector<brep::Landmark> landmarks;
  for (const SortedJson& list : markups) {
    if (!list.contains("coordinateSystem"))
      assume("frame", "the file names no coordinateSystem: LPS is assumed", audit);
    if (!list.contains("coordinateUnits"))
      assume("unit", "the file names no coordinateUnits: mm is assumed", audit);
    const glm::dvec3 lps_mm = lps_mm_of_markup(list);
    for (const SortedJson& entry : list.value("controlPoints", SortedJson::array())) {
      if (entry.value("positionStatus", "defined") != "defined") continue;
      brep::Landmark landmark;
      landmark.name = voxel::trimmed(entry.value("label", ""));
      if (landmark.name.empty())
        throw std::runtime_error("control point " + std::to_string(landmarks.size()) + " has no label");
      landmark.p_mm = lps_mm * position_of(entry.value("position", SortedJson()), landmark.name);
      landmarks.push_back(landmark);
    }
  }
  return landmarks;
}

/// The lower-case key and the value of a line such as "# CoordinateSystem = LPS"; none for other lines.
std::optional<std::pair<std::string, std::string>> fcsv_fact(const std::string& line) {
  const std::size_t middle = line.find('=');
  if (!line.starts_with("#") || middle == std::string::npos) return std::nullopt;
  return std::pair{voxel::lower_case(voxel::trimmed(line.substr(1, middle - 1))),
                   voxel::trimmed(line.substr(middle + 1))};
}

double fcsv_number(const std::string& cell, const std::string& name) {
  const std::string text = voxel::trimmed(cell);
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || !std::isfinite(number))
    throw std::runtime_error("the point of '" + name + "' has a coordinate '" + text +
                             "', which is not a finite number");
  return number;
}

/// Reads Slicer's points, one on each line, separated by commas, and converts them to LPS. Since version 4 of
/// Slicer the columns are id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label, ...; before, they were label,x,y,z,... The
/// file's line "columns" states them.
std::vector<brep::Landmark> fcsv_landmarks(const std::string& text, Audit& audit) {
  std::vector<std::string> columns{"id", "x",  "y",   "z",   "ow",   "ox",
                                   "oy", "oz", "vis", "sel", "lock", "label"};
  glm::dvec3 lps_mm(-1.0, -1.0, 1.0);
  bool is_stated = false;
  std::vector<brep::Landmark> landmarks;
  std::istringstream in(text);
  std::size_t number = 0;
  for (std::string line; std::getline(in, line); ++number) {
    line = voxel::trimmed(line);
    if (line.empty()) continue;
    if (const auto fact = fcsv_fact(line)) {
      if (fact->first == "coordinatesystem") {
        const glm::dvec3 stated_mm = lps_of_system(fact->second);
        if (is_stated && stated_mm != lps_mm)
          throw std::runtime_error("states both coordinate systems, LPS and RAS: delete the wrong one");
        lps_mm = stated_mm;
        is_stated = true;
      }
      if (fact->first == "columns") columns = parse_csv(voxel::lower_case(fact->second)).at(0);
    }
    if (line.starts_with("#")) continue;
    const std::vector<std::string> cells = parse_csv(line).at(0);
    const auto cell = [&](const char* column) -> std::string {
      for (std::size_t i = 0; i < columns.size(); ++i)
        if (voxel::trimmed(columns[i]) == column) return i < cells.size() ? voxel::trimmed(cells[i]) : "";
      return "";
    };
    brep::Landmark landmark;
    landmark.name = cell("label");
    if (landmark.name.empty())
      throw std::runtime_error("line " + std::to_string(number + 1) + " has no label in its column " +
                               "'label': write the point's name there");
    for (int axis = 0; axis < 3; ++axis)
      landmark.p_mm[axis] =
          fcsv_number(cell(std::array{"x", "y", "z"}.at(static_cast<std::size_t>(axis))), landmark.name);
    landmark.p_mm *= lps_mm;
    landmarks.push_back(std::move(landmark));
  }
  if (landmarks.empty()) throw std::runtime_error("there is no point");
  if (!is_stated)
    assume("frame",
           "the file names no CoordinateSystem: RAS is assumed, because old versions of 3D Slicer wrote RAS "
           "without this entry",
           audit);
  return landmarks;
}

}  // namespace

glm::dvec3 lps_mm_of_markup(const SortedJson& markup) {
  const SortedJson system = markup.value("coordinateSystem", SortedJson("LPS"));
  return mm_of_units(markup.value("coordinateUnits", SortedJson("mm"))) *
         lps_of_system(system.is_string() ? system.get<std::string>() : system.dump());
}

bool is_landmarks_file(const std::filesystem::path& path) {
  const std::string extension = voxel::extension_of(path);
  return extension == ".json" || extension == ".fcsv";
}

std::vector<brep::Landmark> read_landmarks(const std::filesystem::path& path) {
  voxel::need_regular_file(path);
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path.string() + ": cannot be read");
  try {
    std::string text{std::istreambuf_iterator<char>(file), {}};
    // Some editors write a byte-order mark at the beginning of a text.
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (text.starts_with(mark)) text.erase(0, mark.size());
    Audit audit;
    std::vector<brep::Landmark> landmarks;
    const auto read = [&] {
      if (!audit.empty()) keep_landmark_audit(path, audit);
      return landmarks;
    };
    if (voxel::extension_of(path) == ".fcsv") {
      landmarks = fcsv_landmarks(text, audit);
      return read();
    }
    const auto root = parse_json(text);
    const auto is_list = [&](const char* key) {
      return root.is_object() && root.contains(key) && root[key].is_array();
    };
    for (const char* statement : {"frame", "unit", "units", "coordinateSystem", "coordinateUnits", "space"})
      if (is_list("landmarks") && root.contains(statement))
        throw std::runtime_error(std::string("states '") + statement +
                                 "' beside \"landmarks\", but \"point_mm\" is always in LPS millimetres: "
                                 "convert the points, and delete this key");
    if (is_list("landmarks") && is_list("markups"))
      throw std::runtime_error("has both \"landmarks\" and \"markups\": delete one of these lists");
    if (is_list("landmarks"))
      landmarks = own_landmarks(root["landmarks"]);
    else if (is_list("markups"))
      landmarks = slicer_landmarks(root["markups"], audit);
    else
      throw std::runtime_error(
          R"(there is no list "landmarks" of { "name": ..., "point_mm": [x, y, z] }, nor Slicer's "markups")");
    return read();
  } catch (const SortedJson::exception& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  } catch (const std::exception& error) {
    rethrow_at(path.string() + ": ", error);
  }
}

}  // namespace octotomy::planner

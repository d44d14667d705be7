// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/file/landmarks_file.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "planner/table/json.h"
#include "planner/table/json_file.h"
#include "planner/table/nearest_name.h"
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
    landmark.name = entry["name"].get<std::string>();
    for (const auto& [key, value] : entry.items())
      if (std::find(known.begin(), known.end(), key) == known.end())
        throw std::runtime_error("'" + landmark.name + "' has an unknown key '" + key + "'" +
                                 suggestion(key, known));
    const SortedJson confirmed = entry.value("confirmed", SortedJson(true));
    if (!confirmed.is_boolean())
      throw std::runtime_error("'confirmed' of '" + landmark.name + "' is neither true nor false");
    if (!confirmed.get<bool>())
      throw std::runtime_error("'" + landmark.name +
                               "' is a guess that nobody has confirmed: look at it, correct it, and set its "
                               "'confirmed' to true, or leave it out");
    landmark.p_mm = position_of(entry.value("point_mm", SortedJson()), landmark.name);
    const SortedJson weight = entry.value("weight", SortedJson(1.0));
    if (!weight.is_number()) throw std::runtime_error("the weight of '" + landmark.name + "' is no number");
    landmark.weight = weight.get<double>();
    landmarks.push_back(landmark);
  }
  return landmarks;
}

/// Control points of every list in the file.
std::vector<brep::Landmark> slicer_landmarks(const SortedJson& markups) {
  std::vector<brep::Landmark> landmarks;
  for (const SortedJson& list : markups) {
    const std::string system = list.value("coordinateSystem", "LPS");
    if (system != "LPS" && system != "RAS" && system != "0" && system != "1")
      throw std::runtime_error("the coordinate system '" + system + "' is neither LPS nor RAS");
    const bool ras = system == "RAS" || system == "0";
    for (const SortedJson& entry : list.value("controlPoints", SortedJson::array())) {
      if (entry.value("positionStatus", "defined") != "defined") continue;
      brep::Landmark landmark;
      landmark.name = entry.value("label", "");
      if (landmark.name.empty())
        throw std::runtime_error("control point " + std::to_string(landmarks.size()) + " has no label");
      landmark.p_mm = position_of(entry.value("position", SortedJson()), landmark.name);
      if (ras) landmark.p_mm *= glm::dvec3(-1.0, -1.0, 1.0);
      landmarks.push_back(landmark);
    }
  }
  return landmarks;
}

}  // namespace

std::vector<brep::Landmark> read_landmarks(const std::filesystem::path& path) {
  voxel::need_regular_file(path);
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path.string() + ": cannot be read");
  try {
    const auto root = parse_json(std::string{std::istreambuf_iterator<char>(file), {}});
    const auto is_list = [&](const char* key) {
      return root.is_object() && root.contains(key) && root[key].is_array();
    };
    std::vector<brep::Landmark> landmarks;
    if (is_list("landmarks"))
      landmarks = own_landmarks(root["landmarks"]);
    else if (is_list("markups"))
      landmarks = slicer_landmarks(root["markups"]);
    else
      throw std::runtime_error(
          R"(there is no list "landmarks" of { "name": ..., "point_mm": [x, y, z] }, nor Slicer's "markups")");
    return landmarks;
  } catch (const SortedJson::exception& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

}  // namespace octotomy::planner

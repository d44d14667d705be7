// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/json_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "planner/operation/table/json.h"
#include "planner/operation/table/nearest_name.h"
#include "voxel/space/error.h"
#include "voxel/space/regular_file.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {

void refuse(const std::string& where, const std::string& what) {
  throw std::runtime_error(where.empty() ? what : where + ": " + what);
}

std::string type_of(const SortedJson& value) {
  return value.is_number() ? "a number"
         : value.is_null() ? "null"
                           : "a JSON " + std::string(value.type_name());
}

int json_levels(std::string_view text) {
  int level = 0, deepest = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char symbol = text[i];
    if (symbol == '"') in_text = !in_text;
    if (in_text && symbol == '\\') ++i;
    if (in_text) continue;
    if (symbol == '[' || symbol == '{') deepest = std::max(deepest, ++level);
    if (symbol == ']' || symbol == '}') --level;
  }
  return deepest;
}

std::string without_last_read(std::string message) {
  if (const std::size_t at = message.find("; last read: "); at != std::string::npos) message.resize(at);
  return message;
}

void need_shallow_json(std::string_view text) {
  if (json_levels(text) > most_json_levels)
    refuse("", "is nested more than " + std::to_string(most_json_levels) + " deep");
}

void OneOfEachKey::add(const std::string& key) {
  if (!open_.back().insert(key).second)
    refuse("", "the key '" + key + "' occurs twice in one object: delete one of them");
}

SortedJson read_json(const std::filesystem::path& path) {
  voxel::need_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) refuse(path.string(), "cannot be opened");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  try {
    return parse_json(text);
  } catch (const std::runtime_error& error) {
    refuse(path.string(), error.what());
  }
}

void write_json(const nlohmann::ordered_json& json, const std::filesystem::path& path) {
  voxel::write_whole(path, json_text(json) + "\n");
}

void check_keys(const SortedJson& object, const std::string& where, const std::vector<std::string>& known) {
  if (!object.is_object()) refuse(where, "must be a JSON object with the keys of this kind of file");
  for (const auto& [key, unused] : object.items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      refuse(where, "unknown key '" + key + "'" + suggestion(key, known));
}

const SortedJson& need(const SortedJson& object, const std::string& key, const std::string& where) {
  if (!object.contains(key)) refuse(where, "has no '" + key + "'");
  return object[key];
}

double number_of(const SortedJson& value, const std::string& where) {
  if (!value.is_number()) refuse(where, "must be a number, not " + type_of(value));
  const auto number = value.get<double>();
  if (!std::isfinite(number)) refuse(where, "must be a finite number");
  return number;
}

std::size_t count_of(const SortedJson& value, const std::string& where) {
  if (!value.is_number_unsigned()) refuse(where, "must be a whole number from 0");
  return value.get<std::size_t>();
}

std::string word_of(const SortedJson& value, const std::string& where) {
  if (!value.is_string()) refuse(where, "must be a word");
  return value.get<std::string>();
}

glm::dvec2 point_of(const SortedJson& value, const std::string& where) {
  if (!value.is_array() || value.size() != 2) refuse(where, "must be two numbers [u, v]");
  return {number_of(value[0], where), number_of(value[1], where)};
}

}  // namespace octotomy::planner

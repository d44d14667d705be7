// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/json_file.h"

namespace octotomy::planner {

// Functions to read the JSON of a plan, for all kinds of steps.

/// The names in a list of pairs, or the keys of a map, in order.
template <typename Pairs>
std::vector<std::string> names_of(const Pairs& pairs) {
  std::vector<std::string> names(pairs.size());
  std::transform(pairs.begin(), pairs.end(), names.begin(), [](const auto& pair) { return pair.first; });
  return names;
}

/// Reads a JSON object key by key. The constructor refuses unknown keys. Members throw std::runtime_error,
/// with the key's place, if a value is missing or has another type.
class Keys {
 public:
  /// `where` is the object's place in error messages, `known` its keys. `value` must outlive this object.
  Keys(const nlohmann::json& value, std::string where, std::vector<std::string> known);

  const std::string& where() const { return where_; }
  /// The place of a key in error messages.
  std::string at(const std::string& key) const { return where_.empty() ? key : where_ + ", " + key; }

  /// The value of a key; null if the key is absent or its value is null.
  const nlohmann::json* find(const std::string& key) const;
  const nlohmann::json& need(const std::string& key) const;
  /// The value of a key as text. Refuses an empty one.
  std::string text(const std::string& key) const;
  double number(const std::string& key) const { return number_of(need(key), at(key)); }
  std::optional<double> number_if(const std::string& key) const;
  bool flag(const std::string& key) const;
  glm::dvec3 point(const std::string& key) const;

 private:
  const nlohmann::json& value_;
  std::string where_;
  std::vector<std::string> known_;
};

}  // namespace octotomy::planner

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

// How a plan's JSON is read: what every kind of step takes, and refuses, alike.

/// The names of pairs or of a map's entries, in their order.
template <typename Pairs>
std::vector<std::string> names_of(const Pairs& pairs) {
  std::vector<std::string> names(pairs.size());
  std::transform(pairs.begin(), pairs.end(), names.begin(), [](const auto& pair) { return pair.first; });
  return names;
}

/// One JSON object, read key by key; it refuses keys that are not known. Members throw std::runtime_error
/// where a value is missing or of another kind than asked for.
class Keys {
 public:
  /// `where` names the object in refusals; the value must live as long.
  Keys(const nlohmann::json& value, std::string where, std::vector<std::string> known);

  const std::string& where() const { return where_; }
  /// The same of a key within.
  std::string at(const std::string& key) const { return where_.empty() ? key : where_ + ", " + key; }

  /// None where the key is not there or null.
  const nlohmann::json* find(const std::string& key) const;
  const nlohmann::json& need(const std::string& key) const;
  /// Not empty.
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

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

// Functions for reading a plan's JSON, common to all kinds of steps.

/// The names of pairs or of a map's entries, in their order.
template <typename Pairs>
std::vector<std::string> names_of(const Pairs& pairs) {
  std::vector<std::string> names(pairs.size());
  std::transform(pairs.begin(), pairs.end(), names.begin(), [](const auto& pair) { return pair.first; });
  return names;
}

/// Reads a JSON object key by key; refuses unknown keys. Members throw std::runtime_error if a value is
/// missing or has another type.
class Keys {
 public:
  /// `where` names the object in error messages. `value` must outlive this object.
  Keys(const nlohmann::json& value, std::string where, std::vector<std::string> known);

  const std::string& where() const { return where_; }
  /// The name of a key of this object for messages.
  std::string at(const std::string& key) const { return where_.empty() ? key : where_ + ", " + key; }

  /// Null if the key is absent or its value is null.
  const nlohmann::json* find(const std::string& key) const;
  const nlohmann::json& need(const std::string& key) const;
  /// A text that is not empty.
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

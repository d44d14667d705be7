// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/plan_keys.h"

#include <cctype>
#include <utility>

#include "planner/operation/table/json.h"
#include "planner/operation/table/nearest_name.h"

namespace octotomy::planner {

Keys::Keys(const SortedJson& value, std::string where, std::vector<std::string> known)
    : value_(value), where_(std::move(where)), known_(std::move(known)) {
  if (!value.is_object()) refuse(where_, "must be an object in braces, not " + type_of(value));
  std::sort(known_.begin(), known_.end());
  for (const auto& [key, unused] : value.items())
    if (!std::binary_search(known_.begin(), known_.end(), key))
      refuse(where_, "unknown key '" + key + "'" + suggestion(key, known_));
}

const SortedJson* Keys::find(const std::string& key) const {
  const auto found = value_.find(key);
  return found == value_.end() || found->is_null() ? nullptr : &*found;
}

const SortedJson& Keys::need(const std::string& key) const {
  const SortedJson* found = find(key);
  if (found == nullptr) refuse(where_, "'" + key + "' is missing: add it");
  return *found;
}

std::string Keys::text(const std::string& key) const {
  const SortedJson& value = need(key);
  if (!value.is_string()) refuse(at(key), "must be a text in quotes, not " + type_of(value));
  if (value.get_ref<const std::string&>().empty()) refuse(at(key), "is empty: give a value");
  return value.get<std::string>();
}

std::optional<double> Keys::number_if(const std::string& key) const {
  return find(key) == nullptr ? std::nullopt : std::optional(number(key));
}

glm::dvec3 Keys::point(const std::string& key) const {
  const SortedJson& value = need(key);
  if (!value.is_array() || value.size() != 3) refuse(at(key), "must be three numbers [x, y, z]");
  return {number_of(value[0], at(key)), number_of(value[1], at(key)), number_of(value[2], at(key))};
}

bool Keys::flag(const std::string& key) const {
  const SortedJson& value = need(key);
  if (!value.is_boolean()) refuse(at(key), "must be true or false");
  return value.get<bool>();
}

}  // namespace octotomy::planner

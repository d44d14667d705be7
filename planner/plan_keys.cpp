// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan_keys.h"

#include <cctype>
#include <utility>

#include "planner/nearest_name.h"

namespace octotomy::planner {

using Json = nlohmann::json;

Keys::Keys(const Json& value, std::string where, std::vector<std::string> known)
    : value_(value), where_(std::move(where)), known_(std::move(known)) {
  if (!value.is_object()) refuse(where_, "must be an object in braces, not " + type_of(value));
  std::sort(known_.begin(), known_.end());
  for (const auto& [key, unused] : value.items())
    if (!std::binary_search(known_.begin(), known_.end(), key))
      refuse(where_, "unknown key '" + key + "'" + suggestion(key, known_));
}

const Json* Keys::find(const std::string& key) const {
  const auto found = value_.find(key);
  return found == value_.end() || found->is_null() ? nullptr : &*found;
}

const Json& Keys::need(const std::string& key) const {
  const Json* found = find(key);
  if (found == nullptr) refuse(where_, "'" + key + "' is missing: add it");
  return *found;
}

std::string Keys::text(const std::string& key) const {
  const Json& value = need(key);
  if (!value.is_string()) refuse(at(key), "must be a text in quotes, not " + type_of(value));
  if (value.get_ref<const std::string&>().empty()) refuse(at(key), "is empty: say what is meant");
  return value.get<std::string>();
}

std::optional<double> Keys::number_if(const std::string& key) const {
  return find(key) == nullptr ? std::nullopt : std::optional(number(key));
}

glm::dvec3 Keys::point(const std::string& key) const {
  const Json& value = need(key);
  if (!value.is_array() || value.size() != 3) refuse(at(key), "must be three numbers [x, y, z]");
  return {number_of(value[0], at(key)), number_of(value[1], at(key)), number_of(value[2], at(key))};
}

bool Keys::flag(const std::string& key) const {
  const Json& value = need(key);
  if (!value.is_boolean()) refuse(at(key), "must be true or false");
  return value.get<bool>();
}

std::vector<std::string> Keys::names(const std::string& key) const {
  std::vector<std::string> names;
  const Json* list = find(key);
  if (list == nullptr) return names;
  if (!list->is_array()) refuse(at(key), "must be a list of names of earlier steps");
  for (const Json& name : *list) {
    if (!name.is_string()) refuse(at(key), "must hold names of earlier steps, not " + type_of(name));
    names.push_back(name.get<std::string>());
  }
  return names;
}

void Bound::bind(const std::string& where, const std::string& id, const std::string& word) {
  const bool letter_first = !id.empty() && (std::isalpha(static_cast<unsigned char>(id[0])) || id[0] == '_');
  const bool identifier = letter_first && std::all_of(id.begin(), id.end(), [](unsigned char c) {
                            return c < 128 && (std::isalnum(c) || c == '_');
                          });
  if (!identifier)
    refuse(where, "id '" + id + "' is not a name: use letters, digits and underscores, a letter first");
  if (!words_.emplace(id, word).second)
    refuse(where, "id '" + id + "' is taken by an earlier step: choose another");
  if (word != "measure" && word != "export") objects_.push_back(id);
}

void Bound::need_moved(const std::string& where, const std::string& name) const {
  need_object(where, name);
  if (words_.at(name) != "move")
    refuse(where, "'" + name + "' is a " + words_.at(name) +
                      " step: name the result of a move step, or list it as fixed");
}

void Bound::need_object(const std::string& where, const std::string& name) const {
  if (std::find(objects_.begin(), objects_.end(), name) != objects_.end()) return;
  const auto found = words_.find(name);
  if (found != words_.end()) refuse(where, "'" + name + "' is a " + found->second + " step, not an object");
  refuse(where, "no earlier step is called '" + name + "'" + suggestion(name, objects_));
}

}  // namespace octotomy::planner

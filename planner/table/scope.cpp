// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/table/scope.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "planner/table/nearest_name.h"
#include "planner/table/operation.h"

namespace octotomy::planner {
namespace {

bool is_identifier(const std::string& id) {
  const auto letter = [](unsigned char c) { return c < 128 && (std::isalpha(c) || c == '_'); };
  const auto digit = [](unsigned char c) { return c < 128 && std::isdigit(c); };
  return !id.empty() && letter(static_cast<unsigned char>(id[0])) &&
         std::all_of(id.begin(), id.end(), [&](unsigned char c) { return letter(c) || digit(c); });
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void Place::refuse(const std::string& what) const {
  throw std::runtime_error(where.empty() ? what : where + ": " + what);
}

void Scope::bind(const std::string& where, const std::string& id, const Operation& operation) {
  const Place place{where};
  if (!is_identifier(id))
    place.refuse("id '" + id + "' is not a name: use letters, digits and underscores, a letter first");
  if (operation.makes == Makes::Scan && contains(scans_, id))
    place.refuse("id '" + id + "' is taken by a scan of the plan: choose another");
  if (!operations_.emplace(id, &operation).second)
    place.refuse("id '" + id + "' is taken by an earlier step: choose another");
  if (operation.makes == Makes::Object) objects_.push_back(id);
  if (operation.makes == Makes::Scan) scans_.push_back(id);
}

void Scope::need_object(const std::string& where, const std::string& name) const {
  const auto found = operations_.find(name);
  if (found != operations_.end() && found->second->makes == Makes::Object) return;
  if (found != operations_.end())
    Place{where}.refuse("'" + name + "' is a " + found->second->name + " step, not an object");
  Place{where}.refuse("no earlier step is called '" + name + "'" + suggestion(name, objects_));
}

void Scope::need_scan(const std::string& where, const std::string& name) const {
  const auto found = operations_.find(name);
  const bool is_made = found != operations_.end() && found->second->makes == Makes::Scan;
  if (!is_made && !contains(scans_, name))
    Place{where}.refuse("no scan is called '" + name + "'" + suggestion(name, scans_));
}

void Scope::take_path(const std::string& where, const std::string& path) {
  if (contains(paths_, path))
    Place{where}.refuse("'" + path + "' is written by an earlier step: choose another");
  paths_.push_back(path);
}

}  // namespace octotomy::planner

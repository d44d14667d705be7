// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/scope.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/operation.h"

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

void FieldLocation::refuse(const std::string& what) const {
  throw std::runtime_error(where.empty() ? what : where + ": " + what);
}

void Scope::bind(const std::string& where, const std::string& id, const Operation& operation) {
  const FieldLocation place{where};
  if (!is_identifier(id))
    place.refuse("id '" + id + "' is not a name: use letters, digits and underscores, with a letter first");
  if (operation.makes == Makes::Scan && contains(scans_, id))
    place.refuse("id '" + id + "' is the name of a scan of the plan: choose another name");
  if (!operations_.emplace(id, &operation).second)
    place.refuse("id '" + id + "' is taken by an earlier step: choose another name");
  if (operation.makes == Makes::Object) objects_.push_back(id);
  if (operation.makes == Makes::Scan) scans_.push_back(id);
}

void Scope::need_object(const std::string& where, const std::string& name) const {
  const auto found = operations_.find(name);
  if (found != operations_.end() && found->second->makes == Makes::Object) return;
  if (found != operations_.end())
    FieldLocation{where}.refuse("'" + name + "' is a " + found->second->name + " step, not an object");
  FieldLocation{where}.refuse("no earlier step is called '" + name + "'" + suggestion(name, objects_));
}

void Scope::need_scan(const std::string& where, const std::string& name) const {
  const auto found = operations_.find(name);
  const bool is_made = found != operations_.end() && found->second->makes == Makes::Scan;
  if (!is_made && !contains(scans_, name))
    FieldLocation{where}.refuse("no scan is called '" + name + "'" + suggestion(name, scans_));
}

void Scope::bind_landmark(const std::string& where, const NamedPoint& landmark) {
  const FieldLocation place{where};
  if (landmark.name.empty() || landmark.name.find('@') != std::string::npos)
    place.refuse("the landmark '" + landmark.name + "' needs a name without '@'");
  if (!landmark_of_.emplace(landmark.name, landmarks_.size()).second)
    place.refuse("the landmark '" + landmark.name + "' is named twice: rename or delete one of them");
  landmarks_.push_back(landmark);
}

glm::dvec3 Scope::landmark_mm(const std::string& where, const std::string& name) const {
  if (const auto found = landmark_of_.find(name); found != landmark_of_.end())
    return landmarks_[found->second].p_mm;
  std::vector<std::string> known;
  for (const NamedPoint& landmark : landmarks_) known.push_back(landmark.name);
  FieldLocation{where}.refuse(known.empty()
                                  ? "no earlier step names landmarks: add a landmarks step, or type [x, y, z]"
                                  : "no landmark is called '" + name + "'" + suggestion(name, known));
}

void Scope::hold_head(const std::string& where, const glm::dmat3& lps_from_head) {
  if (lps_from_head_)
    FieldLocation{where}.refuse("an earlier step already sets the head's orientation: keep one of the two");
  lps_from_head_ = lps_from_head;
}

void Scope::take_path(const std::string& where, const std::string& path) {
  if (!paths_.insert(path).second)
    FieldLocation{where}.refuse("'" + path + "' is written by an earlier step: choose another path");
}

}  // namespace octotomy::planner

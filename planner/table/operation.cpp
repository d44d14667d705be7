// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/table/operation.h"

#include <algorithm>

namespace octotomy::planner {
namespace {

void collect_marks(const std::vector<Field>& fields, void* owner, std::vector<Mark>& marks) {
  for (const Field& field : fields) {
    const Slot slot = field.slot(owner);
    if (const auto* mark = std::get_if<Mark*>(&slot)) marks.push_back(**mark);
    if (const auto* mark = std::get_if<std::optional<Mark>*>(&slot); mark != nullptr && **mark)
      marks.push_back(***mark);
    if (const auto* list = std::get_if<std::vector<Mark>*>(&slot))
      marks.insert(marks.end(), (*list)->begin(), (*list)->end());
    if (const auto* records = std::get_if<Records>(&slot))
      for (std::size_t i = 0; i < records->count; ++i) collect_marks(field.fields, records->at(i), marks);
  }
}

/// Collects the names in fields of one type.
template <typename Name>
void collect(const std::vector<Field>& fields, void* owner, std::vector<std::string>& names) {
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const Field& field : fields) {
    const Slot slot = field.slot(owner);
    if (const auto* name = std::get_if<Name*>(&slot)) add((*name)->name);
    if constexpr (std::is_same_v<Name, ObjectName>) {
      if (const auto* site = std::get_if<Site*>(&slot)) add((*site)->object);
      if (const auto* name = std::get_if<std::optional<Name>*>(&slot); name != nullptr && **name)
        add((**name)->name);
      if (const auto* list = std::get_if<std::vector<Name>*>(&slot))
        for (const Name& name : **list) add(name.name);
    }
    if (const auto* records = std::get_if<Records>(&slot))
      for (std::size_t i = 0; i < records->count; ++i) collect<Name>(field.fields, records->at(i), names);
  }
}

}  // namespace

const Operation* find_operation(const std::string& name) {
  for (const Operation& operation : operations())
    if (operation.name == name) return &operation;
  return nullptr;
}

std::vector<std::string> objects_used(const Action& action) {
  std::vector<std::string> names;
  collect<ObjectName>(action.operation().fields, const_cast<void*>(action.value()), names);
  for (const Mark& mark : marks_used(action))
    if (!mark.object.empty() && std::find(names.begin(), names.end(), mark.object) == names.end())
      names.push_back(mark.object);
  if (action.operation().uses)
    for (const std::string& name : action.operation().uses(action.value()))
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

std::filesystem::path path_written(const Action& action) {
  if (action.operation().makes == Makes::File)
    for (const Field& field : action.operation().fields)
      if (const Slot slot = field.slot(const_cast<void*>(action.value()));
          std::holds_alternative<std::filesystem::path*>(slot))
        return std::get<std::filesystem::path*>(slot)->lexically_normal();
  return {};
}

std::vector<Mark> marks_used(const Action& action) {
  std::vector<Mark> marks;
  collect_marks(action.operation().fields, const_cast<void*>(action.value()), marks);
  return marks;
}

std::vector<std::string> scans_used(const Action& action) {
  std::vector<std::string> names;
  collect<ScanName>(action.operation().fields, const_cast<void*>(action.value()), names);
  return names;
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/operation.h"

#include <set>
#include <utility>

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

/// Names without repetitions, in the order of first occurrence.
class Names {
 public:
  void add(const std::string& name) {
    if (!name.empty() && known_.insert(name).second) in_order_.push_back(name);
  }
  std::vector<std::string> all() && { return std::move(in_order_); }

 private:
  std::vector<std::string> in_order_;
  std::set<std::string> known_;
};

/// Collects the names in all fields of one type.
template <typename Name>
void collect(const std::vector<Field>& fields, void* owner, Names& names) {
  for (const Field& field : fields) {
    const Slot slot = field.slot(owner);
    if (const auto* name = std::get_if<Name*>(&slot)) names.add((*name)->name);
    if constexpr (std::is_same_v<Name, ObjectName>) {
      if (const auto* site = std::get_if<Site*>(&slot)) names.add((*site)->object);
      if (const auto* name = std::get_if<std::optional<Name>*>(&slot); name != nullptr && **name)
        names.add((**name)->name);
      if (const auto* list = std::get_if<std::vector<Name>*>(&slot))
        for (const Name& name : **list) names.add(name.name);
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
  Names names;
  collect<ObjectName>(action.operation().fields, const_cast<void*>(action.value()), names);
  for (const Mark& mark : marks_used(action)) names.add(mark.object);
  if (action.operation().uses)
    for (const std::string& name : action.operation().uses(action.value())) names.add(name);
  return std::move(names).all();
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
  Names names;
  collect<ScanName>(action.operation().fields, const_cast<void*>(action.value()), names);
  return std::move(names).all();
}

}  // namespace octotomy::planner

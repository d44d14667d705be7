// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "planner/operation/table/sample_window.h"

// The fields of operations: name, type and meaning of each. Reading and printing of JSON, error messages, the
// schema, the options of the command line and their help all derive from this one description. The header is
// long, because it contains Field, its slot and the functions that build it.
namespace octotomy::planner {

/// The name of an object from an earlier step.
struct ObjectName {
  std::string name;
};
/// The name of a scan of the plan.
struct ScanName {
  std::string name;
};
/// A place: a point in LPS millimetres, or the surface of a named object.
struct Site {
  glm::dvec3 point_mm{0.0};
  std::string object;  ///< empty: the point
};
/// A point: typed in LPS millimetres, or a landmark of the plan. A landmark is at its position in the scan;
/// as "ans@advanced" it is at the position to which that object's motions move it.
struct Mark {
  glm::dvec3 p_mm{0.0};  ///< for a landmark: its position in the scan
  std::string landmark;  ///< empty: typed
  std::string object;    ///< object with which the landmark moves; empty: it stays at its position in the
                         ///< scan

  bool operator==(const Mark&) const = default;
};
/// Closed polygons in the millimetres (u, v) of a view.
using Polygons = std::vector<std::vector<glm::dvec2>>;
/// Pairs of names of objects.
using NamePairs = std::vector<std::pair<std::string, std::string>>;

/// Access to the records in a field of an operation: a single optional record, a list of records, or records
/// by object name.
struct Records {
  enum class Form { Optional, List, ByName };
  Form form = Form::Optional;
  std::size_t count = 0;
  std::function<void*(std::size_t index)> at;
  std::function<std::string(std::size_t index)> name_of;  ///< ByName only
  std::function<void*(const std::string& name)> add;      ///< `name` is only used by ByName
};

/// A pointer to the value of a field. The alternative of the variant is the field's type.
using Slot = std::variant<
    bool*, int*, double*, std::string*, std::filesystem::path*, glm::dvec3*, ObjectName*, ScanName*, Site*,
    std::optional<double>*, std::optional<int>*, std::optional<std::string>*, std::optional<glm::dvec3>*,
    std::optional<ObjectName>*, SampleWindow*, std::optional<SampleWindow>*, std::vector<double>*,
    std::vector<int>*, std::vector<std::string>*, std::vector<glm::dvec3>*, std::vector<ObjectName>*, Mark*,
    std::optional<Mark>*, std::vector<Mark>*, std::optional<glm::dmat4>*, Polygons*, NamePairs*, Records>;

/// A field's slot, with the conditions under which the operation reads the field. It is stored in
/// Field::slot, so that a field without conditions needs no memory for them.
struct ConditionalSlot {
  /// A condition, and the message if it is not met, such as "is of 'curve': add it".
  struct Condition {
    std::function<bool(const void* owner)> is_read;
    std::string otherwise;
  };
  std::function<Slot(void* owner)> slot;
  std::vector<Condition> conditions;

  Slot operator()(void* owner) const { return slot(owner); }
};

/// The unit at the end of a field's name, for people: "mm", "mm³", "°"; empty if there is none.
std::string unit_of_name(const std::string& name);

/// One field of an operation or of a record within it.
struct Field {
  std::string name;  ///< as in a plan; a measured value's name ends in its unit: "kerf_mm"
  std::string says;  ///< one plain sentence
  std::function<Slot(void* owner)> slot;
  std::vector<Field> fields = {};  ///< fields of the records in this field

  bool is_required = false;
  bool is_direction = false;            ///< the value is a vector that must have a length
  std::optional<double> above = {};     ///< numbers are greater
  std::optional<double> least = {};     ///< numbers are at least this, lists have at least this many entries
  std::optional<double> most = {};      ///< numbers are at most this, lists have at most this many entries
  std::optional<double> below = {};     ///< numbers are less
  std::vector<std::string> words = {};  ///< the allowed texts; if empty, every non-empty text is allowed
  std::string sample = {};              ///< an example as JSON, for error messages

  std::optional<std::string> argument = {};  ///< if set, the field is a positional argument with this name on
                                             ///< the command line
  std::string option = {};                   ///< on the command line "--" and this; default: from `name`
  bool has_commas = false;                   ///< the list is one word with commas on the command line
  bool is_repeated = false;                  ///< the option is repeated for each entry of the list
  bool is_of_plans = false;                  ///< only for plans, because the command line has another form
                                             ///< for it
  bool is_input = false;                     ///< a path of an input, which must exist on the command line

  Field required() && { return is_required = true, std::move(*this); }
  Field direction() && { return is_direction = true, std::move(*this); }
  Field greater_than(double bound) && { return above = bound, std::move(*this); }
  Field less_than(double bound) && { return below = bound, std::move(*this); }
  Field from(double bound) && { return least = bound, std::move(*this); }
  Field to(double bound) && { return most = bound, std::move(*this); }
  Field one_of(std::vector<std::string> allowed) && { return words = std::move(allowed), std::move(*this); }
  Field for_example(std::string json) && { return sample = std::move(json), std::move(*this); }
  Field positional(std::string as) && { return argument = std::move(as), std::move(*this); }
  Field comma_separated() && { return has_commas = true, std::move(*this); }
  Field repeated() && { return is_repeated = true, std::move(*this); }
  Field in_plans_only() && { return is_of_plans = true, std::move(*this); }
  Field a_file() && { return is_input = true, std::move(*this); }
  Field called(std::string as) && { return option = std::move(as), std::move(*this); }

  /// Adds a condition on the operation's value, which is tested after all fields were read. If the condition
  /// is not met, the field has no effect, and need_fields_read() refuses a stated value with the message
  /// `otherwise`. The condition must allow that objects are paths of files on the command line, and names in
  /// a plan.
  template <typename Owner>
  Field read_if(bool (*is_read)(const Owner&), std::string otherwise) && {
    ConditionalSlot conditional{slot, {}};
    if (const auto* before = slot.target<ConditionalSlot>()) conditional = *before;
    conditional.conditions.push_back(
        {[is_read](const void* owner) { return is_read(*static_cast<const Owner*>(owner)); },
         std::move(otherwise)});
    slot = std::move(conditional);
    return std::move(*this);
  }

  std::string unit() const;  ///< unit_of_name() of its name
};

/// Makes a field whose type is an alternative of Slot.
template <typename Owner, typename Value>
Field field(std::string name, Value Owner::*member, std::string says) {
  return {std::move(name), std::move(says),
          [member](void* owner) -> Slot { return &(static_cast<Owner*>(owner)->*member); }};
}

/// Makes a field of an optional record.
template <typename Owner, typename Record>
Field record(std::string name, std::optional<Record> Owner::*member, std::string says,
             std::vector<Field> fields) {
  const auto slot = [member](void* owner) -> Slot {
    auto& held = static_cast<Owner*>(owner)->*member;
    return Records{Records::Form::Optional,
                   held ? 1u : 0u,
                   [&held](std::size_t) -> void* { return &*held; },
                   {},
                   [&held](const std::string&) -> void* { return &held.emplace(Record{}); }};
  };
  return {std::move(name), std::move(says), slot, std::move(fields)};
}

/// A list of records.
template <typename Owner, typename Record>
Field records(std::string name, std::vector<Record> Owner::*member, std::string says,
              std::vector<Field> fields) {
  const auto slot = [member](void* owner) -> Slot {
    auto& held = static_cast<Owner*>(owner)->*member;
    return Records{Records::Form::List,
                   held.size(),
                   [&held](std::size_t index) -> void* { return &held[index]; },
                   {},
                   [&held](const std::string&) -> void* { return &held.emplace_back(); }};
  };
  return {std::move(name), std::move(says), slot, std::move(fields)};
}

/// Makes a field of records by the names of objects, in the order in which they are stated.
template <typename Owner, typename Record>
Field records_by_name(std::string name, std::vector<std::pair<std::string, Record>> Owner::*member,
                      std::string says, std::vector<Field> fields) {
  const auto slot = [member](void* owner) -> Slot {
    auto& held = static_cast<Owner*>(owner)->*member;
    return Records{
        Records::Form::ByName, held.size(),
        [&held](std::size_t index) -> void* { return &held[index].second; },
        [&held](std::size_t index) { return held[index].first; },
        [&held](const std::string& key) -> void* { return &held.emplace_back(key, Record{}).second; }};
  };
  return {std::move(name), std::move(says), slot, std::move(fields)};
}

}  // namespace octotomy::planner

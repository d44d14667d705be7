// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <concepts>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "planner/operation/table/json.h"

// Results as values and as JSON. A record is a struct with a function members_of(), which lists its members
// in the order of the JSON's keys. print_record() and read_record() use this list.
namespace octotomy::planner {

/// A member of a record, with its key in JSON.
template <typename Owner, typename Value>
struct Member {
  const char* key;
  Value Owner::*value;
  bool is_left_out;  ///< if the value is empty, the key is left out; otherwise it is null
};

template <typename Owner, typename Value>
constexpr Member<Owner, Value> member(const char* key, Value Owner::*value) {
  return {key, value, false};
}
/// A member whose key is left out if its optional value, list or text is empty.
template <typename Owner, typename Value>
constexpr Member<Owner, Value> member_if_any(const char* key, Value Owner::*value) {
  return {key, value, true};
}

template <typename Type>
concept Record = requires(const Type& record) {
  members_of(record);
};

template <Record Type>
Json print_record(const Type& record);
template <Record Type>
void read_record(const Json& json, Type& record);

/// Infinity and NaN become null, because JSON has neither.
inline Json print_value(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
template <std::integral Type>
Json print_value(Type value) {
  return value;
}
inline Json print_value(const std::string& value) {
  return value;
}
inline Json print_value(const Json& value) {
  return value;
}
inline Json print_value(const glm::dvec3& value) {
  return Json::array({print_value(value.x), print_value(value.y), print_value(value.z)});
}
template <Record Type>
Json print_value(const Type& value) {
  return print_record(value);
}
template <typename Type>
Json print_value(const std::vector<Type>& values) {
  Json list = Json::array();
  for (const Type& value : values) list.push_back(print_value(value));
  return list;
}
template <typename Type>
Json print_value(const std::optional<Type>& value) {
  return value ? print_value(*value) : Json(nullptr);
}

inline void read_value(const Json& json, double& value) {
  if (json.is_number()) value = json.get<double>();
}
template <std::integral Type>
void read_value(const Json& json, Type& value) {
  if (std::is_same_v<Type, bool> ? json.is_boolean() : json.is_number_integer()) value = json.get<Type>();
}
inline void read_value(const Json& json, std::string& value) {
  if (json.is_string()) value = json.get<std::string>();
}
inline void read_value(const Json& json, Json& value) {
  value = json;
}
inline void read_value(const Json& json, glm::dvec3& value) {
  if (json.is_array() && json.size() == 3)
    for (int axis = 0; axis < 3; ++axis) read_value(json[static_cast<std::size_t>(axis)], value[axis]);
}
template <Record Type>
void read_value(const Json& json, Type& value) {
  read_record(json, value);
}
template <typename Type>
void read_value(const Json& json, std::vector<Type>& values) {
  values.clear();
  if (json.is_array())
    for (const Json& entry : json) read_value(entry, values.emplace_back());
}
template <typename Type>
void read_value(const Json& json, std::optional<Type>& value) {
  value.reset();
  if (!json.is_null()) read_value(json, value.emplace());
}

/// Whether a value is present, that is not an empty optional, list or text.
template <typename Type>
bool has_any(const Type& value) {
  if constexpr (requires { value.has_value(); })
    return value.has_value();
  else if constexpr (requires { value.empty(); })
    return !value.empty();
  else
    return true;
}

/// The record as JSON, with keys in the order of its members.
template <Record Type>
Json print_record(const Type& record) {
  Json json = Json::object();
  const auto print = [&](const auto& member) {
    if (!member.is_left_out || has_any(record.*member.value))
      json.emplace(member.key, print_value(record.*member.value));
  };
  std::apply([&](const auto&... all) { (print(all), ...); }, members_of(record));
  return json;
}

/// Reads a record that print_record() of this or another version of the program printed. A member stays
/// unchanged if its key is missing or its value has another type.
template <Record Type>
void read_record(const Json& json, Type& record) {
  if (!json.is_object()) return;
  const auto read = [&](const auto& member) {
    if (const auto found = json.find(member.key); found != json.end())
      read_value(*found, record.*member.value);
  };
  std::apply([&](const auto&... all) { (read(all), ...); }, members_of(record));
}
template <Record Type>
Type record_of(const Json& json) {
  Type record;
  read_record(json, record);
  return record;
}

}  // namespace octotomy::planner

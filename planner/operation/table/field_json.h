// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "planner/operation/table/field.h"
#include "planner/operation/table/scope.h"

// Fields and JSON: one reader, one printer and one schema for every operation.
namespace octotomy::planner {

/// Reads an object's keys into the fields of `owner`. `also` lists further keys that are allowed but not read
/// here. Throws std::runtime_error with the place, the fault and the remedy: an unknown key with the nearest
/// known one, a missing one, a wrong type, a number out of its range, a name that is not bound.
void read_fields(const std::vector<Field>& fields, const nlohmann::json& object, void* owner,
                 const FieldLocation& place, const std::vector<std::string>& also = {});

/// Throws std::runtime_error with the place if `object` states a field that the operation in `owner` does
/// not read (Field::read_if()): a value without effect is a mistake of its author. A false flag, an empty
/// list and null count as not stated.
void need_fields_read(const std::vector<Field>& fields, const nlohmann::json& object, const void* owner,
                      const FieldLocation& place);

/// The fields as JSON that read_fields() reads back to the same value. Leaves out absent optional fields, empty
/// lists, and fields that the operation does not read (Field::read_if()).
nlohmann::ordered_json print_fields(const std::vector<Field>& fields, void* owner);

/// The fields as a JSON schema's object (draft 2020-12). `fresh` is an owner with all defaults; a field that
/// is not required states its default.
nlohmann::ordered_json fields_schema(const std::vector<Field>& fields, void* fresh);

/// A field's value as JSON from the words of the command line: "X,Y,Z" is a point, several are a list. Throws
/// std::runtime_error if a word is not of the field's type.
nlohmann::json json_of_words(const Field& field, void* fresh, const std::vector<std::string>& words);

/// The values of several fields in their order: a point has three values, a list has all remaining values,
/// any other field has one. Scans are skipped. Throws std::runtime_error if there are too many values or too
/// few.
nlohmann::json json_of_values(const std::vector<Field>& fields, void* fresh,
                              const std::vector<std::string>& values);

/// Whether the field holds several words on the command line.
bool takes_several(const Field& field, void* fresh);
/// Whether the field names objects, which are files on the command line.
bool names_objects(const Field& field, void* fresh);
/// Whether the field names a scan.
bool names_scan(const Field& field, void* fresh);
/// Whether the field is a flag, which has no word.
bool is_flag(const Field& field, void* fresh);
/// The form of one word in help: "MM", "X,Y,Z", "NAME".
std::string word_form(const Field& field, void* fresh);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "planner/operation/table/field.h"
#include "planner/operation/table/scope.h"

// Converts fields from and to JSON: one reader, one printer and one schema for all operations.
namespace octotomy::planner {

/// Reads the keys of a JSON object into the fields of `owner`. `also` lists further keys that are allowed but
/// not read here. Throws std::runtime_error that states the place, the fault and the remedy for an unknown
/// key, with the nearest known one, a missing key, a wrong type, a number outside of its range, or an unknown
/// name.
void read_fields(const std::vector<Field>& fields, const nlohmann::json& object, void* owner,
                 const FieldLocation& place, const std::vector<std::string>& also = {});

/// Throws std::runtime_error that states the place if `object` states a field that the operation in `owner`
/// does not read (Field::read_if()), because a value without effect is a mistake of its author. False, an
/// empty list and null count as not stated.
void need_fields_read(const std::vector<Field>& fields, const nlohmann::json& object, const void* owner,
                      const FieldLocation& place);

/// The fields as JSON from which read_fields() reads the same value. Leaves out empty optional fields, empty
/// lists, and fields that the operation does not read (Field::read_if()).
nlohmann::ordered_json print_fields(const std::vector<Field>& fields, void* owner);

/// The JSON schema of an object with these fields (draft 2020-12). `fresh` is an owner with all defaults; the
/// schema states the default of each field that is not required.
nlohmann::ordered_json fields_schema(const std::vector<Field>& fields, void* fresh);

/// A field's value as JSON, from words of the command line: "X,Y,Z" is a point, several words are a list.
/// Throws std::runtime_error if a word does not have the field's type.
nlohmann::json json_of_words(const Field& field, void* fresh, const std::vector<std::string>& words);

/// The values of several fields in their order, from words of the command line: a point has three values, a
/// list has all remaining values, any other field has one. Scans are skipped. Throws std::runtime_error if
/// there are too many or too few values.
nlohmann::json json_of_values(const std::vector<Field>& fields, void* fresh,
                              const std::vector<std::string>& values);

/// Whether the field may have several words on the command line.
bool takes_several(const Field& field, void* fresh);
/// Whether the field names objects, which are paths of files on the command line.
bool names_objects(const Field& field, void* fresh);
/// Whether the field names a scan.
bool names_scan(const Field& field, void* fresh);
/// Whether the field is a flag, which has no word on the command line.
bool is_flag(const Field& field, void* fresh);
/// The form of one word of a field, for help: "MM", "X,Y,Z", "NAME".
std::string word_form(const Field& field, void* fresh);

}  // namespace octotomy::planner

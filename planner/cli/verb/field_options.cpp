// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/field_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "planner/cli/verb/scan_in.h"
#include "planner/operation/table/field_json.h"

namespace octotomy::planner::cli {
namespace {

/// The name of a field's option: "-o,--out" for "out"; for others the field's name without its unit, with
/// hyphens.
std::string option_of(const Field& field) {
  std::string name = field.option.empty() ? field.name : field.option;
  if (name == "out") return "-o,--out";
  for (const char* ending : {"_mm", "_mm2", "_mm3", "_deg"})
    if (field.option.empty() && name.ends_with(ending)) name.resize(name.size() - std::string(ending).size());
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

/// The help of a field's option: the field's sentence with its unit and default.
std::string help_of(const Field& field, void* fresh) {
  std::string text = field.says;
  if (const std::string unit = field.unit(); !unit.empty()) text += " In " + unit + ".";
  if (field.is_required || is_flag(field, fresh)) return text;
  // A field that is read only under a condition is not printed, but its default belongs in the help too.
  Field always = field;
  if (const auto* conditional = field.slot.target<ConditionalSlot>()) always.slot = conditional->slot;
  const auto printed = print_fields({always}, fresh);
  return printed.empty() ? text : text + " Default: " + printed.begin()->dump() + ".";
}

/// Replaces the names of fields in an error message by those of their options, such as "--out".
std::string in_options(std::string text, const std::string& operation, const std::vector<Field>& fields) {
  for (const Field& field : fields) {
    const std::string option = option_of(field), name = option.substr(option.rfind(',') + 1);
    for (const std::string& said : {operation + ", " + field.name + ":", "'" + field.name + "'"})
      for (std::size_t at = 0; (at = text.find(said, at)) != std::string::npos; ++at)
        text.replace(at, said.size(), name + (said.ends_with(':') ? ":" : ""));
  }
  return text;
}

/// Removes a field's name at the beginning of an error message. If the message does not contain the last of
/// the option's words, puts the words before it, in quotes.
std::string with_words(std::string text, const Field& field, const std::vector<std::string>& words) {
  if (text.starts_with(field.name + ": ")) text.erase(0, field.name.size() + 2);
  if (text.find(words.back()) != std::string::npos) return text;
  std::string shown;
  for (const std::string& word : words) shown += (shown.empty() ? "'" : " ") + word;
  return shown + "' " + text;
}

}  // namespace

void add_field_options(CLI::App& verb, const Operation& operation, const std::vector<Field>& fields,
                       FieldWords& words) {
  const std::shared_ptr<void> fresh = operation.fresh();
  for (const Field& field : fields) {
    std::vector<std::string>& given = words[field.name];
    if (is_flag(field, fresh.get())) {
      verb.add_flag_callback(
          option_of(field), [&given] { given = {"true"}; }, field.says);
      continue;
    }
    CLI::Option* option =
        verb.add_option(field.argument.value_or(option_of(field)), given, help_of(field, fresh.get()));
    option->type_name(word_form(field, fresh.get()));
    if (field.has_commas)
      option->delimiter(',')->expected(1, -1)->allow_extra_args(false);
    else if (field.is_repeated)
      option->expected(1)->take_all()->allow_extra_args(false);
    else if (takes_several(field, fresh.get()))
      option->expected(static_cast<int>(field.least.value_or(1.0)),
                       field.most ? static_cast<int>(*field.most) : -1);
    else
      option->expected(1)->allow_extra_args(false);
    option->required(field.is_required);
    const bool is_named = names_scan(field, fresh.get()) || names_objects(field, fresh.get());
    if (field.is_input || is_named)
      option->check(is_named && operation.reads_scans ? scan_path() : CLI::Validator(CLI::ExistingFile));
  }
}

Action read_action(const Operation& operation, const FieldWords& words) {
  Action action(operation);
  nlohmann::json step = nlohmann::json::object();
  std::vector<Field> fields = operation.fields;
  fields.insert(fields.end(), operation.verb_fields.begin(), operation.verb_fields.end());
  for (const Field& field : fields) {
    const auto given = words.find(field.name);
    if (given == words.end() || given->second.empty()) continue;
    try {
      step[field.name] = json_of_words(field, action.value(), given->second);
      read_fields({field}, {{field.name, step[field.name]}}, Action(operation).value(), {});
    } catch (const std::runtime_error& error) {
      throw CLI::ValidationError(field.argument.value_or(option_of(field)),
                                 with_words(error.what(), field, given->second));
    }
  }
  try {
    read_fields(fields, step, action.value(), {operation.name});
    need_fields_read(fields, step, action.value(), {operation.name});
    if (operation.check) operation.check(action.value(), {operation.name});
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(in_options(error.what(), operation.name, fields));
  }
  return action;
}

}  // namespace octotomy::planner::cli

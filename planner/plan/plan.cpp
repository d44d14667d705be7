// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "planner/operation/object/import.h"
#include "planner/operation/object/tile.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/field_json.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/plan/migration.h"
#include "planner/plan/plan_keys.h"
#include "planner/plan/signature.h"
#include "voxel/space/error.h"
#include "voxel/space/regular_file.h"

namespace octotomy::planner {
namespace {

int whole_number(const SortedJson& value, const std::string& where) {
  const double number = number_of(value, where);
  if (number != std::trunc(number) || std::abs(number) > std::numeric_limits<int>::max())
    refuse(where, "must be a whole number");
  return static_cast<int>(number);
}

std::vector<voxel::SliceRange> slices_of(const Keys& scan) {
  try {
    return voxel::parse_slices(scan.text("slices"));
  } catch (const voxel::InvalidInput& error) {
    refuse(scan.at("slices"), error.what());
  }
}

/// Parses the text of a scan's key. None if the scan does not have the key.
template <typename Value>
std::optional<Value> parsed(const Keys& scan, const char* key, Value (*parse)(const std::string&)) {
  if (scan.find(key) == nullptr) return std::nullopt;
  try {
    return parse(scan.text(key));
  } catch (const voxel::InvalidInput& error) {
    refuse(scan.at(key), error.what());
  }
}

/// The options for reading a scan: which series, and facts that images and raw files do not state.
voxel::ReadOptions read_options_of(const Keys& scan) {
  voxel::ReadOptions read;
  if (scan.find("series") != nullptr) read.series = scan.text("series");
  if (scan.find("join") != nullptr) read.join = scan.flag("join");
  if (scan.find("slices") != nullptr) read.slices = slices_of(scan);
  if (scan.find("spacing_mm") != nullptr) read.spacing_mm = scan.point("spacing_mm");
  read.frame = parsed(scan, "frame", voxel::parse_frame);
  read.unit = parsed(scan, "unit", voxel::parse_unit);
  if (const SortedJson* value = scan.find("raw")) {
    const Keys keys(*value, scan.at("raw"), {"dims", "type", "big_endian", "offset"});
    voxel::RawLayout raw;
    const SortedJson& dims = keys.need("dims");
    if (!dims.is_array() || dims.size() != 3) refuse(keys.at("dims"), "must be three numbers [x, y, z]");
    for (int axis = 0; axis < 3; ++axis)
      raw.dims[axis] = whole_number(dims[static_cast<std::size_t>(axis)], keys.at("dims"));
    const std::optional<voxel::SampleType> type = voxel::sample_type(keys.text("type"));
    if (!type) refuse(keys.at("type"), "'" + keys.text("type") + "' is no type: use for example int16");
    raw.type = *type;
    if (keys.find("big_endian") != nullptr) raw.big_endian = keys.flag("big_endian");
    if (const SortedJson* offset = keys.find("offset")) {
      const int bytes = whole_number(*offset, keys.at("offset"));
      if (bytes < 0) refuse(keys.at("offset"), "must not be negative");
      raw.offset = static_cast<std::uint64_t>(bytes);
    }
    read.raw = raw;
  }
  return read;
}

std::map<std::string, ScanSource> scans_of(const Keys& top) {
  std::map<std::string, ScanSource> scans;
  const SortedJson* value = top.find("scans");
  if (value == nullptr) return scans;
  if (!value->is_object() || value->empty())
    refuse("scans",
           "must name at least one scan, for example {\"ct\": {\"path\": \"head.nrrd\"}}; leave it out if "
           "the plan only imports meshes and tiles contours");
  for (const auto& [name, entry] : value->items()) {
    const Keys keys(entry, "scans, " + name,
                    {"path", "sha256", "series", "join", "slices", "frame", "unit", "spacing_mm", "raw",
                     "other_identity"});
    ScanSource source{keys.text("path"), std::nullopt, read_options_of(keys)};
    if (keys.find("other_identity") != nullptr) source.other_identity = keys.flag("other_identity");
    if (keys.find("sha256") != nullptr) {
      source.sha256 = keys.text("sha256");
      const bool hex = source.sha256->size() == 64 &&
                       source.sha256->find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
      if (!hex) refuse(keys.at("sha256"), "must be 64 hexadecimal digits, or null");
      for (char& digit : *source.sha256)
        digit = static_cast<char>(std::tolower(static_cast<unsigned char>(digit)));
    }
    scans.emplace(name, std::move(source));
  }
  return scans;
}

/// The words that a step's `do` may have: the names of operations, and "export".
std::vector<std::string> step_words() {
  std::vector<std::string> words;
  for (const Operation& operation : operations()) words.push_back(operation.name);
  words.emplace_back("export");
  return words;
}

/// The operation of a step whose `do` is "export": the one that writes files with the extension of its path.
const char* export_of(const SortedJson& step) {
  const auto path = step.find("path");
  const std::string name = path != step.end() && path->is_string() ? path->get<std::string>() : "";
  for (const char* ending : {".inp", ".vtu", ".feb", ".msh", ".node"})
    if (name.ends_with(ending)) return "deck";
  for (const char* ending : {".nrrd", ".nii.gz", ".mha"})
    if (name.ends_with(ending)) return "label_map";
  return "surface";
}

Step step_of(const SortedJson& value, std::size_t index, Scope& scope) {
  FieldLocation place{"step " + std::to_string(index + 1), &scope};
  if (!value.is_object()) place.refuse("must be an object in braces, not " + type_of(value));
  if (const auto id = value.find("id"); id != value.end() && id->is_string())
    place.where = "step '" + id->get<std::string>() + "'";
  const auto found = value.find("do");
  if (found == value.end() || !found->is_string())
    place.refuse("'do' is missing" + suggestion("", step_words()));
  const std::string word = found->get<std::string>();
  const Operation* operation = find_operation(word == "export" ? export_of(value) : word);
  if (operation == nullptr)
    place.at("do").refuse("unknown step '" + word + "'" + suggestion(word, step_words()));
  const auto id = value.find("id");
  if (id == value.end() || id->is_null()) place.refuse("'id' is missing: add it");
  if (!id->is_string()) place.at("id").refuse("must be a text in quotes, not " + type_of(*id));
  Step step{id->get<std::string>(), Action(*operation)};
  try {
    read_fields(operation->fields, value, step.action.value(), place, {"id", "do"});
    need_fields_read(operation->fields, value, step.action.value(), place);
    if (operation->check) operation->check(step.action.value(), place);
  } catch (const std::exception& error) {
    // Refusals already state the place, so only internal errors need it here.
    if (fault_of(error) == Fault::Internal) rethrow_at(place.where + ": ", error);
    throw;
  }
  // Bound after its fields are read, so that a step cannot use its own result.
  scope.bind(place.where, step.id, *operation);
  return step;
}

const char* word(Makes makes) {
  switch (makes) {
    case Makes::Object:
      return "object";
    case Makes::Scan:
      return "scan";
    case Makes::Measurement:
      return "measurement";
    case Makes::File:
      return "file";
    case Makes::Names:
      return "names";
  }
  return "";
}

/// The JSON schema for steps of an operation. `x-makes` states what the step makes; a tool is an object that
/// only helps to make others. `x-moves` names the field with the object that the step moves rigidly.
Json step_schema(const Operation& operation) {
  Json schema{{"title", operation.name}, {"description", operation.says}};
  schema.update(fields_schema(operation.fields, operation.fresh().get()));
  Json properties{{"id", {{"type", "string"}, {"pattern", "^[A-Za-z_][A-Za-z0-9_]*$"}}},
                  {"do", {{"const", operation.name}}}};
  properties.update(schema["properties"]);
  schema["properties"] = properties;
  Json required{"id", "do"};
  for (const Json& name : schema.value("required", Json::array())) required.push_back(name);
  schema["required"] = required;
  schema["examples"] = Json::array({Json::parse(operation.example)});
  schema["x-makes"] = operation.is_tool ? "tool" : word(operation.makes);
  if (operation.is_motion) schema["x-moves"] = "object";
  return schema;
}

}  // namespace

Plan parse_plan(const std::string& json, const std::filesystem::path& folder) {
  SortedJson root = parse_json(json);
  if (root.is_object()) migrate(root, migrations());
  const Keys top(root, "", {"octotomy_plan", "name", "scans", "universe", "steps", "signatures"});
  top.need("octotomy_plan");
  Plan plan;
  plan.text = json;
  plan.folder = folder;
  plan.name = top.text("name");
  plan.scans = scans_of(top);
  signatures_of(json);  // refuses invalid signatures
  if (const SortedJson* universe = top.find("universe")) {
    const Keys keys(*universe, "universe", {"voxel_mm"});
    plan.voxel_mm = keys.number_if("voxel_mm");
    if (plan.voxel_mm && *plan.voxel_mm <= 0.0)
      refuse(keys.at("voxel_mm"), "must be above zero, for example 1.0");
  }
  const SortedJson& steps = top.need("steps");
  if (!steps.is_array() || steps.empty()) refuse("steps", "must be a list of at least one step");
  Scope scope(names_of(plan.scans), folder);
  for (const SortedJson& step : steps) plan.steps.push_back(step_of(step, plan.steps.size(), scope));
  const auto needs_no_scan = [](const Step& step) { return is_import(step.action) || is_tile(step.action); };
  if (plan.scans.empty() && std::none_of(plan.steps.begin(), plan.steps.end(), needs_no_scan))
    refuse("scans",
           "must name at least one scan, for example {\"ct\": {\"path\": \"head.nrrd\"}}, unless a step "
           "imports a "
           "mesh or tiles contours");
  plan.landmarks = scope.landmarks();
  plan.lps_from_head = scope.lps_from_head();
  return plan;
}

Plan read_plan(const std::filesystem::path& path) {
  voxel::need_regular_file(path);
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw std::runtime_error(path.string() + ": cannot be opened as a plan: check the path");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  try {
    Plan plan = parse_plan(text, std::filesystem::absolute(path).parent_path());
    plan.file = path;
    return plan;
  } catch (const std::exception& error) {
    rethrow_at(path.string() + ": ", error);
  }
}

std::filesystem::path scan_path(const Plan& plan, const ScanSource& scan) {
  return scan.path.is_absolute() ? scan.path : plan.folder / scan.path;
}

std::string verb(const Step& step) {
  return step.action.operation().name;
}

Json plan_schema() {
  const Json vector{{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 3}, {"maxItems", 3}};
  const Json raw{{"type", "object"},
                 {"properties",
                  {{"dims", vector},
                   {"type", {{"type", "string"}}},
                   {"big_endian", {{"type", "boolean"}}},
                   {"offset", {{"type", "integer"}, {"minimum", 0}}}}},
                 {"required", {"dims", "type"}},
                 {"additionalProperties", false}};
  const Json scan{{"type", "object"},
                  {"properties",
                   {{"path", {{"type", "string"}, {"minLength", 1}}},
                    {"sha256", {{"type", {"string", "null"}}, {"pattern", "^[0-9a-fA-F]{64}$"}}},
                    {"series", {{"type", "string"}}},
                    {"join", {{"type", "boolean"}}},
                    {"slices", {{"type", "string"}}},
                    {"frame", {{"type", "string"}}},
                    {"unit", {{"type", "string"}}},
                    {"spacing_mm", vector},
                    {"raw", raw},
                    {"other_identity", {{"type", "boolean"}}}}},
                  {"required", {"path"}},
                  {"additionalProperties", false}};
  Json steps = Json::array();
  for (const Operation& operation : operations()) steps.push_back(step_schema(operation));
  // Each of these operations is also written as "export", with a path of its extensions.
  for (const char* name : {"surface", "deck", "label_map"}) {
    Json schema = step_schema(*find_operation(name));
    schema["title"] = std::string("export, as ") + name;
    schema["properties"]["do"] = {{"const", "export"}};
    schema["examples"][0]["do"] = "export";
    steps.push_back(schema);
  }
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", "Octotomy plan"},
          {"description", "Ordered steps on scans. Lengths are in mm, angles in degrees, coordinates LPS."},
          {"type", "object"},
          {"properties",
           {{"octotomy_plan", {{"const", plan_version}}},
            {"name", {{"type", "string"}, {"minLength", 1}}},
            {"scans",
             {{"description", "May be left out if the plan only imports meshes or tiles contours."},
              {"type", "object"},
              {"minProperties", 1},
              {"additionalProperties", scan}}},
            {"universe",
             {{"type", "object"},
              {"properties", {{"voxel_mm", {{"type", "number"}, {"exclusiveMinimum", 0}}}}},
              {"additionalProperties", false}}},
            {"steps", {{"type", "array"}, {"minItems", 1}, {"items", {{"anyOf", steps}}}}},
            {"signatures",
             {{"description", "Readers who have approved the plan, as written by octotomy plan sign."},
              {"type", "array"},
              {"items",
               {{"type", "object"},
                {"properties",
                 {{"by", {{"type", "string"}, {"minLength", 1}}},
                  {"as", {{"type", "string"}, {"minLength", 1}}},
                  {"note", {{"type", "string"}}},
                  {"at", {{"type", "string"}, {"minLength", 1}}},
                  {"plan_sha256", {{"type", "string"}, {"minLength", 1}}},
                  {"scans_sha256", {{"type", "object"}, {"additionalProperties", {{"type", "string"}}}}}}},
                {"required", {"by", "as", "at", "plan_sha256", "scans_sha256"}},
                {"additionalProperties", false}}}}}}},
          {"required", {"octotomy_plan", "name", "steps"}},
          {"additionalProperties", false}};
}

}  // namespace octotomy::planner

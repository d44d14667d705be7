// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/plan.h"

namespace octotomy::planner {
namespace {

/// Whether a value fits a schema made of the words that plan_schema() uses; `why` receives the first misfit.
bool fits(const SortedJson& value, const SortedJson& schema, const std::string& where, std::string& why) {
  const auto misfit = [&](const std::string& what) {
    if (why.empty()) why = where + ": " + what;
    return false;
  };
  if (schema.contains("const") && value != schema["const"]) return misfit("is not " + schema["const"].dump());
  if (schema.contains("enum") &&
      std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end())
    return misfit("is none of " + schema["enum"].dump());
  for (const char* choice : {"anyOf", "oneOf"})
    if (schema.contains(choice)) {
      std::string reasons;
      for (const SortedJson& one : schema[choice]) {
        std::string reason;
        if (fits(value, one, where, reason)) return true;
        reasons += "\n  " + one.value("title", "") + ": " + reason;
      }
      return misfit("fits no alternative" + reasons);
    }
  if (schema.contains("type")) {
    const auto is = [&](const std::string& type) {
      return type == "object"    ? value.is_object()
             : type == "array"   ? value.is_array()
             : type == "string"  ? value.is_string()
             : type == "boolean" ? value.is_boolean()
             : type == "null"    ? value.is_null()
             : type == "integer" ? value.is_number() && value.get<double>() == std::trunc(value.get<double>())
                                 : value.is_number();
    };
    const SortedJson types = schema["type"].is_array() ? schema["type"] : SortedJson::array({schema["type"]});
    if (std::none_of(types.begin(), types.end(),
                     [&](const SortedJson& type) { return is(type.get<std::string>()); }))
      return misfit("is no " + schema["type"].dump());
  }
  if (value.is_number()) {
    const double number = value.get<double>();
    if (number <= schema.value("exclusiveMinimum", -1e300) || number < schema.value("minimum", -1e300) ||
        number > schema.value("maximum", 1e300) || number >= schema.value("exclusiveMaximum", 1e300))
      return misfit("is out of its range");
  }
  if (value.is_array()) {
    if (value.size() < schema.value("minItems", 0u) || value.size() > schema.value("maxItems", 1000000u))
      return misfit("has too few or too many entries");
    for (std::size_t i = 0; schema.contains("items") && i < value.size(); ++i)
      if (!fits(value[i], schema["items"], where + "[" + std::to_string(i) + "]", why)) return false;
  }
  if (value.is_object()) {
    if (value.size() < schema.value("minProperties", 0u)) return misfit("has too few keys");
    for (const SortedJson& name : schema.value("required", SortedJson::array()))
      if (!value.contains(name.get<std::string>())) return misfit("lacks " + name.dump());
    for (const auto& [key, entry] : value.items()) {
      const SortedJson properties = schema.value("properties", SortedJson::object());
      const SortedJson others = schema.value("additionalProperties", SortedJson(true));
      if (properties.contains(key)) {
        if (!fits(entry, properties[key], where + "/" + key, why)) return false;
      } else if (others.is_object()) {
        if (!fits(entry, others, where + "/" + key, why)) return false;
      } else if (others == false) {
        return misfit("does not know " + key);
      }
    }
  }
  return true;
}

SortedJson schema() {
  return SortedJson::parse(plan_schema().dump());
}

TEST(Schema, EveryPlanOfTheProjectFits) {
  int plans = 0;
  for (const char* folder : {"/planner", "/tests/planner/data"})
    for (const auto& entry : std::filesystem::directory_iterator(std::string(OCTOTOMY_SOURCE_DIR) + folder)) {
      if (!entry.path().filename().string().ends_with(".plan.json")) continue;
      std::ifstream file(entry.path());
      std::string why;
      EXPECT_TRUE(fits(SortedJson::parse(file), schema(), "", why)) << entry.path() << why;
      ++plans;
    }
  EXPECT_GE(plans, 3);
}

/// The plans that a page of the manual holds in blocks of JSON.
std::vector<SortedJson> plans_on(const std::filesystem::path& page) {
  std::ifstream file(page);
  const std::string text{std::istreambuf_iterator<char>(file), {}}, open = "```json\n{ \"octotomy_plan\"";
  std::vector<SortedJson> plans;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at + 1)) {
    const std::size_t first = text.find('{', at);
    plans.push_back(SortedJson::parse(text.substr(first, text.find("```", first) - first)));
  }
  return plans;
}

TEST(Schema, EveryPlanOfTheManualFitsButTheOneWithASlip) {
  int plans = 0, slips = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(OCTOTOMY_SOURCE_DIR) + "/planner/manual")) {
    if (entry.path().extension() != ".md") continue;
    for (const SortedJson& plan : plans_on(entry.path())) {
      const bool slip = plan["name"] == "A slip";
      std::string why;
      EXPECT_EQ(fits(plan, schema(), "", why), !slip) << entry.path() << why;
      ++plans;
      slips += slip;
    }
  }
  EXPECT_GE(plans, 8);
  EXPECT_EQ(slips, 1);
}

TEST(Schema, EveryExampleOfAnOperationFitsItsOwnAlternative) {
  const SortedJson whole = schema();
  for (const SortedJson& step : whole["properties"]["steps"]["items"]["anyOf"]) {
    std::string why;
    EXPECT_TRUE(fits(step["examples"][0], step, step["title"], why)) << why;
  }
}

TEST(Schema, ASpoiledPlanDoesNotFit) {
  std::ifstream file(std::string(OCTOTOMY_SOURCE_DIR) + "/planner/le_fort_i.plan.json");
  const SortedJson plan = SortedJson::parse(file);
  const auto refuses = [&](const char* pointer, const SortedJson& value) {
    SortedJson spoiled = plan;
    spoiled[SortedJson::json_pointer(pointer)] = value;
    std::string why;
    EXPECT_FALSE(fits(spoiled, schema(), "", why)) << pointer << " = " << value;
  };
  refuses("/steps/0/do", "windw");
  refuses("/steps/0/low", "300");
  refuses("/steps/0/lower", 300);
  refuses("/steps/4/rotate/axis", {1, 0});
  refuses("/universe/voxel_mm", 0);
  refuses("/scans", SortedJson::object());
  refuses("/octotomy_plan", 2);
}

}  // namespace
}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/operation.h"

#include <gtest/gtest.h>
#include <set>

#include "planner/operation/table/field_json.h"
#include "planner/operation/table/json.h"
#include "planner/plan/plan.h"

namespace octotomy::planner {
namespace {

/// A scope in which the example's objects are bound.
Scope scope_for(const Operation& operation, const SortedJson& example) {
  Scope scope({"ct"});
  const auto bind = [&](const std::string& name, const char* maker) {
    try {
      scope.need_object("", name);
    } catch (const std::runtime_error&) {
      scope.bind("", name, *find_operation(maker));
    }
  };
  for (const char* name : {"skull", "cut", "maxilla", "rest", "soft", "tumour"}) bind(name, "window");
  bind("advanced", "move");
  bind("sawn", "saw");
  bind("left_1", "screw");
  for (const char* name : {"upper_lip", "lower_lip", "subnasale", "incisor", "a_point"})
    scope.bind_landmark("", {name, {}});
  EXPECT_EQ(example.at("do"), operation.name);
  return scope;
}

TEST(Operation, EveryExampleIsReadAndPrintedBackToTheSame) {
  ASSERT_GE(operations().size(), 8u);
  std::set<std::string> names;
  for (const Operation& operation : operations()) {
    EXPECT_TRUE(names.insert(operation.name).second) << operation.name << " is in the table twice";
    const SortedJson example = SortedJson::parse(operation.example);
    Scope scope = scope_for(operation, example);
    Action action(operation), again(operation);
    const FieldLocation place{operation.name, &scope};
    read_fields(operation.fields, example, action.value(), place, {"id", "do"});
    if (operation.check) operation.check(action.value(), place);
    const auto printed = print_fields(operation.fields, action.value());
    read_fields(operation.fields, SortedJson::parse(printed.dump()), again.value(), place);
    EXPECT_EQ(print_fields(operation.fields, again.value()).dump(), printed.dump()) << operation.name;
    SortedJson given = example;
    given.erase("id");
    given.erase("do");
    const SortedJson back = SortedJson::parse(printed.dump());
    for (const auto& [key, value] : given.items()) EXPECT_EQ(back.at(key), value) << operation.name;
  }
}

TEST(Operation, EveryFieldSaysWhatItIsInOneSentence) {
  const std::function<void(const std::vector<Field>&, const std::string&)> look =
      [&](const std::vector<Field>& fields, const std::string& where) {
        for (const Field& field : fields) {
          EXPECT_TRUE(field.says.ends_with(".")) << where << ", " << field.name << ": " << field.says;
          look(field.fields, where + ", " + field.name);
        }
      };
  for (const Operation& operation : operations()) {
    EXPECT_TRUE(operation.says.ends_with(".")) << operation.name;
    look(operation.fields, operation.name);
    look(operation.verb_fields, operation.name);
    const bool is_whole = operation.makes == Makes::Object
                              ? (operation.voxel || operation.mesh) && operation.bound
                          : operation.makes == Makes::Scan        ? static_cast<bool>(operation.scan)
                          : operation.makes == Makes::Measurement ? static_cast<bool>(operation.measure)
                          : operation.makes == Makes::Names       ? static_cast<bool>(operation.check)
                                                                  : static_cast<bool>(operation.write);
    EXPECT_TRUE(is_whole) << operation.name;
  }
}

TEST(Operation, ARequiredFieldAWrongTypeAndANumberOutOfItsRangeAreRefusedByPlace) {
  const Operation& deck = *find_operation("deck");
  const auto refusal = [&](const char* text) -> std::string {
    Action action(deck);
    try {
      read_fields(deck.fields, SortedJson::parse(text), action.value(), {"step 'd'", nullptr});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(R"({"object": "a", "path": "a.inp"})"), "");
  EXPECT_EQ(refusal(R"({"path": "a.inp"})"), "step 'd': 'object' is missing: add it");
  EXPECT_EQ(refusal(R"({"object": 3, "path": "a.inp"})"),
            "step 'd', object: must be a text in quotes, not a number");
  EXPECT_EQ(refusal(R"({"object": "a", "path": "a.inp", "element_mm": 0})"),
            "step 'd', element_mm: must be above zero, for example 3.0");
  EXPECT_EQ(refusal(R"({"object": "a", "path": "a.inp", "order": 3})"),
            "step 'd', order: must be from 1 to 2");
  EXPECT_NE(refusal(R"({"object": "a", "path": "a.inp", "ordr": 3})").find("did you mean 'order'?"),
            std::string::npos);
  EXPECT_EQ(refusal(R"({"object": "a", "path": "a.inp", "materials": {"a": {"youngs_modulus_mpa": 1,
                        "poisson_ratio": 0.5}}})"),
            "step 'd', materials, a, poisson_ratio: must be from 0 to less than 0.5, for example 0.45");
}

TEST(Operation, ObjectsAndScansUsedAreFoundInEveryKindOfField) {
  const Operation& deck = *find_operation("deck");
  Action action(deck);
  read_fields(deck.fields,
              SortedJson::parse(R"({"object": "a", "path": "a.inp", "moved": ["b", "c"], "fixed": ["b"],
                              "finer": [{"at": [0, 0, 0], "size_mm": 1}, {"at": "d", "size_mm": 1}]})"),
              action.value(), {});
  EXPECT_EQ(objects_used(action), (std::vector<std::string>{"a", "b", "c", "d"}));
  Action window(*find_operation("window"));
  read_fields(window.operation().fields, SortedJson::parse(R"({"scan": "ct", "low": 3})"), window.value(),
              {});
  EXPECT_EQ(scans_used(window), std::vector<std::string>{"ct"});
}

}  // namespace
}  // namespace octotomy::planner

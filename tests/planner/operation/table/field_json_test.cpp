// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/field_json.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace octotomy::planner {
namespace {

struct Drawn {
  bool curved = false, flag = false;
  double height_mm = 1.0;
  std::vector<double> list;
};

std::vector<Field> fields() {
  const auto is_curved = [](const Drawn& drawn) { return drawn.curved; };
  return {field("curved", &Drawn::curved, "Whether it is."),
          field("height_mm", &Drawn::height_mm, "Of a curve.")
              .greater_than(0.0)
              .read_if<Drawn>(is_curved, "is of curves: add 'curved'")
              .read_if<Drawn>([](const Drawn& drawn) { return !drawn.flag; }, "is not of flags"),
          field("flag", &Drawn::flag, "A flag.").read_if<Drawn>(is_curved, "is of curves"),
          field("list", &Drawn::list, "A list.").read_if<Drawn>(is_curved, "is of curves")};
}

/// The text of the refusal; empty if there is none.
std::string refusal(const nlohmann::json& given) {
  Drawn drawn;
  read_fields(fields(), given, &drawn, {"step 'a'"});
  try {
    need_fields_read(fields(), given, &drawn, {"step 'a'"});
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST(NeedFieldsRead, AFieldIsRefusedWhereAConditionIsNotMetWhateverItsValue) {
  EXPECT_EQ(refusal({{"height_mm", 1.0}}), "step 'a', height_mm: is of curves: add 'curved'");
  EXPECT_EQ(refusal({{"height_mm", 2.0}, {"curved", true}}), "");
  EXPECT_EQ(refusal({{"height_mm", 2.0}, {"curved", true}, {"flag", true}}),
            "step 'a', height_mm: is not of flags");
}

TEST(NeedFieldsRead, WhatGivesNothingIsNotRefused) {
  EXPECT_EQ(refusal({{"flag", false}, {"list", nlohmann::json::array()}, {"height_mm", nullptr}}), "");
  EXPECT_EQ(refusal({{"flag", true}}), "step 'a', flag: is of curves");
  EXPECT_EQ(refusal({{"list", {1.0}}}), "step 'a', list: is of curves");
}

TEST(PrintFields, LeavesOutAFieldWhoseConditionIsNotMet) {
  Drawn drawn;
  read_fields(fields(), {{"height_mm", 2.5}}, &drawn, {});
  EXPECT_EQ(drawn.height_mm, 2.5);
  EXPECT_FALSE(print_fields(fields(), &drawn).contains("height_mm"));
  drawn.curved = true;
  EXPECT_EQ(print_fields(fields(), &drawn)["height_mm"], 2.5);
}

}  // namespace
}  // namespace octotomy::planner

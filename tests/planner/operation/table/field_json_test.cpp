// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/field_json.h"

#include <gtest/gtest.h>
#include <memory>
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

struct Skewed {
  struct Part {
    double by = 0.0;
    glm::dvec3 along{1, 0, 0};
  };
  std::optional<Part> part;
  std::optional<glm::dmat4> matrix;
};

TEST(JsonOfWords, ARecordAndAMatrixAreReadFromAWordOfJson) {
  const std::vector<Field> of_skewed{
      record("part", &Skewed::part, "A part.",
             {field("by", &Skewed::Part::by, "How far."), field("along", &Skewed::Part::along, "Its way.")})
          .for_example(R"({"by": 2})"),
      field("matrix", &Skewed::matrix, "A matrix.")};
  const auto read = [&](std::size_t at, const std::string& word) {
    Skewed skewed;
    const nlohmann::json json{{of_skewed[at].name, json_of_words(of_skewed[at], &skewed, {word})}};
    read_fields(of_skewed, json, &skewed, {"--" + of_skewed[at].name});
    return skewed;
  };
  const Skewed part = read(0, R"({"by": 0.5, "along": [0, 0, 1]})");
  ASSERT_TRUE(part.part);
  EXPECT_EQ(part.part->by, 0.5);
  EXPECT_EQ(part.part->along, glm::dvec3(0, 0, 1));
  const Skewed matrix = read(1, "[[1,0,0,7],[0,2,0,0],[0,0,3,0],[0,0,0,1]]");
  ASSERT_TRUE(matrix.matrix);
  EXPECT_EQ((*matrix.matrix)[3][0], 7.0) << "row by row";
  EXPECT_EQ((*matrix.matrix)[2][2], 3.0);
  EXPECT_EQ(word_form(of_skewed[0], std::make_unique<Skewed>().get()), "JSON");
  EXPECT_EQ(word_form(of_skewed[1], std::make_unique<Skewed>().get()), "JSON");
  const auto refusal = [&](std::size_t at, const std::string& word) -> std::string {
    try {
      read(at, word);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(refusal(0, "{by: 0.5}"), R"('{by: 0.5}' is not JSON, for example {"by": 2})");
  EXPECT_NE(refusal(0, "0.5").find("must be an object in braces"), std::string::npos);
  EXPECT_NE(refusal(1, "[[1,0],[0,1]]").find("four rows of four numbers"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner

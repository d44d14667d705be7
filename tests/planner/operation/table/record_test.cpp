// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/record.h"

#include <gtest/gtest.h>
#include <limits>

namespace octotomy::planner {
namespace {

struct Inner {
  std::string name;
  double length_mm = 0.0;
};
constexpr auto members_of(const Inner&) {
  return std::tuple(member("name", &Inner::name), member("length_mm", &Inner::length_mm));
}

struct Outer {
  glm::dvec3 at_mm{0.0};
  std::optional<double> area_mm2;
  std::optional<Inner> first;
  std::vector<Inner> inner;
  bool held = false;
  int count = 7;
  std::vector<std::string> findings;
};
constexpr auto members_of(const Outer&) {
  using O = Outer;
  return std::tuple(member("at_mm", &O::at_mm), member("area_mm2", &O::area_mm2),
                    member_if_any("first", &O::first), member("inner", &O::inner), member("held", &O::held),
                    member("count", &O::count), member_if_any("findings", &O::findings));
}

TEST(Record, PrintsItsMembersInOrderAndWhatIsEmptyAsNullOrNotAtAll) {
  Outer outer;
  outer.at_mm = {1, 2.5, -3};
  EXPECT_EQ(print_record(outer).dump(),
            R"({"at_mm":[1.0,2.5,-3.0],"area_mm2":null,"inner":[],"held":false,"count":7})");
  outer.area_mm2 = 0.1;
  outer.first = Inner{"a", 1.0};
  outer.inner = {{"b", 2.0}, {"c", std::numeric_limits<double>::infinity()}};
  outer.findings = {"said"};
  EXPECT_EQ(print_record(outer).dump(),
            R"({"at_mm":[1.0,2.5,-3.0],"area_mm2":0.1,"first":{"name":"a","length_mm":1.0},)"
            R"("inner":[{"name":"b","length_mm":2.0},{"name":"c","length_mm":null}],)"
            R"("held":false,"count":7,"findings":["said"]})");
}

TEST(Record, ReadsBackWhatItPrints) {
  Outer outer;
  outer.at_mm = {1, 2.5, -3};
  outer.first = Inner{"a", 1.0};
  outer.inner = {{"b", 2.0}};
  outer.held = true;
  outer.count = -3;
  outer.findings = {"said", "twice"};
  const Json json = print_record(outer);
  EXPECT_EQ(print_record(record_of<Outer>(json)), json);
  EXPECT_EQ(print_record(record_of<Outer>(Json::parse(json.dump()))), json);
}

TEST(Record, KeepsItsValueForAKeyThatIsMissingOrOfAnotherType) {
  const auto outer = record_of<Outer>(
      Json::parse(R"({"held": "yes", "count": 1.5, "at_mm": [1, 2], "inner": {}, "findings": [3, "a"]})"));
  EXPECT_FALSE(outer.held);
  EXPECT_EQ(outer.count, 7);
  EXPECT_EQ(outer.at_mm, glm::dvec3(0.0));
  EXPECT_TRUE(outer.inner.empty());
  EXPECT_EQ(outer.findings, (std::vector<std::string>{"", "a"}));
  EXPECT_EQ(record_of<Outer>(Json("text")).count, 7);
}

}  // namespace
}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/template/formula.h"

#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

const std::map<std::string, double> names{{"ans.x", 2.0}, {"kerf_mm", 0.5}};

std::string refusal(const char* formula) {
  try {
    value_of(formula, names);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Formula, OperatorsBindAsInArithmetic) {
  EXPECT_EQ(value_of("1 + 2*3 - 4/2", names), 5.0);
  EXPECT_EQ(value_of("2 - 3 - 4", names), -5.0);
  EXPECT_EQ(value_of("12 / 3 / 2", names), 2.0);
  EXPECT_EQ(value_of("-(ans.x + kerf_mm) * -2", names), 5.0);
  EXPECT_EQ(value_of(" min(3, ans.x) + max(1,abs(-7)) ", names), 9.0);
  EXPECT_EQ(value_of("max(1, 5, 3) - min(4, 2, 3, 6)", names), 3.0);
  EXPECT_EQ(value_of("1.5e1", names), 15.0);
  EXPECT_EQ(value_of("hypot(3, 2 * 2)", names), 5.0);
  EXPECT_NEAR(value_of("asin_deg(1 / 2)", names), 30.0, 1e-12);
}

TEST(Formula, RefusalsSayWhereAndWhat) {
  EXPECT_NE(
      refusal("1 + ans.y").find("character 5: there is no value or landmark 'ans.y', did you mean 'ans.x'?"),
      std::string::npos)
      << refusal("1 + ans.y");
  EXPECT_NE(refusal("(1 + 2").find("expected ')'"), std::string::npos);
  EXPECT_NE(refusal("1 2").find("expected an operator or the end"), std::string::npos);
  EXPECT_NE(refusal("").find("expected a number"), std::string::npos);
  EXPECT_NE(refusal("1 / (kerf_mm - 0.5)").find("a division by zero"), std::string::npos);
  EXPECT_NE(refusal("sin(1)").find("there is no function 'sin'"), std::string::npos);
  EXPECT_NE(refusal("hypot(1)").find("no function 'hypot' of 1"), std::string::npos);
  EXPECT_NE(refusal("asin_deg(1.5)").find("from -1 to 1"), std::string::npos);
  EXPECT_NE(refusal(std::string(100000, '(').c_str()).find("too many parentheses"), std::string::npos);
}

TEST(SumOf, NamesAreTermsAndFactorsAreMultipliedOut) {
  const Sum sum = sum_of("2 * (ans.x - kerf_mm / 4) - -ans.x + 3 * (1 + kerf_mm) - 5");
  EXPECT_EQ(sum.terms, (std::map<std::string, double>{{"ans.x", 3.0}, {"kerf_mm", 2.5}}));
  EXPECT_EQ(sum.constant, -2.0);
  EXPECT_TRUE(sum_of("ans.x + 2 - ans.x").terms.empty());
  EXPECT_EQ(sum_of("max(3, hypot(3, 4))").constant, 5.0);
}

TEST(SumOf, WhatIsNoSumIsOneTermWhichSameFormulasShare) {
  const Sum far = sum_of("max(rim_1.x, rim_2.x) + (reach_mm + 1)"), near = sum_of("max(rim_1.x,rim_2.x) - 4");
  EXPECT_EQ(far.terms.size(), 2u);
  EXPECT_EQ(far.terms.at("reach_mm"), 1.0);
  for (const auto& [name, factor] : near.terms) EXPECT_EQ(far.terms.at(name), factor) << name;
  EXPECT_EQ(sum_of("a * b - a * b + a / b").terms.size(), 1u) << "the quotient";
  EXPECT_NE(sum_of("max(a, b)").terms, sum_of("max(b, a)").terms);
  EXPECT_THROW(sum_of("a / (1 - 1)"), std::runtime_error);
  EXPECT_THROW(sum_of("sin(a)"), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner

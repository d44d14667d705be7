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
  EXPECT_NE(refusal("1 + ans.y").find("at 5: nothing is called 'ans.y', did you mean 'ans.x'?"),
            std::string::npos)
      << refusal("1 + ans.y");
  EXPECT_NE(refusal("(1 + 2").find("expected ')'"), std::string::npos);
  EXPECT_NE(refusal("1 2").find("expected an operator or the end"), std::string::npos);
  EXPECT_NE(refusal("").find("expected a number"), std::string::npos);
  EXPECT_NE(refusal("1 / (kerf_mm - 0.5)").find("divides by zero"), std::string::npos);
  EXPECT_NE(refusal("sin(1)").find("there is no function 'sin'"), std::string::npos);
  EXPECT_NE(refusal("hypot(1)").find("no function 'hypot' of 1"), std::string::npos);
  EXPECT_NE(refusal("asin_deg(1.5)").find("from -1 to 1"), std::string::npos);
  EXPECT_NE(refusal(std::string(100000, '(').c_str()).find("too many parentheses"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/exact_boolean.h"

#include <gtest/gtest.h>
#include <stop_token>

#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(ExactBoolean, VolumesAddUpAsRationalsAndAgreeWithTheRoundedKernel) {
  const Solid a = solid_of(shapes::sphere({0.1, 0.2, 0.3}, 3, 2)),
              b = solid_of(shapes::sphere({2.1, 0.5, 0.7}, 2, 2));
  for (const Operation operation : {Operation::Union, Operation::Intersection, Operation::Difference}) {
    const ExactBoolean exact = exact_boolean(a, operation, b);
    EXPECT_NEAR(exact.a_mm3 + exact.b_mm3, exact.united_mm3 + exact.intersection_mm3, 1e-12);
    EXPECT_NEAR(exact.result_mm3, volume_mm3(boolean(a, operation, b).solid), 1e-11);
    EXPECT_LT(std::abs(exact.rounding_mm3), 1e-11);
    EXPECT_GT(exact.points, 0u);
  }
}

TEST(ExactBoolean, BoxesHaveTheirExactVolumes) {
  const ExactBoolean exact = exact_boolean(solid_of(shapes::box({0, 0, 0}, {2, 2, 2})), Operation::Difference,
                                           solid_of(shapes::box({1, 1, 1}, {3, 3, 3})));
  EXPECT_EQ(exact.result_mm3, 7.0);
  EXPECT_EQ(exact.points, 0u);
}

TEST(ExactBoolean, RefusesWhatHasNoSolidAnswer) {
  const Triangles box = shapes::box({0, 0, 0}, {2, 2, 2});
  EXPECT_THROW(exact_boolean(solid_of(box), Operation::Union, solid_of(shapes::box({2, 2, 0}, {4, 4, 2}))),
               std::runtime_error);
  Triangles open = box;
  open.faces.pop_back();
  EXPECT_THROW(exact_boolean(trusted_solid(open, Proof::Rounded), Operation::Union, solid_of(box)),
               std::invalid_argument);
  EXPECT_THROW(exact_boolean(solid_of(box), Operation::Union,
                             trusted_solid(shapes::inside_out(box), Proof::Connection)),
               std::invalid_argument);
}

TEST(ExactBoolean, SolidsThatTouchAtAnEdgeHaveNothingInCommon) {
  const Solid a = solid_of(shapes::box({0, 0, 0}, {2, 2, 2})),
              b = solid_of(shapes::box({2, 2, 0}, {4, 4, 2}));
  const ExactBoolean common = exact_boolean(a, Operation::Intersection, b);
  EXPECT_TRUE(common.solid.empty());
  EXPECT_EQ(common.result_mm3, 0.0);
  EXPECT_EQ(common.united_mm3, 16.0);
  EXPECT_EQ(exact_boolean(a, Operation::Difference, b).result_mm3, 8.0);
}

TEST(ExactBoolean, AnOperandThatMeetsItselfDoesNotPassForASolid) {
  // Two balls in one mesh that overlap: their common part counts twice in the volume but not in the result.
  const Triangles twice =
      shapes::together(shapes::sphere({0, 0, 0}, 2, 2), shapes::sphere({1, 0.1, 0.2}, 2, 2));
  EXPECT_ANY_THROW(exact_boolean(trusted_solid(twice, Proof::Connection), Operation::Union,
                                 solid_of(shapes::box({-3, -3, 0.31}, {0.7, 3, 3}))));
}

TEST(ExactBoolean, ReportsItsProgressAndStopsWhenAsked) {
  const Solid a = solid_of(shapes::sphere({0, 0, 0}, 3, 2)),
              b = solid_of(shapes::sphere({2, 0.3, 0.4}, 2, 2));
  std::stop_source source;
  double last = 0.0;
  const Progress progress{source.get_token(), [&](double fraction) {
                            EXPECT_GE(fraction, last);
                            last = fraction;
                            if (fraction > 0.3) source.request_stop();
                          }};
  EXPECT_THROW(exact_boolean(a, Operation::Union, b, progress), Stopped);
  EXPECT_GT(last, 0.3);
  EXPECT_LT(last, 0.9) << "it went on after the stop";
}

TEST(ExactBoolean, AnOperandThatTouchesItselfWithinTheOtherIsRefused) {
  const Solid touching = trusted_solid(
      shapes::together(shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({2, 2, 0}, {4, 4, 2})), Proof::Rounded);
  const Solid around = solid_of(shapes::box({1, 1, -1}, {3, 3, 3})),
              beside = solid_of(shapes::box({-1, -1, -1}, {1, 1, 1}));
  try {
    exact_boolean(touching, Operation::Intersection, around);
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Geometry);
    EXPECT_NE(std::string(error.what()).find("operand a touches itself at (2, 2, "), std::string::npos)
        << error.what();
  }
  EXPECT_DOUBLE_EQ(exact_boolean(touching, Operation::Intersection, beside).result_mm3, 1.0);
}

}  // namespace
}  // namespace octotomy::brep

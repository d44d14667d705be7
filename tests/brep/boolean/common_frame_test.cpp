// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/common_frame.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "brep/boolean/boolean.h"
#include "brep/mesh/health.h"
#include "tests/brep/shapes.h"
#include "tests/brep/told.h"

namespace octotomy::brep {
namespace {

using tests::told;

glm::dmat4 pose(int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> place(-50.0, 50.0), angle(0.1, 3.0);
  std::normal_distribution<double> along;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(along(random), along(random), along(random)));
  const glm::dvec3 to(place(random), place(random), place(random));
  return glm::rotate(glm::translate(glm::dmat4(1.0), to), angle(random), axis);
}

/// A surface turned point by point; rounded to single precision, as in files, if requested.
Solid turned(Triangles surface, const glm::dmat4& pose, bool as_floats = false) {
  for (glm::dvec3& p : surface.points_mm) {
    p = glm::dvec3(pose * glm::dvec4(p, 1.0));
    if (as_floats) p = glm::dvec3(glm::vec3(p));
  }
  return solid_of(surface);
}

TEST(CommonFrame, FlushBoxesTurnedAsOneHaveTheirVolumesAndDoNotCrossThemselves) {
  const glm::dvec3 extent(3, 2, 4);
  const std::array<std::array<glm::dvec3, 2>, 4> others{{{{{3, 0.3, -0.2}, {5, 1.5, 2}}},
                                                         {{{0, 0, 0}, {1.5, 1.2, 2.8}}},
                                                         {{{-0.3, 0.2, 0}, {1.8, 2.3, 2}}},
                                                         {{{1.2, -0.3, 0}, {4, 1, 4}}}}};
  int framed = 0;
  for (int seed = 0; seed < 40; ++seed) {
    const auto& [low, high] = others.at(static_cast<std::size_t>(seed) % others.size());
    const Solid a = turned(shapes::box({0, 0, 0}, extent), pose(seed));
    const Solid b = turned(shapes::box(low, high), pose(seed));
    framed += common_frame(a, b).has_value();
    const glm::dvec3 common = glm::max(glm::min(extent, high) - glm::max(glm::dvec3(0.0), low), 0.0);
    const double both = common.x * common.y * common.z, whole = extent.x * extent.y * extent.z;
    const glm::dvec3 other = high - low;
    const Booleans made = booleans(a, b);
    const auto expect = [&](const std::optional<Solid>& result, double mm3, const char* what) {
      ASSERT_TRUE(result) << what << ", pose " << seed;
      EXPECT_NEAR(volume_mm3(*result), mm3, 1e-9 * whole) << what << ", pose " << seed;
      if (result->empty()) return;
      const Health found = health(result->triangles());
      EXPECT_TRUE(found.solid()) << what << ", pose " << seed << ": " << told(found);
    };
    expect(made.united, whole + other.x * other.y * other.z - both, "union");
    expect(made.intersection, both, "intersection");
    expect(made.a_minus_b, whole - both, "difference");
    EXPECT_EQ(made.shift_mm, 0.0) << "pose " << seed;
  }
  EXPECT_EQ(framed, 40);
}

TEST(CommonFrame, PointsOfTheOperandsComeBackAsTheyWere) {
  const Solid a = turned(shapes::box({0, 0, 0}, {3, 2, 4}), pose(7));
  const Solid b = turned(shapes::box({3, 0, 0}, {5, 2, 4}), pose(7));
  const std::optional<CommonFrame> frame = common_frame(a, b);
  ASSERT_TRUE(frame);
  EXPECT_LT(frame->moved_mm, 1e-12);
  EXPECT_EQ(frame->moved_back(frame->a.triangles()).points_mm, a.triangles().points_mm);
}

TEST(CommonFrame, PointsRoundedToFloatsCountAsOnOnePlaneAndTheFindingSaysHowFarTheyMoved) {
  const Solid a = turned(shapes::box({0, 0, 0}, {3, 2, 4}), pose(3), true);
  const Solid b = turned(shapes::box({0, 0, 0}, {1.4, 1.1, 2.3}), pose(3), true);
  const BooleanResult made = boolean(a, Operation::Difference, b);
  const Health found = health(made.solid.triangles());
  EXPECT_TRUE(found.solid()) << told(found);
  EXPECT_NEAR(volume_mm3(made.solid), 24.0 - 1.4 * 1.1 * 2.3, 1e-3);
  ASSERT_EQ(made.findings.size(), 1U);
  EXPECT_TRUE(made.findings[0].starts_with("coplanar: ")) << made.findings[0];
}

TEST(CommonFrame, SolidsWithoutACommonPlaneOrAlongTheAxesNeedNone) {
  const Solid box = solid_of(shapes::box({0, 0, 0}, {3, 2, 4}));
  EXPECT_FALSE(common_frame(box, solid_of(shapes::box({1, 0, 0}, {2, 2, 6})))) << "exact already";
  EXPECT_FALSE(common_frame(box, turned(shapes::box({1, 0.1, 0.2}, {2, 1, 3}), pose(1))));
  EXPECT_FALSE(common_frame(box, solid_of(shapes::box({30, 0, 0}, {33, 2, 4})))) << "apart";
  EXPECT_FALSE(common_frame(box, Solid()));
}

}  // namespace
}  // namespace octotomy::brep

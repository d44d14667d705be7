// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/mirror.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <numbers>

#include "brep/boolean/boolean.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

/// A head that is its own mirror image about x = 0 and about no other plane: long, with a nose, and leaning.
Triangles head() {
  Triangles t = shapes::sphere({0, 0, 0}, 1, 4);
  for (glm::dvec3& p : t.points_mm) {
    const double nose = std::exp(-8.0 * (p.x * p.x + (p.y + 1) * (p.y + 1) + p.z * p.z));
    p = glm::dvec3(70 * p.x, 90 * p.y - 30 * nose + 15 * p.z * p.z, 110 * p.z + 20 * p.y);
  }
  return t;
}

TEST(Mirror, AMirrorImageIsASolidAndTwiceIsTheSame) {
  const Solid still = solid_of(head());
  const MirrorPlane plane{{1, 2, 3}, {2, -1, 0.5}};
  const Solid image = mirrored(still, plane), back = mirrored(image, plane);
  EXPECT_TRUE(health(image).solid());
  EXPECT_NEAR(volume_mm3(image), volume_mm3(still), 1e-9 * volume_mm3(still));
  for (const auto v : still.mesh().vertices()) {
    EXPECT_LT((back.mesh().point(v) - still.mesh().point(v)).norm(), 1e-12 * 200);
    // The plane lies half way between a point and its image.
    const auto middle = 0.5 * (image.mesh().point(v) + still.mesh().point(v));
    EXPECT_NEAR(
        glm::dot(glm::dvec3(middle[0], middle[1], middle[2]) - plane.point_mm, glm::normalize(plane.normal)),
        0.0, 1e-11);
  }
  EXPECT_THROW(mirrored(still, {{0, 0, 0}, {0, 0, 0}}), std::invalid_argument);
}

TEST(Mirror, TheMidPlaneOfAHeadIsFoundWhereverItStands) {
  for (const int seed : {1, 3}) {
    const glm::dmat4 motion = glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(30, -40, 10 * seed)),
                                          0.4 * seed, glm::normalize(glm::dvec3(1, 0.5 * seed, -0.3)));
    const MirrorFit fit = fit_mirror_plane(moved(mesh_of(head()), motion));
    const glm::dvec3 normal(motion[0]), on_plane(motion[3]);
    EXPECT_GT(std::abs(glm::dot(fit.plane.normal, normal)), std::cos(0.001)) << "seed " << seed;
    EXPECT_NEAR(glm::dot(on_plane - fit.plane.point_mm, fit.plane.normal), 0.0, 0.02) << "seed " << seed;
    EXPECT_LT(fit.rms_mm, 0.05) << "seed " << seed;
    EXPECT_LT(fit.twist_deg, 0.1) << "seed " << seed;
    EXPECT_LT(fit.slide_mm, 0.1) << "seed " << seed;
  }
}

TEST(Mirror, APieceMissingOnOneSideDoesNotPullThePlane) {
  const Solid cut =
      boolean(solid_of(head()), Operation::Difference, solid_of(shapes::box({25, -150, -60}, {100, 20, 20})))
          .solid;
  const MirrorFit fit = fit_mirror_plane(cut);
  EXPECT_GT(fit.plane.normal.x, std::cos(0.005));
  EXPECT_NEAR(glm::dot(-fit.plane.point_mm, fit.plane.normal), 0.0, 0.2);
}

/// A jaw: a tube along an arch, equally thick below and above, so that its two halves are nearly mirror
/// images about a plane along it too. It loses a share of its right end.
Triangles jaw(double lost) {
  constexpr int along = 120, around = 24;
  Triangles t;
  const auto middle = [&](double s) {
    return glm::dvec3(45 * s, 70 * s * s - 40,
                      7.5 * std::max(0.0, std::abs(s) - 0.8) / 0.2 + 4 * std::cos(3 * s));
  };
  for (int i = 0; i <= along; ++i) {
    const double s = -1.0 + (2.0 - 2.0 * lost) * i / along;
    const glm::dvec3 forward = glm::normalize(middle(s + 1e-3) - middle(s - 1e-3));
    const glm::dvec3 out = glm::normalize(glm::cross(forward, glm::dvec3(0, 0, 1)));
    const glm::dvec3 up = glm::cross(out, forward);
    for (int k = 0; k < around; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / around;
      t.points_mm.push_back(middle(s) + (5 + 1.5 * std::cos(6 * s)) * std::cos(angle) * out +
                            (9 + 5 * std::abs(s)) * std::sin(angle) * up);
    }
  }
  for (std::uint32_t i = 0; i < along; ++i)
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t a = i * around + k, b = i * around + (k + 1) % around, c = a + around,
                          d = b + around;
      t.faces.push_back({a, d, b});
      t.faces.push_back({a, c, d});
    }
  return t;
}

TEST(Mirror, ALossOnOneSideOfAJawDoesNotChooseAnotherPlane) {
  for (const double lost : {0.0, 0.15, 0.2, 0.25, 0.3}) {
    const MirrorFit fit = fit_mirror_plane(mesh_of(jaw(lost)));
    EXPECT_GT(fit.plane.normal.x, std::cos(0.01)) << lost;
    EXPECT_NEAR(glm::dot(-fit.plane.point_mm, fit.plane.normal), 0.0, 0.3) << lost;
  }
}

TEST(Mirror, OfSeveralPlanesThatFitTheFindingNamesAnother) {
  const MirrorFit fit = fit_mirror_plane(mesh_of(shapes::box({-10, -10, -10}, {10, 10, 10})));
  ASSERT_FALSE(fit.findings.empty());
  EXPECT_NE(fit.findings.back().find("another plane"), std::string::npos) << fit.findings.back();
  for (const std::string& finding : fit_mirror_plane(mesh_of(head())).findings)
    EXPECT_EQ(finding.find("another plane"), std::string::npos) << finding;
}

}  // namespace
}  // namespace octotomy::brep

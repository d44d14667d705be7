// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/prism.h"

#include <gtest/gtest.h>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using Polygon = std::vector<glm::dvec2>;
const Polygon square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
const Polygon hole{{2, 2}, {4, 2}, {4, 5}, {2, 5}};
const Polygon island{{2.5, 2.5}, {3.5, 2.5}, {3.5, 4.5}, {2.5, 4.5}};

Polygon reversed(Polygon polygon) {
  std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

Prism prism_of(std::vector<Polygon> polygons) {
  Prism prism;
  prism.polygons_mm = std::move(polygons);
  prism.from_mm = -1.0;
  prism.to_mm = 4.0;
  return prism;
}

std::string refusal_of(const Prism& prism) {
  try {
    solid_of(prism);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(Prism, HolesAndIslandsAlternateWhateverTheWinding) {
  for (int winding = 0; winding < 8; ++winding) {
    const Solid solid =
        solid_of(prism_of({winding & 1 ? reversed(square) : square, winding & 2 ? reversed(hole) : hole,
                           winding & 4 ? reversed(island) : island}));
    const Health h = health(solid);
    EXPECT_TRUE(h.solid()) << (h.findings.empty() ? "" : h.findings[0]);
    EXPECT_EQ(h.components, 2u);
    EXPECT_EQ(h.euler, 2);  // a ring has 0, the island 2
    EXPECT_NEAR(measure(solid).volume_mm3, 5.0 * (100 - 6 + 2), 1e-11);
    EXPECT_NEAR(measure(solid).area_mm2, 2 * 96 + 5.0 * (40 + 10 + 6), 1e-11);
  }
}

TEST(Prism, LiesWhereItsFrameSays) {
  Prism prism = prism_of({square});
  Measures m = measure(solid_of(prism));
  EXPECT_EQ(m.low_mm, glm::dvec3(0, -1, 0));
  EXPECT_EQ(m.high_mm, glm::dvec3(10, 4, 10));
  // Seen from the patient's left: look (1,0,0), right (0,-1,0).
  prism.look = {1, 0, 0};
  prism.up = {0, 0, 1};
  prism.right = {0, -1, 0};
  m = measure(solid_of(prism));
  EXPECT_EQ(m.low_mm, glm::dvec3(-1, -10, 0));
  EXPECT_EQ(m.high_mm, glm::dvec3(4, 0, 10));
  EXPECT_GT(m.volume_mm3, 0.0);
}

TEST(Prism, AStarOfManyPointsHasTheShoelaceArea) {
  Polygon star;
  double twice_area = 0;
  constexpr int count = 1000;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count, r = i % 2 ? 10.0 : 7.0;
    star.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  for (int i = 0; i < count; ++i) {
    const glm::dvec2 &p = star[static_cast<std::size_t>(i)],
                     &q = star[static_cast<std::size_t>((i + 1) % count)];
    twice_area += p.x * q.y - p.y * q.x;
  }
  const Solid solid = solid_of(prism_of({star}));
  EXPECT_TRUE(health(solid).solid());
  EXPECT_NEAR(measure(solid).volume_mm3, 2.5 * twice_area, 1e-10 * twice_area);
}

TEST(Prism, RepeatedPointsAreOne) {
  const Polygon repeating{{0, 0}, {10, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}};
  EXPECT_EQ(solid_of(prism_of({repeating})).mesh().n_vertices(), 8u);
}

TEST(Prism, RefusesPolygonsThatCrossOrTouchAndNamesThem) {
  const Polygon bow_tie{{0, 0}, {10, 10}, {10, 0}, {0, 10}};
  EXPECT_NE(refusal_of(prism_of({hole, bow_tie})).find("polygon 1 crosses or touches itself"),
            std::string::npos);
  const Polygon across{{5, 5}, {15, 5}, {15, 6}};
  EXPECT_NE(refusal_of(prism_of({square, across})).find("crosses or touches polygon"), std::string::npos);
  const Polygon neighbour{{10, 0}, {20, 0}, {20, 10}, {10, 10}};
  EXPECT_NE(refusal_of(prism_of({square, neighbour})), "");
  const Polygon spike{{0, 0}, {10, 0}, {5, 0}, {5, 5}};
  EXPECT_NE(refusal_of(prism_of({spike})), "");
  const Polygon flat{{0, 0}, {1, 1}, {2, 2}};
  EXPECT_NE(refusal_of(prism_of({flat})), "");
  const Polygon two{{0, 0}, {1, 1}, {0, 0}};
  EXPECT_NE(refusal_of(prism_of({square, two})).find("polygon 1 has fewer than three"), std::string::npos);
  EXPECT_EQ(refusal_of(prism_of({square, hole})), "");
}

TEST(Prism, RefusesFramesAndDepthsThatAreNone) {
  Prism left_handed = prism_of({square});
  left_handed.right = -left_handed.right;
  EXPECT_NE(refusal_of(left_handed).find("orthonormal"), std::string::npos);
  Prism backwards = prism_of({square});
  std::swap(backwards.from_mm, backwards.to_mm);
  EXPECT_NE(refusal_of(backwards).find("reaches from"), std::string::npos);
  EXPECT_NE(refusal_of(prism_of({})), "");
}

}  // namespace
}  // namespace octotomy::brep

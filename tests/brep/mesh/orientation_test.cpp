// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/orientation.h"

#include <array>
#include <gtest/gtest.h>
#include <random>

#include "brep/mesh/distance.h"

namespace octotomy::brep {
namespace {

__extension__ using Wide = __int128;
using Whole = std::array<Wide, 3>;

Whole minus(const Whole& p, const Whole& q) {
  return {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
}
Wide determinant(const Whole& u, const Whole& v, const Whole& w) {
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}
int sign(Wide value) {
  return (value > 0) - (value < 0);
}
glm::dvec3 real(const Whole& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

/// Whole numbers of 34 bits: their determinants have twice as many bits as a double holds.
Whole any_point(std::mt19937_64& random) {
  const auto number = [&] { return static_cast<Wide>(random() >> 30) - (Wide{1} << 33); };
  return {number(), number(), number()};
}
Whole step(std::mt19937_64& random) {
  const auto number = [&] { return static_cast<Wide>(random() % 3) - 1; };
  return {number(), number(), number()};
}

TEST(Orientation, PointsAStepFromAPlaneAreOnTheSideThatWholeNumbersSay) {
  std::mt19937_64 random(1);
  std::array<int, 3> seen{};
  int rounded_wrong = 0;
  for (int i = 0; i < 3000; ++i) {
    const Whole a = any_point(random), b = any_point(random), c = any_point(random), off = step(random);
    Whole p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = b[k] + c[k] - a[k] + off[k];
    const int expected = sign(determinant(minus(b, a), minus(c, a), minus(p, a)));
    ASSERT_EQ(orientation(real(a), real(b), real(c), real(p)), expected) << "case " << i;
    ASSERT_EQ(orientation(real(b), real(a), real(c), real(p)), -expected) << "case " << i;
    ++seen.at(static_cast<std::size_t>(expected + 1));
    const double rounded = glm::dot(glm::cross(real(b) - real(a), real(c) - real(a)), real(p) - real(a));
    rounded_wrong += (rounded > 0) - (rounded < 0) != expected;
  }
  EXPECT_GT(seen[0], 500);
  EXPECT_GT(seen[1], 50);
  EXPECT_GT(seen[2], 500);
  EXPECT_GT(rounded_wrong, 0) << "the cases are too easy";
}

TEST(Orientation, PointsOnALineInThePlaneAreOnNeitherSide) {
  EXPECT_EQ(orientation(glm::dvec2(0, 0), glm::dvec2(2, 0), glm::dvec2(1, 1)), 1);
  EXPECT_EQ(orientation(glm::dvec2(0, 0), glm::dvec2(2, 0), glm::dvec2(1, -1)), -1);
  EXPECT_EQ(orientation(glm::dvec2(1, 3), glm::dvec2(0x1p40 + 1, 0x1p40 + 3), glm::dvec2(5, 7)), 0);
  EXPECT_EQ(
      orientation(glm::dvec2(1, 3), glm::dvec2(0x1p40 + 1, 0x1p40 + 3), glm::dvec2(5, std::nextafter(7, 8))),
      1);
}

TEST(Orientation, APointOneStepFromAFaceIsInsideOrOutsideAsWholeNumbersSay) {
  std::mt19937_64 random(2);
  int inside = 0, outside = 0;
  for (int i = 0; i < 2000; ++i) {
    std::array<Whole, 4> corner{any_point(random), any_point(random), any_point(random), any_point(random)};
    if (determinant(minus(corner[1], corner[0]), minus(corner[2], corner[0]), minus(corner[3], corner[0])) <
        0)
      std::swap(corner[0], corner[1]);
    Triangles tetrahedron;
    for (Whole& c : corner) {
      for (Wide& number : c) number *= 3;
      tetrahedron.points_mm.push_back(real(c));
    }
    tetrahedron.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    const Whole off = step(random);
    Whole p{};  // the middle of the face that corner 3 does not have, or a step from there
    for (std::size_t k = 0; k < 3; ++k) p[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3 + off[k];
    const Wide side =
        determinant(minus(corner[1], corner[0]), minus(corner[2], corner[0]), minus(p, corner[0]));
    if (side == 0) continue;
    ++(side > 0 ? inside : outside);
    ASSERT_EQ(is_inside(real(p), tetrahedron), side > 0) << "case " << i;
    ASSERT_EQ(SurfaceTree(tetrahedron).inside({real(p)}).front() != 0, side > 0) << "case " << i;
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(outside, 500);
}

}  // namespace
}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/oriented_box.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "brep/mesh/move.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(OrientedBox, ATurnedBoxIsItsOwn) {
  for (int seed = 0; seed < 8; ++seed) {
    const glm::dmat4 motion =
        glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(40, -30, 7)), 0.3 + 0.7 * seed,
                    glm::normalize(glm::dvec3(1, seed - 3, 0.5 * seed)));
    const OrientedBox box = oriented_box(moved(mesh_of(shapes::box({0, 0, 0}, {5, 2, 9})), motion));
    EXPECT_NEAR(box.edges_mm.x, 9, 1e-6) << "seed " << seed;
    EXPECT_NEAR(box.edges_mm.y, 5, 1e-6) << "seed " << seed;
    EXPECT_NEAR(box.edges_mm.z, 2, 1e-6) << "seed " << seed;
    EXPECT_LT(glm::distance(box.centre_mm, glm::dvec3(motion * glm::dvec4(2.5, 1, 4.5, 1))), 1e-6);
    EXPECT_NEAR(std::abs(glm::dot(box.axes[0], glm::dvec3(motion[2]))), 1.0, 1e-9) << "seed " << seed;
    EXPECT_NEAR(glm::dot(glm::cross(box.axes[0], box.axes[1]), box.axes[2]), 1.0, 1e-12);
  }
}

TEST(OrientedBox, HoldsEveryPointAndIsNoLargerThanTheOneAlongTheAxes) {
  Triangles blob = shapes::sphere({0, 0, 0}, 3, 3);
  for (glm::dvec3& p : blob.points_mm)
    p = glm::dvec3(p.x + 0.8 * p.y, p.y - 0.5 * p.z * p.z, 2.0 * p.z + p.x);
  const OrientedBox box = oriented_box(mesh_of(blob));
  glm::dvec3 low(1e9), high(-1e9);
  for (const glm::dvec3& p : blob.points_mm) {
    low = glm::min(low, p);
    high = glm::max(high, p);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LE(std::abs(glm::dot(p - box.centre_mm, box.axes[k])),
                0.5 * box.edges_mm[static_cast<int>(k)] + 1e-9);
  }
  const glm::dvec3 along_axes = high - low;
  EXPECT_LT(box.volume_mm3(), 0.95 * along_axes.x * along_axes.y * along_axes.z);
}

TEST(OrientedBox, HoldsEveryPointOfAHullOfMany) {
  Triangles egg = shapes::sphere({7, -8, 9}, 50, 5);  // 10 242 points, all on the hull
  const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3))));
  for (glm::dvec3& p : egg.points_mm) p = turn * (glm::dvec3(1.0, 0.7, 0.5) * (p - glm::dvec3(7, -8, 9)));
  const OrientedBox box = oriented_box(mesh_of(egg));
  for (const glm::dvec3& p : egg.points_mm)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LE(std::abs(glm::dot(p - box.centre_mm, box.axes[k])),
                0.5 * box.edges_mm[static_cast<int>(k)] + 1e-9);
  EXPECT_LT(box.volume_mm3(), 1.005 * 100 * 70 * 50);
}

TEST(OrientedBox, IsTheSameInEveryCall) {
  const Mesh ball = mesh_of(shapes::sphere({1, 2, 3}, 3, 2));
  const OrientedBox one = oriented_box(ball), other = oriented_box(ball);
  EXPECT_EQ(one.edges_mm, other.edges_mm);
  EXPECT_EQ(one.axes, other.axes);
}

TEST(OrientedBox, RefusesWhatHasNoBox) {
  EXPECT_THROW(oriented_box(Mesh()), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep

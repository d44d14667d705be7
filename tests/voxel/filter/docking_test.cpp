// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/docking.h"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "tests/voxel/spaced_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

TEST(VoxelDocking, SixContactsOfABoxCornerHoldByTheirClosedForm) {
  const std::vector<DockingContact> corner{{{10, 10, 0}, {0, 0, 1}}, {{40, 10, 0}, {0, 0, 1}},
                                           {{10, 40, 0}, {0, 0, 1}}, {{10, 0, 20}, {0, 1, 0}},
                                           {{40, 0, 20}, {0, 1, 0}}, {{0, 20, 20}, {1, 0, 0}}};
  const glm::dvec3 push = -glm::normalize(glm::dvec3(1.0));
  // Above the walls' contacts by h, the floor's contacts bear (10 gz - h gx) / 30, (10 gz - h gy) / 30 and
  // the rest.
  for (const double h : {0.0, 2.0, 5.0, 9.0}) {
    const double truth = glm::degrees(
        std::asin(std::min((10.0 - h) / std::sqrt(3.0 * (100.0 + h * h)), 1.0 / std::sqrt(3.0))));
    EXPECT_NEAR(docking(corner, push, {{20, 20, 20 + h}}).angle_deg, truth, 0.002 * truth) << h;
  }
  for (std::size_t lost = 0; lost < 6; ++lost) {
    std::vector<DockingContact> five = corner;
    five.erase(five.begin() + static_cast<std::ptrdiff_t>(lost));
    EXPECT_LT(docking(five, push, {{20, 20, 22}}).angle_deg, 1e-4) << lost;
  }
}

TEST(VoxelDocking, ThreeContactsOnASphereAndASaddleOnACylinderHoldNothing) {
  std::vector<DockingContact> sphere, cylinder;
  for (const double at : {0.0, 2.0, 4.0}) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(std::cos(at), std::sin(at), 1.0));
    sphere.push_back({20.0 * normal, normal});
  }
  for (int i = -5; i <= 5; ++i)
    for (int k = -6; k <= 6; ++k) {
      const glm::dvec3 out(0.0, std::sin(k / 6.0), std::cos(k / 6.0));
      cylinder.push_back({glm::dvec3(2.0 * i, 0, 0) + 12.0 * out, out});
    }
  EXPECT_LT(docking(sphere, {0, 0, -1}, {{0, 0, 23}}).angle_deg, 1e-3);
  EXPECT_LT(docking(sphere, {0, 0, -1}, {{5, 2, 22}}).angle_deg, 1e-3);
  EXPECT_LT(docking(cylinder, {0, 0, -1}, {{0, 0, 15}}).angle_deg, 1e-3);
}

/// A plane of three contacts, 10 mm about the middle, within flanges.
TEST(VoxelDocking, AFlangedPlaneTipsOverTheTrianglesNearestSide) {
  std::vector<DockingContact> contacts;
  for (const double at : {90.0, 210.0, 330.0})
    contacts.push_back(
        {{10.0 * std::cos(glm::radians(at)), 10.0 * std::sin(glm::radians(at)), 0.0}, {0, 0, 1}});
  for (const double side : {-1.0, 1.0})
    for (const double along : {-8.0, 8.0}) {
      contacts.push_back({{15.0 * side, along, 0.0}, {side, 0, 0}});
      contacts.push_back({{along, 15.0 * side, 0.0}, {0, side, 0}});
    }
  const double truth = glm::degrees(std::atan(2.0 / 20.0));
  const Docking worst = docking(contacts, {0, 0, -1}, {{0, 0, 20}, {0, -3, 20}, {0, 3, 20}});
  EXPECT_NEAR(worst.angle_deg, truth, 0.01 * truth);
  EXPECT_EQ(worst.at_mm, glm::dvec3(0, -3, 20));
}

TEST(VoxelDocking, ContactsOfACapOnABlockLieOnItsTopWithItsNormal) {
  const Universe universe = tests::spaced_universe(6, glm::dvec3(1.0));
  const glm::dvec3 m_mm = universe.lattice().lps_mm(glm::dvec3(32.0)) + 0.3;
  const Expression block(Box{m_mm + glm::dvec3(-10, -8, -20), m_mm + glm::dvec3(10, 8, 0)}),
      plate(Box{m_mm + glm::dvec3(-6, -12, 0.2), m_mm + glm::dvec3(6, 12, 3)});
  const Octree block_voxels = combine(universe, block), plate_voxels = combine(universe, plate);
  const std::vector<DockingContact> contacts =
      docking_contacts({plate_voxels, plate}, {{block_voxels, block}}, {.within_mm = 0.3});
  ASSERT_GT(contacts.size(), 100U);
  for (const DockingContact& contact : contacts) {
    EXPECT_NEAR(contact.p_mm.z, m_mm.z, 0.01);
    EXPECT_GT(contact.normal.z, 0.999);
    EXPECT_LE(std::abs(contact.p_mm.x - m_mm.x), 6.1);
    EXPECT_LE(std::abs(contact.p_mm.y - m_mm.y), 8.01);
  }
  EXPECT_TRUE(docking_contacts({plate_voxels, plate}, {{block_voxels, block}}, {.within_mm = 0.1}).empty());
  // At the rim the sides' first crossings belong to it.
  for (const glm::dvec3& p : pushed_surface({plate_voxels, plate}, {0, 0, -1}))
    EXPECT_NEAR(p.z, m_mm.z + 3.0, 0.31);
}

TEST(VoxelDocking, NormalsOfABallAreRadialToADegree) {
  const Universe universe = tests::spaced_universe(6, glm::dvec3(1.0));
  const glm::dvec3 m_mm = universe.lattice().lps_mm(glm::dvec3(32.0)) + glm::dvec3(0.1, 0.2, 0.3);
  const Expression ball(Sphere{m_mm, 20.0}),
      cup = Expression(Sphere{m_mm, 24.0}) - Expression(Sphere{m_mm, 20.2});
  const Octree ball_voxels = combine(universe, ball), cup_voxels = combine(universe, cup);
  const std::vector<DockingContact> contacts =
      docking_contacts({cup_voxels, cup}, {{ball_voxels, ball}}, {.within_mm = 0.4});
  ASSERT_GT(contacts.size(), 1000U);
  for (const DockingContact& contact : contacts)
    EXPECT_GT(glm::dot(contact.normal, glm::normalize(contact.p_mm - m_mm)), std::cos(glm::radians(1.5)));
}

}  // namespace
}  // namespace octotomy::voxel

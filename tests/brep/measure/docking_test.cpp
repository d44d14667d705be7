// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/docking.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <set>
#include <tbb/global_control.h>

#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

double deg(double rad) {
  return rad * 180.0 / std::numbers::pi;
}

/// At the worst of the points.
Docking docking(const std::vector<DockingContact>& contacts, const glm::dvec3& push,
                const std::vector<glm::dvec3>& points_mm) {
  return worst_dockings(contacts, push, points_mm).front();
}

/// Three contacts on the floor, two on the wall y = 0, one on the wall x = 0.
std::vector<DockingContact> box_corner() {
  return {{{10, 10, 0}, {0, 0, 1}, 0}, {{40, 10, 0}, {0, 0, 1}, 0}, {{10, 40, 0}, {0, 0, 1}, 0},
          {{10, 0, 20}, {0, 1, 0}, 0}, {{40, 0, 20}, {0, 1, 0}, 0}, {{0, 20, 20}, {1, 0, 0}, 0}};
}
const glm::dvec3 into_corner = -glm::normalize(glm::dvec3(1.0));

TEST(Docking, SixContactsOfABoxCornerHoldByTheirClosedForm) {
  // Above the common height of the walls' contacts by h, the balance of moments leaves to the floor's contacts
  // (10 gz - h gx) / 30, (10 gz - h gy) / 30 and the rest, for reactions (gx, gy, gz).
  for (const double h : {0.0, 2.0, 5.0, 9.0}) {
    const Docking found = docking(box_corner(), into_corner, {{20, 20, 20 + h}});
    const double by_floor = std::asin((10.0 - h) / std::sqrt(3.0 * (100.0 + h * h))),
                 by_walls = std::asin(1.0 / std::sqrt(3.0));
    EXPECT_NEAR(found.angle_deg, deg(std::min(by_floor, by_walls)), 1e-6) << h;
    ASSERT_TRUE(found.loosening);
    // At the common height lifting off the floor and sliding along a wall begin together.
    EXPECT_TRUE(h == 0.0 || found.loosening->turns) << h;
  }
}

TEST(Docking, WithOneContactLessABoxCornerHoldsNothing) {
  for (std::size_t lost = 0; lost < 6; ++lost) {
    std::vector<DockingContact> contacts = box_corner();
    contacts.erase(contacts.begin() + static_cast<std::ptrdiff_t>(lost));
    const Docking found = docking(contacts, into_corner, {{20, 20, 22}});
    EXPECT_EQ(found.angle_deg, 0.0) << lost;
    EXPECT_TRUE(found.loosening) << lost;
  }
}

/// Three contacts of a plane, 10 mm about the middle, within eight contacts of flanges that push outward.
std::vector<DockingContact> flanged_plane() {
  std::vector<DockingContact> contacts;
  for (const double at : {90.0, 210.0, 330.0}) {
    const double rad = at * std::numbers::pi / 180.0;
    contacts.push_back({{10.0 * std::cos(rad), 10.0 * std::sin(rad), 0.0}, {0, 0, 1}, 0});
  }
  for (const double side : {-1.0, 1.0})
    for (const double along : {-8.0, 8.0}) {
      contacts.push_back({{15.0 * side, along, 0.0}, {side, 0, 0}, 0});
      contacts.push_back({{along, 15.0 * side, 0.0}, {0, side, 0}, 0});
    }
  return contacts;
}

TEST(Docking, AFlangedPlaneTipsOverTheTrianglesNearestSide) {
  for (const double height_mm : {5.0, 20.0, 60.0}) {
    const Docking found = docking(flanged_plane(), {0, 0, -1}, {{0, 0, height_mm}});
    EXPECT_NEAR(found.angle_deg, deg(std::atan(5.0 / height_mm)), 1e-6) << height_mm;
    ASSERT_TRUE(found.loosening);
    EXPECT_TRUE(found.loosening->turns);
    EXPECT_NEAR(glm::length(glm::dvec2(found.loosening->about_mm)), 5.0, 1e-6);
    EXPECT_NEAR(found.loosening->direction.z, 0.0, 1e-9);
  }
  // Off the middle the same side is nearer; beyond the triangle nothing is held.
  EXPECT_NEAR(docking(flanged_plane(), {0, 0, -1}, {{0, -3, 20}}).angle_deg, deg(std::atan(2.0 / 20.0)),
              1e-6);
  EXPECT_EQ(docking(flanged_plane(), {0, 0, -1}, {{0, -6, 20}}).angle_deg, 0.0);
}

TEST(Docking, TheWorstPointCountsAndInnerPointsAreNotExamined) {
  const std::vector<glm::dvec3> points{{0, 0, 20}, {1, 0, 20}, {0, -3, 20}, {0, 3, 20}, {-1, 0, 20}};
  const Docking worst = docking(flanged_plane(), {0, 0, -1}, points);
  EXPECT_EQ(worst.at_mm, glm::dvec3(0, -3, 20));
  double least = 90.0;
  for (const Docking& one : dockings(flanged_plane(), {0, 0, -1}, points))
    least = std::min(least, one.angle_deg);
  EXPECT_EQ(worst.angle_deg, least);
  std::set<double> corners;
  for (const Docking& one : worst_dockings(flanged_plane(), {0, 0, -1}, points)) {
    EXPECT_NE(one.at_mm, points[0]);
    corners.insert(10.0 * one.at_mm.x + one.at_mm.y);
  }
  EXPECT_EQ(corners, (std::set<double>{10.0, -3.0, 3.0, -10.0}));
}

TEST(Docking, ALargestAngleShortensTheSearchAndChangesNoSmallerOne) {
  for (const double at_most_deg : {0.0, 3.0, 14.0, 15.0, 40.0}) {
    const double found =
        dockings(flanged_plane(), {0, 0, -1}, {{0, 0, 20}}, {}, at_most_deg).front().angle_deg;
    EXPECT_NEAR(found, std::min(at_most_deg, deg(std::atan(5.0 / 20.0))), 1e-6) << at_most_deg;
  }
  EXPECT_THROW(dockings(flanged_plane(), {0, 0, -1}, {{0, 0, 20}}, {}, 90.0), std::invalid_argument);
}

TEST(Docking, WithoutFlangesAPlaneSlides) {
  std::vector<DockingContact> contacts = flanged_plane();
  contacts.resize(3);
  const Docking found = docking(contacts, {0, 0, -1}, {{0, 0, 20}});
  EXPECT_EQ(found.angle_deg, 0.0);
}

TEST(Docking, ThreeContactsOnASphereTurn) {
  std::vector<DockingContact> contacts;
  for (const double at : {0.0, 2.0, 4.0}) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(std::cos(at), std::sin(at), 1.0));
    contacts.push_back({20.0 * normal, normal, 0});
  }
  for (const glm::dvec3& point : {glm::dvec3(0, 0, 23), glm::dvec3(5, 2, 22)}) {
    const Docking found = docking(contacts, {0, 0, -1}, {point});
    EXPECT_NEAR(found.angle_deg, 0.0, 1e-4);
    ASSERT_TRUE(found.loosening);
    EXPECT_TRUE(found.loosening->turns);
    // The axis passes through the sphere's middle.
    const glm::dvec3 arm = found.loosening->about_mm;
    EXPECT_NEAR(glm::length(glm::cross(arm, found.loosening->direction)), 0.0, 1e-6);
  }
}

/// A saddle of 120 degrees on a cylinder about the x axis, from -10 to 10 mm. With a flare its radius grows.
std::vector<DockingContact> saddle(double flare) {
  std::vector<DockingContact> contacts;
  for (int i = -5; i <= 5; ++i)
    for (int k = -6; k <= 6; ++k) {
      const double x = 2.0 * i, at = k * std::numbers::pi / 18.0, radius = 12.0 + flare * x * x;
      const glm::dvec3 out(0.0, std::sin(at), std::cos(at));
      contacts.push_back(
          {glm::dvec3(x, 0, 0) + radius * out, glm::normalize(out - glm::dvec3(2.0 * flare * x, 0, 0)), 0});
    }
  return contacts;
}

TEST(Docking, ASaddleOnACylinderSlidesAlongItOrTurnsAboutIt) {
  const Docking found = docking(saddle(0.0), {0, 0, -1}, {{0, 0, 15}});
  EXPECT_NEAR(found.angle_deg, 0.0, 1e-4);
  ASSERT_TRUE(found.loosening);
  EXPECT_NEAR(std::abs(found.loosening->direction.x), 1.0, 1e-6);
}

TEST(Docking, ALateralExtensionHoldsWhatAMidShaftDoesNot) {
  // A waisted shaft stops the sliding, but not the turning about it.
  EXPECT_NEAR(docking(saddle(0.02), {0, 0, -1}, {{0, 0, 15}}).angle_deg, 0.0, 1e-4);
  const auto extended = [](double reach_mm) {
    std::vector<DockingContact> contacts = saddle(0.02);
    for (const double x : {-6.0, 6.0})
      for (const double side : {-1.0, 1.0}) contacts.push_back({{x, side * reach_mm, 0.0}, {0, 0, 1}, 0});
    return docking(contacts, {0, 0, -1}, {{0, 0, 15}}).angle_deg;
  };
  const double short_deg = extended(14.0), long_deg = extended(20.0);
  EXPECT_GT(short_deg, 5.0);
  EXPECT_GT(long_deg, short_deg);
}

TEST(Docking, TheSameBitsOnOneThreadAndMany) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 40; ++i)
    points.emplace_back(3.0 * std::cos(i), 3.0 * std::sin(2.0 * i), 15.0 + std::sin(3.0 * i));
  const Docking many = docking(saddle(0.02), {0, 0, -1}, points);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Docking alone = docking(saddle(0.02), {0, 0, -1}, points);
  EXPECT_EQ(many.angle_deg, alone.angle_deg);
  EXPECT_EQ(many.at_mm, alone.at_mm);
}

TEST(Docking, RefusesNoContactsNoPointsAndAPushWithoutLength) {
  EXPECT_THROW(docking({}, {0, 0, -1}, {{0, 0, 0}}), std::invalid_argument);
  EXPECT_THROW(docking(box_corner(), {0, 0, -1}, {}), std::invalid_argument);
  EXPECT_THROW(docking(box_corner(), {0, 0, 0}, {{0, 0, 0}}), std::invalid_argument);
}

TEST(DockingContacts, OfACapOnABlockReachItsEdgesAndLeaveOutItsSides) {
  const Solid block = solid_of(shapes::box({-10, -8, -30}, {10, 8, 0}));
  const Solid plate = solid_of(shapes::box({-6, -12, 0.2}, {6, 12, 3}));
  const std::vector<DockingContact> contacts = docking_contacts(plate, {block}, {.within_mm = 0.3});
  ASSERT_GT(contacts.size(), 100U);
  glm::dvec3 low(1e9), high(-1e9);
  for (const DockingContact& contact : contacts) {
    EXPECT_NEAR(contact.normal.z, 1.0, 1e-12);
    EXPECT_NEAR(contact.gap_mm, 0.2, 0.12);
    low = glm::min(low, contact.p_mm);
    high = glm::max(high, contact.p_mm);
  }
  EXPECT_NEAR(low.x, -6.0, 1e-9);
  EXPECT_NEAR(high.x, 6.0, 1e-9);
  EXPECT_NEAR(low.y, -8.0, 1.0);
  EXPECT_TRUE(docking_contacts(plate, {block}, {.within_mm = 0.1}).empty());
  EXPECT_THROW(docking_contacts(plate, {block}, {.within_mm = 0.0}), std::invalid_argument);
}

TEST(DockingContacts, OfAPlateOnAnObjectAKilometreWideAreThoseOnASmallOne) {
  const Solid plate = solid_of(shapes::box({-6, -12, 0.2}, {6, 12, 3}));
  const auto contacts_on = [&](double half_mm) {
    return docking_contacts(plate,
                            {solid_of(shapes::box({-half_mm, -half_mm, -half_mm}, {half_mm, half_mm, 0}))},
                            {.within_mm = 0.3});
  };
  const std::vector<DockingContact> small = contacts_on(20.0), wide = contacts_on(5e5);
  ASSERT_GT(small.size(), 100U);
  EXPECT_NEAR(static_cast<double>(wide.size()), static_cast<double>(small.size()), 0.2 * small.size());
  for (const DockingContact& contact : wide) EXPECT_NEAR(contact.normal.z, 1.0, 1e-9);
}

TEST(DockingContacts, APushedSurfaceIsTheSideThatFacesThePush) {
  const Solid plate = solid_of(shapes::box({-6, -12, 0.2}, {6, 12, 3}));
  const std::vector<glm::dvec3> points = pushed_surface(plate, {0, 0, -1}, 1.0);
  ASSERT_GT(points.size(), 100U);
  for (const glm::dvec3& p : points) EXPECT_EQ(p.z, 3.0);
}

}  // namespace
}  // namespace octotomy::brep

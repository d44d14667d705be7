// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/repair.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "brep/io/read_mesh.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/shape/repair_effect.h"
#include "tests/brep/shapes.h"
#include "tests/reference_data.h"

namespace octotomy::brep {
namespace {

/// Each triangle with points of its own, as STL has them, moved by up to `noise`.
Triangles soup_of(const Triangles& triangles, double noise) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-noise, noise);
  Triangles soup;
  for (const auto& face : triangles.faces) {
    const auto first = static_cast<std::uint32_t>(soup.points_mm.size());
    for (const std::uint32_t v : face)
      soup.points_mm.push_back(triangles.points_mm[v] + glm::dvec3(any(random), any(random), any(random)));
    soup.faces.push_back({first, first + 1, first + 2});
  }
  return soup;
}

long count_of(const Repair& repaired, const std::string& step) {
  return std::count_if(repaired.changes.begin(), repaired.changes.end(),
                       [&](const Change& change) { return change.step == step; });
}

const Triangles sound_ball = shapes::sphere({1, 2, 3}, 5, 2);

TEST(Repair, DoesNothingUnasked) {
  Triangles bad = soup_of(sound_ball, 1e-4);
  std::swap(bad.faces[3][0], bad.faces[3][1]);
  const Repair untouched = repair(bad, {});
  EXPECT_TRUE(untouched.changes.empty());
  EXPECT_TRUE(untouched.left.empty());
  EXPECT_EQ(untouched.surface.faces, bad.faces);
  EXPECT_EQ(untouched.surface.points_mm, bad.points_mm);
}

TEST(TurnedAlike, TurnsWhatWindsAgainstTheRestAndMovesNothing) {
  Triangles bad = sound_ball;
  for (const std::size_t f : {3, 7, 40}) std::swap(bad.faces[f][0], bad.faces[f][1]);
  const TurnedAlike alike = turned_alike(bad);
  EXPECT_EQ(alike.turned, 3u);
  EXPECT_EQ(alike.surface.points_mm, sound_ball.points_mm);
  EXPECT_TRUE(health(alike.surface).solid());
  EXPECT_EQ(turned_alike(sound_ball).turned, 0u);
}

TEST(Repair, ASoupOfTrianglesIsWeldedAndEveryPointThatMovedIsListed) {
  RepairOptions options;
  options.weld_mm = 1e-3;
  const Repair welded = repair(soup_of(sound_ball, 1e-4), options);
  EXPECT_TRUE(health(welded.surface).solid());
  EXPECT_EQ(welded.surface.points_mm.size(), sound_ball.points_mm.size());
  EXPECT_EQ(count_of(welded, "weld"),
            static_cast<long>(3 * sound_ball.faces.size() - sound_ball.points_mm.size()));
  EXPECT_NEAR(size_of(welded.surface).volume_mm3, size_of(sound_ball).volume_mm3,
              1e-3 * size_of(sound_ball).area_mm2);
  options.weld_mm = 0.0;
  EXPECT_EQ(repair(soup_of(sound_ball, 0.0), options).surface.points_mm.size(), sound_ball.points_mm.size());
  EXPECT_TRUE(repair(soup_of(sound_ball, 1e-4), options).changes.empty());
}

TEST(Repair, TurnedTrianglesDuplicatesAndFlatOnesAreNamed) {
  Triangles bad = sound_ball;
  std::swap(bad.faces[3][0], bad.faces[3][1]);
  bad.faces.push_back(bad.faces[7]);
  bad.faces.push_back({4, 4, 9});
  RepairOptions options;
  options.orient = options.remove_duplicates = options.remove_flat = true;
  const Repair mended = repair(bad, options);
  EXPECT_TRUE(mended.left.empty());
  EXPECT_TRUE(health(mended.surface).solid());
  ASSERT_EQ(mended.changes.size(), 3u);
  EXPECT_EQ(mended.changes[0].what, "triangle 321 repeats a point: taken out");
  EXPECT_EQ(mended.changes[1].what, "triangle 320 has the points of triangle 7: taken out");
  EXPECT_EQ(mended.changes[2].what, "triangle 3 turned round");
}

TEST(Repair, ShellsFaceOutwardAndCavitiesInward) {
  Triangles nested = shapes::together(shapes::box({0, 0, 0}, {9, 9, 9}), shapes::box({2, 2, 2}, {7, 7, 7}));
  nested = shapes::inside_out(shapes::together(nested, shapes::box({3, 3, 3}, {5, 5, 5})));
  RepairOptions options;
  options.orient = true;
  const Repair mended = repair(nested, options);
  EXPECT_TRUE(health(mended.surface).solid());
  EXPECT_NEAR(size_of(mended.surface).volume_mm3, 729 - 125 + 8, 1e-12);
  EXPECT_EQ(count_of(mended, "orient"), 24);
}

/// The volume of a solid that Booleans make of the surface, never by enclosing.
double united_mm3(const Triangles& surface, std::size_t shells) {
  RepairOptions options;
  options.solid = true;
  const Repair mended = repair(surface, options);
  EXPECT_FALSE(mended.enclosed_cell_mm.has_value());
  const Health found = health(mended.surface);
  EXPECT_TRUE(found.solid());
  EXPECT_EQ(found.shells, shells);
  return size_of(mended.surface).volume_mm3;
}

TEST(Repair, ClosedShellsThatOverlapAreUnitedByTheirBoolean) {
  const Triangles cube = shapes::box({0, 0, 0}, {2, 2, 2}), other = shapes::box({1, 1, 1}, {3, 3, 3});
  EXPECT_NEAR(united_mm3(shapes::together(cube, other), 1), 15, 1e-12);
  EXPECT_NEAR(united_mm3(shapes::together(cube, shapes::inside_out(other)), 1), 15, 1e-12) << "one turned";
  const Triangles flush = shapes::box({2, 0, 0}, {4, 2, 2});
  EXPECT_NEAR(united_mm3(shapes::together(cube, flush), 1), 16, 1e-12) << "a face in common";
}

TEST(Repair, ShellsWithinAnotherAreBodiesOrCavitiesAsTheyAreTurned) {
  const Triangles outer = shapes::box({0, 0, 0}, {4, 4, 4}), inner = shapes::box({1, 1, 1}, {3, 3, 3});
  EXPECT_NEAR(united_mm3(shapes::together(outer, inner), 1), 64, 1e-12);
  const Triangles hollow = shapes::together(outer, shapes::inside_out(inner));
  EXPECT_NEAR(united_mm3(hollow, 2), 56, 1e-12);
  EXPECT_NEAR(united_mm3(shapes::inside_out(hollow), 2), 56, 1e-12) << "inside out as a whole";
  // A body in the wall of the hollow one fills one of the cavity's eight unit cubes: 56 + 27 - 7.
  EXPECT_NEAR(united_mm3(shapes::together(hollow, shapes::box({2, 2, 2}, {5, 5, 5})), 2), 76, 1e-12);
}

TEST(Repair, VolumesOfSolidsAreTheirTriangles) {
  const Triangles thin = shapes::box({0, 0, 0}, {1.0 / 3.0, 0.7, 11});
  const double exact = size_of(thin).volume_mm3;
  const RepairEffect effect = repair_effect(thin, thin, {.before = true, .after = true});
  EXPECT_EQ(effect.volume_before_mm3, exact);
  EXPECT_EQ(effect.volume_after_mm3, exact);
}

TEST(Repair, AMoebiusStripCannotBeOrientedAndThatIsTold) {
  Triangles strip;
  constexpr std::uint32_t n = 12;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double turn = 2 * std::numbers::pi * k / n;
    const glm::dvec3 out(std::cos(turn), std::sin(turn), 0);
    const glm::dvec3 across = std::cos(turn / 2) * out + std::sin(turn / 2) * glm::dvec3(0, 0, 1);
    strip.points_mm.push_back(5.0 * out - across);
    strip.points_mm.push_back(5.0 * out + across);
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t a = 2 * k, b = 2 * k + 1, c = k + 1 < n ? a + 2 : 1, d = k + 1 < n ? b + 2 : 0;
    strip.faces.push_back({a, c, b});
    strip.faces.push_back({b, c, d});
  }
  RepairOptions options;
  options.orient = true;
  const Repair tried = repair(strip, options);
  ASSERT_EQ(tried.left.size(), 1u);
  EXPECT_NE(tried.left[0].what.find("Moebius"), std::string::npos);
}

TEST(Repair, RealScansBecomeSolidsOrSayWhatIsLeft) {
  OCTOTOMY_NEEDS_DATA("meshes/fran_cut.vtk");
  RepairOptions options;
  options.weld_mm = 0.0;
  options.remove_duplicates = options.remove_flat = options.orient = options.fill_holes = true;
  const Repair face = repair(read_triangles(tests::reference_data("meshes/fran_cut.vtk")), options);
  EXPECT_TRUE(face.left.empty()) << face.left.front().what;
  const Health found = health(face.surface, {.self_intersections = false});
  EXPECT_TRUE(found.closed && found.manifold && found.oriented);
  EXPECT_EQ(count_of(face, "holes"), 1);
  const Repair bunny =
      repair(read_triangles(tests::reference_data("meshes/trimesh_bunny_nonmanifold.ply")), options);
  EXPECT_GT(count_of(bunny, "duplicates"), 80);
  EXPECT_EQ(health(bunny.surface, {.self_intersections = false}).duplicate_faces, 0u);
  const Health of_bunny = health(bunny.surface, {.self_intersections = false});
  EXPECT_TRUE(of_bunny.solid() || !bunny.left.empty());
}

TEST(Repair, ARefusedEnclosingNamesWhatWouldBeAccepted) {
  // Plates that cross, in cells wider than they are thick.
  const Triangles plates =
      shapes::together(shapes::box({0, 0, 0}, {20, 20, 0.6}), shapes::box({9.7, -1, -10}, {10.3, 21, 10}));
  RepairOptions options;
  options.solid = true;
  options.cell_mm = 1.0;
  try {
    repair(plates, options);
    FAIL() << "cells of 1 mm keep plates of 0.6 mm";
  } catch (const Error& error) {
    const std::string told = error.what();
    const std::size_t cell = told.find("--cell "), hull = told.find("--hull"),
                      share = told.find("--max-volume-share ");
    ASSERT_NE(cell, std::string::npos) << told;
    EXPECT_NE(hull, std::string::npos) << told;
    ASSERT_NE(share, std::string::npos) << told;
    options.cell_mm = std::stod(told.substr(cell + 7));
    EXPECT_NO_THROW(repair(plates, options)) << told;
    options.cell_mm = 1.0;
    options.max_volume_share = std::stod(told.substr(share + 19));
    EXPECT_NO_THROW(repair(plates, options)) << told;
  }
}

TEST(Repair, ASheetIsToldTheWallThatItCanBeGivenAndGetsIt) {
  // A square sheet of 20 mm, bent up at one side: it encloses nothing.
  Triangles sheet;
  sheet.points_mm = {{0, 0, 0}, {20, 0, 0}, {20, 20, 0}, {0, 20, 0}, {20, 0, 10}, {20, 20, 10}};
  sheet.faces = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  RepairOptions options;
  options.solid = true;
  options.longest_hole_mm = 1.0;
  try {
    repair(sheet, options);
    FAIL() << "a sheet encloses something";
  } catch (const Error& error) {
    const std::string told = error.what();
    const std::size_t wall = told.find("--wall ");
    ASSERT_NE(wall, std::string::npos) << told;
    options.wall_mm = std::stod(told.substr(wall + 7));
    EXPECT_TRUE(health(repair(sheet, options).surface).solid()) << told;
  }
  // Its area times the wall, the bend's inner corner once, and rounded along its outline of 100 mm.
  options.wall_mm = 1.0;
  const Repair made = repair(sheet, options);
  EXPECT_TRUE(health(made.surface).solid());
  const double half = 0.5;
  const double flat_mm3 = 600.0 - 20.0 * half * half;
  const double bend_mm3 = 20.0 * 0.25 * std::numbers::pi * half * half;
  const double rims_mm3 = 100.0 * 0.5 * std::numbers::pi * half * half;
  const double corners_mm3 = std::numbers::pi * half * half * half;
  EXPECT_NEAR(size_of(made.surface).volume_mm3, flat_mm3 + bend_mm3 + rims_mm3, 3.0 * corners_mm3);
  ASSERT_FALSE(made.changes.empty());
  EXPECT_NE(made.changes.back().what.find("wall of 1 mm"), std::string::npos) << made.changes.back().what;
  options.wall_mm = 0.0;
  EXPECT_THROW(repair(sheet, options), std::invalid_argument);
}

TEST(Repair, LooseTrianglesAreOfferedTheWeldThatClosesThem) {
  // Each triangle by itself, its corners up to a fiftieth of a millimetre off.
  const Triangles ball = shapes::sphere({0, 0, 0}, 20, 3);
  Triangles loose;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> off(-0.02, 0.02);
  for (const auto& face : ball.faces) {
    const auto first = static_cast<std::uint32_t>(loose.points_mm.size());
    for (const std::uint32_t v : face)
      loose.points_mm.push_back(ball.points_mm[v] + glm::dvec3(off(random), off(random), off(random)));
    loose.faces.push_back({first, first + 1, first + 2});
  }
  RepairOptions options;
  options.solid = true;
  try {
    repair(loose, options);
    FAIL() << "points 0.03 mm apart were joined without being asked";
  } catch (const std::runtime_error& error) {
    const std::string told = error.what();
    const std::size_t weld = told.find("--weld ");
    ASSERT_NE(weld, std::string::npos) << told;
    options.weld_mm = std::stod(told.substr(weld + 7));
  }
  const Repair made = repair(loose, options);
  EXPECT_TRUE(health(made.surface).solid());
  const double volume_mm3 = size_of(ball).volume_mm3;
  EXPECT_NEAR(size_of(made.surface).volume_mm3, volume_mm3, 2e-3 * volume_mm3);
}

TEST(Repair, RefusesOptionsOutOfTheirRange) {
  RepairOptions options;
  options.weld_mm = -1.0;
  EXPECT_THROW(repair(sound_ball, options), std::invalid_argument);
  options = {};
  options.longest_hole_mm = 0.0;
  EXPECT_THROW(repair(sound_ball, options), std::invalid_argument);
  Triangles bad = sound_ball;
  bad.faces[0][0] = 4000;
  EXPECT_THROW(repair(bad, {}), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::brep

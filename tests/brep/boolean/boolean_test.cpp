// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/boolean.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <thread>

#include "brep/io/read_mesh.h"
#include "brep/mesh/components.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "brep/shape/prism.h"
#include "tests/brep/shapes.h"
#include "tests/brep/told.h"
#include "tests/reference_data.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;
using tests::told;

Solid solid_box(const glm::dvec3& low, const glm::dvec3& high) {
  return solid_of(shapes::box(low, high));
}
Solid solid_sphere(const glm::dvec3& centre, double radius, int splits) {
  return solid_of(shapes::sphere(centre, radius, splits));
}
double volume(const Mesh& mesh) {
  return measure(mesh).volume_mm3;
}

/// Closed, manifold, oriented and without intersections; degenerate slivers are judged apart.
void expect_solid(const Mesh& mesh, const char* what) {
  const Health h = health(mesh);
  EXPECT_TRUE(h.solid()) << what << ": " << told(h);
}

/// All four results of overlapping operands of known volumes.
void expect_volumes(const Booleans& results, double a, double b, double common, double tolerance) {
  ASSERT_TRUE(results.united && results.intersection && results.a_minus_b && results.b_minus_a);
  EXPECT_NEAR(volume(*results.united), a + b - common, tolerance);
  EXPECT_NEAR(volume(*results.intersection), common, tolerance);
  EXPECT_NEAR(volume(*results.a_minus_b), a - common, tolerance);
  EXPECT_NEAR(volume(*results.b_minus_a), b - common, tolerance);
  ASSERT_TRUE(results.residual);
  EXPECT_LT(*results.residual, 1e-12);
}

TEST(Boolean, BoxesInGeneralPositionGiveFourExactSolids) {
  const Booleans results = booleans(solid_box({0, 0, 0}, {2, 2, 2}), solid_box({1, 1, 1}, {4, 3.5, 3}));
  expect_volumes(results, 8, 3 * 2.5 * 2, 1, 1e-13);
  expect_solid(*results.united, "union");
  expect_solid(*results.intersection, "intersection");
  expect_solid(*results.a_minus_b, "a - b");
  expect_solid(*results.b_minus_a, "b - a");
  EXPECT_TRUE(results.findings.empty()) << told(results.findings);
}

TEST(Boolean, TheOperandsAreNotChanged) {
  const Solid a = solid_box({0, 0, 0}, {2, 2, 2}), b = solid_box({1, 1, 1}, {3, 3, 3});
  boolean(a, Operation::Difference, b);
  EXPECT_EQ(a.mesh().n_faces(), 12u);
  EXPECT_EQ(triangles_of(b).points_mm, shapes::box({1, 1, 1}, {3, 3, 3}).points_mm);
}

TEST(Boolean, DifferenceTakesTheSecondFromTheFirst) {
  const Solid a = solid_box({0, 0, 0}, {2, 2, 2}), b = solid_box({1, -1, -1}, {9, 9, 9});
  EXPECT_NEAR(volume(boolean(a, Operation::Difference, b).solid), 4, 1e-13);
  EXPECT_NEAR(volume(boolean(b, Operation::Difference, a).solid), 800 - 4, 1e-11);
}

TEST(Boolean, ALensConvergesToItsClosedFormAtSecondOrder) {
  const double r = 5, d = 6;  // between the centres
  const double lens = pi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12;
  double last = 0;
  for (int splits = 2; splits <= 5; ++splits) {
    const BooleanResult result =
        boolean(solid_sphere({0.1, 0.2, 0.3}, r, splits), Operation::Intersection,
                moved(solid_sphere({0, 0, 0}, r, splits),
                      glm::translate(glm::dmat4(1.0),
                                     glm::dvec3(0.1, 0.2, 0.3) + d * glm::normalize(glm::dvec3(1, 2, 3)))));
    expect_solid(result.solid, "lens");
    ASSERT_TRUE(result.residual);
    EXPECT_LT(*result.residual, 1e-13);
    const double error = lens - volume(result.solid);
    EXPECT_GT(error, 0.0);
    if (splits > 2) {
      EXPECT_NEAR(last / error, 4.0, 0.5) << splits << " splits";
    }
    last = error;
  }
  EXPECT_LT(last, 2e-3 * lens);
}

TEST(Boolean, ACubeCutByAnObliquePrismIsExact) {
  // The prism looks along z; its side runs across the cube from (0, 1) to (4, 3) in x and y.
  Prism prism;
  prism.look = {0, 0, -1};
  prism.up = {0, 1, 0};
  prism.right = glm::cross(prism.look, prism.up);
  prism.from_mm = -10;
  prism.to_mm = 10;
  prism.polygons_mm = {{{-4, -1}, {8, 5}, {8, -9}, {-4, -9}}};
  const Solid cube = solid_box({0, 0, 0}, {4, 4, 4});
  const Booleans results = booleans(cube, solid_of(prism), {false, true, true, false});
  ASSERT_TRUE(results.intersection && results.a_minus_b);
  EXPECT_NEAR(volume(*results.intersection), 32, 1e-12);
  EXPECT_NEAR(volume(*results.a_minus_b), 32, 1e-12);
  EXPECT_NEAR(measure(*results.intersection).area_mm2, 8 + 8 + 4 * 4 + 4 * (1 + 3) + 4 * std::sqrt(20.0),
              1e-12);
  expect_solid(*results.intersection, "piece");
  expect_solid(*results.a_minus_b, "rest");
}

TEST(Boolean, IsTheSameInAnyPose) {
  const Solid a = solid_sphere({0, 0, 0}, 3, 3), b = solid_box({-1, -2, -1.5}, {4, 2.1, 1.7});
  const Booleans still = booleans(a, b);
  for (int pose = 1; pose <= 5; ++pose) {
    glm::dmat4 motion = glm::translate(glm::dmat4(1.0), glm::dvec3(50.0 * pose, -30.0, 7.0 * pose));
    motion = glm::rotate(motion, 0.37 * pose, glm::normalize(glm::dvec3(pose, 1, 2)));
    const Booleans turned = booleans(moved(a, motion), moved(b, motion));
    EXPECT_NEAR(volume(*turned.united), volume(*still.united), 1e-10) << "pose " << pose;
    EXPECT_NEAR(volume(*turned.intersection), volume(*still.intersection), 1e-10) << "pose " << pose;
    EXPECT_NEAR(volume(*turned.a_minus_b), volume(*still.a_minus_b), 1e-10) << "pose " << pose;
    expect_solid(*turned.united, "union");
  }
}

TEST(Boolean, DisjointNestedAndEmptyOperandsNeedNoCorefinement) {
  const Solid a = solid_box({0, 0, 0}, {4, 4, 4}), far = solid_box({9, 9, 9}, {10, 10, 10}),
              within = solid_box({1, 1, 1}, {2, 2, 2});
  const Booleans apart = booleans(a, far);
  expect_volumes(apart, 64, 1, 0, 1e-12);
  EXPECT_EQ(apart.intersection->mesh().n_faces(), 0u);
  EXPECT_EQ(components(*apart.united).size(), 2u);

  const Booleans nested = booleans(a, within);
  expect_volumes(nested, 64, 1, 1, 1e-12);
  EXPECT_EQ(nested.b_minus_a->mesh().n_faces(), 0u);
  EXPECT_EQ(components(*nested.a_minus_b).at(0).cavities, 1u);

  const Booleans with_nothing = booleans(a, Solid());
  expect_volumes(with_nothing, 64, 0, 0, 1e-12);
  const Booleans from_nothing = booleans(Solid(), a);
  expect_volumes(from_nothing, 0, 64, 0, 1e-12);
  expect_volumes(booleans(Solid(), Solid()), 0, 0, 0, 0);
}

TEST(Boolean, IdenticalOperandsGiveThemselvesOrNothing) {
  const Solid a = solid_sphere({0, 0, 0}, 2, 2);
  const Booleans results = booleans(a, a);
  expect_volumes(results, volume(a), volume(a), volume(a), 1e-12);
  EXPECT_EQ(results.a_minus_b->mesh().n_faces(), 0u);
  EXPECT_EQ(results.intersection->mesh().n_faces(), a.mesh().n_faces());
}

TEST(Boolean, ASharedFaceVanishesInTheUnionAndIsEmptyInTheIntersection) {
  const Solid a = solid_box({0, 0, 0}, {2, 2, 2});
  for (const double slide : {0.0, 0.5, 1.0}) {
    const Booleans results = booleans(a, solid_box({2, slide, 0}, {4, 2 + slide, 2}));
    expect_volumes(results, 8, 8, 0, 1e-12);
    EXPECT_EQ(results.intersection->mesh().n_faces(), 0u);
    EXPECT_EQ(components(*results.united).size(), 1u);
    expect_solid(*results.united, "union");
    EXPECT_TRUE(results.findings.empty()) << told(results.findings);
  }
}

TEST(Boolean, ASharedEdgeIsKeptOnceForEachSheetAndTold) {
  const Solid a = solid_box({0, 0, 0}, {2, 2, 2}), b = solid_box({2, 2, 0}, {4, 4, 2});
  const BooleanResult united = boolean(a, Operation::Union, b);
  EXPECT_EQ(volume(united.solid), 16);
  expect_solid(united.solid, "union");
  EXPECT_EQ(told(united.findings), "the union touches itself at 2 points; ");
  EXPECT_EQ(united.shift_mm, 0.0);
  EXPECT_EQ(components(united.solid).size(), 2u);
  const BooleanResult common = boolean(a, Operation::Intersection, b);
  EXPECT_EQ(common.solid.mesh().n_faces(), 0u);
  EXPECT_TRUE(common.findings.empty()) << told(common.findings);
}

TEST(Boolean, TheShiftThatIsToldIsTheShiftThatWasMadeAndAShareOfTheExtent) {
  // A tunnel whose roof has its ridge on the top, which makes the result no manifold. It is far from the
  // origin, so that its extent differs from its coordinates.
  const glm::dvec3 at(100, 200, 300);
  Triangles tunnel;
  for (const double y : {1.0, 3.0})
    for (const glm::dvec3& p : {glm::dvec3(1, y, 2), glm::dvec3(3, y, 2), glm::dvec3(2, y, 4)})
      tunnel.points_mm.push_back(at + p);
  tunnel.faces = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
  const Solid a = solid_box(at, at + glm::dvec3(4, 4, 4)), b = solid_of(tunnel);
  const BooleanResult rest = boolean(a, Operation::Difference, b);
  const std::string findings = told(rest.findings);
  const std::size_t begin = findings.find("shifted: a was moved by (");
  ASSERT_NE(begin, std::string::npos) << findings;
  glm::dvec3 shift(0.0);
  ASSERT_EQ(std::sscanf(findings.c_str() + begin, "shifted: a was moved by (%lf, %lf, %lf)", &shift.x,
                        &shift.y, &shift.z),
            3)
      << findings;
  const double step_mm = 0x1p-18 * std::sqrt(3 * 4 * 4);
  const double steps = glm::length(shift) / step_mm;
  EXPECT_NEAR(steps, 1.0, 0.05) << "the first shift does";
  EXPECT_GT(glm::min(glm::min(shift.x, shift.y), shift.z), 0.0) << "the first goes forward";
  EXPECT_NEAR(volume(rest.solid), 60, glm::length(shift) * 96);
  double nearest = std::numeric_limits<double>::infinity();
  const glm::dvec3 corner = at + glm::dvec3(4, 4, 4) + shift;
  for (const auto v : rest.solid.mesh().vertices()) {
    const Mesh::Point p = rest.solid.mesh().point(v);
    nearest = std::min(nearest, glm::distance(glm::dvec3(p[0], p[1], p[2]), corner));
  }
  EXPECT_LT(nearest, 0.05 * glm::length(shift)) << "no corner of a where the finding says it was moved to";
}

/// A tetrahedron with its tip at a point; its far face lies in the direction `way`.
Triangles tip(const glm::dvec3& at, const glm::dvec3& way) {
  const glm::dvec3 side = glm::normalize(glm::cross(way, glm::dvec3(0.3, 0.5, 0.8)));
  const glm::dvec3 other = glm::normalize(glm::cross(way, side));
  Triangles t;
  t.points_mm = {at, at + way + 0.4 * side, at + way - 0.3 * side + 0.3 * other,
                 at + way - 0.3 * side - 0.3 * other};
  t.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return size_of(t).volume_mm3 > 0.0 ? t : shapes::inside_out(t);
}

TEST(Boolean, SheetsThatMeetInOnePointAreOnePointHoweverManyTheyAre) {
  const glm::dvec3 at(1, 2, 3), ways[] = {{1, 0, 0}, {-1, 0.1, 0}, {0, 1, 0.1}, {0.1, 0, 1}};
  const Triangles about = shapes::together(shapes::box(at - 5.0, at - 4.0), shapes::box(at + 4.0, at + 5.0));
  Triangles tips = tip(at, ways[0]);
  for (int count = 2; count <= 4; ++count) {
    tips = shapes::together(tips, tip(at, ways[count - 1]));
    const BooleanResult united =
        boolean(trusted_solid(tips, Proof::Rounded), Operation::Union, solid_of(about));
    EXPECT_EQ(told(united.findings), "the union touches itself at 1 point; ") << count << " tips";
  }
}

TEST(Boolean, TellsOfTheDifferenceThatItIsInTheCallersOrder) {
  const Solid cube = solid_box({0, 0, 0}, {6, 6, 6});
  const Solid pair =
      boolean(solid_box({1, 1, 1}, {2, 2, 2}), Operation::Union, solid_box({2, 2, 2}, {4, 4, 4})).solid;
  const Booleans ab = booleans(cube, pair, {false, false, true, false}),
                 ba = booleans(pair, cube, {false, false, false, true});
  EXPECT_EQ(told(ab.findings), "a - b touches itself at 1 point; ");
  EXPECT_EQ(told(ba.findings), "b - a touches itself at 1 point; ");
  EXPECT_NEAR(volume(*ab.a_minus_b), 216 - 9, 1e-12);
}

TEST(Boolean, OneResultAloneIsVouchedForToo) {
  // All triangles meet, so that everything is corefined.
  const Solid a = solid_box({-1, -1, -1}, {1, 1, 1});
  const Solid b = moved(a, glm::rotate(glm::dmat4(1.0), 0.6, glm::normalize(glm::dvec3(1, 2, 3))));
  for (const Operation operation : {Operation::Union, Operation::Intersection, Operation::Difference}) {
    const BooleanResult result = boolean(a, operation, b);
    EXPECT_TRUE(result.residual) << told(result.findings);
    EXPECT_TRUE(result.findings.empty()) << told(result.findings);
  }
}

TEST(Boolean, ResultsThatDoNotAddUpAreNotGiven) {
  // Two balls through each other in one mesh: their common part counts twice in the mesh's volume, but once
  // in a result.
  const Solid twice =
      trusted_solid(shapes::together(shapes::sphere({0, 0, 0}, 3, 3), shapes::sphere({1, 0.5, 0.25}, 3, 3)),
                    Proof::Connection);
  for (const Operation operation : {Operation::Union, Operation::Intersection, Operation::Difference}) {
    try {
      const BooleanResult result = boolean(twice, operation, solid_box({-5, -5, 0.1}, {5, 5, 5}));
      ADD_FAILURE() << volume(result.solid) << " mm3; " << told(result.findings);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Geometry);
      EXPECT_NE(std::string(error.what()).find("no Boolean"), std::string::npos) << error.what();
    }
  }
}

TEST(Boolean, WhereAnOperandTouchesItselfAwayFromTheOtherIsNotToldOfTheResult) {
  const Solid pair =
      boolean(solid_box({0, 0, 0}, {2, 2, 2}), Operation::Union, solid_box({2, 2, 2}, {4, 4, 4})).solid;
  for (const double at : {-11.0, 10.0}) {
    const BooleanResult apart = boolean(pair, Operation::Union, solid_box({at, -1, -1}, {at + 1, 5, 5}));
    EXPECT_NEAR(volume(apart.solid), 16 + 36, 1e-12);
    EXPECT_EQ(told(apart.findings).find("touches itself"), std::string::npos) << told(apart.findings);
  }
}

TEST(Boolean, PointsWhereItTouchesItselfAreCountedOnceEach) {
  const Triangles corners = shapes::together(
      shapes::together(shapes::box({-1, -1, -1}, {0, 0, 0}), shapes::box({2, 2, 2}, {3, 3, 3})),
      shapes::box({-1, 2, -1}, {0, 3, 0}));
  const BooleanResult three = boolean(solid_box({0, 0, 0}, {2, 2, 2}), Operation::Union, solid_of(corners));
  EXPECT_NEAR(volume(three.solid), 8 + 3, 1e-12);
  EXPECT_NE(told(three.findings).find("touches itself at 3 points;"), std::string::npos)
      << told(three.findings);
}

TEST(Boolean, TheResidualIsMeasuredAndNotMerelySmall) {
  double largest = 0;
  for (int i = 1; i <= 5; ++i) {
    const Booleans results =
        booleans(solid_sphere({0, 0, 0}, 3, 3), solid_sphere({0.3 * i, 0.5, 0.25}, 2.7, 3));
    ASSERT_TRUE(results.residual);
    const double whole = volume(solid_sphere({0, 0, 0}, 3, 3));
    const double seen =
        std::abs(whole - volume(*results.intersection) - volume(*results.a_minus_b)) / (2 * whole);
    EXPECT_GE(*results.residual, 0.9 * seen - 1e-17);
    largest = std::max(largest, *results.residual);
  }
  EXPECT_GT(largest, 0.0);
  EXPECT_LT(largest, 1e-13);
  const BooleanResult all = boolean({solid_sphere({0, 0, 0}, 3, 3), solid_sphere({1, 0.5, 0.25}, 2.7, 3),
                                     solid_sphere({0.3, 1, 0.6}, 2.5, 3)},
                                    Operation::Union);
  ASSERT_TRUE(all.residual);
  EXPECT_GT(*all.residual, 0.0);
}

TEST(Boolean, ASharedVertexIsKeptOnceForEachSheetAndTold) {
  const BooleanResult united =
      boolean(solid_box({0, 0, 0}, {2, 2, 2}), Operation::Union, solid_box({2, 2, 2}, {4, 4, 4}));
  EXPECT_NEAR(volume(united.solid), 16, 1e-12);
  const Health h = health(united.solid, {.self_intersections = false});
  EXPECT_TRUE(h.solid()) << told(h);
  EXPECT_EQ(h.vertices, 16u);
  EXPECT_NE(told(united.findings).find("touches itself at 1 point"), std::string::npos)
      << told(united.findings);
}

TEST(Boolean, APieceCutOffAndSlidAlongTheCutUnitesWithItsRest) {
  // The usual case in osteotomy: both cut faces lie in one plane again.
  const Solid ball = solid_sphere({0, 0, 0}, 10, 4);
  Prism prism;
  prism.polygons_mm = {{{-20, -20}, {20, -20}, {20, -2.5}, {-20, -2.5}}};
  prism.from_mm = -30;
  prism.to_mm = 30;
  const Booleans cut = booleans(ball, solid_of(prism), {false, true, true, false});
  for (const glm::dvec3& slide : {glm::dvec3(0, -6, 0), glm::dvec3(0.125, 0.25, 0), glm::dvec3(0, 0, 0)}) {
    const Solid piece = moved(*cut.intersection, glm::translate(glm::dmat4(1.0), slide));
    const BooleanResult united = boolean(*cut.a_minus_b, Operation::Union, piece);
    // Cut points are rounded, so the faces meet only to the last digit. If they would touch in points, the
    // piece is shifted by up to three steps over the area of the cut, and a finding states it.
    const bool shifted = told(united.findings).find("shifted: b was moved by") != std::string::npos;
    const double cut_mm2 = std::numbers::pi * (10 * 10 - 2.5 * 2.5);
    const double step_mm = 0x1p-18 * glm::length(glm::dvec3(20, 26, 20));
    EXPECT_NEAR(volume(united.solid), volume(ball), shifted ? 3 * step_mm * cut_mm2 : 1e-4)
        << told(united.findings);
    const Health h = health(united.solid);
    EXPECT_TRUE(h.closed && h.manifold && h.oriented) << told(h);
  }
}

TEST(Boolean, TheFirstLessAllOthersHowManyTheyAre) {
  std::vector<Solid> operands = {solid_box({0, 0, 0}, {10, 10, 10})};
  EXPECT_NEAR(volume(boolean(operands, Operation::Difference).solid), 1000, 1e-11);
  for (int others = 1; others <= 5; ++others) {
    // A corner of one cubic millimetre of each lies in the one before.
    operands.push_back(solid_box(glm::dvec3(others), glm::dvec3(others + 2)));
    EXPECT_NEAR(volume(boolean(operands, Operation::Difference).solid), 999 - 7 * others, 1e-11) << others;
  }
}

TEST(Boolean, StopsWhereAskedTo) {
  std::stop_source stop;
  const Solid a = solid_sphere({0, 0, 0}, 3, 6), b = solid_sphere({1, 0.5, 0.25}, 3, 6);
  std::jthread asker([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    stop.request_stop();
  });
  // On a fast machine it may end before the stop is requested; afterwards it must not.
  try {
    for (int i = 0; i < 100; ++i) boolean(a, Operation::Union, b, stop.get_token());
    ADD_FAILURE() << "never stopped";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Cancelled);
    EXPECT_STREQ(error.what(), "the Boolean was stopped");
  }
  EXPECT_GT(volume(boolean(a, Operation::Union, b).solid), volume(a)) << "the next one is not stopped";
}

TEST(Boolean, RefusesOpenAndInsideOutOperands) {
  const Triangles t = shapes::box({0, 0, 0}, {1, 1, 1});
  Triangles open = t;
  open.faces.pop_back();
  EXPECT_THROW(boolean(trusted_solid(open, Proof::Rounded), Operation::Union, solid_of(t)),
               std::invalid_argument);
  EXPECT_THROW(
      boolean(solid_of(t), Operation::Union, trusted_solid(shapes::inside_out(t), Proof::Connection)),
      std::invalid_argument);
}

TEST(Boolean, TheSameBitsComeEveryTime) {
  const Solid a = solid_sphere({0, 0, 0}, 3, 3), b = solid_sphere({1, 0.5, 0.25}, 3, 3);
  const Triangles once = triangles_of(boolean(a, Operation::Union, b).solid);
  const Triangles again = triangles_of(boolean(a, Operation::Union, b).solid);
  EXPECT_EQ(once.points_mm, again.points_mm);
  EXPECT_EQ(once.faces, again.faces);
}

TEST(Boolean, BallsOfAnotherProjectAddUp) {
  OCTOTOMY_NEEDS_DATA("meshes/ballA.off");
  const Solid a = solid_of(read_triangles(tests::reference_data("meshes/ballA.off")));
  const Solid b = solid_of(read_triangles(tests::reference_data("meshes/ballB.off")));
  const Booleans results = booleans(a, b);
  ASSERT_TRUE(results.residual);
  EXPECT_LT(*results.residual, 1e-12) << told(results.findings);
  EXPECT_GT(volume(*results.united), volume(a));
}

TEST(Boolean, AHundredSpheresAgainstABoxAddUp) {
  Triangles many;
  double whole = 0;
  for (int i = 0; i < 100; ++i) {
    many = shapes::together(many, shapes::sphere({3 * (i % 10), 3 * (i / 10), 0.01 * i}, 1.0 + 0.004 * i, 1));
  }
  const Solid spheres = solid_of(many);
  whole = volume(spheres);
  const Booleans cut = booleans(spheres, solid_box({-5, -5, 0.5}, {14.2, 40, 50}));
  EXPECT_NEAR(volume(*cut.intersection) + volume(*cut.a_minus_b), whole, 1e-10);
  EXPECT_GT(components(*cut.intersection).size(), 40u);
  expect_solid(*cut.intersection, "pieces");
}

}  // namespace
}  // namespace octotomy::brep

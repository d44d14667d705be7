// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/register_surfaces.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

#include "brep/io/read_mesh.h"
#include "brep/mesh/components.h"
#include "brep/mesh/move.h"
#include "brep/mesh/triangles.h"
#include "tests/brep/shapes.h"
#include "tests/reference_data.h"

namespace octotomy::brep {
namespace {

/// A face of a person, as an open surface of some 2000 points about 200 mm high; its file is in metres.
Mesh face_of_a_person() {
  Triangles face = read_triangles(tests::reference_data("meshes/fran_cut.vtk"));
  for (glm::dvec3& p : face.points_mm) p *= 1000.0;
  return mesh_of(face);
}

/// A body without symmetry: a bumpy ball.
Mesh potato(int splits) {
  Triangles t = shapes::sphere({0, 0, 0}, 1, splits);
  for (glm::dvec3& p : t.points_mm)
    p *= 30.0 + 6.0 * std::sin(3.0 * p.x + 1.0) + 5.0 * std::cos(4.0 * p.y) * p.z + 4.0 * p.x * p.y;
  return mesh_of(t);
}

glm::dmat4 motion(double degrees, const glm::dvec3& axis, const glm::dvec3& translation) {
  return glm::rotate(glm::translate(glm::dmat4(1.0), translation), glm::radians(degrees),
                     glm::normalize(axis));
}

Mesh with_noise(Mesh mesh, double sigma_mm, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, sigma_mm);
  for (const auto v : mesh.vertices())
    mesh.set_point(v, mesh.point(v) + Mesh::Point(normal(random), normal(random), normal(random)));
  return mesh;
}

/// The mesh without the share of its triangles that lie farthest along a direction.
Mesh without(const Mesh& mesh, double share, const glm::dvec3& direction) {
  std::vector<std::pair<double, std::uint32_t>> order;
  for (const auto f : mesh.faces()) {
    const Mesh::Point c = mesh.calc_face_centroid(f);
    order.emplace_back(c[0] * direction.x + c[1] * direction.y + c[2] * direction.z, f.idx());
  }
  std::sort(order.begin(), order.end());
  order.resize(static_cast<std::size_t>((1.0 - share) * static_cast<double>(order.size())));
  std::vector<std::uint32_t> faces;
  for (const auto& [along, face] : order) faces.push_back(face);
  std::sort(faces.begin(), faces.end());
  return part_of(mesh, faces);
}

/// The difference between the fitted and the true motion: the turn, and the largest displacement of a vertex.
struct MotionError {
  double degrees = 0.0, mm = 0.0;
};

MotionError error_of(const glm::dmat4& found, const glm::dmat4& truth, const Mesh& mesh) {
  MotionError error;
  const glm::dmat3 between = glm::dmat3(found) * glm::transpose(glm::dmat3(truth));
  const glm::dvec3 skew(between[1][2] - between[2][1], between[2][0] - between[0][2],
                        between[0][1] - between[1][0]);
  error.degrees =
      glm::degrees(std::atan2(glm::length(skew), between[0][0] + between[1][1] + between[2][2] - 1.0));
  for (const auto v : mesh.vertices()) {
    const glm::dvec4 p(mesh.point(v)[0], mesh.point(v)[1], mesh.point(v)[2], 1.0);
    error.mm = std::max(error.mm, glm::distance(glm::dvec3(found * p), glm::dvec3(truth * p)));
  }
  return error;
}

TEST(RegisterSurfaces, AFaceWithNoiseAndThirtyPerCentMissingIsBroughtBack) {
  OCTOTOMY_NEEDS_DATA("meshes/fran_cut.vtk");
  const Mesh fixed = face_of_a_person();
  const glm::dmat4 truth = motion(35.0, {1, 2, -1}, {40, -25, 60});
  int case_number = 0;
  for (const glm::dvec3& direction : {glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0), glm::dvec3(1, 0, 0)}) {
    const Mesh moving = with_noise(moved(without(fixed, 0.3, direction), glm::inverse(truth)), 0.1,
                                   static_cast<unsigned>(++case_number));
    const SurfaceFit fit = register_surfaces(moving, fixed);
    const MotionError error = error_of(fit.fixed_from_moving, truth, moving);
    EXPECT_LT(error.mm, 0.05) << "case " << case_number;
    EXPECT_LT(error.degrees, 0.05) << "case " << case_number;
    EXPECT_TRUE(fit.converged);
    EXPECT_GT(fit.rms_mm, 0.02);
    EXPECT_LT(fit.rms_mm, 0.2);
    EXPECT_TRUE(fit.findings.empty()) << fit.findings.front();
  }
}

TEST(RegisterSurfaces, TheWholeFindsItsPlaceOnAPartThatLacksThirtyPerCent) {
  OCTOTOMY_NEEDS_DATA("meshes/fran_cut.vtk");
  const Mesh whole = face_of_a_person();
  const glm::dmat4 truth = motion(20.0, {0, 1, 1}, {-15, 30, 5});
  const Mesh fixed = with_noise(without(whole, 0.3, {0, 1, 0}), 0.1, 5);
  const SurfaceFit fit = register_surfaces(moved(whole, glm::inverse(truth)), fixed);
  const MotionError error = error_of(fit.fixed_from_moving, truth, moved(whole, glm::inverse(truth)));
  EXPECT_LT(error.mm, 0.05);
  EXPECT_LT(error.degrees, 0.05);
}

TEST(RegisterSurfaces, AnyTurnIsFoundWithoutAStart) {
  const Mesh fixed = potato(3);
  int number = 0;
  for (const double degrees : {60.0, 180.0})
    for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), glm::dvec3(0.3, -1, 2)}) {
      const glm::dmat4 truth = motion(degrees, axis, {100, -200, 50});
      const Mesh moving = moved(fixed, glm::inverse(truth));
      const SurfaceFit fit = register_surfaces(moving, fixed, {.overlap = 0.95});
      const MotionError error = error_of(fit.fixed_from_moving, truth, moving);
      EXPECT_LT(error.mm, 1e-6) << degrees << " degrees, case " << number;
      ++number;
    }
}

TEST(RegisterSurfaces, AStartNearTheTruthIsKeptTo) {
  const Mesh fixed = potato(3);
  const glm::dmat4 truth = motion(10.0, {1, 1, 0}, {3, 2, 1});
  const Mesh moving = moved(fixed, glm::inverse(truth));
  const SurfaceFit fit =
      register_surfaces(moving, fixed, {.start = motion(8.0, {1, 1, 0.1}, {2, 2, 2}), .overlap = 1.0});
  EXPECT_LT(error_of(fit.fixed_from_moving, truth, moving).mm, 1e-6);
  EXPECT_TRUE(fit.converged);
}

TEST(RegisterSurfaces, BallsThatSlideSaySo) {
  const Mesh ball = mesh_of(shapes::sphere({0, 0, 0}, 30, 4));
  const SurfaceFit fit = register_surfaces(moved(ball, motion(7.0, {1, 2, 3}, {5, 6, 7})), ball);
  ASSERT_FALSE(fit.findings.empty());
  EXPECT_NE(fit.findings.back().find("slide"), std::string::npos) << fit.findings.back();
}

TEST(RegisterSurfaces, TheMotionIsTheSameOnOneThreadAndRigid) {
  const Mesh fixed = potato(3);
  const Mesh moving = with_noise(moved(fixed, motion(50.0, {1, 0, 2}, {1, 2, 3})), 0.2, 1);
  const SurfaceFit many = register_surfaces(moving, fixed);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SurfaceFit alone = register_surfaces(moving, fixed);
  EXPECT_EQ(many.fixed_from_moving, alone.fixed_from_moving);
  EXPECT_NO_THROW(moved(moving, many.fixed_from_moving));
}

/// A bent tube, somewhat thicker at its ends.
Triangles tube() {
  Triangles t = shapes::sphere({0, 0, 0}, 1, 4);
  for (glm::dvec3& p : t.points_mm) {
    const double r = 6.0 + 2.5 * p.x * p.x + 1.5 * p.x + 0.8 * std::sin(9.0 * p.x);
    p = {70.0 * p.x, 12.0 * std::sin(2.6 * p.x) + r * p.y,
         3.0 * std::cos(3.0 * p.x) + r * (0.8 - 0.2 * p.x) * p.z};
  }
  return t;
}

TEST(RegisterSurfaces, ARightFitIsTrustedAndItsSearchMatchesNothingElse) {
  const Mesh fixed = mesh_of(tube());
  const glm::dmat4 truth = motion(60.0, {1, 2, 3}, {10, 20, 30});
  const Mesh moving = with_noise(moved(fixed, glm::inverse(truth)), 0.05, 3);
  const SurfaceFit fit = register_surfaces(moving, fixed);
  ASSERT_TRUE(fit.trust);
  EXPECT_EQ(fit.trust->verdict, FitVerdict::Right) << fit.trust->reason;
  EXPECT_TRUE(fit.trust->equals.empty());
  EXPECT_GT(fit.trust->matched_share, 2.0 * fit.trust->rival_share);
  EXPECT_GT(fit.trust->agreeing_starts, 1U);
  EXPECT_EQ(fit.trust->starts, 61U);
  EXPECT_TRUE(fit.findings.empty()) << fit.findings.front();
  EXPECT_LT(error_of(fit.fixed_from_moving, truth, moving).mm, 0.2);
}

TEST(RegisterSurfaces, BodiesThatHaveNothingInCommonAreAFailedFit) {
  const Mesh fixed = potato(3);
  Triangles other = tube();
  const SurfaceFit fit = register_surfaces(mesh_of(other), fixed);
  ASSERT_TRUE(fit.trust);
  EXPECT_EQ(fit.trust->verdict, FitVerdict::Failed);
  ASSERT_FALSE(fit.findings.empty());
  EXPECT_TRUE(fit.findings.back().starts_with("FAIL registration: ")) << fit.findings.back();
  EXPECT_NE(fit.findings.back().find("--landmarks"), std::string::npos);
  // The misfit is detected from a given start too, although there is no search to compare with.
  const SurfaceFit started = register_surfaces(mesh_of(other), fixed, {.start = glm::dmat4(1.0)});
  EXPECT_NE(started.trust->verdict, FitVerdict::Right);
  EXPECT_EQ(started.trust->starts, 0U);
}

TEST(RegisterSurfaces, AForeignBodyOfMoreThanHalfTheAreaIsFittedRightOrNotTrusted) {
  const Mesh fixed = mesh_of(tube());
  int right = 0, told = 0;
  for (int i = 0; i < 3; ++i) {
    const glm::dmat4 truth = motion(60.0, {1.0, 0.3 * i, -1.0}, {5.0 * i, 20, -30});
    const Triangles foreign = shapes::sphere({10.0 * i, 30, 10.0 - 4.0 * i}, 15.0 + 4.0 * i, 3);
    const Mesh moving = moved(mesh_of(shapes::together(tube(), foreign)), glm::inverse(truth));
    const SurfaceFit fit = register_surfaces(moving, fixed, {.samples = 1000});
    const bool is_right = error_of(fit.fixed_from_moving, truth, moved(fixed, glm::inverse(truth))).mm < 1.0;
    if (is_right) ++right;
    if (!is_right) {
      ++told;
      EXPECT_NE(fit.trust->verdict, FitVerdict::Right) << "case " << i;
    }
  }
  EXPECT_GE(right, 1) << told << " told";
}

TEST(RegisterSurfaces, TheFourAnswersOfABoxAreStated) {
  Triangles box = shapes::sphere({0, 0, 0}, 1, 4);
  for (glm::dvec3& p : box.points_mm)
    p = p / std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) * glm::dvec3(20, 30, 45);
  const Mesh fixed = mesh_of(box);
  const SurfaceFit fit = register_surfaces(moved(fixed, motion(40.0, {1, 2, 3}, {5, 6, 7})), fixed);
  ASSERT_TRUE(fit.trust);
  EXPECT_EQ(fit.trust->verdict, FitVerdict::Right);
  EXPECT_EQ(fit.trust->equals.size(), 3U);
  ASSERT_FALSE(fit.findings.empty());
  EXPECT_NE(fit.findings.back().find("3 other motions match"), std::string::npos) << fit.findings.back();
  // Each equal answer takes the box onto itself.
  for (const glm::dmat4& equal : fit.trust->equals) {
    const glm::dmat4 own = equal * glm::inverse(fit.fixed_from_moving);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::abs(own[axis][axis]), 1.0, 0.01);
  }
}

TEST(RegisterSurfaces, StopsAndRefusesWhatCannotBe) {
  const Mesh mesh = potato(2);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(register_surfaces(mesh, mesh, {.stop = stop.get_token()}), std::runtime_error);
  EXPECT_THROW(register_surfaces(Mesh(), mesh), std::invalid_argument);
  EXPECT_THROW(register_surfaces(mesh, Mesh()), std::invalid_argument);
  EXPECT_THROW(register_surfaces(mesh, mesh, {.overlap = 0.0}), std::invalid_argument);
  EXPECT_THROW(register_surfaces(mesh, mesh, {.overlap = 1.1}), std::invalid_argument);
  EXPECT_THROW(register_surfaces(mesh, mesh, {.samples = 10}), std::invalid_argument);
  EXPECT_THROW(register_surfaces(mesh, mesh, {.max_rounds = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/decimate.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <string>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "tests/brep/shape/plain_decimation.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

Triangles centred_ball(double radius_mm, int splits) {
  return shapes::sphere({0, 0, 0}, radius_mm, splits);
}

/// A ball with a concentric cavity.
Mesh shell(double outer_mm, double inner_mm, int splits) {
  return mesh_of(
      shapes::together(centred_ball(outer_mm, splits), shapes::inside_out(centred_ball(inner_mm, splits))));
}

TEST(Decimate, ABallKeepsItsVolumeWithinTheErrorAndItsVerticesAreTheOldOnes) {
  const Triangles fine = centred_ball(30.0, 5);
  DecimateOptions options;
  options.max_error_mm = 0.3;
  const Mesh coarse = decimate(mesh_of(fine), options);
  EXPECT_LT(coarse.n_faces(), fine.faces.size() / 3);
  EXPECT_TRUE(health(coarse).solid());
  const Measures before = measure(mesh_of(fine));
  EXPECT_LT(std::abs(measure(coarse).volume_mm3 - before.volume_mm3), before.area_mm2 * options.max_error_mm);
  std::set<std::array<double, 3>> points;
  for (const glm::dvec3& p : fine.points_mm) points.insert({p.x, p.y, p.z});
  for (const auto vertex : coarse.vertices()) {
    const OpenMesh::Vec3d& p = coarse.point(vertex);
    EXPECT_TRUE(points.contains({p[0], p[1], p[2]}));
  }
}

TEST(Decimate, CollapsesTheSameEdgesAsTheLibraryOnItsOwnMesh) {
  const Triangles torus = shapes::torus(20.0, 6.0, 60, 30);
  for (const Triangles& fine : {centred_ball(30.0, 4), torus, shapes::box({0, 0, 0}, {3, 2, 1})})
    for (const double error_mm : {0.05, 0.5, 20.0}) {
      DecimateOptions options;
      options.max_error_mm = error_mm;
      options.max_normal_deviation_deg = error_mm > 1.0 ? 90.0 : 45.0;
      options.max_aspect = error_mm > 1.0 ? 1000.0 : 10.0;
      const Mesh plain = plain_decimation(mesh_of(fine), options);
      if (!health(plain).solid()) continue;
      const Triangles ours = triangles_of(decimate(mesh_of(fine), options)), theirs = triangles_of(plain);
      EXPECT_EQ(ours.points_mm, theirs.points_mm);
      EXPECT_EQ(ours.faces, theirs.faces);
    }
}

TEST(Decimate, EndsAtTheNumberOfFacesAskedFor) {
  DecimateOptions options;
  options.max_error_mm = 10.0;
  options.faces = 1000;
  const Mesh coarse = decimate(mesh_of(centred_ball(30.0, 5)), options);
  EXPECT_LE(coarse.n_faces(), 1000U);
  EXPECT_GE(coarse.n_faces(), 998U) << "a collapse takes two";
  EXPECT_TRUE(health(coarse).solid());
}

TEST(Decimate, WallsThinnerThanTheErrorDoNotPassThroughEachOther) {
  const Mesh thin = shell(20.0, 19.9, 4);
  DecimateOptions options;
  options.max_error_mm = 1.0;
  options.max_rounds = 1;
  EXPECT_THROW(decimate(thin, options), std::runtime_error)
      << "one round does not do: the case is a hard one";
  options.max_rounds = 30;
  const Mesh coarse = decimate(thin, options);
  EXPECT_EQ(health(coarse).self_intersections, 0U);
  EXPECT_LT(coarse.n_faces(), thin.n_faces());
  EXPECT_EQ(health(coarse).components, 2U);
}

TEST(Decimate, AMeshThatIntersectsItselfBeforeIsNamedAsTheLikelyCause) {
  const Triangles t = shapes::together(centred_ball(10.0, 2), shapes::sphere({7.1, 0.3, 0.2}, 10.0, 2));
  try {
    decimate(mesh_of(t));
    FAIL() << "two balls through each other came out well";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("the input intersects itself"), std::string::npos)
        << error.what();
  }
}

TEST(Decimate, OpenMeshesAndOptionsOutOfRangeAreRefused) {
  Triangles open = centred_ball(10.0, 1);
  open.faces.pop_back();
  EXPECT_THROW(decimate(mesh_of(open)), std::invalid_argument);
  DecimateOptions options;
  options.max_error_mm = 0.0;
  EXPECT_THROW(decimate(mesh_of(centred_ball(10.0, 1)), options), std::invalid_argument);
}

TEST(Decimate, GivesTheSameMeshTwice) {
  const Triangles once = triangles_of(decimate(mesh_of(centred_ball(30.0, 4))));
  const Triangles again = triangles_of(decimate(mesh_of(centred_ball(30.0, 4))));
  EXPECT_EQ(once.points_mm, again.points_mm);
  EXPECT_EQ(once.faces, again.faces);
}

}  // namespace
}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/decimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <string>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "brep/shape/surface_error.h"
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
  int compared = 0;
  for (const Triangles& fine : {centred_ball(30.0, 4), torus, shapes::box({0, 0, 0}, {3, 2, 1})})
    for (const double error_mm : {0.05, 0.5, 20.0}) {
      DecimateOptions options;
      options.max_error_mm = error_mm;
      options.max_normal_deviation_deg = error_mm > 1.0 ? 90.0 : 45.0;
      options.max_aspect = error_mm > 1.0 ? 1000.0 : 10.0;
      const Mesh plain = plain_decimation(mesh_of(fine), options);
      if (!health(plain).solid()) continue;
      if (!far_places(fine, SurfaceTree(fine), triangles_of(plain), error_mm).given_points.empty()) continue;
      ++compared;
      const Triangles ours = triangles_of(decimate(mesh_of(fine), options)), theirs = triangles_of(plain);
      EXPECT_EQ(ours.points_mm, theirs.points_mm);
      EXPECT_EQ(ours.faces, theirs.faces);
    }
  EXPECT_GE(compared, 3);
}

TEST(Decimate, NeitherSurfaceLiesFurtherFromTheOtherThanTheError) {
  const Triangles torus = shapes::torus(20.0, 6.0, 120, 60), ball = centred_ball(10.0, 5);
  int redone = 0;
  for (const Triangles& fine : {torus, ball})
    for (const double error_mm : {0.02, 0.1, 0.5, 2.0}) {
      DecimateOptions options;
      options.max_error_mm = error_mm;
      const Mesh coarse = decimate(mesh_of(fine), options);
      EXPECT_TRUE(health(coarse).solid());
      const FarPlaces far = far_places(fine, SurfaceTree(fine), triangles_of(coarse), error_mm);
      EXPECT_LE(far.largest_mm, error_mm);
      EXPECT_LT(coarse.n_faces(), fine.faces.size()) << error_mm;
      const Triangles once = triangles_of(plain_decimation(mesh_of(fine), options));
      redone += far_places(fine, SurfaceTree(fine), once, error_mm).largest_mm > error_mm;
    }
  EXPECT_GT(redone, 0) << "no case was a hard one";
}

TEST(Decimate, ASearchForFarPlacesThatMayEndEarlyFindsTheSame) {
  const Triangles fine = shapes::torus(20.0, 6.0, 120, 60);
  DecimateOptions options;
  options.max_error_mm = 0.5;
  const Triangles coarse = triangles_of(plain_decimation(mesh_of(fine), options));
  const SurfaceTree tree(fine);
  const double limit_mm = 0.5 * far_places(fine, tree, coarse, 1.0).largest_mm;
  const FarPlaces whole = far_places(fine, tree, coarse, limit_mm),
                  early = far_places(fine, tree, coarse, limit_mm, limit_mm);
  EXPECT_FALSE(whole.given_points.empty());
  EXPECT_EQ(early.largest_mm, whole.largest_mm);
  EXPECT_EQ(early.given_points, whole.given_points);
  EXPECT_EQ(early.coarse_faces, whole.coarse_faces);
}

TEST(Decimate, WhatIsStillThereIsNotMeasuredAgainAndTheSameIsFound) {
  const Triangles fine = shapes::torus(20.0, 6.0, 120, 60);
  const SurfaceTree tree(fine);
  const auto coarse_at = [&](double error_mm) {
    DecimateOptions options;
    options.max_error_mm = error_mm;
    return triangles_of(plain_decimation(mesh_of(fine), options));
  };
  const auto fine_points_of = [&](const Triangles& coarse) {
    std::vector<std::uint32_t> numbers;
    for (const glm::dvec3& p : coarse.points_mm)
      numbers.push_back(static_cast<std::uint32_t>(
          std::find(fine.points_mm.begin(), fine.points_mm.end(), p) - fine.points_mm.begin()));
    return numbers;
  };
  // From coarse to fine and back, so triangles are removed and come back.
  const std::vector<Triangles> rounds = {coarse_at(0.5), coarse_at(0.1), coarse_at(0.02), coarse_at(0.1),
                                         fine};
  const double limit_mm = 0.5 * far_places(fine, tree, rounds.front(), 1.0).largest_mm;
  NearFaces near;
  int were_far = 0;
  for (const Triangles& coarse : rounds) {
    const FarPlaces anew = far_places(fine, tree, coarse, limit_mm, limit_mm),
                    found = far_places(fine, tree, coarse, fine_points_of(coarse), limit_mm, near);
    EXPECT_EQ(found.given_points, anew.given_points);
    EXPECT_EQ(found.coarse_faces, anew.coarse_faces);
    EXPECT_EQ(found.largest_mm > limit_mm, anew.largest_mm > limit_mm);
    were_far += anew.given_points.empty() ? 0 : 1;
  }
  EXPECT_GT(were_far, 0);
  EXPECT_LT(were_far, 5);
}

TEST(Decimate, FarPlacesAreMeasuredBothWays) {
  const Triangles low = shapes::box({0, 0, 0}, {10, 10, 10}), high = shapes::box({0, 0, 0}, {10, 10, 12});
  for (const auto& [given, coarse] : {std::pair(low, high), std::pair(high, low)}) {
    const FarPlaces far = far_places(given, SurfaceTree(given), coarse, 1.0);
    EXPECT_NEAR(far.largest_mm, 2.0, 1e-12);
    EXPECT_FALSE(far.given_points.empty());
    EXPECT_FALSE(far.coarse_faces.empty());
    EXPECT_TRUE(far_places(given, SurfaceTree(given), coarse, 2.5).given_points.empty());
  }
}

TEST(Decimate, AnOpenMeshKeepsItsBorder) {
  Triangles cap = centred_ball(30.0, 4);
  std::erase_if(cap.faces, [&](const auto& f) {
    return cap.points_mm[f[0]].z + cap.points_mm[f[1]].z + cap.points_mm[f[2]].z < 0.0;
  });
  std::map<std::uint32_t, std::uint32_t> number;
  std::vector<glm::dvec3> in_use;
  for (auto& face : cap.faces)
    for (std::uint32_t& v : face) {
      const auto [known, is_new] = number.try_emplace(v, static_cast<std::uint32_t>(in_use.size()));
      if (is_new) in_use.push_back(cap.points_mm[v]);
      v = known->second;
    }
  cap.points_mm = std::move(in_use);
  const Mesh open = mesh_of(cap);
  const auto border = [](const Mesh& mesh) {
    std::set<std::array<double, 3>> points;
    for (const auto h : mesh.halfedges())
      if (mesh.is_boundary(h)) {
        const Mesh::Point& p = mesh.point(mesh.to_vertex_handle(h));
        points.insert({p[0], p[1], p[2]});
      }
    return points;
  };
  DecimateOptions options;
  options.max_error_mm = 0.3;
  const Mesh coarse = decimate(open, options);
  EXPECT_LT(coarse.n_faces(), open.n_faces() / 2);
  EXPECT_EQ(border(coarse), border(open));
  EXPECT_TRUE(health(coarse).manifold);
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

TEST(Decimate, OptionsOutOfRangeAreRefused) {
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

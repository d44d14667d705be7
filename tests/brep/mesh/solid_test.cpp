// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/solid.h"

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <optional>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <utility>
#include <vector>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

static_assert(!std::is_constructible_v<Solid, Mesh> && !std::is_constructible_v<Solid, Triangles>,
              "only health and trusted makers make solids");

Triangles cube() {
  return shapes::box({0, 0, 0}, {2, 2, 2});
}

/// A spoiled cube and what health() should find first.
struct Spoiled {
  Defect defect;
  Triangles triangles;
  const char* told;
};

/// Points at one place become one.
Triangles joined(Triangles t) {
  for (auto& face : t.faces)
    for (std::uint32_t& v : face)
      v = static_cast<std::uint32_t>(std::find(t.points_mm.begin(), t.points_mm.end(), t.points_mm[v]) -
                                     t.points_mm.begin());
  return t;
}

/// A cube one of whose edges has a further point, which a triangle without area joins to its ends.
Triangles with_flat_triangle() {
  Triangles t = cube();
  t.points_mm.emplace_back(1.0, 0.0, 0.0);
  *std::find(t.faces.begin(), t.faces.end(), std::array<std::uint32_t, 3>{0, 1, 5}) = {0, 8, 5};
  t.faces.insert(t.faces.end(), {{8, 1, 5}, {0, 1, 8}});
  return t;
}

std::vector<Spoiled> spoiled_solids() {
  Triangles open = cube(), turned = cube();
  open.faces.pop_back();
  std::swap(turned.faces[3][0], turned.faces[3][1]);
  const auto with = [](const glm::dvec3& low, const glm::dvec3& high) {
    return shapes::together(cube(), shapes::box(low, high));
  };
  const Triangles pillow{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  return {{Defect::NoTriangles, {}, "no triangles"},
          {Defect::Open, open, "the surface is open"},
          {Defect::NonmanifoldEdge, joined(with({2, 2, 0}, {4, 4, 2})), "more than two triangles"},
          {Defect::NonmanifoldVertex, joined(with({2, 2, 2}, {4, 4, 4})), "more than one fan"},
          {Defect::Misoriented, turned, "wind against each other"},
          {Defect::Degenerate, with_flat_triangle(), "without area"},
          {Defect::Duplicate, pillow, "with the same points"},
          {Defect::MisplacedShell, with({0.5, 0.5, 0.5}, {1, 1, 1}),
           "shells that overlap: they lie within others that face outward, too"},
          {Defect::SelfIntersection, with({1, 1, 1}, {3, 3, 3}), "pairs of triangles that intersect"}};
}

TEST(Solid, IsMadeOfWhatHealthProves) {
  const Solid solid = solid_of(cube());
  EXPECT_EQ(solid.proof(), Proof::Health);
  EXPECT_FALSE(solid.empty());
  EXPECT_EQ(solid.triangles().faces, cube().faces);
  EXPECT_EQ(solid.triangles().points_mm, cube().points_mm);
  EXPECT_DOUBLE_EQ(solid.measures().volume_mm3, 8.0);
  EXPECT_DOUBLE_EQ(solid.size().volume_mm3, 8.0);
  EXPECT_DOUBLE_EQ(solid.tree().distances_mm({{5, 1, 1}}).front(), 3.0);
  EXPECT_EQ(solid.tree().inside({{1, 1, 1}, {3, 1, 1}}), (std::vector<std::uint8_t>{1, 0}));
}

TEST(Solid, RefusesEveryDefectByNameTriangleAndPlace) {
  for (const Spoiled& spoiled : spoiled_solids()) {
    EXPECT_EQ(health(spoiled.triangles).first_defect, spoiled.defect) << spoiled.told;
    try {
      solid_of(spoiled.triangles);
      ADD_FAILURE() << spoiled.told;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Geometry);
      const std::string text = error.what();
      EXPECT_NE(text.find("is not a solid: "), std::string::npos) << text;
      EXPECT_NE(text.find(spoiled.told), std::string::npos) << text;
      if (spoiled.defect == Defect::NoTriangles) continue;
      EXPECT_NE(text.find("triangle"), std::string::npos) << text;
      EXPECT_NE(text.find(" mm)"), std::string::npos) << text;
    }
  }
  EXPECT_EQ(health(cube()).first_defect, std::nullopt);
}

TEST(Solid, CopiesShareWhatWasComputed) {
  const Solid solid = solid_of(cube()), copy = solid;
  EXPECT_TRUE(copy.is_same(solid));
  EXPECT_EQ(&copy.measures(), &solid.measures());
  EXPECT_EQ(&copy.triangles(), &solid.triangles());
  EXPECT_EQ(&copy.tree(), &solid.tree());
  EXPECT_FALSE(solid_of(cube()).is_same(solid));
}

TEST(Solid, OfNothingIsTheEmptySet) {
  const Solid nothing;
  EXPECT_TRUE(nothing.empty());
  EXPECT_TRUE(nothing.triangles().faces.empty());
  EXPECT_EQ(nothing.size().volume_mm3, 0.0);
  EXPECT_EQ(nothing.measures().area_mm2, 0.0);
  EXPECT_TRUE(trusted_solid(Triangles(), Proof::Rounded).empty());
}

TEST(Solid, ATrustedOneIsStillClosed) {
  Triangles open = cube();
  open.faces.pop_back();
  EXPECT_THROW(trusted_solid(open, Proof::Connection), std::invalid_argument);
  EXPECT_THROW(trusted_solid(mesh_of(open), Proof::Connection), std::invalid_argument);
  EXPECT_EQ(trusted_solid(cube(), Proof::Construction).proof(), Proof::Construction);
}

TEST(Solid, GivesTheTrianglesOfItsMeshWhereFansShareAPoint) {
  // Two cubes with one point in common, which the mesh has twice.
  const Triangles pair = joined(shapes::together(cube(), shapes::box({2, 2, 2}, {3, 3, 3})));
  const Solid solid = trusted_solid(pair, Proof::Rounded);
  EXPECT_EQ(solid.triangles().points_mm.size(), solid.mesh().n_vertices());
  EXPECT_EQ(solid.triangles().faces, triangles_of(solid.mesh()).faces);
}

TEST(Solid, AMotionKeepsTheSetAndLowersTheProof) {
  const glm::dmat4 motion =
      glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(10, 0, 0)), 0.3, glm::dvec3(0, 0, 1));
  const Solid still = solid_of(cube()), turned = moved(still, motion);
  EXPECT_EQ(turned.proof(), Proof::Rounded);
  EXPECT_NEAR(turned.size().volume_mm3, 8.0, 1e-12);
  EXPECT_EQ(moved(trusted_solid(cube(), Proof::Connection), motion).proof(), Proof::Connection);
}

TEST(Solid, ComputesOnceHoweverManyThreadsAsk) {
  for (int round = 0; round < 20; ++round) {
    const Solid solid = solid_of(shapes::sphere({0, 0, 0}, 3, 3));
    const Measures alone = measure(solid.mesh());
    std::vector<const Measures*> seen(200);
    std::vector<const SurfaceTree*> trees(seen.size());
    // Each computes by a parallel loop of its own, within which a thread may come by further callers.
    tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t i) {
      seen[i] = &solid.measures();
      trees[i] = &solid.tree();
    });
    for (std::size_t i = 0; i < seen.size(); ++i) {
      EXPECT_EQ(seen[i], seen.front());
      EXPECT_EQ(trees[i], trees.front());
    }
    EXPECT_EQ(solid.measures().volume_mm3, alone.volume_mm3);
  }
}

}  // namespace
}  // namespace octotomy::brep

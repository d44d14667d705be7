// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/brush_witness.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <stdexcept>

#include "brep/mesh/measure.h"
#include "brep/shape/brush.h"
#include "tests/unit_universe.h"
#include "verify/witness/line_count.h"
#include "voxel/solid/brush.h"
#include "voxel/solid/membership.h"

namespace octotomy::verify {
namespace {

/// The same brush for the witness and for both kernels.
struct Drawn {
  std::vector<DrawnBrush> ways;
  std::vector<voxel::BrushStroke> strokes;
  std::vector<brep::BrushTrace> traces;

  void add(const std::vector<glm::dvec3>& points_mm, double radius_mm) {
    ways.push_back({points_mm, radius_mm});
    strokes.push_back({points_mm, radius_mm});
    traces.push_back({points_mm, radius_mm});
  }
  void make_slab(const glm::dvec3& normal, const glm::dvec3& across, double thickness_mm) {
    ways.back().disc = {normal, across, thickness_mm};
    strokes.back().slab = {normal, across, thickness_mm};
    traces.back().disc = {normal, across, thickness_mm};
  }
};

Drawn random_brush(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  Drawn drawn;
  for (unsigned stroke = 0; stroke < 1 + seed % 3; ++stroke) {
    std::vector<glm::dvec3> points_mm{5.0 * glm::dvec3(share(random), share(random), share(random))};
    for (unsigned i = 0; i < (seed + stroke) % 5; ++i)
      points_mm.push_back(points_mm.back() + 4.0 * glm::dvec3(share(random), share(random),
                                                              seed % 2 == 0 ? 0.0 : share(random)));
    drawn.add(points_mm, 2.0 + share(random));
    if ((seed + stroke) % 2 == 0) continue;
    const glm::dvec3 normal = glm::normalize(glm::dvec3(share(random), share(random), 2.0));
    drawn.make_slab(normal, glm::normalize(glm::cross(normal, glm::dvec3(1.0, 0.0, 0.0))),
                    1.5 + share(random));
  }
  return drawn;
}

TEST(BrushWitness, AgreesWithBothKernelsOnRandomStrokes) {
  std::size_t in = 0, out = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Drawn drawn = random_brush(seed);
    const Witness witness = witness_of_brush(drawn.ways);
    const voxel::Membership voxels(tests::unit_universe(5), voxel::brush(drawn.strokes));
    const brep::Solid mesh = brep::brush_solid(drawn.traces).solid;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-12.0, 12.0);
    for (int i = 0; i < 1500; ++i) {
      const glm::dvec3 p_mm(place(random), place(random), place(random));
      const AllowedSides sides = witness.mesh_sides(p_mm);
      ASSERT_FALSE(sides.near) << seed;
      ASSERT_EQ(voxels(p_mm), sides.in)
          << "seed " << seed << " at " << p_mm.x << ' ' << p_mm.y << ' ' << p_mm.z;
      ++(sides.in ? in : out);
    }
    for (const glm::dvec3& corner_mm : mesh.triangles().points_mm) {
      const Reading reading = witness(corner_mm, 0.0);
      EXPECT_TRUE(reading.mesh.near) << seed;
      EXPECT_GE(reading.surfaces, 2) << "a corner of the mesh is one of the brush, seed " << seed;
    }
    for (const auto& face : mesh.triangles().faces) {
      const auto& points = mesh.triangles().points_mm;
      const glm::dvec3 middle_mm = (points[face[0]] + points[face[1]] + points[face[2]]) / 3.0;
      EXPECT_TRUE(witness.mesh_sides(middle_mm).near) << seed;
    }
  }
  EXPECT_GT(in, 200u);
  EXPECT_GT(out, 200u);
}

TEST(BrushWitness, LinesAgreeWithPointsAndWithTheMeshesVolume) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Drawn drawn = random_brush(seed);
    const Witness witness = witness_of_brush(drawn.ways);
    const LineCount count = count_along_lines(witness.lines(), {.seed = seed + 1});
    const double volume_mm3 = brep::volume_mm3(brep::brush_solid(drawn.traces).solid);
    EXPECT_NEAR(count.volume_mm3, volume_mm3, 5.0 * count.deviation_mm3 + 0.005 * volume_mm3) << seed;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(-1.0, 1.0);
    for (int i = 0; i < 100; ++i) {
      const Line line{5.0 * glm::dvec3(share(random), share(random), share(random)),
                      glm::normalize(glm::dvec3(share(random), share(random), share(random)))};
      const Spans spans = witness.lines().inside(line, {{-20.0, 3.0}, {4.0, 20.0}});
      for (double at_mm = -19.93; at_mm < 20.0; at_mm += 0.31) {
        if (at_mm > 3.0 && at_mm < 4.0) continue;
        const bool in_span = std::any_of(spans.begin(), spans.end(), [&](const Span& span) {
          return at_mm > span.low_mm && at_mm < span.high_mm;
        });
        ASSERT_EQ(in_span, witness.mesh_sides(line.from_mm + at_mm * line.along).in) << seed << ' ' << i;
      }
    }
  }
}

TEST(BrushWitness, OnAFaceBesideThePieceThereIsOneSurface) {
  // Along x the outermost edge above is flat: half of the way, one face.
  const Witness witness = witness_of_brush({{{{-5.0, 0.0, 0.0}, {5.0, 0.0, 0.0}}, 2.0}});
  const double top_mm = 2.0 * 0.9675583399663303 * std::numbers::sqrt3 / std::numbers::phi;
  EXPECT_EQ(witness.mesh_sides({0.3, 0.0, top_mm - 1e-5}), certainly_in);
  EXPECT_EQ(witness.mesh_sides({0.3, 0.0, top_mm + 1e-5}), certainly_out);
  EXPECT_TRUE(witness.mesh_sides({0.3, 0.0, top_mm}).near);
}

TEST(BrushWitness, ABrushWithoutPointsIsRefused) {
  EXPECT_THROW(witness_of_brush({}), std::invalid_argument);
  EXPECT_THROW(witness_of_brush({{{}, 2.0}}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify

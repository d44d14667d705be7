// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/warped_witness.h"

#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "brep/mesh/solid.h"
#include "convert/deck/displacement_field.h"
#include "convert/surface/isosurface.h"
#include "convert/tet/octree_tetrahedra.h"
#include "convert/voxel/voxelise.h"
#include "tests/unit_universe.h"
#include "verify/certificate/certify_bounded.h"
#include "verify/certificate/surface_reach.h"
#include "verify/witness/witness.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

/// A ball of 9 mm in a scan, in elements of a ball of 13 mm, all about (16, 16, 16), which stretch and bend.
class AWarpedBall : public testing::Test {
 protected:
  static constexpr double endless = std::numeric_limits<double>::infinity();
  static constexpr double fade_mm = 20.0;
  static convert::Tetrahedra elements() {
    return convert::tetrahedra_of(voxel::combine(tests::unit_universe(5), voxel::Sphere{{16, 16, 16}, 13.0}));
  }
  static glm::dvec3 bent(const glm::dvec3& p) {
    const glm::dvec3 q = (p - 16.0) / 13.0;
    return {1.5 + 0.8 * q.y * q.y, -1.0 + 0.9 * q.z, 0.7 * q.x * q.y + 0.5 * q.x};
  }
  static std::vector<glm::dvec3> displacements(const convert::Tetrahedra& of, double share = 1.0) {
    std::vector<glm::dvec3> made;
    for (const glm::dvec3& p : of.nodes_mm) made.push_back(share * bent(p));
    return made;
  }
  static std::shared_ptr<const NodeMotion> motion() {
    const convert::Tetrahedra all = elements();
    return std::make_shared<const NodeMotion>(all, displacements(all), fade_mm);
  }
  static convert::DisplacementField field(double share = 1.0) {
    const convert::Tetrahedra all = elements();
    return {all, displacements(all, share), fade_mm};
  }

  static std::shared_ptr<const voxel::Scene> scan() {
    voxel::Scene scene;
    scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(33), glm::dvec3(1.0), glm::dvec3(0.0));
    voxel::Int16Samples samples(scene.lattice.sample_count());
    std::size_t i = 0;
    for (int z = 0; z < 33; ++z)
      for (int y = 0; y < 33; ++y)
        for (int x = 0; x < 33; ++x) {
          const double depth_mm = 9.0 - glm::distance(glm::dvec3(x, y, z), {16.21, 15.87, 16.34});
          samples[i++] = static_cast<std::int16_t>(std::lround(2000.0 * std::clamp(depth_mm, -0.5, 0.5)));
        }
    scene.samples = std::move(samples);
    return std::make_shared<const voxel::Scene>(std::move(scene));
  }
  static brep::Solid still() {
    return brep::trusted_solid(convert::isosurface(*scan(), 0.0, endless), brep::Proof::Construction);
  }
  static brep::Solid warped(const convert::DisplacementField& by) {
    return brep::trusted_solid(convert::warped(still().mesh(), by), brep::Proof::Connection);
  }

  static Witness witness() {
    return witness_of_reshaped([] {
      const auto by = motion();
      const Witness window = witness_of_window(scan(), 0.0, endless, tests::unit_universe(5));
      return Reshaped{surface_warped(still().triangles(), *by),
                      witness_of_warped(window, still().triangles(), by)};
    });
  }
  static Certificate by_places(const brep::Solid& answer) {
    const voxel::Universe universe = tests::unit_universe(5);
    BoundInputs inputs;
    inputs.operation = "warp";
    inputs.scan_spacing_mm = glm::dvec3(0.0);
    inputs.witness = both(witness(), witness_of_box(voxel::bounds(universe.lattice())));
    return certify_bounded(convert::voxelise(universe, answer.linked()), answer, inputs);
  }
  static Certificate certified(const brep::Solid& answer) {
    Certificate certificate = by_places(answer);
    judge_reach(certificate, answer.triangles(), expected_surface(witness_),
                {voxel::bounds(tests::unit_universe(5).lattice()), 0.0, 1.0});
    return certificate;
  }
  static std::string told(const Certificate& certificate) {
    return verdict_text(certificate) + testing::PrintToString(certificate.reasons);
  }
  inline static const Witness witness_ = witness();
};

TEST_F(AWarpedBall, DisplacementsAreThoseOfTheOtherCodeWithinAndBesideTheElements) {
  const auto own = motion();
  const convert::DisplacementField other = field();
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> coordinate(-4.0, 36.0);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 2000; ++i)
    points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  const std::vector<glm::dvec3> theirs = other.at(points);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT(glm::distance(own->displacement_mm(points[i]), theirs[i]), 1e-9) << i;
}

TEST_F(AWarpedBall, BetweenTwoEquallyNearElementsBothCodesChooseTheSame) {
  const convert::Tetrahedra apart = convert::tetrahedra_of(
      voxel::combine(tests::unit_universe(5), voxel::Expression(voxel::Box{{4, 4, 4}, {12, 28, 28}}) |
                                                  voxel::Expression(voxel::Box{{20, 4, 4}, {28, 28, 28}})));
  std::vector<glm::dvec3> moved;
  double low = 1e300, high = -1e300;  // the gap's walls
  for (const glm::dvec3& p : apart.nodes_mm) {
    moved.push_back(p.x < 16 ? glm::dvec3(0, -2, 0) : glm::dvec3(0, 1, 1));
    if (p.x < 16) low = low > 1e299 ? p.x : std::max(low, p.x);
    if (p.x > 16) high = high < -1e299 ? p.x : std::min(high, p.x);
  }
  const NodeMotion own(apart, moved, fade_mm);
  const convert::DisplacementField other(apart, moved, fade_mm);
  std::vector<glm::dvec3> points;
  for (int y = 6; y < 26; ++y)
    for (int z = 6; z < 26; ++z) points.emplace_back(0.5 * (low + high), y + 0.1 * z, z - 0.07 * y);
  const std::vector<glm::dvec3> theirs = other.at(points);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT(glm::distance(own.displacement_mm(points[i]), theirs[i]), 1e-9) << i;
}

TEST_F(AWarpedBall, TheOriginOfAMovedPointIsThePoint) {
  const auto own = motion();
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> coordinate(6.0, 26.0);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 p(coordinate(random), coordinate(random), coordinate(random));
    const auto origin = own->origin_mm(p + own->displacement_mm(p));
    ASSERT_TRUE(origin) << i;
    EXPECT_LT(glm::distance(*origin, p), 1e-9) << i;
  }
}

TEST_F(AWarpedBall, WhereAPointFindsNoOriginAnyAnswerIsAllowed) {
  const convert::Tetrahedra all = elements();
  std::vector<glm::dvec3> quarter_turn, over;
  for (const glm::dvec3& p : all.nodes_mm) {
    const glm::dvec3 q = p - 16.0;
    quarter_turn.push_back(glm::dvec3(-q.y, q.x, q.z) - q);
    over.push_back(-2.5 * q);
  }
  const auto turn = std::make_shared<const NodeMotion>(all, quarter_turn, fade_mm);
  EXPECT_FALSE(turn->turns_over());
  EXPECT_FALSE(turn->origin_mm({17, 15, 18}));
  const Witness window = witness_of_window(scan(), 0.0, endless, tests::unit_universe(5));
  EXPECT_EQ(witness_of_warped(window, still().triangles(), turn).allowed_sides({17, 15, 18}).mesh,
            on_surface);
  const auto turned_over = std::make_shared<const NodeMotion>(all, over, fade_mm);
  EXPECT_TRUE(turned_over->turns_over());
  EXPECT_FALSE(witness_of_warped(window, still().triangles(), turned_over));
  EXPECT_FALSE(witness_of_warped(Witness(), still().triangles(), motion()));
}

TEST_F(AWarpedBall, TheRightAnswerHasNoContradictionAndASharpLimit) {
  const Certificate certificate = certified(warped(field()));
  EXPECT_EQ(certificate.verdict, Verdict::Pass) << told(certificate);
  ASSERT_TRUE(certificate.limit);
  EXPECT_LT(certificate.limit->volume_mm3, 70.0);
  ASSERT_TRUE(certificate.limit->shift_mm);
  EXPECT_LE(*certificate.limit->shift_mm, 0.5);
}

TEST_F(AWarpedBall, TheInverseMotionAloneSeesAFieldOfAnotherSizeAndASurfacePushedOut) {
  const auto pushed = [](const brep::Solid& solid) {
    brep::Triangles mesh = solid.triangles();
    for (glm::dvec3& p : mesh.points_mm) p += glm::normalize(p - glm::dvec3(17.7, 14.9, 16.3));
    return brep::trusted_solid(std::move(mesh), brep::Proof::Connection);
  };
  EXPECT_EQ(by_places(warped(field())).verdict, Verdict::Pass) << told(by_places(warped(field())));
  EXPECT_EQ(by_places(still()).verdict, Verdict::Fail);
  EXPECT_EQ(by_places(warped(field(1.3))).verdict, Verdict::Fail);
  EXPECT_EQ(by_places(pushed(warped(field()))).verdict, Verdict::Fail);
}

TEST_F(AWarpedBall, DistancesSeeAHundredthOfTheMotion) {
  EXPECT_EQ(certified(warped(field(1.01))).verdict, Verdict::Fail);
  EXPECT_EQ(certified(warped(field(-1.0))).verdict, Verdict::Fail);
  EXPECT_EQ(certified(brep::Solid()).verdict, Verdict::Fail);
}

TEST_F(AWarpedBall, AMotionNeedsElementsAndADisplacementForEachNode) {
  EXPECT_THROW(NodeMotion(convert::Tetrahedra{}, {}, fade_mm), std::invalid_argument);
  EXPECT_THROW(NodeMotion(elements(), {glm::dvec3(0.0)}, fade_mm), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/surface_reach.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "brep/mesh/solid.h"
#include "brep/shape/decimate.h"
#include "brep/shape/smooth.h"
#include "convert/voxel/voxelise.h"
#include "tests/brep/shapes.h"
#include "tests/unit_universe.h"
#include "verify/certificate/certify_bounded.h"
#include "verify/witness/reshaped_witness.h"
#include "verify/witness/witness.h"

namespace octotomy::verify {
namespace {

/// Two balls apart, with ripples of a twentieth of a millimetre.
class ReshapedBalls : public testing::Test {
 protected:
  using Change = std::function<glm::dvec3(const glm::dvec3&)>;

  static brep::Triangles changed(brep::Triangles mesh, const Change& change) {
    for (glm::dvec3& p : mesh.points_mm) p = change(p);
    return mesh;
  }
  static glm::dvec3 rippled(const glm::dvec3& p) {
    return p + 0.05 * glm::dvec3(std::sin(5.0 * p.y), std::sin(5.0 * p.z), std::sin(5.0 * p.x));
  }
  static brep::Solid large() { return solid(changed(brep::shapes::sphere({0, 0, 0}, 12.0, 5), rippled)); }
  static brep::Solid small() { return solid(changed(brep::shapes::sphere({22, 0, 0}, 4.0, 4), rippled)); }
  static brep::Solid balls() {
    return solid(brep::shapes::together(large().triangles(), small().triangles()));
  }
  static brep::Solid solid(brep::Triangles mesh) {
    return brep::trusted_solid(std::move(mesh), brep::Proof::Connection);
  }
  static brep::Solid smoothed(const brep::Solid& still, const brep::SmoothOptions& options = {}) {
    return brep::trusted_solid(brep::smooth(still, options), brep::Proof::Connection);
  }

  static brep::Solid decimated(const brep::Solid& still) {
    brep::DecimateOptions options;
    options.max_error_mm = 0.1;
    return brep::trusted_solid(brep::decimate(still, options), brep::Proof::Construction);
  }

  static Witness smoothing() {
    return witness_of_reshaped([] {
      return Reshaped{surface_smoothed(balls().triangles(), brep::SmoothOptions{}.rounds,
                                       brep::SmoothOptions{}.pass_band)};
    });
  }
  static Witness decimation(double max_error_mm) {
    return witness_of_reshaped(
        [max_error_mm] { return Reshaped{surface_decimated(balls().triangles(), max_error_mm)}; });
  }

  /// Certifies the answer like an object that the mesh kernel alone makes. The voxels are computed from the
  /// answer.
  static Certificate certified(const brep::Solid& answer, const Witness& witness) {
    const voxel::Universe universe = tests::universe_about_origin(6);
    const voxel::Box world = voxel::bounds(universe.lattice());
    BoundInputs inputs;
    inputs.operation = "reshaped";
    inputs.scan_spacing_mm = glm::dvec3(0.0);
    inputs.witness = both(witness, witness_of_box(world));
    Certificate certificate = certify_bounded(convert::voxelise(universe, answer.linked()), answer, inputs);
    certificate.voxel.makers = certificate.mesh.makers = {"the mesh kernel"};
    judge_reach(certificate, answer.triangles(), expected_surface(witness), {world, 0.0, 1.0});
    judge_independence(certificate);
    return certificate;
  }
  static std::string told(const Certificate& certificate) {
    return verdict_text(certificate) + testing::PrintToString(certificate.reasons);
  }
  /// The larger one of the two distances.
  static double reach_mm(const Certificate& certificate) {
    double most_mm = -1.0;
    for (const Comparison& comparison : certificate.comparisons)
      if (comparison.quantity.find("where it must lie") != std::string::npos)
        most_mm = std::max(most_mm, comparison.difference);
    return most_mm;
  }
};

TEST_F(ReshapedBalls, ASmoothSurfaceIsThatOfOtherCodeAndWarnsOnlyOfItsMaker) {
  const Certificate certificate = certified(smoothed(balls()), smoothing());
  EXPECT_EQ(certificate.verdict, Verdict::Warn) << told(certificate);
  EXPECT_EQ(certificate.reasons.size(), 1U) << told(certificate);
  EXPECT_NE(told(certificate).find("not independent"), std::string::npos);
  EXPECT_GE(reach_mm(certificate), 0.0);
  EXPECT_LT(reach_mm(certificate), 1e-11);
  ASSERT_TRUE(certificate.limit);
  EXPECT_LT(certificate.limit->volume_mm3, 30.0);
}

TEST_F(ReshapedBalls, OtherRoundsOrAnotherPassBandFail) {
  brep::SmoothOptions fewer, wider;
  fewer.rounds -= 1;
  wider.pass_band = 0.12;
  for (const brep::SmoothOptions& options : {fewer, wider}) {
    const Certificate certificate = certified(smoothed(balls(), options), smoothing());
    EXPECT_EQ(certificate.verdict, Verdict::Fail) << told(certificate);
    EXPECT_GT(reach_mm(certificate), 1e-5);
  }
  EXPECT_EQ(certified(balls(), smoothing()).verdict, Verdict::Fail);
}

TEST_F(ReshapedBalls, ALostPartASurfacePushedOutAndNothingFail) {
  const brep::Solid fewer = decimated(balls());
  const std::vector<std::pair<Witness, brep::Solid>> steps{{smoothing(), smoothed(balls())},
                                                           {decimation(0.1), fewer}};
  for (const auto& [witness, right] : steps) {
    const Certificate of_right = certified(right, witness);
    EXPECT_EQ(of_right.verdict, Verdict::Warn) << told(of_right);
    const auto pushed = [](const glm::dvec3& p) {
      const glm::dvec3 middle(p.x > 14.0 ? 22.0 : 0.0, 0.0, 0.0);
      return p + glm::normalize(p - middle);
    };
    const auto bump = [](const glm::dvec3& p) { return p.z > 11.0 ? p + glm::dvec3(0.0, 0.0, 1.0) : p; };
    const auto shifted = [&](const glm::dvec3& p) {
      return p + glm::dvec3(0.0, of_right.limit->shift_mm.value_or(4.0), 0.0);
    };
    const std::vector<std::pair<const char*, brep::Solid>> spoiled{
        {"a part lost", decimated(large())},
        {"the larger part lost", small()},
        {"pushed out", solid(changed(right.triangles(), pushed))},
        {"a bump", solid(changed(right.triangles(), bump))},
        {"shifted by the printed limit", solid(changed(right.triangles(), shifted))},
        {"a part more",
         solid(brep::shapes::together(right.triangles(), brep::shapes::sphere({0, 22, 0}, 3.0, 3)))},
        {"nothing", brep::Solid()}};
    for (const auto& [name, answer] : spoiled) {
      const Certificate certificate = certified(answer, witness);
      EXPECT_EQ(certificate.verdict, Verdict::Fail) << name << told(certificate);
    }
  }
}

/// No voxel shows it: a plate thinner than a voxel and than what the reach leaves open.
TEST_F(ReshapedBalls, ALostPlateThinnerThanTheReachFails) {
  const brep::Triangles plate = brep::shapes::box({-10.03, 18.0, -10.03}, {10.07, 18.1, 10.07});
  const brep::Solid with = solid(brep::shapes::together(large().triangles(), plate));
  const Witness witness =
      witness_of_reshaped([=] { return Reshaped{surface_decimated(with.triangles(), 0.1)}; });
  EXPECT_EQ(certified(with, witness).verdict, Verdict::Warn) << told(certified(with, witness));
  const Certificate certificate = certified(large(), witness);
  EXPECT_EQ(certificate.verdict, Verdict::Fail) << told(certificate);
  EXPECT_GT(certificate.worst->size_mm, 5.0);
}

TEST_F(ReshapedBalls, AnErrorUpToTheReachDoesNotFailAndTheLimitSaysSo) {
  const double off_mm = 0.19;
  const auto pushed = [&](const glm::dvec3& p) {
    const glm::dvec3 middle(p.x > 14.0 ? 22.0 : 0.0, 0.0, 0.0);
    return p + off_mm * glm::normalize(p - middle);
  };
  const brep::Solid answer = solid(changed(balls().triangles(), pushed));
  const Certificate certificate = certified(answer, decimation(0.1));
  EXPECT_EQ(certificate.verdict, Verdict::Warn) << told(certificate);
  const double hidden_mm3 = answer.measures().volume_mm3 - balls().measures().volume_mm3;
  EXPECT_GT(hidden_mm3, 300.0);
  EXPECT_GT(certificate.limit->volume_mm3, hidden_mm3);
}

TEST_F(ReshapedBalls, TheAnswerEndsWithTheWorldAndItsSurfaceDoesNot) {
  const brep::Triangles whole = brep::shapes::sphere({0, 0, 0}, 12.0, 5);
  // Flattened at the border, as a Boolean with the world would cut it.
  const brep::Triangles cut =
      changed(whole, [](const glm::dvec3& p) { return glm::dvec3(p.x, p.y, std::min(p.z, 6.0)); });
  const voxel::Box world{glm::dvec3(-30.0), {30.0, 30.0, 6.0}};
  const ReshapedSurface expected = surface_decimated(whole, 0.5);
  Certificate certificate;
  judge_reach(certificate, cut, expected, {world, 0.0, 0.5});
  EXPECT_EQ(certificate.verdict, Verdict::Pass) << told(certificate);
  Certificate uncut;
  judge_reach(uncut, cut, expected, {{glm::dvec3(-30.0), glm::dvec3(30.0)}, 0.0, 0.5});
  EXPECT_EQ(uncut.verdict, Verdict::Fail);
}

/// Both surfaces have the same vertices: a top that is not flat, with one diagonal and with the other.
TEST_F(ReshapedBalls, ADifferenceBetweenVerticesIsFound) {
  const brep::Triangles one = changed(brep::shapes::box({0, 0, 0}, {10, 10, 10}), [](const glm::dvec3& p) {
    return p == glm::dvec3(10.0) ? glm::dvec3(10.0, 10.0, 12.0) : p;
  });
  brep::Triangles other = one;
  std::vector<std::size_t> top;
  for (std::size_t face = 0; face < one.faces.size(); ++face)
    if (std::ranges::all_of(one.faces[face],
                            [&](std::uint32_t corner) { return one.points_mm[corner].z >= 10.0; }))
      top.push_back(face);
  ASSERT_EQ(top.size(), 2u);
  auto &first = other.faces[top[0]], &second = other.faces[top[1]];
  // Begins each triangle with the corner that the other one lacks.
  const auto has = [](const auto& face, std::uint32_t corner) {
    return std::ranges::find(face, corner) != face.end();
  };
  while (has(second, first[0])) std::ranges::rotate(first, first.begin() + 1);
  while (has(first, second[0])) std::ranges::rotate(second, second.begin() + 1);
  first = {first[0], first[1], second[0]};
  second = {second[0], second[1], first[0]};
  const voxel::Box world{glm::dvec3(-30.0), glm::dvec3(30.0)};
  Certificate certificate;
  judge_reach(certificate, other, surface_decimated(one, 0.2), {world, 0.0, 0.5});
  EXPECT_EQ(certificate.verdict, Verdict::Fail) << told(certificate);
  // At the middle of the top the diagonals lie at heights of 10 and 11.
  EXPECT_NEAR(certificate.worst->size_mm, 1.0, 0.05);
  Certificate same;
  judge_reach(same, one, surface_decimated(one, 0.2), {world, 0.0, 0.5});
  EXPECT_EQ(same.verdict, Verdict::Pass) << told(same);
}

TEST_F(ReshapedBalls, WhereNoSampleCanBeComparedNothingPasses) {
  const brep::Triangles whole = brep::shapes::sphere({0, 0, 0}, 12.0, 4);
  // The border is nearer to every place than what could go unseen.
  Certificate certificate;
  judge_reach(certificate, whole, surface_decimated(whole, 20.0),
              {{glm::dvec3(-12.5), glm::dvec3(12.5)}, 0.0, 0.5});
  EXPECT_EQ(certificate.verdict, Verdict::Warn) << told(certificate);
}

TEST_F(ReshapedBalls, ReadsOnceAndIsNoneOfItsCopiesUnderABoolean) {
  int calls = 0;
  const Witness witness = witness_of_reshaped([&] {
    ++calls;
    return Reshaped{surface_decimated(balls().triangles(), 0.1)};
  });
  EXPECT_EQ(calls, 0);
  const Witness copy = witness;
  EXPECT_EQ(copy.allowed_sides({0, 0, 0}).mesh, certainly_in);
  EXPECT_EQ(witness.allowed_sides({22, 0, 0}).voxel, certainly_in);
  EXPECT_EQ(witness.allowed_sides({15, 0, 0}).mesh, certainly_out);
  EXPECT_EQ(witness.of_mesh({0, 0, 12.0}).mesh, on_surface);
  EXPECT_EQ(calls, 1);
  EXPECT_TRUE(is_reshaped(copy));
  EXPECT_FALSE(is_reshaped(both(witness, witness_of_box({glm::dvec3(-30.0), glm::dvec3(30.0)}))));
  EXPECT_FALSE(is_reshaped(Witness()));
}

TEST_F(ReshapedBalls, CutByABoxItIsReadAsBothAndKeepsItsSurface) {
  const Witness whole = decimation(0.1);
  const voxel::Box world{glm::dvec3(-30.0), {30.0, 30.0, 6.0}};
  const Witness with_box = both(whole, witness_of_box(world)), cut = cut_by_box(whole, world);
  for (double z = -13.0; z < 13.0; z += 0.25) {
    const Reading expected = with_box({0, 0, z}, 0.1), read = cut({0, 0, z}, 0.1);
    EXPECT_EQ(read.mesh, expected.mesh) << z;
    EXPECT_EQ(read.voxel, expected.voxel) << z;
    EXPECT_EQ(read.surfaces, expected.surfaces) << z;
  }
  EXPECT_EQ(cut.allowed_sides({0, 0, 9.0}).mesh, certainly_out);
  EXPECT_EQ(whole.allowed_sides({0, 0, 9.0}).mesh, certainly_in);
  const Witness again = cut_by_box(cut, world);
  ASSERT_TRUE(is_reshaped(cut) && is_reshaped(again));
  EXPECT_EQ(&expected_surface(cut), &expected_surface(whole));
  EXPECT_EQ(&expected_surface(again), &expected_surface(whole));
  EXPECT_FALSE(is_reshaped(cut_by_box(with_box, world)));
  EXPECT_FALSE(cut_by_box(Witness(), world));
}

}  // namespace
}  // namespace octotomy::verify

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/offset_witness.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <numbers>

#include "brep/boolean/boolean.h"
#include "brep/shape/offset.h"
#include "convert/surface/isosurface.h"
#include "tests/brep/shapes.h"
#include "verify/certificate/certify_bounded.h"
#include "verify/witness/witness.h"
#include "voxel/filter/offset.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::verify {
namespace {

/// A ball in samples of a millimetre and voxels of a half.
class OffsetOfABall : public testing::Test {
 protected:
  static constexpr double radius_mm = 12.0, by_mm = 2.0, cell_mm = 0.5;
  static constexpr double endless = std::numeric_limits<double>::infinity();
  inline static const glm::dvec3 centre_mm{0.21, -0.13, 0.34};

  static std::shared_ptr<const voxel::Scene> ball(const glm::dvec3& about_mm) {
    voxel::Scene scene;
    scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(48), glm::dvec3(1.0), glm::dvec3(-23.5));
    voxel::Int16Samples samples(scene.lattice.sample_count());
    std::size_t i = 0;
    for (int z = 0; z < 48; ++z)
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 48; ++x) {
          const double depth_mm = radius_mm - glm::distance(scene.lattice.lps_mm({x, y, z}), about_mm);
          samples[i++] = static_cast<std::int16_t>(std::lround(2000.0 * std::clamp(depth_mm, -0.5, 0.5)));
        }
    scene.samples = std::move(samples);
    return std::make_shared<const voxel::Scene>(std::move(scene));
  }

  struct Operand {
    voxel::Expression symbol;
    OffsetOperand both;
  };
  static Operand operand(const glm::dvec3& about_mm = centre_mm) {
    const auto scan = ball(about_mm);
    const voxel::Universe universe = {
        7, voxel::axis_aligned_lattice(glm::ivec3(128), glm::dvec3(0.5), glm::dvec3(-31.5)).lps_from_voxel};
    const voxel::GreyOctree grey = voxel::grey_octree_of(universe, *scan);
    const voxel::Expression symbol(voxel::window_of(grey, 0.0));
    return {symbol,
            {witness_of_window(scan, 0.0, endless, universe), voxel::combine(universe, symbol),
             brep::trusted_solid(convert::isosurface(*scan, 0.0, endless), brep::Proof::Construction)}};
  }

  static voxel::Octree voxels(const Operand& of, double by) {
    return voxel::combine(of.both.voxels.universe(),
                          voxel::Expression(voxel::offset(of.both.voxels, of.symbol, by)));
  }
  static brep::Solid mesh(const Operand& of, double by) {
    return brep::offset(of.both.mesh, {.by_mm = by, .cell_mm = cell_mm});
  }

  /// The certificate of answers, judged by the offset of `asked`.
  static Certificate certified(const Operand& asked, double by, const voxel::Octree& octree,
                               const brep::Solid& solid) {
    BoundInputs inputs;
    inputs.operation = "offset";
    inputs.witness = both(witness_of_offset(asked.both, {by, cell_mm}),
                          witness_of_box(voxel::bounds(octree.universe().lattice())));
    inputs.measured_apart_mm = offset_allowance_mm(asked.both, {by, cell_mm}, solid.measures().area_mm2);
    return certify_bounded(octree, solid, inputs);
  }

  static std::string told(const Certificate& certificate) {
    return verdict_text(certificate) + testing::PrintToString(certificate.reasons);
  }
};

TEST_F(OffsetOfABall, BothKernelsHaveTheClosedFormAndPass) {
  const Operand of = operand();
  for (const double by : {by_mm, -by_mm}) {
    const voxel::Octree octree = voxels(of, by);
    const brep::Solid solid = mesh(of, by);
    const double truth_mm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm + by, 3.0);
    const double voxels_mm3 = static_cast<double>(octree.voxel_count()) * 0.125;
    EXPECT_NEAR(voxels_mm3, truth_mm3, 0.01 * truth_mm3);
    EXPECT_NEAR(solid.measures().volume_mm3, truth_mm3, 0.01 * truth_mm3);
    const Certificate certificate = certified(of, by, octree, solid);
    EXPECT_EQ(certificate.verdict, Verdict::Pass) << by << told(certificate);
    EXPECT_TRUE(certificate.limit) << "no place was judged";
  }
}

TEST_F(OffsetOfABall, AKernelThatGoesATenthTooFarFails) {
  const Operand of = operand();
  const voxel::Octree octree = voxels(of, by_mm);
  const brep::Solid solid = mesh(of, by_mm);
  for (const double share : {0.9, 1.1}) {
    const Certificate of_voxels = certified(of, by_mm, voxels(of, share * by_mm), solid);
    EXPECT_EQ(of_voxels.verdict, Verdict::Fail) << share << told(of_voxels);
    const Certificate of_mesh = certified(of, by_mm, octree, mesh(of, share * by_mm));
    EXPECT_EQ(of_mesh.verdict, Verdict::Fail) << share << told(of_mesh);
  }
}

TEST_F(OffsetOfABall, TheWrongSignFailsInEitherKernelAndInBoth) {
  const Operand of = operand();
  const voxel::Octree in = voxels(of, -by_mm), out = voxels(of, by_mm);
  const brep::Solid solid_in = mesh(of, -by_mm), solid_out = mesh(of, by_mm);
  EXPECT_EQ(certified(of, by_mm, in, solid_out).verdict, Verdict::Fail);
  EXPECT_EQ(certified(of, by_mm, out, solid_in).verdict, Verdict::Fail);
  EXPECT_EQ(certified(of, by_mm, in, solid_in).verdict, Verdict::Fail);
  EXPECT_EQ(certified(of, -by_mm, out, solid_out).verdict, Verdict::Fail);
}

/// Both kernels agree on the offset of an object that nobody asked for.
TEST_F(OffsetOfABall, AnotherStepsOperandFailsAlsoWhereBothKernelsTookIt) {
  const Operand asked = operand(), other = operand(centre_mm + glm::dvec3(6.0, 0.0, 0.0));
  const voxel::Octree octree = voxels(other, by_mm);
  const brep::Solid solid = mesh(other, by_mm);
  const Certificate certificate = certified(asked, by_mm, octree, solid);
  EXPECT_EQ(certificate.verdict, Verdict::Fail) << told(certificate);
  const Certificate twin = certified(other, by_mm, octree, solid);
  EXPECT_EQ(twin.verdict, Verdict::Pass) << told(twin);
}

TEST_F(OffsetOfABall, TheWitnessIsSureAwayFromTheMovedSurfaceAlone) {
  const Operand of = operand();
  const Witness witness = witness_of_offset(of.both, {by_mm, cell_mm});
  const auto allowed = [&](double distance_mm) {
    return witness.mesh_sides(centre_mm + glm::dvec3(0.0, 0.6, 0.8) * distance_mm);
  };
  EXPECT_EQ(allowed(radius_mm), certainly_in);
  EXPECT_TRUE(allowed(radius_mm + by_mm).near);
  EXPECT_EQ(allowed(radius_mm + 2.0 * by_mm), certainly_out);
}

TEST_F(OffsetOfABall, AnOperandOfWholeVoxelsAllowsHalfAVoxelMore) {
  const Operand of = operand();
  OffsetOperand whole = of.both;
  whole.is_whole_voxels = true;
  EXPECT_NEAR(offset_allowance_mm(whole, {by_mm, cell_mm}, 2463.0) -
                  offset_allowance_mm(of.both, {by_mm, cell_mm}, 2463.0),
              0.25, 1e-12);
}

/// A block with a plate or a slot of a millimetre, in samples of a millimetre and voxels of two, whose centres
/// lie half a millimetre off the plate and the slot.
class OffsetOfAThinWall : public OffsetOfABall {
 protected:
  enum class Thin { None, Plate, Slot };
  inline static const glm::dvec3 plate_low_mm{-10.0, -12.3, 0.0}, plate_high_mm{20.3, 12.4, 1.0};

  static double depth_mm(const glm::dvec3& p_mm, const glm::dvec3& low_mm, const glm::dvec3& high_mm) {
    const glm::dvec3 depths_mm = glm::min(p_mm - low_mm, high_mm - p_mm);
    return std::min({depths_mm.x, depths_mm.y, depths_mm.z});
  }
  static std::shared_ptr<const voxel::Scene> block_with(Thin thin) {
    voxel::Scene scene;
    scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(64), glm::dvec3(1.0), glm::dvec3(-31.5));
    voxel::Int16Samples samples(scene.lattice.sample_count());
    std::size_t i = 0;
    for (int z = 0; z < 64; ++z)
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
          const glm::dvec3 p_mm = scene.lattice.lps_mm({x, y, z});
          double depth = depth_mm(p_mm, {-24.2, -14.3, -12.7}, {-4.1, 14.6, 13.2});
          if (thin == Thin::Plate) depth = std::max(depth, depth_mm(p_mm, plate_low_mm, plate_high_mm));
          if (thin == Thin::Slot) depth = std::min(depth, std::abs(p_mm.z - 0.5) - 0.5);
          samples[i++] = static_cast<std::int16_t>(std::lround(2000.0 * std::clamp(depth, -0.5, 0.5)));
        }
    scene.samples = std::move(samples);
    return std::make_shared<const voxel::Scene>(std::move(scene));
  }
  static Operand block(Thin thin) {
    const auto scan = block_with(thin);
    const voxel::Universe universe = {
        6, voxel::axis_aligned_lattice(glm::ivec3(64), glm::dvec3(2.0), glm::dvec3(-62.5)).lps_from_voxel};
    const voxel::GreyOctree grey = voxel::grey_octree_of(universe, *scan);
    const voxel::Expression symbol(voxel::window_of(grey, 0.0));
    return {symbol,
            {witness_of_window(scan, 0.0, endless, universe), voxel::combine(universe, symbol),
             brep::trusted_solid(convert::isosurface(*scan, 0.0, endless), brep::Proof::Construction)}};
  }
  static brep::Solid altered(const brep::Solid& solid, brep::Operation operation, const glm::dvec3& low_mm,
                             const glm::dvec3& high_mm) {
    const brep::Solid box =
        brep::trusted_solid(brep::shapes::box(low_mm, high_mm), brep::Proof::Construction);
    return brep::boolean(solid, operation, box).solid;
  }
  static bool tells_loss(const Certificate& certificate) {
    return std::any_of(certificate.reasons.begin(), certificate.reasons.end(), [](const std::string& reason) {
      return reason.find("resampling loses walls or gaps thinner than a voxel") != std::string::npos;
    });
  }
  static double difference_of(const Certificate& certificate, const std::string& quantity) {
    for (const Comparison& comparison : certificate.comparisons)
      if (comparison.quantity == quantity) return comparison.difference;
    return -1.0;
  }
  static double contradicted_mm3(const Certificate& certificate) {
    return difference_of(certificate, "contradicted voxels");
  }
};

TEST_F(OffsetOfAThinWall, APlateBetweenVoxelsCentresIsALossOfTheVoxels) {
  const Operand of = block(Thin::Plate);
  const voxel::Octree octree = voxels(of, by_mm);
  const brep::Solid solid = mesh(of, by_mm);
  const glm::ivec3 beside(glm::round(octree.universe().lattice().voxel({9.5, 0.0, 1.5})));
  ASSERT_FALSE(octree.contains(beside)) << "the voxels have the plate";
  const Certificate certificate = certified(of, by_mm, octree, solid);
  EXPECT_EQ(certificate.verdict, Verdict::Warn) << told(certificate);
  EXPECT_EQ(contradicted_mm3(certificate), 0.0);
  EXPECT_TRUE(tells_loss(certificate)) << told(certificate);
  ASSERT_TRUE(certificate.worst);
  EXPECT_GT(certificate.worst->at_mm.x, -4.1);
  EXPECT_NEAR(certificate.worst->at_mm.z, 0.5, 3.0);
}

TEST_F(OffsetOfAThinWall, AnErrorOfTheMeshFailsBesideThePlateAndAwayFromIt) {
  const Operand of = block(Thin::Plate);
  const voxel::Octree octree = voxels(of, by_mm);
  const brep::Solid solid = mesh(of, by_mm);
  struct Error {
    const char* what;
    brep::Operation operation;
    glm::dvec3 low_mm, high_mm;
  };
  for (const Error& error : {
           Error{"a hole in the plate", brep::Operation::Difference, {5.1, -4.9, -9.0}, {13.1, 5.1, 9.0}},
           Error{"a post on the plate", brep::Operation::Union, {5.1, -4.9, 0.5}, {11.1, 3.1, 9.1}},
           Error{"a hole in the block", brep::Operation::Difference, {-40.0, -4.9, -4.1}, {-18.1, 5.1, 5.3}},
           Error{"a post on the block", brep::Operation::Union, {-20.1, -4.9, 9.3}, {-14.1, 3.1, 22.1}},
       }) {
    const Certificate certificate =
        certified(of, by_mm, octree, altered(solid, error.operation, error.low_mm, error.high_mm));
    EXPECT_EQ(certificate.verdict, Verdict::Fail) << error.what << told(certificate);
    EXPECT_GT(contradicted_mm3(certificate) + difference_of(certificate, "stray surface"), 0.0) << error.what;
  }
}

/// The operand's mesh proposes the plate, and the scan does not confirm it.
TEST_F(OffsetOfAThinWall, APlateThatTheScanLacksFails) {
  Operand of = block(Thin::None);
  of.both.mesh = block(Thin::Plate).both.mesh;
  const Certificate certificate = certified(of, by_mm, voxels(of, by_mm), mesh(of, by_mm));
  EXPECT_EQ(certificate.verdict, Verdict::Fail) << told(certificate);
  EXPECT_GT(contradicted_mm3(certificate), 0.0);
}

TEST_F(OffsetOfAThinWall, ASlotBetweenVoxelsCentresIsALossOfTheVoxels) {
  const Operand of = block(Thin::Slot);
  const voxel::Octree octree = voxels(of, -by_mm);
  const Certificate certificate = certified(of, -by_mm, octree, mesh(of, -by_mm));
  EXPECT_EQ(certificate.verdict, Verdict::Warn) << told(certificate);
  EXPECT_EQ(contradicted_mm3(certificate), 0.0);
  EXPECT_TRUE(tells_loss(certificate)) << told(certificate);
  const Certificate unmoved = certified(of, -by_mm, octree, mesh(block(Thin::None), -by_mm));
  EXPECT_EQ(unmoved.verdict, Verdict::Fail) << told(unmoved);
}

}  // namespace
}  // namespace octotomy::verify

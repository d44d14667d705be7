// SPDX-License-Identifier: AGPL-3.0-or-later
//
// What a certificate with a witness must not let pass: errors that both kernels make alike, parts that a mesh
// has several times, totals that resampling loses.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <limits>

#include "brep/mesh/components.h"
#include "brep/mesh/triangles.h"
#include "convert/surface/isosurface.h"
#include "convert/voxel/voxelise.h"
#include "tests/brep/shapes.h"
#include "verify/certificate/certify_bounded.h"
#include "verify/witness/witness.h"
#include "voxel/filter/components.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

/// A large and a small ball, samples a hundred times the depth below their surfaces; beside them air.
std::shared_ptr<const voxel::Scene> two_balls(double floor) {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({64, 64, 64}, glm::dvec3(1.0), glm::dvec3(0.0));
  voxel::Int16Samples samples(scene.lattice.sample_count());
  std::size_t i = 0;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const glm::dvec3 p(x, y, z);
        const double depth =
            std::max(16.3 - glm::distance(p, {24.2, 25.1, 24.4}), 5.4 - glm::distance(p, {52.3, 51.2, 50.8}));
        samples[i++] = static_cast<std::int16_t>(std::lround(std::clamp(100.0 * depth, floor, 3000.0)));
      }
  scene.samples = std::move(samples);
  return std::make_shared<const voxel::Scene>(std::move(scene));
}

class Witnessed : public testing::Test {
 protected:
  Witnessed() {
    inputs_.scan_spacing_mm = glm::dvec3(1.0);
    inputs_.witness = witness_of_window(scan_, 0.0, endless, universe_);
  }
  voxel::Octree octree() const {
    return voxel::combine(
        universe_, voxel::Expression(voxel::Window{voxel::grey_octree_of(universe_, *scan_, -1024), 0.0}));
  }
  brep::Triangles mesh() const { return convert::isosurface(*scan_, 0.0, endless); }
  Certificate certified(const voxel::Octree& octree, const brep::Triangles& mesh) const {
    return certify_bounded(octree, brep::trusted_solid(mesh, brep::Proof::Construction), inputs_);
  }
  /// The mesh with its smallest part so many times.
  brep::Triangles with_small_part(int times) const {
    const brep::Triangles all = mesh();
    const brep::Solid solid = brep::trusted_solid(all, brep::Proof::Construction);
    const std::vector<brep::Component>& parts = solid.components();
    EXPECT_EQ(parts.size(), 2U);
    brep::Triangles made;
    const auto add = [&](const brep::Component& part) {
      const auto first = static_cast<std::uint32_t>(made.points_mm.size());
      made.points_mm.insert(made.points_mm.end(), all.points_mm.begin(), all.points_mm.end());
      for (const std::uint32_t face : part.faces) {
        made.faces.push_back(all.faces[face]);
        for (std::uint32_t& corner : made.faces.back()) corner += first;
      }
    };
    add(parts.front());
    for (int i = 0; i < times; ++i) add(parts.back());
    return made;
  }

  std::shared_ptr<const voxel::Scene> scan_ = two_balls(-1000.0);
  voxel::Universe universe_ = [] {
    voxel::Universe universe;
    universe.depth = 6;
    return universe;
  }();
  BoundInputs inputs_;
};

TEST_F(Witnessed, RightAnswersPassAndLinesFindTheSameVolume) {
  const Certificate right = certified(octree(), mesh());
  EXPECT_EQ(right.verdict, Verdict::Pass) << (right.reasons.empty() ? "" : right.reasons.front());
  ASSERT_TRUE(right.third);
  EXPECT_NEAR(right.third->volume_mm3, right.mesh.volume_mm3, 0.02 * right.mesh.volume_mm3);
  EXPECT_LE(right.limit->volume_mm3, 64.0);
}

TEST_F(Witnessed, PaddingThatCutsTheObjectContradictsNothing) {
  voxel::Scene scene = *scan_;
  scene.padding = -1500.0;
  auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  std::size_t i = 0;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x, ++i)
        if (x + 0.4 * y - 0.3 * z > 32.0) samples[i] = -1500;
  const auto scan = std::make_shared<const voxel::Scene>(std::move(scene));
  universe_.lps_from_voxel[3] = {0.3, 0.4, 0.2, 1.0};
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe_, *scan, -1500);
  for (const auto& [low, high] :
       {std::pair(0.0, endless), std::pair(-700.0, -200.0), std::pair(-2000.0, 0.0)}) {
    inputs_.witness = witness_of_window(scan, low, high, universe_);
    voxel::Window window{grey, std::max(low, -1499.0)};
    if (high < endless) window.high = high;
    const Certificate right = certified(voxel::combine(universe_, voxel::Expression(window)),
                                        convert::isosurface(*scan, low, high));
    for (const Comparison& each : right.comparisons)
      if (each.quantity == "contradicted voxels" || each.quantity == "stray surface") {
        EXPECT_EQ(each.difference, 0.0) << each.quantity << " of " << low;
      }
    ASSERT_TRUE(right.third);
    EXPECT_NEAR(right.third->volume_mm3, right.mesh.volume_mm3, 0.02 * right.mesh.volume_mm3) << low;
  }
}

TEST_F(Witnessed, APartThatBothKernelsLostFails) {
  const Certificate lost = certified(voxel::components(octree()).largest, with_small_part(0));
  EXPECT_EQ(lost.verdict, Verdict::Fail);
  ASSERT_TRUE(lost.worst);
  EXPECT_NE(lost.worst->what.find("both kernels lack"), std::string::npos) << lost.worst->what;
  EXPECT_LT(glm::distance(lost.worst->at_mm, {52.3, 51.2, 50.8}), 6.0);
}

TEST_F(Witnessed, TwoEmptyAnswersFailWhereTheScanHasAnObjectAndElseProveNothing) {
  const voxel::Octree nothing = voxel::Octree::empty(universe_);
  EXPECT_EQ(certified(nothing, {}).verdict, Verdict::Fail);
  inputs_.witness = witness_of_window(scan_, 2500.0, endless, universe_);
  const Certificate right = certified(nothing, {});
  EXPECT_EQ(right.verdict, Verdict::Warn);
  EXPECT_FALSE(right.resolved());
  ASSERT_EQ(right.reasons.size(), 1U);
  EXPECT_NE(right.reasons.front().find("8 mm3"), std::string::npos) << right.reasons.front();
}

TEST_F(Witnessed, AnObjectThatNoVoxelHoldsIsNoPass) {
  inputs_.witness = {};
  const brep::Triangles between = brep::shapes::box({20.2, 20.2, 20.2}, {20.8, 20.8, 20.8});
  const Certificate lost = certified(voxel::Octree::empty(universe_), between);
  EXPECT_NE(lost.verdict, Verdict::Pass);
  EXPECT_TRUE(std::any_of(lost.reasons.begin(), lost.reasons.end(), [](const std::string& reason) {
    return reason.find("The object has no voxel, but its mesh encloses 0.216 mm3") == 0;
  })) << lost.reasons.back();
}

TEST_F(Witnessed, APartThatTheMeshHasSeveralTimesFails) {
  EXPECT_EQ(certified(octree(), with_small_part(1)).verdict, Verdict::Pass);
  for (const int times : {2, 3, 5})
    EXPECT_EQ(certified(octree(), with_small_part(times)).verdict, Verdict::Fail) << times;
}

/// A ball and, far away from it, 64 single bright samples between the centres of voxels of two samples a side.
class Speckled : public Witnessed {
 protected:
  Speckled() {
    voxel::Scene scene = *two_balls(-1000.0);
    auto& samples = std::get<voxel::Int16Samples>(scene.samples);
    for (int z = 0; z < 64; ++z)
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
          std::int16_t& sample = samples[static_cast<std::size_t>((z * 64 + y) * 64 + x)];
          if (x > 42 || y > 42 || z > 42) sample = -1000;
          const auto is_bright = [](int i) { return i > 45 && i % 4 == 1; };
          if (is_bright(x) && is_bright(y) && is_bright(z)) sample = 3000;
        }
    scan_ = std::make_shared<const voxel::Scene>(std::move(scene));
    universe_.depth = 5;
    universe_.lps_from_voxel = glm::dmat4(2.0);
    universe_.lps_from_voxel[3] = {0.0, 0.0, 0.0, 1.0};
    inputs_.witness = witness_of_window(scan_, 0.0, endless, universe_);
  }
  static const Comparison& comparison(const Certificate& certificate, const std::string& quantity) {
    return *std::find_if(certificate.comparisons.begin(), certificate.comparisons.end(),
                         [&](const Comparison& each) { return each.quantity == quantity; });
  }
};

TEST_F(Speckled, PartsBetweenCentresAreStatedAndLeftOutOfDistances) {
  const Certificate right = certified(octree(), mesh());
  EXPECT_EQ(right.verdict, Verdict::Pass) << (right.reasons.empty() ? "" : right.reasons.front());
  EXPECT_TRUE(right.resolved());
  const Comparison& specks = comparison(right, "parts and cavities between voxels' centres");
  EXPECT_NE(specks.formula.find("the mesh has 64"), std::string::npos) << specks.formula;
  // Each is an octahedron whose corners lie three quarters of a sample from its middle.
  const double one_mm3 = 4.0 / 3.0 * std::pow(0.75, 3.0);
  EXPECT_NEAR(specks.difference, 64.0 * one_mm3, 1e-3);
  EXPECT_GE(right.limit->volume_mm3, one_mm3);
  EXPECT_LT(*right.hausdorff_mm, 3.0);
}

/// The ball and, far away, a pile of sheets one sample thick between layers of voxels' centres. A post that
/// voxels hold joins them, so that they are no specks.
class Sheeted : public Speckled {
 protected:
  Sheeted() {
    voxel::Scene scene = *scan_;
    auto& samples = std::get<voxel::Int16Samples>(scene.samples);
    for (int z = 46; z < 63; ++z)
      for (int y = 46; y < 63; ++y)
        for (int x = 46; x < 63; ++x) {
          const bool is_post = std::abs(x - 54) < 2 && std::abs(z - 54) < 2;
          samples[static_cast<std::size_t>((z * 64 + y) * 64 + x)] = is_post || y % 4 == 1 ? 3000 : -1000;
        }
    scan_ = std::make_shared<const voxel::Scene>(std::move(scene));
    inputs_.witness = witness_of_window(scan_, 0.0, endless, universe_);
  }
};

TEST_F(Sheeted, RimsOfSheetsBetweenCentresAreLeftOutOfDistancesAndNoWarning) {
  const Certificate right = certified(octree(), mesh());
  EXPECT_EQ(right.verdict, Verdict::Pass) << (right.reasons.empty() ? "" : right.reasons.front());
  ASSERT_FALSE(right.resolved());
  EXPECT_NE(right.unresolved->reason.find("thinner than a voxel"), std::string::npos)
      << right.unresolved->reason;
  EXPECT_LE(comparison(right, "hausdorff95").difference, *comparison(right, "hausdorff95").tolerance);
}

TEST_F(Sheeted, APartThatOneKernelLostIsStillDetectedBesideThem) {
  const voxel::Octree ball = octree();
  const voxel::Octree without = voxel::combine(
      universe_, voxel::Expression(ball) - voxel::Expression(voxel::Box{glm::dvec3(21.0), glm::dvec3(29.0)}));
  EXPECT_EQ(certified(without, mesh()).verdict, Verdict::Fail);
}

TEST_F(Speckled, APartBetweenCentresThatTheScanLacksIsNoPass) {
  const Certificate right = certified(octree(), mesh());
  // The last part of the mesh is moved between two others, or is there twice.
  const brep::Solid solid = brep::trusted_solid(mesh(), brep::Proof::Construction);
  const brep::Component& part = solid.components().back();
  ASSERT_LT(part.volume_mm3, 1.0);
  for (const glm::dvec3& by_mm : {glm::dvec3(2.0, 0.0, 0.0), glm::dvec3(0.0)}) {
    brep::Triangles planted = mesh();
    const auto first = static_cast<std::uint32_t>(planted.points_mm.size());
    for (const glm::dvec3& p_mm : mesh().points_mm) planted.points_mm.push_back(p_mm + by_mm);
    for (const std::uint32_t face : part.faces) {
      planted.faces.push_back(mesh().faces[face]);
      for (std::uint32_t& corner : planted.faces.back()) corner += first;
    }
    const Certificate wrong = certified(octree(), planted);
    EXPECT_NE(comparison(wrong, "parts and cavities between voxels' centres").formula.find("the mesh has 65"),
              std::string::npos);
    EXPECT_NE(wrong.verdict, Verdict::Pass) << by_mm.x;
  }
}

TEST_F(Witnessed, ACapAtTheScansBorderThatIsShiftedFails) {
  // The whole scan is inside, so that the surface is its border.
  inputs_.witness = witness_of_window(scan_, -2000.0, endless, universe_);
  const voxel::Octree full = voxel::combine(universe_, voxel::Expression(voxel::bounds(scan_->lattice)));
  const brep::Triangles right = convert::isosurface(*scan_, -2000.0, endless);
  inputs_.scan_box_mm = voxel::bounds(scan_->lattice);
  const Certificate as_it_is = certified(full, right);
  EXPECT_EQ(as_it_is.verdict, Verdict::Pass) << (as_it_is.reasons.empty() ? "" : as_it_is.reasons.front());
  for (const double by_mm : {-0.45, -0.2, 0.2, 0.45}) {
    brep::Triangles shifted = right;
    for (glm::dvec3& p : shifted.points_mm)
      if (p.z > 63.2) p.z += by_mm;
    EXPECT_EQ(certified(full, shifted).verdict, Verdict::Fail) << by_mm;
  }
}

/// A plate thinner than a sample, of which only single samples reach the window's bound.
class Plate : public Speckled {
 protected:
  Plate() {
    voxel::Scene scene = *scan_;
    auto& samples = std::get<voxel::Int16Samples>(scene.samples);
    std::fill(samples.begin(), samples.end(), std::int16_t{-1000});
    for (int y = 8; y < 56; y += 2)
      for (int x = 8; x < 56; x += 2)
        samples[static_cast<std::size_t>((30 * 64 + y) * 64 + x)] =
            static_cast<std::int16_t>(50 + (37 * x + 11 * y) % 200);
    scan_ = std::make_shared<const voxel::Scene>(std::move(scene));
    universe_.depth = 6;
    universe_.lps_from_voxel = glm::dmat4(1.0);
    inputs_.witness = witness_of_window(scan_, 0.0, endless, universe_);
  }
};

TEST_F(Plate, IsNoPassAndNoFailWhereLinesConfirmTheMesh) {
  const Certificate right = certified(octree(), mesh());
  EXPECT_EQ(right.voxel.volume_mm3, 576.0);
  EXPECT_LT(right.mesh.volume_mm3, 20.0);
  EXPECT_EQ(right.verdict, Verdict::Warn);
  EXPECT_FALSE(right.resolved());
  EXPECT_TRUE(std::any_of(right.reasons.begin(), right.reasons.end(), [](const std::string& reason) {
    return reason.find("walls are thinner than a voxel") != std::string::npos;
  }));
}

TEST_F(Plate, WithAPartThatIsLargerThanTheScansFails) {
  // Each part of the mesh, eight times as long about its sample.
  brep::Triangles grown = mesh();
  for (glm::dvec3& p : grown.points_mm) p = glm::round(p) + 8.0 * (p - glm::round(p));
  EXPECT_EQ(certified(octree(), grown).verdict, Verdict::Fail);
}

/// A rind that is thinner than the distance of samples.
class Rind : public Witnessed {
 protected:
  Rind() { inputs_.witness = witness_of_window(scan_, low_, high_, universe_); }
  voxel::Octree rind() const {
    return voxel::combine(universe_, voxel::Expression(voxel::Window{
                                         voxel::grey_octree_of(universe_, *scan_, -1024), low_, high_}));
  }
  static double difference(const Certificate& certificate, const std::string& quantity) {
    for (const Comparison& each : certificate.comparisons)
      if (each.quantity == quantity) return each.difference;
    ADD_FAILURE() << "no comparison of " << quantity;
    return -1.0;
  }

  const double low_ = -60.0, high_ = -20.0;
};

TEST_F(Rind, IsTheSameInBothKernelsAndContradictsNothing) {
  universe_.lps_from_voxel[3] = {0.3, 0.4, 0.2, 1.0};
  inputs_.witness = witness_of_window(scan_, low_, high_, universe_);
  const Certificate right = certified(rind(), convert::isosurface(*scan_, low_, high_));
  EXPECT_LE(std::abs(right.difference_mm3), right.tolerance_mm3);
  EXPECT_EQ(difference(right, "contradicted voxels"), 0.0);
  EXPECT_EQ(difference(right, "stray surface"), 0.0);
  ASSERT_TRUE(right.third);
  EXPECT_NEAR(right.third->volume_mm3, right.mesh.volume_mm3, 0.02 * right.mesh.volume_mm3);
}

TEST_F(Rind, WithoutItsLayersFails) {
  // The surface of the samples in the window alone, which has nothing between a sample below and one above.
  voxel::Scene scene = *scan_;
  for (std::int16_t& sample : std::get<voxel::Int16Samples>(scene.samples))
    if (sample < low_ || sample > high_) sample = -2000;
  const Certificate lost = certified(rind(), convert::isosurface(scene, low_, endless));
  ASSERT_GT(std::abs(lost.difference_mm3), lost.tolerance_mm3);
  EXPECT_EQ(lost.verdict, Verdict::Fail);
  EXPECT_GT(difference(lost, "stray surface"), 0.0);
  EXPECT_TRUE(std::any_of(lost.reasons.begin(), lost.reasons.end(), [](const std::string& reason) {
    return reason.find("% of this tissue") != std::string::npos;
  }));
}

}  // namespace
}  // namespace octotomy::verify

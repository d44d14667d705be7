// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/solid_phantom.h"

#include <cmath>
#include <gtest/gtest.h>

#include "verify/phantom/implicit_solid.h"
#include "voxel/measure/measure.h"

namespace octotomy::verify {
namespace {

using voxel::Digitisation;

SolidPhantomOptions of(int voxels) {
  SolidPhantomOptions options;
  options.voxels = voxels;
  return options;
}

class EverySolid : public testing::TestWithParam<std::string> {};

bool on_lattice(const std::string& kind) {
  return kind == "chequered_sphere" || kind == "figure_3_1";
}

// Off the lattice and oblique to it where that can be: a solid in the middle has eight like octants, whose
// errors add up instead of levelling out.
SolidPhantom askew(const std::string& kind) {
  SolidPhantomOptions options = of(64);
  if (!on_lattice(kind)) {
    options.centre_mm = {0.21, -0.37, 0.11};
    options.lps_from_axes = turned({20, -35, 50});
  }
  return solid_phantom(kind, options);
}

TEST_P(EverySolid, HasTheVolumeAndCentroidOfItsFractions) {
  const SolidPhantom solid = askew(GetParam());
  const voxel::PartialOctree partial = digitise_partial(solid);
  EXPECT_NEAR(voxel::volume_mm3(partial) / solid.volume_mm3, 1.0, 1e-3);
  const voxel::Measures measures = voxel::measure(voxel::at_least_half(partial));
  ASSERT_TRUE(measures.centroid_mm);
  EXPECT_LT(glm::distance(*measures.centroid_mm, solid.centroid_mm), 0.06);
  // A count knows the volume to about the square root of the boundary's voxels.
  const double scatter = std::sqrt(solid.area_mm2);
  for (const Digitisation digitisation : {Digitisation::Centre, Digitisation::Half}) {
    const auto count = static_cast<double>(digitise(solid, digitisation).voxel_count());
    EXPECT_NEAR(count, solid.volume_mm3, scatter);
  }
  EXPECT_LE(digitise(solid, Digitisation::Inside).voxel_count(), solid.volume_mm3 + 0.5);
  EXPECT_GE(digitise(solid, Digitisation::Touching).voxel_count(), solid.volume_mm3 - 0.5);
}

TEST_P(EverySolid, HasAnAreaThatCroftonConfirmsUpToItsLossOnFlats) {
  const SolidPhantom solid = solid_phantom(GetParam(), of(128));
  const double area = voxel::measure(digitise(solid, Digitisation::Centre)).area_crofton13_mm2;
  // 13 directions lose up to 9 % on flats along the axes, and more where flats meet in edges.
  EXPECT_GT(area, (on_lattice(GetParam()) ? 0.85 : 0.9) * solid.area_mm2);
  EXPECT_LT(area, 1.03 * solid.area_mm2);
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const SolidPhantomKind& kind : solid_phantom_kinds()) all.emplace_back(kind.name);
  return all;
}
INSTANTIATE_TEST_SUITE_P(Kinds, EverySolid, testing::ValuesIn(names()),
                         [](const auto& tested) { return tested.param; });

TEST(SolidPhantom, AnEllipsoidsAreaIsTheSpheresAndTheSpheroidsWhereItIsThose) {
  const SolidPhantom solid = solid_phantom("ellipsoid", of(256));
  const double a = 64, b = 48, c = 32;
  // Thomsen's formula is within 1.061 % of every ellipsoid: a wrong sign or axis is not.
  const double p = 1.6075;
  const double thomsen =
      4 * M_PI * std::pow((std::pow(a * b, p) + std::pow(a * c, p) + std::pow(b * c, p)) / 3, 1 / p);
  EXPECT_NEAR(solid.area_mm2 / thomsen, 1.0, 0.0107);
  // By quadrature of the surface element over the sphere of directions.
  double sum = 0.0;
  constexpr int fine = 1000;
  for (int i = 0; i < fine; ++i)
    for (int j = 0; j < fine; ++j) {
      const double t = M_PI * (i + 0.5) / fine;
      const double f = 2 * M_PI * (j + 0.5) / fine;
      const glm::dvec3 n(std::sin(t) * std::cos(f), std::sin(t) * std::sin(f), std::cos(t));
      sum += std::sin(t) * glm::length(glm::dvec3(b * c, a * c, a * b) * n);
    }
  sum *= 2 * M_PI * M_PI / fine / fine;
  EXPECT_NEAR(solid.area_mm2 / sum, 1.0, 1e-6);
}

TEST(SolidPhantom, TurnsAndMovesWithoutChangingItsTruth) {
  SolidPhantomOptions options = of(64);
  options.lps_from_axes = turned({20, -35, 50});
  options.centre_mm = {2.3, -1.1, 0.7};
  for (const char* kind : {"box", "ellipsoid", "torus", "cylinder", "lens", "cut_sphere", "plate"}) {
    const SolidPhantom straight = solid_phantom(kind, of(64));
    const SolidPhantom turned_solid = solid_phantom(kind, options);
    EXPECT_EQ(straight.volume_mm3, turned_solid.volume_mm3) << kind;
    const voxel::PartialOctree partial = digitise_partial(turned_solid);
    EXPECT_NEAR(voxel::volume_mm3(partial) / turned_solid.volume_mm3, 1.0, 2e-3) << kind;
    EXPECT_FALSE(digitise(straight, Digitisation::Centre) == digitise(turned_solid, Digitisation::Centre));
    const auto centroid = voxel::measure(voxel::at_least_half(partial)).centroid_mm;
    ASSERT_TRUE(centroid);
    EXPECT_LT(glm::distance(centroid.value(), turned_solid.centroid_mm), 0.1) << kind;
  }
}

TEST(SolidPhantom, SaysWhatDoesNotFit) {
  EXPECT_THROW(solid_phantom("spher", of(64)), std::invalid_argument);
  EXPECT_THROW(solid_phantom("sphere", of(100)), std::invalid_argument);
  SolidPhantomOptions options = of(64);
  options.radius_voxels = 33;
  EXPECT_THROW(solid_phantom("sphere", options), std::invalid_argument);
  options.radius_voxels = 20;
  options.centre_mm = {1, 0, 0};
  EXPECT_THROW(solid_phantom("chequered_sphere", options), std::invalid_argument);
  EXPECT_THROW(solid_phantom("figure_3_1", options), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify

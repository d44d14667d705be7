// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/pack_witness.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>

#include "tests/planner/ct_scene.h"

namespace octotomy::planner {
namespace {

constexpr double unmeasured = -2000.0;

/// The cells' samples in the rows of an array of 14 columns.
std::vector<double> samples_of(const std::string& npy) {
  const std::size_t begin =
      10 + static_cast<unsigned char>(npy[8]) + 256 * static_cast<unsigned char>(npy[9]);
  std::vector<double> values((npy.size() - begin) / sizeof(double)), samples;
  std::memcpy(values.data(), npy.data() + begin, values.size() * sizeof(double));
  for (std::size_t row = 0; row + 14 <= values.size(); row += 14)
    samples.insert(samples.end(), values.begin() + static_cast<std::ptrdiff_t>(row + 6),
                   values.begin() + static_cast<std::ptrdiff_t>(row + 14));
  return samples;
}

TEST(PackWitness, CellsWithASampleThatWasNotMeasuredAreLeftOut) {
  voxel::Scene scan = tests::ct_scene(
      glm::ivec3(8), glm::dvec3(2.0), glm::dvec3(0.0),
      [](const glm::ivec3& at, auto&&) { return at == glm::ivec3(3) ? static_cast<int>(unmeasured) : at.x; });
  voxel::Universe universe;
  universe.depth = 4;
  const Object object("bone", "window", universe);
  const auto cells = [&] { return samples_of(witness_arrays(object, universe, &scan).at("samples")); };
  const std::vector<double> all = cells();
  EXPECT_GT(std::count(all.begin(), all.end(), unmeasured), 0);
  scan.padding = unmeasured;
  const std::vector<double> measured = cells();
  EXPECT_EQ(std::count(measured.begin(), measured.end(), unmeasured), 0);
  // Eight of 343 cells have the sample.
  EXPECT_GT(measured.size(), all.size() * 9 / 10);
}

}  // namespace
}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A flat scan 0.4 mm above the top of a block, so that every side is known.
#include "verify/witness/scan_blend_witness.h"

#include <gtest/gtest.h>

#include "verify/witness/witness.h"

namespace octotomy::verify {
namespace {

constexpr double above_mm = 0.4;

Witness block_witness() {
  return witness_of_box({{-20, -20, -20}, {20, 20, 0}});
}

/// A square of 20 mm, in triangles of a millimetre, that faces up.
Witness witness_of_flat_scan() {
  constexpr std::uint32_t side = 21;
  WitnessedScan scan;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) scan.scan.points_mm.emplace_back(x - 10.0, y - 10.0, above_mm);
  for (std::uint32_t y = 0; y + 1 < side; ++y)
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = x + side * y, b = a + 1, c = a + side, d = c + 1;
      scan.scan.faces.push_back({a, b, d});
      scan.scan.faces.push_back({a, d, c});
    }
  scan.to_roots = {0, 0, -1};
  scan.tips_mm = -above_mm;
  scan.depth_mm = 5.0;
  scan.blend_mm = scan.reach_mm = 1.5;
  scan.apart_mm = 0.05;
  return witness_of_scan_blend(block_witness(), scan);
}

TEST(ScanBlendWitness, TheScanDecidesOnTheCrownsTheObjectBeyondAndNeitherOnTheBorder) {
  const Witness witness = witness_of_flat_scan();
  const auto sides = [&](const glm::dvec3& p) { return witness.mesh_sides(p); };
  EXPECT_EQ(sides({0.3, 0.2, 0.3}), certainly_in) << "below the scan, above the block";
  EXPECT_EQ(sides({0.3, 0.2, 0.5}), certainly_out) << "above the scan";
  EXPECT_EQ(sides({0.3, 0.2, 0.41}), on_surface);
  EXPECT_EQ(sides({15.3, 0.2, 0.2}), certainly_out) << "beside the scan, above the block";
  EXPECT_EQ(sides({15.3, 0.2, -0.2}), certainly_in);
  EXPECT_EQ(sides({9.5, 0.2, 0.2}), on_surface) << "on the border, between both surfaces";
  EXPECT_EQ(sides({9.5, 0.2, -0.2}), certainly_in);
  EXPECT_EQ(sides({0.3, 0.2, -6.0}), certainly_in) << "below the depth";
  EXPECT_EQ(sides({0.3, 0.2, 6.0}), certainly_out) << "beyond the reach";
  EXPECT_TRUE(is_scan_blend(witness));
  EXPECT_FALSE(is_scan_blend(block_witness()));
  EXPECT_FALSE(witness_of_scan_blend({}, {}));
}

}  // namespace
}  // namespace octotomy::verify

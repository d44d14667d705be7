// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/tilt_correction.h"

#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

TEST(TiltCorrection, LeaningSlicesOfALinearFunctionStayItOnPerpendicularAxes) {
  for (const glm::dvec2& lean_px : {glm::dvec2(0.4, 0.0), {-0.3, 0.7}, {0.0, -1.25}}) {
    Scene leaning;
    leaning.lattice.dims = {9, 8, 7};
    const glm::dvec3 row_mm(0.0, 0.5, 0.0), column_mm(0.0, 0.0, -0.8);
    leaning.lattice.lps_from_voxel =
        glm::dmat4(glm::dvec4(row_mm, 0.0), glm::dvec4(column_mm, 0.0),
                   glm::dvec4(-2.0, 0.5 * lean_px.x, -0.8 * lean_px.y, 0.0), glm::dvec4(3, 4, 5, 1));
    const auto value = [](const glm::dvec3& p_mm) { return 200.0 + glm::dot(p_mm, glm::dvec3(7, -5, 9)); };
    FloatSamples samples;
    for (int z = 0; z < 7; ++z)
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 9; ++x)
          samples.push_back(static_cast<float>(value(leaning.lattice.lps_mm({x, y, z}))));
    leaning.samples = samples;
    const Scene straight = tilt_corrected(leaning);
    const glm::dmat3 axes(straight.lattice.lps_from_voxel);
    EXPECT_NEAR(glm::dot(axes[2], axes[0]), 0.0, 1e-12);
    EXPECT_NEAR(glm::dot(axes[2], axes[1]), 0.0, 1e-12);
    EXPECT_EQ(straight.lattice.dims.z, 7);
    int compared = 0;
    const auto& found = std::get<FloatSamples>(straight.samples);
    for (int z = 0, i = 0; z < straight.lattice.dims.z; ++z)
      for (int y = 0; y < straight.lattice.dims.y; ++y)
        for (int x = 0; x < straight.lattice.dims.x; ++x, ++i) {
          const glm::dvec3 p_mm = straight.lattice.lps_mm({x, y, z}), q = leaning.lattice.voxel(p_mm);
          if (q.x < 0 || q.y < 0 || q.x > 8 || q.y > 7) continue;
          ++compared;
          EXPECT_NEAR(found[static_cast<std::size_t>(i)], value(p_mm), 1e-3);
        }
    // Every slice keeps all its pixels but a row and a column that interpolation takes.
    EXPECT_GE(compared, 7 * 8 * 7);
  }
}

TEST(TiltCorrection, ASampleBetweenLeaningSlicesIsMadeOfBothOrIsTheFill) {
  // Two slices of four pixels, the upper one 1.5 pixels aside, and one between them that no image has.
  const auto field = [](double x_px) { return 100.0 + 10.0 * x_px; };
  const std::vector<glm::dvec2> aside_px{{0.0, 0.0}, {1.5, 0.0}};
  FloatSamples stored;
  for (const glm::dvec2& aside : aside_px)
    for (int x = 0; x < 4; ++x) stored.push_back(static_cast<float>(field(x + aside.x)));
  SlicePlan plan;
  plan.sources = {{0, 0, 0.0}, {0, 1, 0.5}, {1, 1, 0.0}};
  plan.size_px = {7, 1};
  plan.aside_px = aside_px;
  const SceneSamples made = tilt_corrected_samples(plan, {4, 1}, stored);
  const auto& samples = std::get<FloatSamples>(made);
  const float fill = stored.front();
  for (int x = 0; x < 7; ++x) {
    const float between = samples[static_cast<std::size_t>(7 + x)];
    // Half a pixel beyond the outer centres a slice repeats its last sample.
    if (x >= 1 && x <= 3)
      EXPECT_NEAR(between, field(x), 5.0) << x;
    else
      EXPECT_EQ(between, fill) << x;
  }
  EXPECT_EQ(samples[3], field(3));
  EXPECT_EQ(samples[14 + 6], fill);
}

TEST(TiltCorrection, SlicesThatStandStraightStayAsTheyAre) {
  Scene scene;
  scene.lattice.dims = {3, 2, 2};
  scene.samples = Int16Samples{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const Scene straight = tilt_corrected(scene);
  EXPECT_EQ(straight.lattice, scene.lattice);
  EXPECT_EQ(std::get<Int16Samples>(straight.samples), std::get<Int16Samples>(scene.samples));
}

}  // namespace
}  // namespace octotomy::voxel

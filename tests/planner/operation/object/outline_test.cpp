// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/file/region_file.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

Exported written_outline(const ScratchFolder& folder, const std::string& rest) {
  const Plan plan =
      ball_plan(folder, R"({"id": "o", "do": "outline", "object": "ball", "path": "o.json", )" + rest + "}");
  Timings timings;
  return write_files(plan, evaluate(plan), folder.path(), timings).at(0);
}

TEST(OutlineStep, PlanesOfAnyViewCutTheBallInCirclesAtMultiplesOfTheirDistance) {
  const ScratchFolder folder;
  for (const std::string view : {"anterior", "35,15"}) {
    const Exported made = written_outline(folder, R"("every_mm": 2.4, "view": ")" + view + "\"");
    ASSERT_TRUE(made.written) << testing::PrintToString(made.findings);
    const voxel::SliceMask mask = read_slices(folder / "o.json");
    ASSERT_EQ(mask.slices.size(), 19u) << "from -19.2 to 19.2, and an empty one at either end";
    EXPECT_TRUE(mask.slices.front().polygons_mm.empty());
    EXPECT_TRUE(mask.slices.back().polygons_mm.empty());
    for (std::size_t k = 1; k + 1 < mask.slices.size(); ++k) {
      const auto& slice = mask.slices[k];
      EXPECT_NEAR(slice.position_mm, -19.2 + 2.4 * static_cast<double>(k - 1), 1e-12);
      ASSERT_EQ(slice.polygons_mm.size(), 1u) << slice.position_mm;
      for (const glm::dvec2& p : slice.polygons_mm[0])
        EXPECT_NEAR(glm::length(p), std::sqrt(400.0 - slice.position_mm * slice.position_mm), 0.3);
    }
  }
}

TEST(OutlineStep, NamedPlanesAreTheirs) {
  const ScratchFolder folder;
  const Exported made = written_outline(folder, R"("at_mm": [7, -3], "thin_mm": 0.1)");
  ASSERT_TRUE(made.written) << testing::PrintToString(made.findings);
  const voxel::SliceMask mask = read_slices(folder / "o.json");
  ASSERT_EQ(mask.slices.size(), 4u);
  EXPECT_EQ(mask.slices[1].position_mm, -3.0);
  EXPECT_EQ(mask.slices[2].position_mm, 7.0);
  EXPECT_LT(mask.slices[2].polygons_mm.at(0).size(), 60u) << "thinned";
}

TEST(OutlineStep, PlanesThatCannotBeAreRefusedInALine) {
  const ScratchFolder folder;
  const auto expect = [&](const std::string& rest, const std::string& part) {
    const std::string said = ball_refusal(
        folder, R"({"id": "o", "do": "outline", "object": "ball", "path": "o.json", )" + rest + "}");
    EXPECT_NE(said.find(part), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  };
  expect(R"("view": "sideways")", "sideways");
  expect(R"("from_mm": 5, "to_mm": 5)", "exchange the two");
  expect(R"("at_mm": [1], "from_mm": 5)", "leave 'from_mm'");
  expect(R"("at_mm": [1], "every_mm": 3)", "leave 'at_mm' out");
  expect(R"("every_mm": 0)", "every_mm");
  const auto unwritten = [&](const std::string& rest, const std::string& part) {
    const Exported made = written_outline(folder, rest);
    EXPECT_FALSE(made.written);
    EXPECT_NE(testing::PrintToString(made.findings).find(part), std::string::npos)
        << testing::PrintToString(made.findings);
  };
  unwritten(R"("from_mm": 50)", "no plane meets the object");
  unwritten(R"("at_mm": [1, 1])", "has a position twice");
  unwritten(R"("every_mm": 0.001)", "more than 5000 planes");
}

}  // namespace
}  // namespace octotomy::planner

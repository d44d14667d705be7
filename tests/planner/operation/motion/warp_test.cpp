// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>

#include "convert/tet/octree_tetrahedra.h"
#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"
#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// CalculiX's result of a ball of elements of 13 mm about the origin that bends and stretches by millimetres.
void write_frd(const std::filesystem::path& path, double share) {
  const convert::Tetrahedra elements = convert::tetrahedra_of(
      voxel::combine(universe_about_origin(5), voxel::Expression(voxel::Sphere{{0, 0, 0}, 13.0})));
  std::ofstream out(path);
  char line[120];
  const auto put = [&](const char* head, std::size_t node, const glm::dvec3& p) {
    std::snprintf(line, sizeof line, " %s%10zu%12.5E%12.5E%12.5E\n", head, node, p.x, p.y, p.z);
    out << line;
  };
  out << "    1C\n    2C\n";
  for (std::size_t i = 0; i < elements.nodes_mm.size(); ++i) put("-1", i + 1, elements.nodes_mm[i]);
  out << " -3\n    3C\n";
  for (std::size_t i = 0; i < elements.tets.size(); ++i) {
    std::snprintf(line, sizeof line, " -1%10zu%5d%5d%5d\n", i + 1, 3, 0, 1);
    out << line << " -2";
    for (const std::uint32_t node : elements.tets[i]) {
      std::snprintf(line, sizeof line, "%10u", node + 1);
      out << line;
    }
    out << "\n";
  }
  out << " -3\n    1PSTEP                         1           1           1\n"
         "  100CL  101 1.00000000           0                     0    1           1\n"
         " -4  DISP        4    1\n -5  D1          1    2    1    0\n -5  D2          1    2    2    0\n"
         " -5  D3          1    2    3    0\n -5  ALL         1    2    0    0    1ALL\n";
  for (std::size_t i = 0; i < elements.nodes_mm.size(); ++i) {
    const glm::dvec3 q = elements.nodes_mm[i] / 13.0;
    put("-1", i + 1, share * glm::dvec3(1.5 + 1.6 * q.y * q.y, -1.0 + 1.8 * q.z, 1.4 * q.x * q.y + q.x));
  }
  out << " -3\n 9999\n";
}

TEST(WarpStep, TheCertificateMovesPointsBackAndWarnsThatOneKernelMadeIt) {
  const ScratchFolder folder;
  write_frd(folder / "solved.frd", 1.0);
  write_frd(folder / "other.frd", 1.2);
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "face", "do": "warp", "object": "ball", "result": "solved.frd"},
      {"id": "more", "do": "warp", "object": "ball", "result": "other.frd"},
      {"id": "half", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-15, -15], [15, -15], [15, 7.5], [-15, 7.5]]]}]},
      {"id": "part_lost", "do": "combine", "expression": "ball & half"})",
                                                   small_radius_mm));
  const Object& face = evaluation.object("face");
  expect_not_independent(face, face.mesh.within->measures().volume_mm3, 0.01);
  EXPECT_EQ(face.certificate->reasons.size(), 1U) << testing::PrintToString(face.certificate->reasons);
  EXPECT_GT(face.mesh.details["largest_displacement_mm"].get<double>(), 3.0);
  ASSERT_TRUE(face.certificate->limit && face.certificate->limit->shift_mm);
  EXPECT_LE(*face.certificate->limit->shift_mm, 0.5);
  for (const char* by : {"ball", "more", "part_lost", ""}) expect_fails_as(evaluation, "face", by);
  expect_fails_as(evaluation, "face", pushed_out(evaluation, "face", 1.0), "pushed out");
}

}  // namespace
}  // namespace octotomy::planner

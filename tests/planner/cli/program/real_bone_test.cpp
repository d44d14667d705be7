// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Published bone models, and a skull's surface as VTK writes it, through every verb of meshes.
#include "tests/planner/cli/program/command_line.h"
#include "tests/reference_data.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::quoted;
using tests::SortedJson;

class RealBone : public tests::CommandLine {
 protected:
  SortedJson json_of(const std::string& command) {
    const CommandAnswer answer = run(command + " --json");
    EXPECT_EQ(answer.status, 0) << command << ": " << answer.errors;
    return answer.status == 0 ? SortedJson::parse(answer.out) : SortedJson();
  }

  /// A block over the upper half of a solid.
  std::string upper_half(const SortedJson& measured) {
    const auto end = [&](std::size_t which, std::size_t axis) {
      return measured["extents_mm"][which][axis].get<double>();
    };
    std::ostringstream text;
    text << "OFF\n8 12 0\n";
    for (int k = 0; k < 8; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double low = axis == 2 ? 0.5 * (end(0, 2) + end(1, 2)) + 0.0123 : end(0, axis) - 1.0;
        text << ((k >> axis & 1) != 0 ? end(1, axis) + 1.0 : low) << " ";
      }
      text << "\n";
    }
    text << "3 0 2 3\n3 0 3 1\n3 4 5 7\n3 4 7 6\n3 0 1 5\n3 0 5 4\n3 2 6 7\n3 2 7 3\n3 0 4 6\n3 0 6 2\n3 1 3 "
            "7\n3 1 7 5\n";
    write("upper.off", text.str());
    return at("upper.off");
  }

  /// repair, boolean, tet, mirror and compare, none of which may refuse.
  void go_through(const std::string& raw) {
    const SortedJson repaired = json_of("repair " + raw + " --solid -o " + at("solid.ply"));
    EXPECT_EQ(repaired["health"]["self_intersections"], 0);
    const double whole_mm3 = repaired["volume_after_mm3"];
    const std::string upper = upper_half(json_of("measure " + at("solid.ply")));
    // The surface as it came, mended on the way, is cut into the same halves.
    const SortedJson half =
        json_of("boolean " + raw + " intersection " + upper + " --mend -o " + at("half.ply"));
    const SortedJson rest =
        json_of("boolean " + at("solid.ply") + " difference " + upper + " -o " + at("rest.ply"));
    EXPECT_NEAR(half["volume_mm3"].get<double>() + rest["volume_mm3"].get<double>(), whole_mm3,
                1e-3 * whole_mm3);
    EXPECT_NE(half["findings"][0].get<std::string>().find("so it was mended: "), std::string::npos);
    const SortedJson tets = json_of("tet " + raw + " --mend -o " + at("raw.inp"));
    EXPECT_GT(tets["quality"]["min_dihedral_deg"].get<double>(), 5.0) << tets["findings"];
    EXPECT_EQ(tets["fallback"], false);
    EXPECT_NEAR(tets["volume_mm3"].get<double>() / whole_mm3, 1.0, 0.05);
    json_of("mirror " + raw + " -o " + at("mirrored.ply"));
    EXPECT_NEAR(json_of("compare " + raw + " " + raw)["hausdorff_mm"].get<double>(), 0.0, 1e-9);
    json_of("compare " + raw + " " + at("mirrored.ply"));
  }
};

TEST_F(RealBone, OfAHyoidGoesThroughEveryVerbAsPublished) {
  OCTOTOMY_NEEDS_DATA("meshes_bone/spl_hyoid.vtk");
  go_through(quoted(tests::reference_data("meshes_bone/spl_hyoid.vtk")));
}

TEST_F(RealBone, OfAnAtlasGoesThroughEveryVerbAsPublished) {
  OCTOTOMY_NEEDS_DATA("meshes_bone/spl_atlas_C1.vtk");
  go_through(quoted(tests::reference_data("meshes_bone/spl_atlas_C1.vtk")));
}

TEST_F(RealBone, OfAMandibleGoesThroughEveryVerbAsPublished) {
  OCTOTOMY_NEEDS_DATA("meshes_bone/spl_mandible.vtk");
  go_through(quoted(tests::reference_data("meshes_bone/spl_mandible.vtk")));
}

TEST_F(RealBone, UnmendedIsRefusedByNameAndTold) {
  OCTOTOMY_NEEDS_DATA("meshes_bone/spl_hyoid.vtk");
  const std::string hyoid = quoted(tests::reference_data("meshes_bone/spl_hyoid.vtk"));
  expect_refused(run("tet " + hyoid + " -o " + at("hyoid.inp")), "--mend");
  expect_refused(run("boolean " + hyoid + " union " + hyoid + " -o " + at("twice.ply")), "--mend");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "hyoid.inp"));
  const std::string offset = "offset " + hyoid + " --by 1 -o " + at("margin.ply");
  expect_refused(run(offset), "--mend");
  const SortedJson margin = json_of(offset + " --mend");
  EXPECT_NE(margin["findings"][0].get<std::string>().find("so it was mended: "), std::string::npos);
  EXPECT_GT(margin["volume_change_mm3"], 0.0);
  const SortedJson whole = json_of("repair " + hyoid + " --solid -o " + at("solid.ply"));
  const SortedJson box = json_of("measure " + at("solid.ply"))["extents_mm"];
  std::ostringstream line;
  line << " --line";
  for (const std::size_t end : {0, 1})
    line << " " << box[end][0].get<double>() + (end == 0 ? -5.0 : 5.0) << "," << box[0][1].get<double>() - 5.0
         << "," << 0.5 * (box[0][2].get<double>() + box[1][2].get<double>());
  const SortedJson sawn = json_of("saw " + hyoid + " --mend" + line.str() +
                                  " --direction 0,1,0 --depth 300 --kerf 1 -o " + at("sawn.ply"));
  EXPECT_GT(sawn["sawn_away_mm3"], 0.0);
  EXPECT_NEAR(sawn["sawn_away_mm3"].get<double>() + sawn["volume_mm3"].get<double>(),
              whole["volume_after_mm3"].get<double>(), 1e-3 * whole["volume_after_mm3"].get<double>());
}

TEST_F(RealBone, ASkullOf400000TrianglesOfVtkGoesThroughEveryVerb) {
  OCTOTOMY_NEEDS_DATA("ct_invesalius_cranium.nii.gz");
  const CommandAnswer made = tests::run_command(
      "/usr/bin/python3 " OCTOTOMY_SOURCE_DIR "/tests/planner/cli/program/spoiled_cranium.py " +
          quoted(tests::reference_data("ct_invesalius_cranium.nii.gz")) + " " + at("skull.vtp"),
      folder_ / "");
  if (made.status == 77) GTEST_SKIP() << "/usr/bin/python3: " << made.errors;
  ASSERT_EQ(made.status, 0) << made.errors;
  const SortedJson spoiled = SortedJson::parse(made.out);
  ASSERT_GT(spoiled["triangles"], 390000);
  ASSERT_GT(spoiled["open_edges"], 500) << "the surface is not spoiled";
  ASSERT_GT(spoiled["fans"], 50) << "the surface is not spoiled";
  ASSERT_GT(json_of("info " + at("skull.vtp"))["self_intersections"], 500) << "the surface is not spoiled";
  go_through(at("skull.vtp"));
}

}  // namespace
}  // namespace octotomy::planner

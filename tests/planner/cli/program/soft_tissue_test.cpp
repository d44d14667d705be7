// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The soft-tissue example that stands beside the first: from the phantom's head to the skin that a solver
// moved.
#include <algorithm>
#include <cmath>
#include <optional>

#include "convert/deck/calculix_result.h"
#include "planner/operation/file/mesh_in.h"
#include "tests/planner/cli/program/command_line.h"
#include "tests/reference_data.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::SortedJson;

/// The displacement that a solved deck has at a place, interpolated within the element that holds it; none
/// outside of all elements.
std::optional<glm::dvec3> displacement_at(const convert::SolvedDeck& deck, const glm::dvec3& p_mm) {
  for (const auto& tet : deck.tetrahedra.tets) {
    const auto corner = [&](std::size_t i) { return deck.tetrahedra.nodes_mm[tet[i]]; };
    const glm::dvec3 last_mm = corner(3);
    if (glm::distance(last_mm, p_mm) > 20.0) continue;
    const glm::dvec3 share =
        glm::inverse(glm::dmat3(corner(0) - last_mm, corner(1) - last_mm, corner(2) - last_mm)) *
        (p_mm - last_mm);
    const double rest = 1.0 - share.x - share.y - share.z;
    if (std::min({share.x, share.y, share.z, rest}) < 0.0) continue;
    const auto by = [&](std::size_t i) { return deck.displacement_mm[tet[i]]; };
    return share.x * by(0) + share.y * by(1) + share.z * by(2) + rest * by(3);
  }
  return std::nullopt;
}

class SoftTissue : public tests::CommandLine {};

TEST_F(SoftTissue, OfTheExamplePlanIsSolvedAndMovesTheSkinAsFarAsThePieceAtMost) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  ASSERT_EQ(run("phantom head -o " + at("head.nrrd")).status, 0);
  const CommandAnswer planned =
      run("run " + tests::quoted(OCTOTOMY_SOURCE_DIR "/planner/soft_tissue.plan.json") +
          " --scan ct=" + at("head.nrrd") + " --certify never -o " + at("report"));
  ASSERT_EQ(planned.status, 0) << planned.errors;
  ASSERT_EQ(tests::run_command("cd " + at("report") + " && ccx -i face", folder_ / "").status, 0);
  const CommandAnswer warped = run("warp " + at("report/skin.stl") + " --result " + at("report/face.frd") +
                                   " -o " + at("predicted.stl") + " --json");
  ASSERT_EQ(warped.status, 0) << warped.errors;
  // The piece goes 4.12 mm; tissue that it presses aside may go little more.
  const SortedJson answer = SortedJson::parse(warped.out);
  const double largest_mm = answer["largest_displacement_mm"];
  EXPECT_GT(largest_mm, 3.0);
  EXPECT_LT(largest_mm, 4.5);
  EXPECT_EQ(answer["fade_mm"], 20.0);

  // Skin farther than 20 mm beyond the deck's box (y up to -20, z from -85) stays where it was: the neck
  // below, and the headrest behind. The lips, in front of the moved teeth, come forward.
  const brep::Triangles before = read_mesh_in(folder_ / "report" / "skin.stl");
  const brep::Triangles after = read_mesh_in(folder_ / "predicted.stl");
  ASSERT_EQ(before.points_mm.size(), after.points_mm.size());
  const convert::SolvedDeck deck = convert::read_solved_deck(folder_ / "report" / "face.frd");
  std::size_t neck = 0, behind = 0, lips = 0, in_elements = 0;
  for (std::size_t i = 0; i < before.points_mm.size(); ++i) {
    const glm::dvec3& p_mm = before.points_mm[i];
    const glm::dvec3 moved_mm = after.points_mm[i] - p_mm;
    neck += p_mm.z < -106.0 ? 1 : 0;
    behind += p_mm.y > 1.0 ? 1 : 0;
    if (p_mm.z < -106.0 || p_mm.y > 1.0) {
      ASSERT_LT(glm::length(moved_mm), 1e-5) << i;
    }
    if (std::abs(p_mm.x) < 10.0 && p_mm.y < -85.0 && p_mm.z > -50.0 && p_mm.z < -35.0) {
      ++lips;
      EXPECT_LT(moved_mm.y, -1.0) << i;
      // They lie where the finite elements put them; coordinates of the files have six digits.
      if (const auto solved_mm = displacement_at(deck, p_mm)) {
        ++in_elements;
        EXPECT_LT(glm::distance(*solved_mm, moved_mm), 0.001) << i;
      }
    }
  }
  EXPECT_GT(neck, 100u);
  EXPECT_GT(behind, 1000u);
  EXPECT_GT(lips, 10u);
  EXPECT_GT(in_elements, 10u);
}

}  // namespace
}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/health.h"
#include "brep/mesh/triangles.h"
#include "tests/brep/bad_meshes.h"
#include "tests/planner/cli/program/command_line.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;
using brep::shapes::box;
using brep::shapes::together;

/// A block with a cavity, and a smaller block.
brep::Triangles hollow_and_small() {
  brep::Triangles cavity = box({-5, -5, -5}, {5, 5, 5});
  for (auto& face : cavity.faces) std::swap(face[1], face[2]);
  return together(together(box({20, 0, 0}, {24, 4, 4}), box({-10, -10, -10}, {10, 10, 10})), cavity);
}

TEST(SeparateStep, TheSecondPieceIsTheSmallerBlockAndTheFirstKeepsItsCavity) {
  const ScratchFolder folder;
  brep::write_mesh(hollow_and_small(), folder / "two.off");
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "two", "do": "import", "path": "two.off"},
      {"id": "large", "do": "separate", "object": "two", "piece": 1},
      {"id": "small", "do": "separate", "object": "two", "piece": 2})"));
  EXPECT_NEAR(evaluation.object("large").mesh.whole->measures().volume_mm3, 8000.0 - 1000.0, 1e-9);
  EXPECT_NEAR(evaluation.object("small").mesh.whole->measures().volume_mm3, 64.0, 1e-9);
  EXPECT_EQ(evaluation.object("large").mesh.details["cavities"], 1);
}

TEST(SeparateStep, APieceThatIsNotThereOrNotSaidIsRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "separate", "object": "ball"})").find("is missing"),
            std::string::npos);
  try {
    evaluate(ball_plan(folder, R"({"id": "s", "do": "separate", "object": "ball", "piece": 2})"));
    FAIL() << "was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("has 1 pieces"), std::string::npos) << error.what();
  }
}

class SeparateVerb : public CommandLine {};

TEST_F(SeparateVerb, EachPieceOfAnOpenSurfaceIsAFileAndTheyAddUpToTheWhole) {
  brep::Triangles open = together(hollow_and_small(), brep::shapes::sheet(2, 3.0));
  brep::write_mesh(open, folder_ / "open.off");
  const CommandAnswer answer = run("separate " + at("open.off") + " -o " + at("part.ply") + " --json");
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const SortedJson json = SortedJson::parse(answer.out);
  ASSERT_EQ(json["pieces"], 4);
  std::size_t triangles = 0;
  double before_mm2 = 1e300;
  for (const SortedJson& piece : json["written"]) {
    const brep::Triangles read = brep::read_triangles(piece["path"].get<std::string>());
    EXPECT_EQ(read.faces.size(), piece["triangles"]);
    EXPECT_EQ(brep::health(read).components, 1u);
    EXPECT_LE(piece["area_mm2"].get<double>(), before_mm2);
    before_mm2 = piece["area_mm2"];
    triangles += read.faces.size();
  }
  EXPECT_EQ(triangles, open.faces.size());
  const CommandAnswer few =
      run("separate " + at("open.off") + " --least 500 -o " + at("large.ply") + " --json");
  EXPECT_EQ(SortedJson::parse(few.out)["written"].size(), 2u);
  EXPECT_NE(few.errors.find("2 pieces under 500"), std::string::npos) << few.errors;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "large-3.ply"));
}

TEST_F(SeparateVerb, ARepeatedRunReplacesItsOwnPiecesInEveryFormat) {
  brep::write_mesh(hollow_and_small(), folder_ / "two.off");
  for (const char* extension : {"stl", "ply", "obj", "off", "vtp", "glb"}) {
    const std::string command = "separate " + at("two.off") + " -o " + at(std::string("part.") + extension);
    for (int i = 0; i < 2; ++i) {
      const CommandAnswer answer = run(command);
      EXPECT_EQ(answer.status, 0) << extension << ": " << answer.errors;
    }
    write(std::string("part-2.") + extension, "mine");
    expect_refused(run(command), std::string("part-2.") + extension + ": is there already");
  }
}

TEST_F(SeparateVerb, OnePieceGetsTheNameThatIsGivenAndAMissingOneIsRefused) {
  brep::write_mesh(hollow_and_small(), folder_ / "two.off");
  const CommandAnswer answer =
      run("separate " + at("two.off") + " --piece 1 -o " + at("body.ply") + " --json");
  ASSERT_EQ(answer.status, 0) << answer.errors;
  EXPECT_NEAR(SortedJson::parse(answer.out)["written"][0]["volume_mm3"].get<double>(), 7000.0, 1e-9);
  EXPECT_TRUE(brep::health(brep::read_triangles(folder_ / "body.ply")).solid());
  expect_refused(run("separate " + at("two.off") + " --piece 3 -o " + at("none.ply")), "has 2 pieces");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.ply"));
}

}  // namespace
}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include <filesystem>

#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

/// Commands on a ball's scan, mesh and octree that are refused by one line with a word.
class PictureOptions : public tests::CommandLine {
 protected:
  PictureOptions() {
    EXPECT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.stl")).status, 0);
    EXPECT_EQ(run("octree " + at("ball.nrrd") + " --window 0: -o " + at("ball.octree")).status, 0);
  }
  std::string ball(const std::string& ending) const { return " " + at("ball." + ending) + " "; }
};

TEST_F(PictureOptions, OfDrawAreRefusedInOneLineEach) {
  const std::string draw = "draw -o " + at("d.png") + " ";
  expect_refused(run(draw), "nothing to draw");
  expect_refused(run(draw + ball("stl") + "--axial 3"), "--scan");
  expect_refused(run(draw + "--scan" + ball("nrrd")), "state their positions");
  expect_refused(run(draw + "--scan" + ball("nrrd") + "--axial 900"), "900");
  expect_refused(run(draw + "--scan" + ball("nrrd") + "--axial 0 --level 3,0"), "above zero");
  expect_refused(run(draw + "--scan" + ball("nrrd") + "--axial 0 --within" + ball("nrrd")), "octree");
  expect_refused(run(draw + ball("stl") + "--apart 2"), "--contours");
  expect_refused(run(draw + "--contours" + ball("stl") + "--apart 0.001"), "--apart");
  expect_refused(run(draw + "--contours" + ball("stl") + "--apart 500 --shading flat"), "surfaces");
  expect_refused(run(draw + ball("stl") + "--shading toon"), "gouraud");
  expect_refused(run(draw + ball("stl") + "--light 0,0,0"), "no direction");
  expect_refused(run(draw + ball("stl") + "--ambient 1.5"), "1");
  expect_refused(run(draw + ball("stl") + "--gloss=-1"), "0");
  expect_refused(run(draw + ball("stl") + "--hide"), "--shading");
  expect_refused(run(draw + ball("stl") + "--shading wire --cull"), "--hide");
  expect_refused(run(draw + ball("stl") + "--pick 600,0"), "is not a pixel");
  expect_refused(run(draw + ball("stl") + "--colour red"), "red");
  expect_refused(run(draw + ball("stl") + "--grid 10 --eye 300"), "true scale");
  expect_refused(run("draw -o " + at("d.stl") + ball("stl")), ".png");
}

TEST_F(PictureOptions, OfMontageAreRefusedInOneLineEach) {
  const std::string montage = "montage -o " + at("m.png") + ball("nrrd");
  expect_refused(run(montage + "--count 0"), "1");
  expect_refused(run(montage + "--count 300"), "outside of the scan");
  expect_refused(run(montage + "--first 900"), "outside of the scan");
  expect_refused(run(montage + "--apart 0"), "0");
  expect_refused(run(montage + "--plane oblique"), "axial");
  expect_refused(run(montage + "--level 1,-1"), "above zero");
  expect_refused(run(montage + "--pixel 0.001"), "larger");
  expect_refused(run("montage -o " + at("m.png") + ball("stl")), "ball.stl");
}

TEST_F(PictureOptions, OfTwoScansAreRefusedInOneLineEach) {
  const std::string two = "register" + ball("nrrd") + ball("nrrd");
  expect_refused(run(two + "--samples 200"), "surfaces");
  expect_refused(run(two + "--by surfaces"), "octotomy mesh");
  expect_refused(run(two + "--by likeness"), "correlation");
  expect_refused(run(two + "--finest 9"), "8");
  expect_refused(run(two + "--least-overlap 0"), "0.05");
  expect_refused(run(two + "-o " + at("moved.stl")), ".nrrd");
  expect_refused(run(two + "--watch " + at("")), "choose the name of a new folder");
  expect_refused(run("register" + ball("nrrd") + ball("stl")), "two scans");
  expect_refused(run("register" + ball("stl") + ball("stl") + "--by correlation"), "two scans");
  expect_refused(run("register" + ball("stl") + ball("stl") + "--finest 4"), "two scans");
}

TEST_F(PictureOptions, OfCodesAreRefusedInOneLineEach) {
  const std::string octree = "octree -o " + at("b.txt") + ball("octree");
  expect_refused(run(octree + "--as linear --with" + ball("octree")), "multivalued");
  expect_refused(run(octree + "--as multivalued --with" + ball("nrrd")), ".octree");
  EXPECT_EQ(run(octree + "--as masked").status, 0);
  expect_refused(run("octree -o " + at("c.octree") + " " + at("b.txt") + " --from masked --depth 3"),
                 "character");
  expect_refused(
      run("octree -o " + at("c.octree") + " " + at("b.txt") + " --from masked --depth 5 --number 2"),
      "multivalued");
}

}  // namespace
}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Structure sets, shares of voxels and surfaces that the program writes as DICOM, as it reads them back itself and as
// dciodvfy and a reader in Python that shares nothing with it see them.
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "tests/planner/ball_scan.h"
#include "tests/reference_data.h"
#include "tests/run_command.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using tests::quoted;

class ArchiveDicom : public testing::Test {
 protected:
  tests::CommandAnswer command(const std::string& line) const {
    return tests::run_command("cd " + quoted(folder_.path()) + " && " + line, folder_.path());
  }
  tests::CommandAnswer program(const std::string& arguments) const {
    return command(std::string(OCTOTOMY_BINARY_DIR) + "/octotomy " + arguments);
  }
  SortedJson octotomy(const std::string& arguments) const {
    const tests::CommandAnswer answer = program(arguments + " --json");
    EXPECT_EQ(answer.status, 0) << arguments << "\n" << answer.errors;
    return answer.status == 0 ? SortedJson::parse(answer.out) : SortedJson();
  }
  tests::CommandAnswer python(const std::string& arguments) const {
    return command("/usr/bin/python3 " OCTOTOMY_SOURCE_DIR "/tests/planner/cli/program/other_readers.py " +
                   arguments);
  }
  /// dciodvfy's lines with "Error", except those on CLOSEDPLANAR_XOR, a type of contour that its tables lack
  /// (PS3.3, C.8.8.6.3).
  std::string errors_of(const std::string& file) const {
    const tests::CommandAnswer answer = command("dciodvfy " + file);
    std::istringstream lines(answer.out + answer.errors);
    std::string errors;
    for (std::string line; std::getline(lines, line);)
      if (line.find("Error") != std::string::npos && line.find("CLOSEDPLANAR_XOR") == std::string::npos)
        errors += line + "\n";
    return errors;
  }
  /// A CT of a ball, turned about two axes, with slices 2 mm apart; `lean` is its tilt.
  std::string source_series(double lean) const {
    voxel::Scene ball = tests::ball_scene(12.0, 40);
    ball.lattice.lps_from_voxel[2] = glm::dvec4(0.0, lean, 2.0, 0.0);
    glm::dmat4 turn(1.0);
    turn[0] = {0.8, 0.6, 0.0, 0.0};
    turn[1] = {-0.48, 0.64, 0.6, 0.0};
    turn[2] = {0.36, -0.48, 0.8, 0.0};
    ball.lattice.lps_from_voxel = turn * ball.lattice.lps_from_voxel;
    voxel::DicomOptions options;
    options.patient_name = "Source^Patient";
    fs::remove_all(folder_ / "source");
    voxel::write_dicom_series(ball, folder_ / "source", options);
    return quoted(folder_ / "source");
  }
  /// Draws the labels on the scan, and expects the same voxels from the program and from Python.
  void expect_round_trip(const std::string& scan, const std::string& window) const {
    octotomy("segment " + scan + " --window " + window + " -o a.nii.gz");
    const SortedJson drawn = octotomy("convert a.nii.gz -o rt.dcm --as structures --source " + scan);
    EXPECT_EQ(drawn["findings"].dump().find("off the voxels"), std::string::npos) << drawn["findings"];
    EXPECT_EQ(drawn["findings"].dump().find("beyond"), std::string::npos) << drawn["findings"];
    octotomy("segment " + scan + " --window=-30000: --regions rt.dcm -o back.nii.gz");
    const SortedJson back = octotomy("compare a.nii.gz back.nii.gz");
    EXPECT_EQ(back["labels"][0]["dice"], 1.0) << back;
    const tests::CommandAnswer theirs = python("structures rt.dcm a.nii.gz");
    OCTOTOMY_NEEDS_PYTHON(theirs);
    ASSERT_EQ(theirs.status, 0) << theirs.errors;
    const SortedJson said = SortedJson::parse(theirs.out);
    EXPECT_EQ(said["voxels"], drawn["structures"][0]["voxels"]);
    EXPECT_EQ(said["differing"], 0);
    EXPECT_LT(said["farthest_mm"].get<double>(), 0.01);
    EXPECT_EQ(said["references"], drawn["structures"][0]["planes"]) << "each plane has its image";
    const bool has_hole = drawn["structures"][0]["holes"] > 0;
    EXPECT_EQ(said["kinds"], SortedJson({has_hole ? "CLOSEDPLANAR_XOR" : "CLOSED_PLANAR"}));
  }

  tests::ScratchFolder folder_;
};

TEST_F(ArchiveDicom, AStructureSetHoldsTheVoxelsOfAnObliqueAndATiltedScan) {
  for (const double lean : {0.0, 0.5}) {
    SCOPED_TRACE(lean);
    expect_round_trip(source_series(lean), "0:");
  }
}

TEST_F(ArchiveDicom, AStructureSetOfRealScansHasHolesByExclusiveOr) {
  for (const char* name : {"ct_philips_skullphantom_5mm", "ct_slicer_cthead_lowres_dicom"}) {
    OCTOTOMY_NEEDS_DATA(name);
    SCOPED_TRACE(name);
    const std::string scan = quoted(tests::reference_data(name));
    const bool is_hounsfield = std::string(name) == "ct_philips_skullphantom_5mm";
    expect_round_trip(scan, is_hounsfield ? "300:" : "1150:");
    EXPECT_GT(
        octotomy("convert a.nii.gz -o rt.dcm --as structures --source " + scan)["structures"][0]["holes"], 0);
  }
}

TEST_F(ArchiveDicom, ContoursOnUnevenImagesAreReadWithoutGaps) {
  const std::string source = source_series(0.0);
  for (int i = 20; i < 40; i += 2) {
    char name[40];
    std::snprintf(name, sizeof name, "source/slice_%04d.dcm", i);
    fs::remove(folder_ / name);
  }
  octotomy("segment " + source + " --window 0: -o a.nii.gz");
  const SortedJson drawn = octotomy("convert a.nii.gz -o rt.dcm --as structures --source " + source);
  EXPECT_NE(drawn["findings"].dump().find("--planes voxels"), std::string::npos) << drawn["findings"];
  octotomy("segment " + source + " --window=-30000: --regions rt.dcm -o back.nii.gz");
  EXPECT_GT(octotomy("compare a.nii.gz back.nii.gz")["labels"][0]["dice"].get<double>(), 0.95);
  octotomy("convert a.nii.gz -o rt.dcm --as structures --planes voxels --source " + source);
  octotomy("segment " + source + " --window=-30000: --regions rt.dcm -o back.nii.gz");
  EXPECT_EQ(octotomy("compare a.nii.gz back.nii.gz")["labels"][0]["dice"], 1.0);
}

TEST_F(ArchiveDicom, ASurfaceKeepsItsSizePatientAndFrame) {
  const std::string source = source_series(0.0);
  octotomy("mesh " + source + " --window 0: -o ball.stl");
  octotomy("convert ball.stl -o ball.dcm --source " + source);
  const SortedJson before = octotomy("info ball.stl"), after = octotomy("info ball.dcm");
  EXPECT_EQ(after["kind"], "mesh");
  EXPECT_EQ(after["faces"], before["faces"]);
  EXPECT_NE(after["audit"].dump().find("STL in DICOM"), std::string::npos);
  EXPECT_EQ(octotomy("measure ball.dcm")["volume_mm3"], octotomy("measure ball.stl")["volume_mm3"]);
  EXPECT_LT(octotomy("compare ball.stl ball.dcm")["hausdorff_mm"].get<double>(), 1e-9);
  // OBJ keeps the digits of coordinates.
  octotomy("convert ball.stl -o obj.dcm --as obj");
  EXPECT_EQ(octotomy("info obj.dcm")["vertices"], before["vertices"]);
  const tests::CommandAnswer theirs = python("model ball.dcm");
  OCTOTOMY_NEEDS_PYTHON(theirs);
  ASSERT_EQ(theirs.status, 0) << theirs.errors;
  const SortedJson said = SortedJson::parse(theirs.out);
  EXPECT_EQ(said["type"], "model/stl");
  EXPECT_EQ(said["unit"], "mm");
  EXPECT_EQ(said["patient"], "Source^Patient");
  // A ball of 12 voxels of 1 mm and, along the normal, 2 mm: no thousandth of it.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_GT(said["high"][axis].get<double>() - said["low"][axis].get<double>(), 20.0);
    EXPECT_LT(said["high"][axis].get<double>() - said["low"][axis].get<double>(), 50.0);
  }
}

TEST_F(ArchiveDicom, SharesOfVoxelsKeepTheVolumeOfASurface) {
  const std::string source = source_series(0.0);
  octotomy("mesh " + source + " --window 0: -o ball.stl");
  const SortedJson written =
      octotomy("convert ball.stl -o share.dcm --as fractions --label Ball --source " + source)["segments"][0];
  const double volume_mm3 = octotomy("measure ball.stl")["volume_mm3"].get<double>();
  EXPECT_NEAR(written["exact_volume_mm3"].get<double>(), volume_mm3, 1e-4 * volume_mm3);
  EXPECT_LE(std::abs(written["volume_mm3"].get<double>() - written["exact_volume_mm3"].get<double>()),
            written["rounding_mm3"].get<double>());
  EXPECT_GT(written["partial_voxels"], 500);
  // Reading as samples and writing again loses nothing.
  octotomy("convert share.dcm -o share.nrrd --series Ball");
  const SortedJson again = octotomy("convert share.nrrd -o again.dcm --as fractions")["segments"][0];
  EXPECT_LE(again["partial_voxels"], written["partial_voxels"]) << "some round to none or all of a voxel";
  EXPECT_NEAR(again["volume_mm3"].get<double>(), written["volume_mm3"].get<double>(), 1e-6);
  // The surface half way between the samples is the ball again.
  octotomy("mesh share.dcm --series Ball --window 0.5: -o half.stl");
  EXPECT_LT(octotomy("compare ball.stl half.stl")["mean_mm"].get<double>(), 0.1);
}

TEST_F(ArchiveDicom, IsHeldToTheStandard) {
  OCTOTOMY_NEEDS_PROGRAM("dciodvfy", "dicom3tools");
  const std::string source = source_series(0.5);
  octotomy("segment " + source + " --window 0: -o a.nii.gz");
  octotomy("mesh " + source + " --window 0: -o ball.stl");
  octotomy("convert a.nii.gz -o rt.dcm --as structures --source " + source);
  octotomy("convert a.nii.gz -o rt_alone.dcm --as structures");
  octotomy("convert ball.stl -o ball.dcm --source " + source);
  octotomy("convert ball.stl -o ball_alone.dcm");
  octotomy("convert ball.stl -o share.dcm --as fractions --source " + source);
  for (const char* file : {"rt.dcm", "rt_alone.dcm", "ball.dcm", "ball_alone.dcm", "share.dcm"})
    EXPECT_EQ(errors_of(file), "") << file;
}

TEST_F(ArchiveDicom, ALabelMapKeepsTheNumbersOfObjectsAndAReportItsPages) {
  const std::string source = source_series(0.0);
  octotomy("segment " + source + " --window 0: -o a.nii.gz");
  octotomy("convert a.nii.gz -o map.dcm --as labelmap --source " + source);
  EXPECT_EQ(octotomy("compare a.nii.gz map.dcm")["labels"][0]["dice"], 1.0);
  std::ofstream(folder_ / "report.pdf") << "%PDF-1.4\nA page.\n%%EOF\n";
  const SortedJson report = octotomy("convert report.pdf -o report.dcm --label Plan --source " + source);
  EXPECT_EQ(report["kind"], "DICOM encapsulated PDF");
  EXPECT_EQ(errors_of("report.dcm"), "");
  std::ofstream(folder_ / "cut.pdf") << "%PDF-1.4\nA pa";
  for (const char* line : {"cut.pdf -o x.dcm", "report.pdf -o x.dcm --as stl", "report.pdf -o x.nrrd",
                           "a.nii.gz -o x.nrrd --as labelmap"}) {
    const tests::CommandAnswer refused = program(std::string("convert ") + line);
    EXPECT_EQ(refused.status, 2) << line;
    EXPECT_EQ(std::count(refused.errors.begin(), refused.errors.end(), '\n'), 1) << refused.errors;
  }
  EXPECT_FALSE(fs::exists(folder_ / "x.dcm") || fs::exists(folder_ / "x.nrrd"));
}

TEST_F(ArchiveDicom, WordsThatDoNotFitAreRefusedWithTheWayOut) {
  const std::string source = source_series(0.0);
  octotomy("segment " + source + " --window 0: -o a.nii.gz");
  octotomy("mesh " + source + " --window 0: -o ball.stl");
  const auto refusal = [&](const std::string& arguments) {
    const tests::CommandAnswer answer = program("convert " + arguments);
    EXPECT_EQ(answer.status, 2) << arguments;
    return answer.errors;
  };
  EXPECT_NE(refusal("ball.stl -o x.dcm --as segmentation").find("octotomy voxelise"), std::string::npos);
  EXPECT_NE(refusal("ball.stl -o x.dcm --as fractions").find("--source"), std::string::npos);
  EXPECT_NE(refusal("a.nii.gz -o x.dcm --as stl").find("octotomy mesh"), std::string::npos);
  EXPECT_NE(refusal("a.nii.gz -o x.nrrd --as structures").find(".dcm"), std::string::npos);
  EXPECT_NE(refusal("a.nii.gz -o x.dcm --planes voxels").find("--as structures"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "x.dcm"));
}

}  // namespace
}  // namespace octotomy::planner

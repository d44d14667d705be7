// SPDX-License-Identifier: AGPL-3.0-or-later
//
// DICOM that the program writes, as dciodvfy and pydicom see it: a series made from another refers to its
// images, a segmentation holds the octree's voxels where they are.
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"
#include "tests/reference_data.h"
#include "tests/run_command.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using tests::quoted;

class WrittenDicom : public testing::Test {
 protected:
  tests::CommandAnswer command(const std::string& line) const {
    return tests::run_command(line, folder_.path());
  }
  SortedJson octotomy(const std::string& arguments) const {
    const tests::CommandAnswer answer =
        command(std::string(OCTOTOMY_BINARY_DIR) + "/octotomy " + arguments + " --json");
    EXPECT_EQ(answer.status, 0) << arguments << "\n" << answer.errors;
    return answer.status == 0 ? SortedJson::parse(answer.out) : SortedJson();
  }
  tests::CommandAnswer python(const std::string& arguments) const {
    return command("/usr/bin/python3 " OCTOTOMY_SOURCE_DIR "/tests/planner/cli/program/other_readers.py " +
                   arguments);
  }
  /// dciodvfy's lines with "Error": it compares the file with the standard's tables.
  std::string errors_of(const fs::path& file) const {
    const tests::CommandAnswer answer = command("dciodvfy " + quoted(file));
    std::istringstream lines(answer.out + answer.errors);
    std::string errors;
    for (std::string line; std::getline(lines, line);)
      if (line.find("Error") != std::string::npos) errors += line + "\n";
    return errors;
  }
  /// A CT of a ball of another patient, with slices twice as far apart as its pixels; `lean` is its tilt.
  fs::path source_series(double lean) const {
    voxel::Scene ball = tests::ball_scene(12.0, 40);
    ball.lattice.lps_from_voxel[2] = glm::dvec4(0.0, lean, 2.0, 0.0);
    voxel::DicomOptions options;
    options.patient_name = "Source^Patient";
    voxel::write_dicom_series(ball, folder_ / "source", options);
    return folder_ / "source";
  }

  tests::ScratchFolder folder_;
};

TEST_F(WrittenDicom, ASeriesMadeFromAnotherRefersToTheImagesBehindEachSlice) {
  for (const double lean : {0.0, 0.5}) {
    SCOPED_TRACE(lean);
    fs::remove_all(folder_ / "source");
    fs::remove_all(folder_ / "derived");
    const std::string source = quoted(source_series(lean));
    octotomy("convert " + source + " -o " + quoted(folder_ / "derived"));
    const tests::CommandAnswer theirs = python("derived " + quoted(folder_ / "derived") + " " + source);
    OCTOTOMY_NEEDS_PYTHON(theirs);
    ASSERT_EQ(theirs.status, 0) << theirs.errors;
    const SortedJson said = SortedJson::parse(theirs.out);
    EXPECT_EQ(said["images"], 40);
    EXPECT_EQ(said["references"], 40) << "straightened slices lie at the height of their own";
    EXPECT_EQ(said["unknown"], 0);
    EXPECT_LT(said["farthest_mm"].get<double>(), 0.01);
    EXPECT_EQ(said["same"].size(), 4u) << said["same"];
    EXPECT_EQ(said["own_series"], true);
    EXPECT_EQ(said["own_instances"], true);
    EXPECT_EQ(said["image_type"], SortedJson({"DERIVED", "SECONDARY"}));
  }
}

TEST_F(WrittenDicom, AMissingSliceRefersToItsNeighbours) {
  const fs::path source = source_series(0.0);
  fs::remove(source / "slice_0011.dcm");
  octotomy("convert " + quoted(source) + " -o " + quoted(folder_ / "derived"));
  const tests::CommandAnswer theirs = python("derived " + quoted(folder_ / "derived") + " " + quoted(source));
  OCTOTOMY_NEEDS_PYTHON(theirs);
  const SortedJson said = SortedJson::parse(theirs.out);
  EXPECT_EQ(said["references"], 41);
  EXPECT_EQ(said["unknown"], 0);
  EXPECT_NEAR(said["farthest_mm"].get<double>(), 2.0, 1e-6);
}

TEST_F(WrittenDicom, IsHeldToTheStandard) {
  OCTOTOMY_NEEDS_PROGRAM("dciodvfy", "dicom3tools");
  const fs::path source = source_series(0.5);
  octotomy("convert " + quoted(source) + " -o " + quoted(folder_ / "derived"));
  octotomy("octree " + quoted(source) + " --window 0: -o " + quoted(folder_ / "ball.octree"));
  const std::string ball = quoted(folder_ / "ball.octree");
  octotomy("convert " + ball + " -o " + quoted(folder_ / "alone.dcm"));
  octotomy("convert " + ball + " --source " + quoted(source) + " -o " + quoted(folder_ / "ball.dcm"));
  for (const fs::path& file : {source / "slice_0003.dcm", folder_ / "derived/slice_0003.dcm",
                               folder_ / "alone.dcm", folder_ / "ball.dcm"})
    EXPECT_EQ(errors_of(file), "") << file;
  // The checker detects an error: a type of segmentation that the standard does not define.
  std::string bytes = tests::bytes_of(folder_ / "ball.dcm");
  const std::size_t at = bytes.find("BINARY");
  ASSERT_NE(at, std::string::npos);
  std::ofstream(folder_ / "ball.dcm", std::ios::binary) << bytes.replace(at, 6, "TERNAR");
  EXPECT_NE(errors_of(folder_ / "ball.dcm"), "");
}

TEST_F(WrittenDicom, OfARealSeriesIsHeldToTheStandardToo) {
  OCTOTOMY_NEEDS_PROGRAM("dciodvfy", "dicom3tools");
  for (const char* name : {"ct_philips_skullphantom_5mm", "mr_ctk_mrhead_coronal_dicom"}) {
    OCTOTOMY_NEEDS_DATA(name);
    const fs::path derived = folder_ / name;
    const std::string source = quoted(tests::reference_data(name));
    octotomy("convert " + source + " -o " + quoted(derived));
    EXPECT_EQ(errors_of(derived / "slice_0007.dcm"), "") << name;
    const tests::CommandAnswer theirs = python("derived " + quoted(derived) + " " + source);
    OCTOTOMY_NEEDS_PYTHON(theirs);
    ASSERT_EQ(theirs.status, 0) << theirs.errors;
    const SortedJson said = SortedJson::parse(theirs.out);
    EXPECT_EQ(said["references"], said["images"]);
    EXPECT_EQ(said["unknown"], 0);
    EXPECT_EQ(said["same"].size(), 4u) << said["same"];
    EXPECT_EQ(said["modality"], std::string(name).starts_with("ct_") ? "CT" : "MR");
  }
}

TEST_F(WrittenDicom, ASegmentationHoldsTheOctreesVoxelsWhereTheyAre) {
  const fs::path source = source_series(0.0);
  const std::string octree = quoted(folder_ / "ball.octree");
  const SortedJson built = octotomy("octree " + quoted(source) + " --window 0: --voxel 0.75 -o " + octree);
  const SortedJson measured = octotomy("measure " + octree);
  const fs::path file = folder_ / "ball.dcm";
  octotomy("convert " + octree + " --source " + quoted(source) + " --label Ball -o " + quoted(file));
  const tests::CommandAnswer theirs = python("seg " + quoted(file));
  OCTOTOMY_NEEDS_PYTHON(theirs);
  ASSERT_EQ(theirs.status, 0) << theirs.errors;
  const SortedJson said = SortedJson::parse(theirs.out);
  EXPECT_EQ(said["modality"], "SEG");
  EXPECT_EQ(said["voxels"], built["voxels"]);
  EXPECT_NEAR(said["volume_mm3"].get<double>(), measured["volume_mm3"].get<double>(), 1e-6);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(said["centroid_mm"][axis].get<double>(), measured["centroid_mm"][axis].get<double>(), 1e-6);
  EXPECT_EQ(said["label"], "Ball");
  EXPECT_EQ(said["patient"], "Source^Patient");
  EXPECT_EQ(said["series"].size(), 1u);
  EXPECT_EQ(said["frames_with_source"], said["frames"]);
  EXPECT_GT(said["instances"], 10);
  EXPECT_LE(said["instances"], 40);

  // Labels in any script; pydicom reads them by the file's character set.
  octotomy("convert " + octree + " --source " + quoted(source) + " --label 'Sch\u00e4del \u03b1' -o " +
           quoted(folder_ / "umlaut.dcm"));
  EXPECT_EQ(SortedJson::parse(python("seg " + quoted(folder_ / "umlaut.dcm")).out)["label"],
            "Sch\u00e4del \u03b1");

  // The same bytes again, and a study of its own without a source.
  octotomy("convert " + octree + " --source " + quoted(source) + " --label Ball -o " +
           quoted(folder_ / "again.dcm"));
  EXPECT_EQ(command("cmp " + quoted(file) + " " + quoted(folder_ / "again.dcm")).status, 0);
  octotomy("convert " + octree + " -o " + quoted(folder_ / "alone.dcm"));
  const SortedJson alone = SortedJson::parse(python("seg " + quoted(folder_ / "alone.dcm")).out);
  EXPECT_EQ(alone["voxels"], built["voxels"]);
  EXPECT_TRUE(alone["series"].empty());
  EXPECT_NE(alone["study"], said["study"]);
}

TEST_F(WrittenDicom, ALabelMapBesideTheImagesOfItsSourceIsRefused) {
  const fs::path source = source_series(0.0);
  voxel::Scene labels = tests::ball_scene(6.0, 40);
  for (std::int16_t& sample : std::get<voxel::Int16Samples>(labels.samples)) sample = sample > 0 ? 1 : 0;
  labels.meaning = voxel::Meaning::Label;
  labels.modality = "";
  voxel::write_scene(labels, folder_ / "within.nrrd");
  labels.lattice.lps_from_voxel[3].x += 500.0;
  voxel::write_scene(labels, folder_ / "beside.nrrd");
  const auto converted = [&](const char* in, const std::string& more) {
    return command(std::string(OCTOTOMY_BINARY_DIR) + "/octotomy convert " + quoted(folder_ / in) + " -o " +
                   quoted(folder_ / "s.dcm") + " --source " + quoted(source) + more + " --json");
  };
  const tests::CommandAnswer within = converted("within.nrrd", "");
  ASSERT_EQ(within.status, 0) << within.errors;
  const std::string said = SortedJson::parse(within.out)["findings"].dump();
  EXPECT_EQ(said.find("beyond"), std::string::npos) << said;
  EXPECT_EQ(said.find("series"), std::string::npos) << said;
  const tests::CommandAnswer beside = converted("beside.nrrd", "");
  EXPECT_EQ(beside.status, 2);
  EXPECT_NE(beside.errors.find("lies wholly beside"), std::string::npos) << beside.errors;
  const tests::CommandAnswer allowed = converted("beside.nrrd", " --other-identity");
  ASSERT_EQ(allowed.status, 0) << allowed.errors;
  EXPECT_NE(SortedJson::parse(allowed.out)["findings"].dump().find("FAIL: "), std::string::npos);

  // The audit of the source is the answer's, too: here that one of two series was chosen.
  voxel::write_dicom_series(tests::ball_scene(4.0, 12), source / "more");
  const tests::CommandAnswer chosen = converted("within.nrrd", "");
  ASSERT_EQ(chosen.status, 0) << chosen.errors;
  EXPECT_NE(SortedJson::parse(chosen.out)["findings"].dump().find("WARN, series: "), std::string::npos)
      << chosen.out;
}

TEST_F(WrittenDicom, WhatIsNoSegmentationIsRefused) {
  const fs::path source = source_series(0.0);
  octotomy("octree " + quoted(source) + " --grey -o " + quoted(folder_ / "grey.octree"));
  octotomy("octree " + quoted(source) + " --window 5000: -o " + quoted(folder_ / "empty.octree"));
  for (const auto& [in, out, word] :
       {std::tuple{"grey.octree", "x.dcm", "--window"}, std::tuple{"empty.octree", "x.dcm", "empty"},
        std::tuple{"empty.octree", "x.nii", ".dcm"}}) {
    const tests::CommandAnswer answer = command(std::string(OCTOTOMY_BINARY_DIR) + "/octotomy convert " +
                                                quoted(folder_ / in) + " -o " + quoted(folder_ / out));
    EXPECT_EQ(answer.status, 2) << answer.errors;
    EXPECT_NE(answer.errors.find(word), std::string::npos) << answer.errors;
    EXPECT_FALSE(fs::exists(folder_ / out));
  }
}

}  // namespace
}  // namespace octotomy::planner

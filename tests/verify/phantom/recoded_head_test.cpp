// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The head phantom's series in every transfer syntax that DCMTK's and GDCM's own tools write: read back, the
// lossless ones give the very samples, the lossy ones volumes within one per cent.
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>

#include "tests/run_command.h"
#include "tests/verify/le_fort_cut.h"
#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scratch_folder.h"
#include "verify/phantom/head_phantom.h"
#include "verify/phantom/sample_volume.h"
#include "voxel/measure/measure.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

namespace fs = std::filesystem;
using tests::le_fort_cut;
using voxel::Verdict;

constexpr double bone_hu = 300.0;

const tests::ScratchFolder& scratch() {
  static const tests::ScratchFolder folder;
  return folder;
}

const voxel::Scene& head() {
  static const voxel::Scene scene = [] {
    HeadOptions options;
    options.voxel_mm = 1.0;
    options.slice_mm = 2.0;
    voxel::Scene made = head_phantom(options);
    voxel::write_dicom_series(made, scratch() / "raw");
    return made;
  }();
  return scene;
}

double fragment_mm3(const voxel::Scene& scene) {
  const voxel::Universe fine =
      voxel::universe_around({le_fort_cut.low_mm - 4.0, le_fort_cut.high_mm + 4.0}, 0.5);
  const voxel::Window bone{voxel::grey_octree_of(fine, scene), bone_hu};
  return voxel::measure(voxel::combine(fine, voxel::Expression(bone) & le_fort_cut)).volume_mm3;
}

double truth_mm3() {
  return sample_volume(le_fort_cut, 0.5, [](const glm::dvec3& p) { return head_contains(HeadPart::Bone, p); })
      .volume_mm3;
}

/// Runs a tool on every file of the raw series: its first word is the program, then options.
fs::path recoded(const std::string& tool) {
  head();
  std::string name = tool;
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  const fs::path folder = scratch() / name;
  fs::create_directories(folder);
  const std::string command = "cd '" + (scratch() / "raw").string() + "' && ls | xargs -P 2 -I {} " + tool +
                              " {} '" + folder.string() + "'/{} >/dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return folder;
}

struct Recoding {
  const char* name;
  const char* tool;     ///< program and options; between which the file names go
  const char* package;  ///< that has the program
};
std::ostream& operator<<(std::ostream& out, const Recoding& recoding) {
  return out << recoding.tool;
}

class LosslessSyntax : public testing::TestWithParam<Recoding> {};

TEST_P(LosslessSyntax, GivesTheSameHead) {
  const std::string tool = GetParam().tool;
  OCTOTOMY_NEEDS_PROGRAM(tool.substr(0, tool.find(' ')), GetParam().package);
  const fs::path folder = recoded(tool);
  const voxel::Scene scene = voxel::read_scene(folder);
  EXPECT_EQ(scene.lattice, head().lattice);
  EXPECT_TRUE(scene.samples == head().samples);
  for (const voxel::Finding& line : scene.audit)
    EXPECT_EQ(line.verdict, Verdict::Pass) << line.check << ": " << line.detail;
  fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(RecodedHead, LosslessSyntax,
                         testing::Values(Recoding{"dcmtk_implicit", "dcmconv +ti", "dcmtk"},
                                         Recoding{"dcmtk_big_endian", "dcmconv +tb", "dcmtk"},
                                         Recoding{"dcmtk_deflated", "dcmconv +td", "dcmtk"},
                                         Recoding{"dcmtk_open_lengths", "dcmconv +te -e", "dcmtk"},
                                         Recoding{"dcmtk_no_preamble", "dcmconv -F +te", "dcmtk"},
                                         Recoding{"dcmtk_no_preamble_implicit", "dcmconv -F +ti", "dcmtk"},
                                         Recoding{"dcmtk_rle", "dcmcrle", "dcmtk"},
                                         Recoding{"dcmtk_jpeg_process_14", "dcmcjpeg +el", "dcmtk"},
                                         Recoding{"dcmtk_jpeg_first_order", "dcmcjpeg +e1", "dcmtk"},
                                         Recoding{"dcmtk_jpeg_ls", "dcmcjpls", "dcmtk"},
                                         Recoding{"gdcm_jpeg_2000", "gdcmconv --j2k", "libgdcm-tools"},
                                         Recoding{"gdcm_jpeg", "gdcmconv --jpeg", "libgdcm-tools"},
                                         Recoding{"gdcm_jpeg_ls", "gdcmconv --jpegls", "libgdcm-tools"},
                                         Recoding{"gdcm_rle", "gdcmconv --rle", "libgdcm-tools"},
                                         Recoding{"gdcm_deflated", "gdcmconv --deflated", "libgdcm-tools"}),
                         [](const testing::TestParamInfo<Recoding>& recoding) {
                           return std::string(recoding.param.name);
                         });

class LossySyntax : public testing::TestWithParam<Recoding> {};

TEST_P(LossySyntax, KeepsTheFragmentsVolume) {
  const std::string tool = GetParam().tool;
  OCTOTOMY_NEEDS_PROGRAM(tool.substr(0, tool.find(' ')), GetParam().package);
  const fs::path folder = recoded(tool);
  const voxel::Scene scene = voxel::read_scene(folder);
  EXPECT_EQ(scene.lattice.dims, head().lattice.dims);
  EXPECT_FALSE(scene.samples == head().samples) << "this was to lose something";
  EXPECT_NEAR(fragment_mm3(scene) / truth_mm3(), 1.0, 0.01);
  fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(
    RecodedHead, LossySyntax,
    testing::Values(Recoding{"dcmtk_jpeg_12_bits", "dcmcjpeg +ee +q 95", "dcmtk"},
                    Recoding{"gdcm_jpeg_2000", "gdcmconv --j2k --lossy -q 90", "libgdcm-tools"},
                    Recoding{"gdcm_jpeg_ls", "gdcmconv --jpegls --lossy -e 2", "libgdcm-tools"}),
    [](const testing::TestParamInfo<Recoding>& recoding) { return std::string(recoding.param.name); });

TEST(RecodedHead, HasTheTruesVolumeBeforeItIsRecoded) {
  EXPECT_NEAR(fragment_mm3(head()) / truth_mm3(), 1.0, 0.01);
}

}  // namespace
}  // namespace octotomy::verify

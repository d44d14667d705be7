// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_volume.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <tuple>

#include "tests/file_bytes.h"
#include "tests/voxel/scan/volume_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::voxel {
namespace {

using tests::meta;
using tests::meta_place;
using tests::nifti;
using tests::nrrd;
using tests::ramp;
using tests::write_bytes;

std::string reason_to_refuse(const std::filesystem::path& path, const ReadOptions& options = {}) {
  try {
    read_scene(path, options);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "read";
}

TEST(ReadVolume, RefusesWhatIsNoScanAndSaysWhat) {
  const tests::ScratchFolder folder;
  const std::string lps = "space: LPS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (0,0,0)\n";
  for (const auto& [name, bytes, words] :
       {std::tuple{"a.nii", nifti([](auto& h) {
                     h.dim[0] = 4;
                     h.dim[3] = 2;
                     h.dim[4] = 2;
                   }),
                   "more than three axes (2 x 3 x 2 x 2)"},
        {"a.nii", nifti([](auto& h) {
           h.datatype = DT_RGB24;
           h.bitpix = 24;
         }),
         "colours"},
        {"a.nii", nifti([](auto& h) {
           h.scl_slope = 1;
           h.scl_inter = std::numeric_limits<float>::infinity();
         }),
         "intercept"},
        {"a.nii", nifti([](auto& h) { std::memcpy(h.magic, "ni1", 4); }), "magic"},
        {"a.nrrd", nrrd(lps + "encoding: bzip2\n"), "bzip2"},
        {"a.nrrd", nrrd(lps + "type: block\n"), "block"},
        {"a.nrrd",
         "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 2 2 2\nkinds: RGB-color domain domain "
         "domain\nencoding: raw\n\n" +
             ramp(),
         "one value a sample"},
        {"a.mha", meta(meta_place + "ElementNumberOfChannels = 3\n"), "3 values per sample"},
        {"a.nrrd", nrrd(lps + "encoding: ascii\n", "1 2 3x\n4" + std::string(60, ' ')), "'3x?4"},
        {"a.nii", nifti([](auto& h) { std::memcpy(h.magic, "n\n1", 4); }), "'n?1'"},
        {"a.mha", meta("TransformMatrix = 1 0 0 0 1 0 0\n"), "9 numbers"}}) {
    write_bytes(folder / name, bytes);
    EXPECT_NE(reason_to_refuse(folder / name).find(words), std::string::npos)
        << reason_to_refuse(folder / name) << "\nlacks: " << words;
  }
  write_bytes(folder / "alone.hdr", nifti([](auto&) {}));
  EXPECT_NE(reason_to_refuse(folder / "alone.hdr").find("the other one is missing"), std::string::npos)
      << reason_to_refuse(folder / "alone.hdr");
}

TEST(ReadVolume, SpacingsThatContradictDirectionsAreTold) {
  const tests::ScratchFolder folder;
  const std::string lps = "space: LPS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (0,0,0)\n";
  for (const auto& [spacings, is_told] :
       {std::pair{"2 3 4", false}, {"-2 3 4", false}, {"nan nan nan", false}, {"2 3 3", true}}) {
    write_bytes(folder / "a.nrrd", nrrd(lps + "spacings: " + spacings + "\n"));
    const Scene scene = read_scene(folder / "a.nrrd");
    EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(2, 3, 4));
    EXPECT_EQ(std::any_of(scene.audit.begin(), scene.audit.end(),
                          [](const Finding& line) {
                            return line.check == "spacing" && line.verdict == Verdict::Warn;
                          }),
              is_told)
        << spacings;
  }
}

/// The warnings that a file gets, each check once.
std::map<std::string, std::string> warnings_of(const std::string& name, const std::string& bytes) {
  const tests::ScratchFolder folder;
  write_bytes(folder / name, bytes);
  std::map<std::string, std::string> found;
  for (const Finding& line : read_scene(folder / name).audit)
    if (line.verdict != Verdict::Pass) found[line.check] += line.detail;
  return found;
}

TEST(ReadVolume, StatementsThatAreNoPatientsAreTold) {
  const auto nifti_warnings = [](const std::function<void(nifti_1_header&)>& change) {
    return warnings_of("a.nii", nifti(change));
  };
  EXPECT_FALSE(nifti_warnings([](auto&) {}).contains("form_code"));
  EXPECT_NE(nifti_warnings([](auto& h) { h.sform_code = 4; })["form_code"].find("template"),
            std::string::npos);
  for (const short form : {short{3}, short{4}, short{5}}) {
    EXPECT_NE(nifti_warnings([&](auto& h) { h.sform_code = form; })["form_code"].find("not the patient's"),
              std::string::npos)
        << form;
    EXPECT_NE(nifti_warnings([&](auto& h) {
                h.sform_code = 0;
                h.qform_code = form;
              })["form_code"]
                  .find("not the patient's"),
              std::string::npos)
        << form;
  }
  EXPECT_FALSE(nifti_warnings([](auto& h) { h.sform_code = 2; }).contains("form_code"));
  EXPECT_NE(nifti_warnings([](auto& h) { h.sform_code = 7; })["form_code"].find("does not define"),
            std::string::npos);
  EXPECT_NE(nifti_warnings([](auto& h) { h.sform_code = -1; })["form_code"].find("as none"),
            std::string::npos);
  const auto of_qform = [](float qfac) {
    return [qfac](auto& h) {
      h.sform_code = 0;
      h.pixdim[0] = qfac;
    };
  };
  EXPECT_TRUE(nifti_warnings(of_qform(0)).contains("qfac"));
  EXPECT_FALSE(nifti_warnings(of_qform(1)).contains("qfac"));
  EXPECT_TRUE(nifti_warnings([](auto& h) { h.intent_code = NIFTI_INTENT_TTEST; }).contains("intent"));
  EXPECT_NE(nifti_warnings([](auto& h) {
              h.scl_slope = 1;
              h.scl_inter = 1e30f;
            })["rescale"]
                .find("cannot represent the steps"),
            std::string::npos);
}

TEST(ReadVolume, NrrdFieldsThatContradictWhatIsTakenAreTold) {
  const std::string placed =
      "space: LPS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (0,0,0)\nspace units: \"mm\" "
      "\"mm\" "
      "\"mm\"\n";
  const auto nrrd_warnings = [](const std::string& fields) { return warnings_of("a.nrrd", nrrd(fields)); };
  EXPECT_FALSE(nrrd_warnings(placed).contains("length_unit"));
  EXPECT_TRUE(nrrd_warnings(placed + "units: \"cm\" \"cm\" \"cm\"\n").contains("length_unit"));
  EXPECT_FALSE(nrrd_warnings(placed + "units: \"mm\" \"mm\" \"mm\"\n").contains("length_unit"));
  EXPECT_TRUE(nrrd_warnings(placed + "axis mins: 5 6 7\n").contains("origin"));
  const std::string older = "centers: cell cell cell\naxis mins: 0 0 0\naxis maxs: 4 9 16\n";
  EXPECT_FALSE(nrrd_warnings(older + "spacings: 2 3 4\n").contains("spacing"));
  EXPECT_TRUE(nrrd_warnings(older + "spacings: 2 3 0.8\n").contains("spacing"));
}

TEST(ReadVolume, PlacesBeyondAnyScannersAreRefused) {
  const tests::ScratchFolder folder;
  for (const auto& [origin, is_read] :
       {std::pair{"(-1e308,0,0)", false}, {"(0,2e9,0)", false}, {"(0,0,9e8)", true}}) {
    write_bytes(folder / "a.nrrd",
                nrrd(std::string("space: LPS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: ") +
                     origin + "\n"));
    EXPECT_EQ(reason_to_refuse(folder / "a.nrrd") == "read", is_read) << origin;
  }
}

TEST(ReadVolume, ANiftiPairIsReadByEitherName) {
  const tests::ScratchFolder folder;
  write_bytes(folder / "a.hdr", nifti(
                                    [](auto& h) {
                                      std::memcpy(h.magic, "ni1", 4);
                                      h.vox_offset = 0;
                                    },
                                    ""));
  write_bytes(folder / "a.img", ramp());
  for (const char* name : {"a.hdr", "a.img"}) {
    const Scene scene = read_scene(folder / name);
    EXPECT_EQ(scene.lattice.lps_mm({0, 0, 0}), glm::dvec3(-10, -20, 30)) << name;
    EXPECT_EQ(range(scene).high, 23.0) << name;
  }
}

TEST(ReadVolume, FilesOfAListAndOfAPatternAreReadInTheirOrder) {
  const tests::ScratchFolder folder;
  const std::string samples = ramp();
  for (std::size_t i = 0; i < 4; ++i)
    write_bytes(folder / ("part" + std::to_string(9 - i) + ".raw"), "x" + samples.substr(6 * i, 6));
  const std::string names = "part9.raw\npart8.raw\npart7.raw\npart6.raw\n";
  const std::string nrrd_head =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 3 4\nencoding: raw\nbyte skip: 1\ndata file: ";
  const std::string meta_head =
      "NDims = 3\nDimSize = 2 3 4\nElementType = MET_UCHAR\nHeaderSize = 1\nElementDataFile = ";
  for (const auto& [name, bytes] : {std::pair{"list.nhdr", nrrd_head + "LIST\n" + names},
                                    {"pattern.nhdr", nrrd_head + "part%d.raw 9 6 -1\n"},
                                    {"list.mhd", meta_head + "LIST\n" + names},
                                    {"pattern.mhd", meta_head + "part%d.raw 9 6 -1\n"}}) {
    write_bytes(folder / name, bytes);
    const Scene scene = read_scene(folder / name);
    const auto& read = std::get<Int16Samples>(scene.samples);
    EXPECT_TRUE(std::equal(read.begin(), read.end(), samples.begin(), samples.end())) << name;
  }
  write_bytes(folder / "hostile.nhdr", nrrd_head + "part%s%n.raw 9 6 -1\n");
  EXPECT_NE(reason_to_refuse(folder / "hostile.nhdr").find("one %d"), std::string::npos)
      << reason_to_refuse(folder / "hostile.nhdr");
}

}  // namespace
}  // namespace octotomy::voxel

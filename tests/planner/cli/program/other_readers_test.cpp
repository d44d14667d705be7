// SPDX-License-Identifier: AGPL-3.0-or-later
//
// What `octotomy info` says of the reference scans is what pydicom, nibabel, numpy and ITK say of them, and
// what `octotomy convert` writes they read as the same.
#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"
#include "tests/reference_data.h"
#include "tests/run_command.h"
#include "voxel/scan/image_file.h"
#ifdef OCTOTOMY_HAS_ITK
#include "tests/planner/cli/program/itk_reader.h"
#endif

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using tests::quoted;
using tests::run_command;

// A scan of the reference data, and the options to read it.
struct Subject {
  const char* name;
  const char* kind = "";  ///< of tests/planner/cli/program/other_readers.py
};
std::ostream& operator<<(std::ostream& out, const Subject& subject) {
  return out << subject.name;
}

/// The scan's name as a test's: letters, digits and underscores.
std::string word_of(const testing::TestParamInfo<Subject>& subject) {
  std::string name = subject.param.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

// Places are printed and summed in double precision, NIfTI's in single: 150 mm err by up to 1e-5.
constexpr double place_tolerance_mm(bool single_precision) {
  return single_precision ? 1e-4 : 1e-6;
}

void expect_same(const SortedJson& ours, const SortedJson& theirs, double tolerance_mm) {
  EXPECT_EQ(ours["dims"], theirs["dims"]);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(ours["spacing_mm"][axis].get<double>(), theirs["spacing_mm"][axis].get<double>(),
                tolerance_mm)
        << "axis " << axis;
  const auto place = [](const SortedJson& said, const glm::dvec3& p_voxel) {
    glm::dvec3 p(0.0);
    for (int row = 0; row < 3; ++row) {
      const SortedJson& line = said["lps_from_voxel"][static_cast<std::size_t>(row)];
      p[row] = line[0].get<double>() * p_voxel.x + line[1].get<double>() * p_voxel.y +
               line[2].get<double>() * p_voxel.z + line[3].get<double>();
    }
    return p;
  };
  const auto dims = ours["dims"].get<std::vector<int>>();
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p_voxel = glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2) *
                               glm::dvec3(dims[0] - 1, dims[1] - 1, dims[2] - 1);
    EXPECT_LT(glm::distance(place(ours, p_voxel), place(theirs, p_voxel)), tolerance_mm)
        << "corner " << corner << ": " << ours["lps_from_voxel"] << " and " << theirs["lps_from_voxel"];
  }
  EXPECT_EQ(ours["range"], theirs["range"]);
}

class OtherReaders : public testing::TestWithParam<Subject> {
 protected:
  tests::CommandAnswer octotomy(const std::string& arguments) const {
    return run_command(std::string(OCTOTOMY_BINARY_DIR) + "/octotomy " + arguments, folder_.path());
  }
  tests::CommandAnswer python(const std::string& arguments) const {
    return run_command(
        "/usr/bin/python3 " OCTOTOMY_SOURCE_DIR "/tests/planner/cli/program/other_readers.py " + arguments,
        folder_.path());
  }

  tests::ScratchFolder folder_;
};

class PythonsReaders : public OtherReaders {};

TEST_P(PythonsReaders, SayTheSame) {
  OCTOTOMY_NEEDS_DATA(GetParam().name);
  const std::string path = quoted(tests::reference_data(GetParam().name));
  const tests::CommandAnswer info = octotomy("info --json " + path);
  ASSERT_EQ(info.status, 0) << info.errors;
  const std::string converted = quoted(folder_ / "converted.nii.gz");
  const tests::CommandAnswer convert = octotomy("convert " + path + " -o " + converted);
  ASSERT_EQ(convert.status, 0) << convert.errors;
  const tests::CommandAnswer theirs = python(std::string(GetParam().kind) + " " + path + " " + converted);
  OCTOTOMY_NEEDS_PYTHON(theirs);
  ASSERT_EQ(theirs.status, 0) << theirs.errors;
  const SortedJson said = SortedJson::parse(theirs.out);
  expect_same(SortedJson::parse(info.out), said, place_tolerance_mm(std::string(GetParam().kind) == "nifti"));
  EXPECT_EQ(said["differing"], 0) << "samples that nibabel reads of what was written from it";
  EXPECT_LT(said["shift_mm"].get<double>(), place_tolerance_mm(true));
}

INSTANTIATE_TEST_SUITE_P(ReferenceScans, PythonsReaders,
                         testing::Values(Subject{"ct_philips_skullphantom_5mm", "dicom"},
                                         Subject{"ct_slicer_cthead_lowres_dicom", "dicom"},
                                         Subject{"mr_ctk_mrhead_coronal_dicom", "dicom"},
                                         Subject{"mr_ch2_nifti/ch2.nii.gz", "nifti"}),
                         word_of);

#ifdef OCTOTOMY_HAS_ITK
class ItksReaders : public OtherReaders {};

TEST_P(ItksReaders, SayTheSame) {
  OCTOTOMY_NEEDS_DATA(GetParam().name);
  const fs::path path = tests::reference_data(GetParam().name);
  const tests::ItkVolume theirs = tests::read_by_itk(path);
  const tests::CommandAnswer info = octotomy("info --json " + quoted(path));
  ASSERT_EQ(info.status, 0) << info.errors;
  const SortedJson ours = SortedJson::parse(info.out);
  // ITK ignores padding.
  std::vector<double> measured = theirs.samples;
  if (ours["padding"].is_number())
    std::erase_if(measured, [&](double sample) { return sample == ours["padding"]; });
  const auto [low, high] = std::minmax_element(measured.begin(), measured.end());
  SortedJson said{{"dims", {theirs.dims.x, theirs.dims.y, theirs.dims.z}},
                  {"spacing_mm", {theirs.spacing_mm.x, theirs.spacing_mm.y, theirs.spacing_mm.z}},
                  {"range", {*low, *high}}};
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      said["lps_from_voxel"][static_cast<std::size_t>(row)].push_back(theirs.lps_from_voxel[column][row]);
  const bool single_precision = path.extension() == ".gz";
  expect_same(ours, said, place_tolerance_mm(single_precision));
  for (const char* name : {"converted.nrrd", "converted.mha"}) {
    const tests::CommandAnswer convert =
        octotomy("convert " + quoted(path) + " -o " + quoted(folder_ / name));
    ASSERT_EQ(convert.status, 0) << convert.errors;
    EXPECT_TRUE(tests::read_by_itk(folder_ / name).samples == theirs.samples)
        << "samples that ITK reads of " << name << " differ from what it reads of the original";
  }
}
INSTANTIATE_TEST_SUITE_P(ReferenceScans, ItksReaders,
                         testing::Values(Subject{"ct_philips_skullphantom_5mm"},
                                         Subject{"ct_slicer_cthead_lowres_dicom"},
                                         Subject{"mr_ctk_mrhead_coronal_dicom"},
                                         Subject{"mr_ch2_nifti/ch2.nii.gz"}, Subject{"ct_unc_cthead.nrrd"},
                                         Subject{"mr_vtk_headmrvolume/HeadMRVolume.mhd"}),
                         word_of);
#endif

class NumpysReader : public OtherReaders {};

TEST_P(NumpysReader, NumpyReadsTheSameSlicesWithoutAHeader) {
  OCTOTOMY_NEEDS_DATA(GetParam().name);
  const tests::CommandAnswer unpacked = run_command(
      "tar -xJf " + quoted(tests::reference_data(GetParam().name)) + " -C " + quoted(folder_.path()),
      folder_.path());
  if (unpacked.status != 0) GTEST_SKIP() << "tar cannot unpack .xz here: " << unpacked.errors;
  // Slices of one series are files of their own; the vertex comes first, so they are stacked from the neck.
  std::string whole;
  for (int number = 113; number >= 1; --number)
    whole += tests::bytes_of(folder_ / ("CThead/CThead." + std::to_string(number)));
  std::ofstream(folder_ / "head.raw", std::ios::binary) << whole;
  const std::string raw = quoted(folder_ / "head.raw");
  const std::string layout = " --raw 256x256x113 uint16 --big-endian --spacing 1,1,2";
  const tests::CommandAnswer info = octotomy("info --json " + raw + layout);
  ASSERT_EQ(info.status, 0) << info.errors;
  const std::string converted = quoted(folder_ / "converted.nii.gz");
  ASSERT_EQ(octotomy("convert " + raw + layout + " -o " + converted).status, 0);
  const tests::CommandAnswer theirs = python("raw " + raw + " 256x256x113 '>u2' 1,1,2 " + converted);
  OCTOTOMY_NEEDS_PYTHON(theirs);
  ASSERT_EQ(theirs.status, 0) << theirs.errors;
  const SortedJson said = SortedJson::parse(theirs.out);
  expect_same(SortedJson::parse(info.out), said, place_tolerance_mm(false));
  EXPECT_EQ(said["differing"], 0);
  // The same head as the NRRD beside it, whose values are 1024 lower.
  OCTOTOMY_NEEDS_DATA("ct_unc_cthead.nrrd");
  const SortedJson nrrd =
      SortedJson::parse(octotomy("info --json " + quoted(tests::reference_data("ct_unc_cthead.nrrd"))).out);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(nrrd["range"][i].get<double>() + 1024.0, said["range"][i].get<double>());
}

INSTANTIATE_TEST_SUITE_P(ReferenceScans, NumpysReader,
                         testing::Values(Subject{"ct_unc_cthead_raw_slices.tar.xz", "raw"}), word_of);

class ReferenceAudit : public OtherReaders {};

TEST_P(ReferenceAudit, NamesWhatIsWrongWithTheSeriesAndWithNoOther) {
  OCTOTOMY_NEEDS_DATA(GetParam().name);
  const SortedJson said =
      SortedJson::parse(octotomy("info --json " + quoted(tests::reference_data(GetParam().name))).out);
  std::string failed;
  for (const SortedJson& line : said["audit"])
    if (line["verdict"] == "FAIL") failed += line["check"].get<std::string>();
  const bool without_intercept = std::string(GetParam().name).find("slicer") != std::string::npos;
  EXPECT_EQ(failed, without_intercept ? "air_level" : "");
  const bool hounsfield = !without_intercept && std::string(GetParam().name).starts_with("ct_");
  EXPECT_EQ(said["unit"], hounsfield ? "HU" : "1");
}

INSTANTIATE_TEST_SUITE_P(ReferenceScans, ReferenceAudit,
                         testing::Values(Subject{"ct_philips_skullphantom_5mm"},
                                         Subject{"ct_slicer_cthead_lowres_dicom"},
                                         Subject{"mr_ctk_mrhead_coronal_dicom"}),
                         word_of);

/// Whether a picture's lit rows are those of a head from in front: the vertex above is narrow, neck and
/// shoulders below leave the field wide.
bool has_the_head_up(std::vector<int> lit_in_row) {
  std::erase_if(lit_in_row, [](int count) { return count == 0; });
  return !lit_in_row.empty() && 4 * lit_in_row.front() < lit_in_row.back();
}

class ReferencePicture : public OtherReaders {};

TEST_P(ReferencePicture, HasTheHeadUpFromInFront) {
  OCTOTOMY_NEEDS_DATA(GetParam().name);
  const fs::path picture = folder_ / "anterior.png";
  const tests::CommandAnswer answer =
      octotomy("render " + quoted(tests::reference_data(GetParam().name)) +
               " --window 400: --view anterior --colour '#808080' --size 256x256 -o " + quoted(picture));
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const voxel::StoredImage image = voxel::read_images(picture).front();
  std::vector<int> lit_in_row(static_cast<std::size_t>(image.height), 0);
  for (std::size_t i = 0; i < image.bytes.size(); ++i)
    lit_in_row[i / static_cast<std::size_t>(image.width)] += image.bytes[i] != image.bytes[0];
  EXPECT_TRUE(has_the_head_up(lit_in_row)) << testing::PrintToString(lit_in_row);
  std::reverse(lit_in_row.begin(), lit_in_row.end());
  EXPECT_FALSE(has_the_head_up(lit_in_row)) << "upside down must not pass";
}

INSTANTIATE_TEST_SUITE_P(ReferenceScans, ReferencePicture,
                         testing::Values(Subject{"mr_ctk_mrhead_coronal_dicom"}), word_of);

}  // namespace
}  // namespace octotomy::planner

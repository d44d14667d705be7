// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Each doubt about a series has a line in the audit with the finding and its remedy. The slices
// are put together attribute by attribute, so that each test spoils one of them.
#include <cmath>
#include <cstdint>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <utility>

#include "tests/file_bytes.h"
#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/dicom_bytes.h"
#include "tests/voxel/scan/spoiled_series.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using tests::DicomBytes;
using tests::finding;
using tests::ScratchFolder;
using tests::verdict;
using tests::write_bytes;

constexpr int columns = 6;
constexpr int rows = 5;
constexpr int slices = 4;

/// Attributes of one slice by tag; the pixel in column x, row y of slice k is 100 k + 10 y + x, less 1000.
struct Slice {
  std::map<std::uint32_t, std::pair<std::string, std::string>> elements;

  explicit Slice(int k) {
    const auto us = [](std::uint32_t value) { return DicomBytes::number(value, 2); };
    std::string pixels;
    for (std::uint32_t y = 0; y < rows; ++y)
      for (std::uint32_t x = 0; x < columns; ++x)
        pixels += us(100 * static_cast<std::uint32_t>(k) + 10 * y + x);
    elements = {{0x00080008, {"CS", "ORIGINAL\\PRIMARY\\AXIAL"}},
                {0x00080016, {"UI", "1.2.840.10008.5.1.4.1.1.2"}},
                {0x00080018, {"UI", "1.2.3." + std::to_string(k + 1)}},
                {0x00080060, {"CS", "CT"}},
                {0x00180050, {"DS", "2"}},
                {0x0020000e, {"UI", "1.2.3"}},
                {0x00200013, {"IS", std::to_string(k + 1)}},
                {0x00200032, {"DS", "-10\\-20\\" + std::to_string(30 + 2 * k)}},
                {0x00200037, {"DS", "1\\0\\0\\0\\1\\0"}},
                {0x00280002, {"US", us(1)}},
                {0x00280004, {"CS", "MONOCHROME2"}},
                {0x00280010, {"US", us(rows)}},
                {0x00280011, {"US", us(columns)}},
                {0x00280030, {"DS", "0.5\\0.25"}},
                {0x00280100, {"US", us(16)}},
                {0x00280101, {"US", us(16)}},
                {0x00280102, {"US", us(15)}},
                {0x00280103, {"US", us(0)}},
                {0x00281052, {"DS", "-1000"}},
                {0x00281053, {"DS", "1"}},
                {0x00281054, {"LO", "HU"}},
                {0x7fe00010, {"OW", pixels}}};
  }
  Slice& set(std::uint32_t tag, const std::string& vr, const std::string& value) {
    elements[tag] = {vr, value};
    return *this;
  }
  std::string attributes() const {
    std::string bytes;
    for (const auto& [tag, element] : elements)
      bytes += DicomBytes::element(tag, element.first, element.second);
    return bytes;
  }
  std::string file() const { return DicomBytes::file("1.2.840.10008.1.2.1", attributes()); }
};

/// Writes the sound series with its slices changed by `spoil`, and reads it.
template <typename Spoil>
Scene read_spoiled(const ScratchFolder& folder, const Spoil& spoil, int count = slices) {
  for (int k = 0; k < count; ++k) {
    Slice slice(k);
    spoil(slice, k);
    write_bytes(folder / ("slice" + std::to_string(k) + ".dcm"), slice.file());
  }
  return read_scene(folder.path());
}

int sample(const Scene& scene, int x, int y, int z) {
  return std::get<Int16Samples>(
      scene.samples)[static_cast<std::size_t>(x + scene.lattice.dims.x * (y + scene.lattice.dims.y * z))];
}

std::string detail(const Scene& scene, const char* check) {
  const Finding* line = finding(scene, check);
  return line == nullptr ? "" : line->detail;
}

TEST(SeriesAudit, PassesEveryLineOfASoundSeries) {
  const ScratchFolder folder;
  const Scene scene = read_spoiled(folder, [](Slice&, int) {});
  for (const char* check : {"stray_files", "series", "localizers", "size", "orientation", "duplicates",
                            "slice_spacing", "missing_slices", "gantry_tilt", "rescale", "padding"})
    EXPECT_EQ(verdict(scene, check), Verdict::Pass) << check << ": " << detail(scene, check);
  EXPECT_EQ(scene.lattice.dims, glm::ivec3(columns, rows, slices));
  EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(0.25, 0.5, 2.0))
      << "the tag gives the distance of rows first";
  EXPECT_EQ(sample(scene, 3, 2, 1), 123 - 1000);
}

TEST(SeriesAudit, HoldsTheStatedSpacingAgainstTheMeanOfRoundedPositions) {
  for (const auto& [stated, is_told] : {std::pair{"0.75", false}, std::pair{"0.7", true}}) {
    const ScratchFolder folder;
    std::vector<tests::SpoiledImage> images = tests::sound_series(24);
    for (std::size_t i = 0; i < images.size(); ++i) {
      images[i].place(-6, -5, std::round(7.5 * static_cast<double>(i)) / 10.0);
      images[i].text(0x00180088, "DS", stated);
      std::ofstream(folder / images[i].name, std::ios::binary) << images[i].bytes();
    }
    EXPECT_EQ(tests::finding(read_scene(folder.path()), "spacing_tag") != nullptr, is_told) << stated;
  }
}

TEST(SeriesAudit, NamesTheVolumeThatAFolderWithoutDicomHolds) {
  const ScratchFolder folder;
  write_scene(tests::linear_scene(tests::oblique_lattice()), folder / "head.nrrd");
  try {
    read_scene(folder.path());
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("holds head.nrrd"), std::string::npos) << error.what();
  }
}

TEST(SeriesAudit, LeavesOutAndTellsWhatAnotherRunHasNotFinished) {
  const ScratchFolder folder;
  for (const char* hidden : {".octotomy-AbCdEf", ".report.octotomy-AbCdEf", ".octotomy-empty1"})
    fs::create_directory(folder / hidden);
  Slice below(-1);
  write_bytes(folder / ".octotomy-AbCdEf/slice9.dcm", below.file());
  write_bytes(folder / ".report.octotomy-AbCdEf/slice9.dcm", below.file());
  write_bytes(folder / ".octotomy-result", "a list");
  const Scene scene = read_spoiled(folder, [](Slice&, int) {});
  EXPECT_EQ(scene.lattice.dims.z, slices);
  EXPECT_EQ(verdict(scene, "stray_files"), Verdict::Warn);
  EXPECT_EQ(finding(scene, "stray_files")->files,
            (std::vector<std::string>{".octotomy-AbCdEf", ".report.octotomy-AbCdEf"}))
      << detail(scene, "stray_files");
}

TEST(SeriesAudit, KeepsTheCommonestOfMixedResolutions) {
  const ScratchFolder folder;
  const Scene scene = read_spoiled(folder, [](Slice& slice, int k) {
    if (k == 3) slice.set(0x00280030, "DS", "0.6\\0.3");
  });
  EXPECT_EQ(verdict(scene, "size"), Verdict::Fail);
  EXPECT_NE(detail(scene, "size").find("kept 3 slices of 6 x 5 pixels of 0.25 x 0.5 mm, left 1 slice"),
            std::string::npos)
      << detail(scene, "size");
  EXPECT_EQ(scene.lattice.dims.z, 3);
}

TEST(SeriesAudit, KeepsTheCommonestOfMixedOrientations) {
  const ScratchFolder folder;
  const Scene scene = read_spoiled(folder, [](Slice& slice, int k) {
    if (k == 0) slice.set(0x00200037, "DS", "1\\0\\0\\0\\0\\-1");
  });
  EXPECT_EQ(verdict(scene, "orientation"), Verdict::Fail);
  EXPECT_NE(detail(scene, "orientation").find("kept 3 slices of axial"), std::string::npos)
      << detail(scene, "orientation");
  EXPECT_EQ(scene.lattice.dims.z, 3);
}

TEST(SeriesAudit, SaysThatTheRescaleIsAbsentOrHalfThere) {
  for (const bool both : {true, false}) {
    const ScratchFolder folder;
    const Scene scene = read_spoiled(folder, [&](Slice& slice, int) {
      slice.elements.erase(0x00281052);
      if (both) slice.elements.erase(0x00281053);
    });
    EXPECT_EQ(verdict(scene, "rescale"), Verdict::Warn) << detail(scene, "rescale");
    EXPECT_EQ(sample(scene, 3, 2, 1), 123) << "stored values as they are";
    EXPECT_EQ(verdict(scene, "air_level"), Verdict::Fail) << detail(scene, "air_level");
    EXPECT_EQ(scene.meaning, Meaning::Raw);
  }
}

TEST(SeriesAudit, SaysThatTheUnitIsDeclaredAnother) {
  const ScratchFolder folder;
  const Scene scene = read_spoiled(folder, [](Slice& slice, int) { slice.set(0x00281054, "LO", "US"); });
  EXPECT_EQ(verdict(scene, "rescale"), Verdict::Warn);
  EXPECT_NE(detail(scene, "rescale").find("'US'"), std::string::npos) << detail(scene, "rescale");
}

TEST(SeriesAudit, SaysThatDarkIsHighWhereItIs) {
  const ScratchFolder folder;
  const Scene scene =
      read_spoiled(folder, [](Slice& slice, int) { slice.set(0x00280004, "CS", "MONOCHROME1"); });
  EXPECT_EQ(verdict(scene, "photometric"), Verdict::Warn);
  EXPECT_EQ(sample(scene, 3, 2, 1), 123 - 1000) << "values are measurements, however they are shown";
}

TEST(SeriesAudit, SaysThatTheSpacingIsTheDetectors) {
  const ScratchFolder folder;
  const Scene scene = read_spoiled(folder, [](Slice& slice, int) {
    slice.elements.erase(0x00280030);
    slice.set(0x00181164, "DS", "0.5\\0.25");
  });
  EXPECT_EQ(verdict(scene, "pixel_spacing"), Verdict::Warn);
  EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(0.25, 0.5, 2.0));
}

TEST(SeriesAudit, BelievesPositionsAgainstTheScannersTiltTag) {
  const ScratchFolder folder;
  const Scene scene = read_spoiled(folder, [](Slice& slice, int) { slice.set(0x00181120, "DS", "-12.5"); });
  EXPECT_EQ(verdict(scene, "gantry_tilt"), Verdict::Warn);
  EXPECT_NE(detail(scene, "gantry_tilt").find("the tilt is ignored"), std::string::npos);
  EXPECT_EQ(scene.lattice.dims, glm::ivec3(columns, rows, slices)) << "nothing was straightened";
}

TEST(SeriesAudit, AssumesNoThicknessOfASingleSliceWithoutSayingSo) {
  for (const bool known : {true, false}) {
    const ScratchFolder folder;
    const Scene scene = read_spoiled(
        folder,
        [&](Slice& slice, int) {
          if (!known) slice.elements.erase(0x00180050);
        },
        1);
    EXPECT_EQ(verdict(scene, "slice_spacing"), Verdict::Warn);
    EXPECT_EQ(detail(scene, "slice_spacing").find("assumed") == std::string::npos, known)
        << detail(scene, "slice_spacing");
    EXPECT_EQ(scene.lattice.spacing_mm().z, known ? 2.0 : 1.0);
  }
}

/// A DICOMDIR, which lists files and holds no image.
void write_directory(const std::filesystem::path& path) {
  const std::string directory = DicomBytes::element(0x00020002, "UI", "1.2.840.10008.1.3.10") +
                                DicomBytes::element(0x00020010, "UI", "1.2.840.10008.1.2.1");
  write_bytes(path,
              std::string(128, '\0') + "DICM" +
                  DicomBytes::element(0x00020000, "UL",
                                      DicomBytes::number(static_cast<std::uint32_t>(directory.size()), 4)) +
                  directory + DicomBytes::element(0x00041130, "CS", "DISC"));
}

TEST(SeriesAudit, SkipsADirectoryFileAndAReportAmongTheSlices) {
  const ScratchFolder folder;
  write_directory(folder / "DICOMDIR");
  write_bytes(folder / "report.dcm",
              DicomBytes::file("1.2.840.10008.1.2.1", DicomBytes::element(0x00080060, "CS", "SR")));
  const Scene scene = read_spoiled(folder, [](Slice&, int) {});
  EXPECT_EQ(verdict(scene, "stray_files"), Verdict::Warn);
  EXPECT_NE(detail(scene, "stray_files").find("2 files"), std::string::npos) << detail(scene, "stray_files");
  EXPECT_NE(detail(scene, "stray_files").find("DICOMDIR (a DICOM directory)"), std::string::npos)
      << detail(scene, "stray_files");
  EXPECT_EQ(scene.lattice.dims.z, slices);
}

TEST(SeriesAudit, OfADirectoryFileAsksForItsFolder) {
  const ScratchFolder folder;
  write_directory(folder / "DICOMDIR");
  try {
    read_scene(folder / "DICOMDIR");
    FAIL() << "it holds no image";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Input);
    EXPECT_NE(std::string(error.what()).find("choose the folder in which it lies"), std::string::npos)
        << error.what();
    EXPECT_EQ(std::string(error.what()).find(".nii"), std::string::npos) << error.what();
  }
}

TEST(SeriesAudit, NamesFilesOnOneLine) {
  const ScratchFolder folder;
  write_bytes(folder / "read\nme\x1b[2J.txt", "no image");
  const Scene scene = read_spoiled(folder, [](Slice&, int) {});
  EXPECT_NE(detail(scene, "stray_files").find("read?me?[2J.txt (not DICOM)"), std::string::npos)
      << detail(scene, "stray_files");
  ASSERT_EQ(tests::finding(scene, "stray_files")->files.size(), 1U);
  EXPECT_EQ(tests::finding(scene, "stray_files")->files[0], "read\nme\x1b[2J.txt") << "as the disk has it";
}

TEST(SeriesAudit, ReadsFilesOlderThanThePreamble) {
  const ScratchFolder folder;
  // With values' representations and without; with the file's own attributes and without.
  const Slice slice(0);
  const std::string whole = slice.file();
  std::string implicit;
  for (const auto& [tag, element] : slice.elements) {
    std::string value = element.second;
    if (value.size() % 2 != 0) value += ' ';
    implicit +=
        DicomBytes::tag(tag) + DicomBytes::number(static_cast<std::uint32_t>(value.size()), 4) + value;
  }
  for (const auto& [name, bytes] :
       {std::pair{"explicit", slice.attributes()}, std::pair{"implicit", implicit},
        std::pair{"with its own attributes", whole.substr(132)}}) {
    write_bytes(folder / "old", bytes);
    const Scene scene = read_scene(folder / "old");
    EXPECT_EQ(scene.lattice.dims, glm::ivec3(columns, rows, 1)) << name;
    EXPECT_EQ(sample(scene, 3, 2, 0), 23 - 1000) << name;
  }
}

TEST(SeriesAudit, RescalesEveryFormOfStoredPixelsToTheBit) {
  struct Form {
    int allocated, stored, high;
    bool is_signed;
    double slope, intercept;
  };
  for (const Form& form :
       {Form{16, 12, 11, false, 1, -1024}, Form{16, 12, 11, true, 1, 0}, Form{16, 12, 15, false, 1, -1024},
        Form{16, 12, 15, true, 2, 7}, Form{16, 16, 15, false, 1, -32768}, Form{16, 16, 15, false, 1, 0},
        Form{16, 16, 15, true, 0.5, 0.25}, Form{8, 8, 7, false, 4, -1024}, Form{8, 8, 7, true, 1, 0},
        Form{32, 32, 31, true, 1, 0}, Form{32, 20, 19, false, 0.125, -1000}}) {
    SCOPED_TRACE(std::to_string(form.allocated) + " bits, " + std::to_string(form.stored) + " stored to " +
                 std::to_string(form.high) + (form.is_signed ? ", signed" : ", unsigned"));
    // The lowest, the highest and some in between, stored with foreign bits around them where there is room.
    const auto range = std::int64_t{1} << form.stored;
    const std::int64_t low = form.is_signed ? -range / 2 : 0;
    std::vector<double> expected;
    std::string pixels;
    for (int i = 0; i < columns * rows; ++i) {
      const std::int64_t value = i == 0 ? low : i == 1 ? low + range - 1 : low + (i * 7919) % range;
      expected.push_back(form.slope * static_cast<double>(value) + form.intercept);
      const auto bits = static_cast<std::uint64_t>(value) & static_cast<std::uint64_t>(range - 1);
      const std::uint64_t foreign = ~(static_cast<std::uint64_t>(range - 1) << (form.high + 1 - form.stored));
      const std::uint64_t word = (bits << (form.high + 1 - form.stored)) | (i % 2 == 0 ? foreign : 0);
      pixels += DicomBytes::number(static_cast<std::uint32_t>(word), form.allocated / 8);
    }
    const auto us = [](int value) { return DicomBytes::number(static_cast<std::uint32_t>(value), 2); };
    const ScratchFolder folder;
    const Scene scene = read_spoiled(
        folder,
        [&](Slice& slice, int) {
          slice.set(0x00280100, "US", us(form.allocated)).set(0x00280101, "US", us(form.stored));
          slice.set(0x00280102, "US", us(form.high)).set(0x00280103, "US", us(form.is_signed ? 1 : 0));
          slice.set(0x00281052, "DS", std::to_string(form.intercept));
          slice.set(0x00281053, "DS", std::to_string(form.slope)).set(0x7fe00010, "OW", pixels);
        },
        1);
    bool whole = true;
    for (double& value : expected) {
      whole = whole && value == std::trunc(value) && value >= -32768 && value <= 32767;
      value = static_cast<double>(static_cast<float>(value));
    }
    std::visit(
        [&](const auto& samples) {
          EXPECT_EQ(std::vector<double>(samples.begin(), samples.end()), expected);
        },
        scene.samples);
    EXPECT_EQ(std::holds_alternative<Int16Samples>(scene.samples), whole);
  }
}

TEST(SeriesAudit, PutsSlicesOfEveryOrientationWhereTheyAre) {
  // Rows and columns along each signed axis: 24 right-handed and 24 left-handed stacks as slices go up or
  // down.
  int stacks = 0;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column) {
      if (row % 3 == column % 3) continue;
      for (const double step : {2.0, -2.0}) {
        const auto axis = [](int number) {
          glm::dvec3 along(0.0);
          along[number % 3] = number < 3 ? 1.0 : -1.0;
          return along;
        };
        const glm::dvec3 along_row = axis(row), along_column = axis(column);
        const glm::dvec3 normal = glm::cross(along_row, along_column);
        const ScratchFolder folder;
        const auto text = [](const glm::dvec3& p) {
          return std::to_string(p.x) + "\\" + std::to_string(p.y) + "\\" + std::to_string(p.z);
        };
        const glm::dvec3 first_mm(-10, -20, 30);
        const Scene scene = read_spoiled(folder, [&](Slice& slice, int k) {
          slice.set(0x00200032, "DS", text(first_mm + step * k * normal));
          slice.set(0x00200037, "DS", text(along_row) + "\\" + text(along_column));
        });
        SCOPED_TRACE("row " + std::to_string(row) + ", column " + std::to_string(column) + ", step " +
                     std::to_string(step));
        ASSERT_EQ(scene.lattice.dims, glm::ivec3(columns, rows, slices));
        EXPECT_TRUE(scene.lattice.right_handed());
        // The sample of column x, row y, slice k is found at the place that the headers give it.
        for (int k = 0; k < slices; ++k) {
          const glm::dvec3 p_mm =
              first_mm + step * k * normal + 0.25 * 4 * along_row + 0.5 * 3 * along_column;
          const glm::dvec3 p_voxel = scene.lattice.voxel(p_mm);
          const glm::ivec3 i(glm::round(p_voxel));
          EXPECT_LT(glm::distance(p_voxel, glm::dvec3(i)), 1e-9);
          EXPECT_EQ(sample(scene, i.x, i.y, i.z), 100 * k + 34 - 1000);
        }
        ++stacks;
      }
    }
  EXPECT_EQ(stacks, 48);
}

TEST(SeriesAudit, AScanThatRunsOverMidnightIsOfOneDate) {
  std::vector<tests::SpoiledImage> images = tests::sound_series();
  for (std::size_t i = 0; i < images.size(); ++i)
    images[i].text(0x00080022, "DA", i < 6 ? "20231231" : "20240101");
  const tests::ScratchFolder folder;
  for (const tests::SpoiledImage& image : images)
    std::ofstream(folder / image.name, std::ios::binary) << image.bytes();
  EXPECT_EQ(tests::finding(read_scene(folder.path()), "acquisition_date"), nullptr);
}

}  // namespace
}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// DICOM beyond our own writer: frames of one file, deflated attributes, several series, scout views.
#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/deflated.h"
#include "tests/voxel/scan/dicom_bytes.h"
#include "tests/voxel/scan/dicom_frames.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using tests::deflated;
using tests::DicomBytes;
using tests::ScratchFolder;
using tests::verdict;
using tests::write_bytes;
using Frames = tests::DicomFrames;

constexpr const char* explicit_little = "1.2.840.10008.1.2.1";
constexpr const char* deflated_little = "1.2.840.10008.1.2.1.99";

void expect_ramp(const Scene& scene, const Frames& frames) {
  ASSERT_EQ(scene.lattice.dims, glm::ivec3(frames.columns, frames.rows, frames.count));
  EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(0.25, 0.5, 2.0));
  EXPECT_EQ(glm::dvec3(scene.lattice.lps_from_voxel[3]), glm::dvec3(-10, -20, 30));
  const auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  std::size_t i = 0;
  for (int z = 0; z < frames.count; ++z)
    for (int y = 0; y < frames.rows; ++y)
      for (int x = 0; x < frames.columns; ++x)
        ASSERT_EQ(samples[i++], 100 * (frames.reversed ? frames.count - 1 - z : z) + 10 * y + x - 1000);
}

TEST(ReadDicom, TakesTheFramesOfOneFileByTheirOwnPlaces) {
  const ScratchFolder folder;
  for (const bool open : {false, true})
    for (const bool reversed : {false, true})
      for (const bool own : {false, true}) {
        Frames frames;
        frames.open = open;
        frames.reversed = reversed;
        frames.own_orientation = own;
        write_bytes(folder / "frames.dcm", DicomBytes::file(explicit_little, frames.attributes()));
        SCOPED_TRACE("open " + std::to_string(open) + ", reversed " + std::to_string(reversed));
        expect_ramp(read_scene(folder / "frames.dcm"), frames);
      }
}

TEST(ReadDicom, RefusesFramesThatDoNotSayWhereTheyLieOrAreCutShort) {
  const ScratchFolder folder;
  const Frames frames;
  const auto reason = [&](const std::string& bytes) -> std::string {
    write_bytes(folder / "frames.dcm", bytes);
    try {
      read_scene(folder / "frames.dcm");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "nothing was thrown";
  };
  std::string attributes = frames.attributes();
  const std::size_t groups = attributes.find(DicomBytes::tag(0x52009230));
  const std::size_t pixels = attributes.find(DicomBytes::tag(0x7fe00010));
  const std::string without = attributes.substr(0, groups) + attributes.substr(pixels);
  EXPECT_NE(reason(DicomBytes::file(explicit_little, without)).find("positions of its frames"),
            std::string::npos);
  // One frame's pixels less than there are frames.
  const std::size_t less = attributes.size() - 2 * 12;
  std::string cut = attributes.substr(0, less);
  cut.replace(pixels + 8, 4, DicomBytes::number(5 * 24 - 24, 4));
  EXPECT_NE(reason(DicomBytes::file(explicit_little, cut)).find("cut short"), std::string::npos)
      << reason(DicomBytes::file(explicit_little, cut));
}

TEST(ReadDicom, PlacesFramesByTheFirstOnesPositionAndTheirDistanceAndSaysSo) {
  const ScratchFolder folder;
  const Frames frames;
  const std::string attributes = frames.attributes();
  const std::size_t shared = attributes.find(DicomBytes::tag(0x52009229));
  const std::size_t groups = attributes.find(DicomBytes::tag(0x52009230));
  const std::size_t pixels = attributes.find(DicomBytes::tag(0x7fe00010));
  const std::string first = DicomBytes::element(0x00200032, "DS", frames.position(0));
  const std::string all =
      DicomBytes::element(0x00200032, "DS",
                          frames.position(0) + "\\" + frames.position(1) + "\\" + frames.position(2) + "\\" +
                              frames.position(3) + "\\" + frames.position(4));
  const std::string offsets = DicomBytes::element(0x3004000c, "DS", "0\\2\\4\\6\\8");
  // The shared thickness of 2 mm; a vector of offsets; a list of all positions.
  for (const std::string& places : {first, first + offsets, all}) {
    write_bytes(folder / "frames.dcm",
                DicomBytes::file(explicit_little, attributes.substr(0, shared) + places +
                                                      attributes.substr(shared, groups - shared) +
                                                      attributes.substr(pixels)));
    const Scene scene = read_scene(folder / "frames.dcm");
    expect_ramp(scene, frames);
    EXPECT_EQ(tests::verdict(scene, "frame_positions"), Verdict::Warn);
  }
}

TEST(ReadDicom, InflatesWhatIsDeflatedAsAWhole) {
  const ScratchFolder folder;
  const Frames frames;
  const std::string packed = deflated(frames.attributes(), -MAX_WBITS);
  write_bytes(folder / "deflated.dcm", DicomBytes::file(deflated_little, packed));
  expect_ramp(read_scene(folder / "deflated.dcm"), frames);
  for (const std::size_t keep : {packed.size() / 2, packed.size() - 3}) {
    write_bytes(folder / "deflated.dcm", DicomBytes::file(deflated_little, packed.substr(0, keep)));
    EXPECT_THROW(read_scene(folder / "deflated.dcm"), std::runtime_error) << keep;
  }
}

TEST(ReadDicom, ReadsTheSeriesThatIsAskedForAndListsAll) {
  const ScratchFolder folder;
  DicomOptions options;
  options.series_description = "bone kernel";
  const Lattice lattice = axis_aligned_lattice({20, 20, 6}, {1, 1, 2}, {-10, -10, 0});
  write_dicom_series(tests::linear_scene(lattice), folder / "a", options);
  options.series_description = "soft kernel";
  Scene other = tests::linear_scene(axis_aligned_lattice({20, 20, 4}, {1, 1, 3}, {-10, -10, 0}));
  write_dicom_series(other, folder / "b/deeper", options);
  const std::vector<SeriesEntry> list = list_series(folder.path());
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].description, "bone kernel");
  EXPECT_EQ(list[0].slices, 6U);
  EXPECT_EQ(list[1].description, "soft kernel");
  EXPECT_EQ(read_scene(folder.path()).lattice.dims.z, 6);
  EXPECT_EQ(verdict(read_scene(folder.path()), "series"), Verdict::Warn);
  for (const std::string& series : {std::string("2"), std::string("soft"), list[1].uid}) {
    ReadOptions read;
    read.series = series;
    const Scene scene = read_scene(folder.path(), read);
    EXPECT_EQ(scene.lattice.dims.z, 4) << series;
    EXPECT_EQ(verdict(scene, "series"), Verdict::Pass);
  }
  for (const char* wrong : {"3", "kernel", "lung"}) {
    ReadOptions read;
    read.series = wrong;
    try {
      read_scene(folder.path(), read);
      ADD_FAILURE() << wrong;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("soft kernel"), std::string::npos) << error.what();
    }
  }
}

TEST(ReadDicom, LeavesScoutViewsOutAndSaysSo) {
  const ScratchFolder folder;
  Frames frames;
  write_bytes(folder / "scan.dcm", DicomBytes::file(explicit_little, frames.attributes()));
  Frames scout;
  scout.count = 1;
  scout.image_type = "ORIGINAL\\PRIMARY\\LOCALIZER";
  write_bytes(folder / "scout.dcm", DicomBytes::file(explicit_little, scout.attributes()));
  const Scene scene = read_scene(folder.path());
  expect_ramp(scene, frames);
  EXPECT_EQ(verdict(scene, "localizers"), Verdict::Warn);
  EXPECT_EQ(verdict(read_scene(folder / "scout.dcm"), "localizers"), Verdict::Fail);
}

TEST(ReadDicom, CountsPaddingAndKeepsIt) {
  const ScratchFolder folder;
  Frames frames;
  std::string attributes = frames.attributes();
  const std::size_t at = attributes.find(DicomBytes::tag(0x52009229));
  attributes.insert(at, DicomBytes::element(0x00280120, "SS", DicomBytes::number(11, 2)));
  write_bytes(folder / "padded.dcm", DicomBytes::file(explicit_little, attributes));
  const Scene scene = read_scene(folder / "padded.dcm");
  expect_ramp(scene, frames);
  EXPECT_EQ(verdict(scene, "padding"), Verdict::Warn);
  EXPECT_NE(tests::finding(scene, "padding")->detail.find("1 samples have the padding value -989"),
            std::string::npos)
      << tests::finding(scene, "padding")->detail;
}

TEST(ReadDicom, StopsWhenAskedAndTellsHowFarItIs) {
  const ScratchFolder folder;
  write_dicom_series(tests::linear_scene(axis_aligned_lattice({20, 20, 6}, {1, 1, 2}, {-10, -10, 0})),
                     folder / "series");
  std::stop_source stop;
  ReadOptions options;
  options.progress.stop = stop.get_token();
  double last = -1.0;
  options.progress.report = [&](double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  read_scene(folder / "series", options);
  EXPECT_EQ(last, 1.0);
  stop.request_stop();
  last = -1.0;
  EXPECT_THROW(read_scene(folder / "series", options), Stopped);
}

}  // namespace
}  // namespace octotomy::voxel

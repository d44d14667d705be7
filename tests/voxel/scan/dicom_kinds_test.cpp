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

/// A reconstructed nuclear medicine image of four slices 4 mm apart, for each of `slots` time slots. The
/// pixel in column x, row y of slice k and slot s is 1000 s + 100 k + 10 y + x.
struct Nuclear {
  std::string kind = "RECON TOMO";
  std::string spacing = "4";
  int slots = 1;
  bool has_place = true, has_slice_vector = true;
  int slices_of_slot = 4;

  std::string bytes() const {
    using D = DicomBytes;
    const auto columns = 4, rows = 3;
    std::string slice_vector, slot_vector, pixels;
    for (int s = 0; s < slots; ++s)
      for (int k = 0; k < slices_of_slot; ++k) {
        slice_vector += D::number(static_cast<std::uint32_t>(k + 1), 2);
        slot_vector += D::number(static_cast<std::uint32_t>(s + 1), 2);
        for (int y = 0; y < rows; ++y)
          for (int x = 0; x < columns; ++x)
            pixels += D::number(static_cast<std::uint32_t>(1000 * s + 100 * k + 10 * y + x), 2);
      }
    const std::string place =
        D::element(0x00200032, "DS", "-10\\-20\\30") + D::element(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    return D::file(explicit_little,
                   D::element(0x00080008, "CS", "ORIGINAL\\PRIMARY\\" + kind + "\\EMISSION") +
                       D::element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.20") +
                       D::element(0x00080018, "UI", "1.2.3.4") + D::element(0x00080060, "CS", "NM") +
                       D::element(0x00180050, "DS", "4") +
                       (spacing.empty() ? "" : D::element(0x00180088, "DS", spacing)) +
                       D::element(0x0020000e, "UI", "1.2.3") + D::us(0x00280002, 1) +
                       D::element(0x00280004, "CS", "MONOCHROME2") +
                       D::element(0x00280008, "IS", std::to_string(slots * slices_of_slot)) +
                       D::us(0x00280010, rows) + D::us(0x00280011, columns) +
                       D::element(0x00280030, "DS", "2\\2") + D::us(0x00280100, 16) + D::us(0x00280101, 16) +
                       D::us(0x00280102, 15) + D::us(0x00280103, 0) +
                       D::sequence(0x00540022, D::item(has_place ? place : "")) +
                       (slots > 1 ? D::element(0x00540070, "US", slot_vector) : "") +
                       (has_slice_vector ? D::element(0x00540080, "US", slice_vector) : "") +
                       D::element(0x7fe00010, "OW", pixels));
  }
};

TEST(ReadDicom, PlacesNuclearSlicesFromTheirDetectorOnAlongTheNormalEitherWay) {
  const ScratchFolder folder;
  for (const bool falls : {false, true})
    for (const bool has_vector : {true, false}) {
      Nuclear nuclear;
      nuclear.spacing = falls ? "-4" : "4";
      nuclear.has_slice_vector = has_vector;
      write_bytes(folder / "nm.dcm", nuclear.bytes());
      const Scene scene = read_scene(folder / "nm.dcm");
      ASSERT_EQ(scene.lattice.dims, glm::ivec3(4, 3, 4));
      EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(2, 2, 4));
      EXPECT_EQ(glm::dvec3(scene.lattice.lps_from_voxel[3]), glm::dvec3(-10, -20, falls ? 30 - 12 : 30));
      for (std::size_t z = 0; z < 4; ++z)
        EXPECT_EQ(std::get<Int16Samples>(scene.samples)[12 * z],
                  100 * (falls ? 3 - static_cast<int>(z) : static_cast<int>(z)));
      EXPECT_EQ(verdict(scene, "frame_positions"), Verdict::Warn);
    }
}

TEST(ReadDicom, PartsGatedNuclearSlicesByTheirTimeSlots) {
  const ScratchFolder folder;
  Nuclear nuclear;
  nuclear.kind = "RECON GATED TOMO";
  nuclear.slots = 3;
  write_bytes(folder / "nm.dcm", nuclear.bytes());
  const std::vector<SeriesEntry> list = list_series(folder.path());
  ASSERT_EQ(list.size(), 3U);
  EXPECT_EQ(list[1].stack, "phase time slot 2");
  EXPECT_EQ(list[1].slices, 4U);
  ReadOptions options;
  options.series = "time slot 2";
  const Scene scene = read_scene(folder / "nm.dcm", options);
  EXPECT_EQ(scene.lattice.dims, glm::ivec3(4, 3, 4));
  EXPECT_EQ(std::get<Int16Samples>(scene.samples)[12], 1100);
}

TEST(ReadDicom, RefusesFramesThatAreProjectionsOrAFilm) {
  const ScratchFolder folder;
  const auto reason = [&](const std::string& bytes) -> std::string {
    write_bytes(folder / "frames.dcm", bytes);
    try {
      read_scene(folder / "frames.dcm");
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing was thrown";
  };
  const auto expect = [](const std::string& said, const char* part) {
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  Nuclear nuclear;
  nuclear.kind = "TOMO";
  expect(reason(nuclear.bytes()), "of the kind TOMO, whose frames are projections");
  nuclear.kind = "RECON TOMO";
  nuclear.has_place = false;
  expect(reason(nuclear.bytes()), "DetectorInformationSequence");
  // Frames with a thickness that follow each other in time; with a stated distance they are placed.
  const Frames frames;
  const std::string attributes = frames.attributes();
  const std::size_t pixel = attributes.find(DicomBytes::tag(0x00280010));
  const std::size_t groups = attributes.find(DicomBytes::tag(0x52009230));
  const std::size_t pixels = attributes.find(DicomBytes::tag(0x7fe00010));
  const auto film = [&](const std::string& distance) {
    return DicomBytes::file(
        explicit_little,
        distance + DicomBytes::element(0x00200032, "DS", frames.position(0)) + attributes.substr(0, pixel) +
            DicomBytes::element(0x00280009, "AT",
                                DicomBytes::number(0x0018, 2) + DicomBytes::number(0x1063, 2)) +
            attributes.substr(pixel, groups - pixel) + attributes.substr(pixels));
  };
  expect(reason(film("")), "a film is not a volume");
  write_bytes(folder / "frames.dcm", film(DicomBytes::element(0x00180088, "DS", "2")));
  const Scene scene = read_scene(folder / "frames.dcm");
  expect_ramp(scene, frames);
  expect(tests::finding(scene, "frame_positions")->detail, "as in a film");
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

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/write_dicom_seg.h"

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/voxel/scratch_folder.h"
#include "voxel/codes/run_length.h"
#include "voxel/dicom/dicom_file.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {
namespace {

Universe universe_of_depth(int depth) {
  Universe universe;
  universe.depth = depth;
  return universe;
}

/// The attributes and the packed pixels of a written segmentation.
struct Written {
  std::string bytes;
  DicomFile file() const { return {bytes, bytes.size()}; }
  bool pixel(std::size_t i) const { return ((bytes[file().raw_pixels()->at + i / 8] >> (i % 8)) & 1) != 0; }
};

Written written(const Octree& object, const DicomSegOptions& options = {}) {
  const tests::ScratchFolder folder;
  write_dicom_seg(object, folder / "x.dcm", options);
  std::ifstream in(folder / "x.dcm", std::ios::binary);
  return {{std::istreambuf_iterator<char>(in), {}}};
}

TEST(WriteDicomSeg, FramesFollowEachOtherWithoutGapsBetweenTheirBits) {
  // Rows 1 and 2 of planes 1 and 3: a rectangle of 3 x 2 pixels, six bits a frame.
  const auto index = [](std::uint64_t x, std::uint64_t y, std::uint64_t z) { return x + 8 * (y + 8 * z); };
  const RunLength runs{
      universe_of_depth(3),
      {{index(2, 1, 1), index(3, 1, 1)}, {index(4, 2, 1), index(4, 2, 1)}, {index(2, 2, 3), index(4, 2, 3)}}};
  const Written seg = written(octree_of(runs));
  const DicomFile file = seg.file();
  EXPECT_EQ(file.text(0x00280008), "2");
  EXPECT_EQ(file.unsigned_short(0x00280010), 2);
  EXPECT_EQ(file.unsigned_short(0x00280011), 3);
  ASSERT_EQ(file.raw_pixels()->length, 2u);
  std::string bits;
  for (std::size_t i = 0; i < 12; ++i) bits += seg.pixel(i) ? '1' : '0';
  EXPECT_EQ(bits,
            "110001"
            "000111");
  const std::vector<DicomFile> frames = file.items(0x52009230);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].items(0x00209113).front().decimals(0x00200032), (std::vector<double>{2, 1, 3}));
}

TEST(WriteDicomSeg, OneVoxelIsOnePixel) {
  const Written seg = written(octree_of(RunLength{universe_of_depth(3), {{100, 100}}}));
  EXPECT_EQ(seg.file().unsigned_short(0x00280010), 1);
  EXPECT_TRUE(seg.pixel(0));
}

TEST(WriteDicomSeg, ALabelBeyondAsciiTurnsTheSourcesTextsIntoUtf8) {
  DicomSegOptions options;
  options.source.emplace();
  options.source->attributes[0x00080005] = {"CS", "ISO_IR 100"};
  options.source->attributes[0x00100010] = {"PN", "M\xfcller^Eva"};
  const Octree object = Octree::full(universe_of_depth(2));
  EXPECT_EQ(written(object, options).file().text(0x00100010), "M\xfcller^Eva") << "the source's own bytes";
  options.label =
      "Sch\xc3\xa4"
      "del";
  const Written seg = written(object, options);
  EXPECT_EQ(seg.file().text(0x00080005), "ISO_IR 192");
  EXPECT_EQ(seg.file().text(0x00100010), "M\xc3\xbcller^Eva");
  EXPECT_EQ(seg.file().items(0x00620002).front().text(0x00620005), options.label);
  options.source->attributes[0x00080005].value = "ISO_IR 999";
  try {
    written(object, options);
    FAIL() << "an unknown character set was converted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Input);
    EXPECT_NE(std::string(error.what()).find("ISO_IR 999"), std::string::npos) << error.what();
  }
}

TEST(WriteDicomSeg, FractionsComeBackAsTheyWereWritten) {
  const tests::ScratchFolder folder;
  const Lattice lattice = axis_aligned_lattice({5, 4, 3}, {0.5, 0.75, 2.0}, {-7, 11, 30});
  std::vector<DicomFractions> segments{{"Bone", std::vector<std::uint8_t>(60)},
                                       {"Plate", std::vector<std::uint8_t>(60)}};
  // Bone in the planes 0 and 2, plate over it in plane 2.
  for (std::size_t i = 0; i < 20; ++i) segments[0].fractions[i] = static_cast<std::uint8_t>(13 * i);
  for (std::size_t i = 40; i < 60; ++i) {
    segments[0].fractions[i] = static_cast<std::uint8_t>(255 - i);
    segments[1].fractions[i] = static_cast<std::uint8_t>(i - 40 == 7 ? 1 : 255);
  }
  write_dicom_fractions(lattice, segments, folder / "x.dcm");
  for (std::size_t s = 0; s < 2; ++s)
    for (const std::string& chosen : {segments[s].label, std::to_string(s + 1)}) {
      ReadOptions options;
      options.series = chosen;
      const Scene scene = read_scene(folder / "x.dcm", options);
      EXPECT_EQ(scene.meaning, Meaning::Raw);
      ASSERT_EQ(scene.lattice.dims, lattice.dims);
      EXPECT_LT(glm::distance(scene.lattice.lps_mm({1, 2, 1}), lattice.lps_mm({1, 2, 1})), 1e-9);
      const auto& samples = std::get<FloatSamples>(scene.samples);
      for (std::size_t i = 0; i < 60; ++i)
        EXPECT_EQ(samples[i], static_cast<float>(segments[s].fractions[i]) / 255.0F) << chosen << " " << i;
      const auto line = std::find_if(scene.audit.begin(), scene.audit.end(),
                                     [](const Finding& each) { return each.check == "fractions"; });
      ASSERT_NE(line, scene.audit.end());
      EXPECT_EQ(line->verdict, Verdict::Pass) << line->detail;
    }
  // As labels they are cut at one half, which the audit states with the way around it.
  const Scene labels = read_scene(folder / "x.dcm");
  EXPECT_EQ(labels.meaning, Meaning::Label);
  bool is_told = false;
  for (const Finding& line : labels.audit)
    is_told = is_told || (line.check == "fractions" && line.detail.find("--series") != std::string::npos);
  EXPECT_TRUE(is_told);
  try {
    ReadOptions options;
    options.series = "Screw";
    read_scene(folder / "x.dcm", options);
    FAIL() << "an unknown segment was read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("1 'Bone', 2 'Plate'"), std::string::npos) << error.what();
  }
}

TEST(WriteDicomSeg, ALabelMapHasOneFrameAPlaneAndComesBackByNumbers) {
  const auto index = [](std::uint64_t x, std::uint64_t y, std::uint64_t z) { return x + 8 * (y + 8 * z); };
  const Universe universe = universe_of_depth(3);
  const std::vector<DicomSegment> segments{
      {"low",
       octree_of(RunLength{universe, {{index(2, 1, 1), index(3, 1, 1)}, {index(2, 2, 3), index(2, 2, 3)}}})},
      {"high", octree_of(RunLength{universe, {{index(4, 2, 3), index(4, 2, 3)}}})}};
  const tests::ScratchFolder folder;
  write_dicom_seg(segments, folder / "x.dcm", {.kind = DicomSegKind::LabelMap});
  std::ifstream in(folder / "x.dcm", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const DicomFile file(bytes, bytes.size());
  EXPECT_EQ(file.text(0x00080016), "1.2.840.10008.5.1.4.1.1.66.7");
  EXPECT_EQ(file.text(0x00620001), "LABELMAP");
  ASSERT_EQ(file.items(0x52009230).size(), 2u);
  EXPECT_TRUE(file.items(0x52009230).front().items(0x0062000a).empty())
      << "frames of label maps have no segment";
  const auto pixels = bytes.substr(file.raw_pixels()->at, 12);
  EXPECT_EQ(pixels, std::string({1, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 2}));
  const Scene scene = read_scene(folder / "x.dcm");
  EXPECT_EQ(std::get<Int16Samples>(scene.samples),
            (Int16Samples{1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 2}));
}

TEST(WriteDicomSeg, ALabelMapOfMoreThan255ObjectsHasTwoBytesAPixelAndOneOfSharedVoxelsIsRefused) {
  const Universe universe = universe_of_depth(4);
  std::vector<DicomSegment> segments;
  for (std::uint64_t i = 0; i < 300; ++i)
    segments.push_back({std::to_string(i), octree_of(RunLength{universe, {{i, i}}})});
  const tests::ScratchFolder folder;
  write_dicom_seg(segments, folder / "x.dcm", {.kind = DicomSegKind::LabelMap});
  const Scene scene = read_scene(folder / "x.dcm");
  EXPECT_EQ(range(scene).high, 300.0);
  std::visit(
      [](const auto& samples) {
        EXPECT_EQ(samples.size() - std::count(samples.begin(), samples.end(), 0), 300U);
      },
      scene.samples);
  segments[7].object = segments[8].object;
  try {
    write_dicom_seg(segments, folder / "y.dcm", {.kind = DicomSegKind::LabelMap});
    ADD_FAILURE() << "two objects at one voxel";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("'7' and '8'"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "y.dcm"));
}

TEST(WriteDicomSeg, RefusesFractionsThatFitNoLatticeOrAreAllZero) {
  const tests::ScratchFolder folder;
  const Lattice lattice = axis_aligned_lattice({2, 2, 2}, {1, 1, 1}, {0, 0, 0});
  const DicomFractions few{"A", {255}}, none{"A", std::vector<std::uint8_t>(8)};
  EXPECT_THROW(write_dicom_fractions(lattice, {&few, 1}, folder / "x.dcm"), std::invalid_argument);
  EXPECT_THROW(write_dicom_fractions(lattice, {&none, 1}, folder / "x.dcm"), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(WriteDicomSeg, RefusesWhatItCannotSay) {
  const tests::ScratchFolder folder;
  Universe universe = universe_of_depth(3);
  EXPECT_THROW(write_dicom_seg(Octree::empty(universe), folder / "x.dcm"), std::invalid_argument);
  DicomSegOptions options;
  options.label = std::string(65, 'x');
  EXPECT_THROW(write_dicom_seg(Octree::full(universe), folder / "x.dcm", options), std::invalid_argument);
  universe.lps_from_voxel[1] += 0.1 * universe.lps_from_voxel[0];
  EXPECT_THROW(write_dicom_seg(Octree::full(universe), folder / "x.dcm"), std::invalid_argument);
  std::stop_source stop;
  stop.request_stop();
  options = {};
  options.progress.stop = stop.get_token();
  universe.lps_from_voxel = glm::dmat4(1.0);
  EXPECT_THROW(write_dicom_seg(Octree::full(universe), folder / "x.dcm", options), Stopped);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace octotomy::voxel

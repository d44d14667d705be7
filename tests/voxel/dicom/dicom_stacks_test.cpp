// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/dicom_stacks.h"

#include <array>
#include <bit>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/dicom_bytes.h"
#include "tests/voxel/scan/dicom_frames.h"
#include "tests/voxel/scan/spoiled_series.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {
namespace {

using tests::ScratchFolder;
using tests::verdict;

/// Twelve images of kernel H30s and eleven of H60s at the same places, brighter by 76.
void write_two_kernels(const std::filesystem::path& folder) {
  for (const tests::SpoiledKind& kind : tests::spoiled_kinds())
    if (kind.name == "two_kernels_at_each_place") return kind.write(folder);
  FAIL() << "the kind is gone";
}

Scene read(const std::filesystem::path& folder, const std::string& series, const std::string& slices = "") {
  ReadOptions options;
  options.series = series;
  if (!slices.empty()) options.slices = parse_slices(slices);
  return read_scene(folder, options);
}

TEST(DicomStacks, OfOneSeriesAreListedAndChosenByNumberOrKernel) {
  const ScratchFolder folder;
  write_two_kernels(folder.path());
  const std::vector<SeriesEntry> list = list_series(folder.path());
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].choice, "1.1");
  EXPECT_EQ(list[0].stack, "kernel H30s");
  EXPECT_EQ(list[0].slices, 12U);
  EXPECT_EQ(list[1].choice, "1.2");
  EXPECT_EQ(list[1].stack, "kernel H60s");
  EXPECT_EQ(list[1].slices, 11U);
  const Scene unasked = read_scene(folder.path());
  EXPECT_EQ(unasked.lattice.dims.z, 12);
  EXPECT_EQ(verdict(unasked, "stacks"), Verdict::Fail);
  EXPECT_NE(tests::finding(unasked, "stacks")->detail.find("1.2 'Head' (CT, 11 slices) kernel H60s"),
            std::string::npos)
      << tests::finding(unasked, "stacks")->detail;
  for (const std::string series : {"1.2", "H60s", "kernel H60s"}) {
    const Scene scene = read(folder.path(), series);
    EXPECT_EQ(scene.lattice.dims.z, 11) << series;
    for (const char* check : {"series", "stacks", "duplicates"})
      EXPECT_EQ(verdict(scene, check), Verdict::Pass);
    EXPECT_EQ(std::get<Int16Samples>(scene.samples)[0], std::get<Int16Samples>(unasked.samples)[0] + 76)
        << "the other kernel's pixels";
  }
  for (const char* wrong : {"1.3", "kernel", "H90"}) try {
      read(folder.path(), wrong);
      ADD_FAILURE() << wrong;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("1.2 'Head'"), std::string::npos) << error.what();
    }
}

/// Twelve images with one value of an attribute and twelve with another at the same places, brighter by 76;
/// an empty value: without the attribute.
void write_two_values(const std::filesystem::path& folder, std::uint32_t tag, const std::string& vr,
                      const std::array<std::string, 2>& values) {
  const std::vector<tests::SpoiledImage> sound = tests::sound_series();
  for (std::size_t part = 0; part < 2; ++part)
    for (std::size_t i = 0; i < sound.size(); ++i) {
      tests::SpoiledImage image = sound[i];
      image.name = (part == 0 ? "a" : "b") + std::to_string(i);
      if (part == 1) image.text(0x00080018, "UI", "1.2.3.9." + std::to_string(i));
      if (part == 1) image.text(0x00281052, "DS", "-948");
      if (!values[part].empty()) image.text(tag, vr, values[part]);
      std::ofstream(folder / image.name, std::ios::binary) << image.bytes();
    }
}

std::string float_bytes(float value) {
  return tests::DicomBytes::number(std::bit_cast<std::uint32_t>(value), 4);
}

TEST(DicomStacks, APhaseOfZeroIsNamed) {
  struct Kind {
    std::uint32_t tag;
    std::string vr;
    std::array<std::string, 2> values;
    std::array<std::string, 2> words;
  };
  using D = tests::DicomBytes;
  const std::vector<Kind> kinds{
      {0x00209241, "FL", {float_bytes(0.0F), float_bytes(40.0F)}, {"phase 0", "phase 40"}},
      {0x00209245, "FL", {float_bytes(0.0F), float_bytes(12.5F)}, {"phase 0", "phase 12.5"}},
      {0x00209128, "UL", {D::number(0, 4), D::number(1, 4)}, {"phase 0", "phase 1"}},
      {0x00200100, "IS", {"0", "1"}, {"phase 0", "phase 1"}},
      {0x00181060, "DS", {"0", "40"}, {"phase 0", "phase 40"}},
      {0x00181060, "DS", {"", "40"}, {"no phase", "phase 40"}},
  };
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.words[0] + " by " + kind.vr);
    const ScratchFolder folder;
    write_two_values(folder.path(), kind.tag, kind.vr, kind.values);
    const std::vector<SeriesEntry> list = list_series(folder.path());
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0].stack, kind.words[0]);
    EXPECT_EQ(list[1].stack, kind.words[1]);
    EXPECT_EQ(read(folder.path(), kind.words[0]).lattice.dims.z, 12);
  }
}

TEST(DicomStacks, AHeartsPhaseInTheGroupsOfAFrameNamesItsStack) {
  const ScratchFolder folder;
  using D = tests::DicomBytes;
  for (const bool is_breath : {false, true}) {
    tests::DicomFrames frames;
    frames.count = 6;
    frames.place_of = [](int k) { return k % 3; };
    frames.own = [&](int k) {
      return D::sequence(
          is_breath ? 0x00209253 : 0x00189118,
          D::item(D::element(is_breath ? 0x00209245 : 0x00209241, "FL", float_bytes(k < 3 ? 0.0F : 75.0F))));
    };
    std::ofstream(folder / "frames.dcm", std::ios::binary)
        << D::file("1.2.840.10008.1.2.1", frames.attributes());
    const std::vector<SeriesEntry> list = list_series(folder.path());
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0].stack, "phase 0");
    EXPECT_EQ(list[1].stack, "phase 75");
    EXPECT_EQ(std::get<Int16Samples>(read(folder / "frames.dcm", "phase 75").samples)[0], 300 - 1000);
  }
}

TEST(DicomStacks, SlicesAreChosenByTheirNumbersAlongTheNormal) {
  const ScratchFolder folder;
  write_two_kernels(folder.path());
  const Scene whole = read(folder.path(), "1.1");
  const Scene part = read(folder.path(), "1.1", "3:5,6");
  EXPECT_EQ(part.lattice.dims.z, 4);
  EXPECT_EQ(part.lattice.lps_mm({0, 0, 0}), whole.lattice.lps_mm({0, 0, 2}));
  EXPECT_EQ(verdict(part, "chosen_slices"), Verdict::Pass);
  EXPECT_EQ(verdict(part, "missing_slices"), Verdict::Pass);
  EXPECT_THROW(read(folder.path(), "1.1", "10:13"), Error);
  for (const char* wrong : {"", "0:3", "5:3", "a", "1:2,", "1:2:3", "-1"})
    EXPECT_THROW(parse_slices(wrong), std::invalid_argument) << wrong;
  EXPECT_EQ(to_string(parse_slices("1:40,45:60")), "1:40,45:60");
}

TEST(DicomStacks, AnImageThatNoAttributeTellsApartStaysWithItsRival) {
  std::vector<DicomSlice> images(3);
  for (std::size_t i = 0; i < images.size(); ++i) {
    images[i].size_px = {4, 4};
    images[i].spacing_mm = {1, 1};
    images[i].instance_uid = std::to_string(i);
    images[i].first_mm.z = i == 2 ? 2.0 : 0.0;
  }
  EXPECT_EQ(parted_at_one_place(images).size(), 1U);
  const auto* kernel = std::find_if(dicom_traits.begin(), dicom_traits.end(), [](const auto& trait) {
    return trait.check == std::string_view("kernel");
  });
  ASSERT_NE(kernel, dicom_traits.end());
  images[1].traits[static_cast<std::size_t>(kernel - dicom_traits.begin())] = "H60s";
  const std::vector<DicomSubseries> parts = parted_at_one_place(images);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].slices.size(), 2U);
  EXPECT_EQ(parts[1].words, "kernel H60s");
}

TEST(DicomStacks, GroupsAreThoseOfTheFirstImageThatIsAlike) {
  std::vector<DicomSlice> images(6);
  for (std::size_t i = 0; i < images.size(); ++i) {
    images[i].size_px = {4, 4};
    images[i].spacing_mm = glm::dvec2(1.0 + 0.6e-2 * static_cast<double>(i % 3));
    images[i].instance_uid = std::to_string(i);
  }
  images[3].size_px = {4, 5};
  const std::vector<std::vector<DicomSlice>> groups = grouped(images, same_grid);
  std::string told;
  for (const auto& group : groups)
    for (const DicomSlice& image : group) told += (&image == &group.front() ? "|" : "") + image.instance_uid;
  EXPECT_EQ(told, "|014|25|3") << "2 is as near to 1, but not to 0";
}

}  // namespace
}  // namespace octotomy::voxel

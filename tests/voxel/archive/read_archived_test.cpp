// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/read_archived.h"

#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/archive/write_dicom_document.h"
#include "voxel/archive/write_plan_objects.h"
#include "voxel/space/error.h"
#include "voxel/space/write_whole.h"

namespace octotomy::voxel {
namespace {

using tests::ScratchFolder;

TEST(ReadArchived, DocumentsComeBackByteForByte) {
  const ScratchFolder folder;
  // Odd and even lengths, and bytes that padding looks like.
  for (const std::string& bytes :
       {std::string(" solid\0\0", 8), std::string("\0x ", 3), std::string("%PDF")}) {
    write_dicom_document(bytes, DocumentFormat::Pdf, folder / "x.dcm", {.label = "A report"});
    const auto read = read_archived(folder / "x.dcm");
    ASSERT_TRUE(read);
    EXPECT_EQ(read->document, bytes);
    EXPECT_EQ(read->kind, "encapsulated PDF");
    EXPECT_EQ(read->media_type, "application/pdf");
    EXPECT_EQ(read->title, "A report");
  }
}

TEST(ReadArchived, PicturesComeBackPixelForPixel) {
  const ScratchFolder folder;
  const ColourPixels pixels{{3, 1}, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
  write_plan_objects({"Plan", "<a/>", "2.25.1", {{"before", pixels}}}, folder.path(), std::nullopt);
  const auto read = read_archived(folder / "picture_001.dcm");
  ASSERT_TRUE(read && read->picture);
  EXPECT_EQ(read->picture->size_px, pixels.size_px);
  EXPECT_EQ(read->picture->rgb, pixels.rgb);
  EXPECT_EQ(read->title, "before");
}

TEST(ReadArchived, WrongLengthsAndCutFilesAreRefusedWithThePath) {
  const ScratchFolder folder;
  write_plan_objects(
      {"Plan", "<ClinicalDocument/>", "2.25.1", {{"before", {{2, 2}, std::vector<std::uint8_t>(12)}}}},
      folder.path(), std::nullopt);
  const auto refusal = [&](const std::string& bytes) -> std::string {
    write_file(folder / "y.dcm", bytes);
    try {
      return read_archived(folder / "y.dcm") ? "read" : "none";
    } catch (const Error& error) {
      return error.what();
    }
  };
  const std::string plan = tests::bytes_of(folder / "plan.dcm"),
                    picture = tests::bytes_of(folder / "picture_001.dcm");
  std::string longer = plan;
  const std::string stated("\x42\0\x15\0UL\4\0", 8);
  longer.replace(longer.find(stated) + 8, 4, "\xff\xff\xff\x7f");
  EXPECT_NE(refusal(longer).find("states a document of 2147483647 bytes and holds 20"), std::string::npos);
  std::string taller = picture;
  taller[taller.find(std::string("\x28\0\x10\0US\2\0", 8)) + 9] = 1;  // 258 rows
  EXPECT_NE(refusal(taller).find("y.dcm: holds 12 bytes of pixels instead of 1548"), std::string::npos);
  for (std::size_t length = 200; length < picture.size(); ++length)
    EXPECT_NE(refusal(picture.substr(0, length)), "read") << length;
  for (std::size_t length = 200; length < plan.find("text/XML"); ++length)
    EXPECT_NE(refusal(plan.substr(0, length)), "read") << length;
  EXPECT_EQ(refusal("no DICOM at all"), "none");
  EXPECT_FALSE(read_archived(folder.path()));
}

}  // namespace
}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/volume_header.h"

#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <string>

#include "tests/file_bytes.h"
#include "tests/voxel/scan/deflated.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using tests::write_bytes;

std::string key_lines(std::size_t count, const std::string& between) {
  std::string lines;
  for (std::size_t i = 0; i < count; ++i) lines += "key" + std::to_string(i) + between + "a value\n";
  return lines;
}

/// Six lines and more.
std::string nrrd(std::size_t more_lines) {
  return "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n" +
         key_lines(more_lines, ":=");
}
/// Four lines and more.
std::string meta(std::size_t more_lines, const std::string& data_file) {
  return "NDims = 3\nDimSize = 2 2 2\nElementType = MET_SHORT\n" + key_lines(more_lines, " = ") +
         "ElementDataFile = " + data_file + '\n';
}

template <typename Number>
void put(std::string& bytes, std::size_t at, const Number& number) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

/// A NIfTI of 2 x 2 x 2 samples behind the shortest extensions.
std::string nifti(std::size_t extensions) {
  std::string bytes(352 + 16 * extensions + 16, '\0');
  put<std::int32_t>(bytes, 0, 348);
  const std::int16_t dims[] = {3, 2, 2, 2};
  put(bytes, 40, dims);
  put<std::int16_t>(bytes, 70, 4);
  put<std::int16_t>(bytes, 72, 16);
  const float spacing[] = {1.0f, 1.0f, 1.0f, 1.0f};
  put(bytes, 76, spacing);
  put(bytes, 108, static_cast<float>(352 + 16 * extensions));
  bytes.replace(344, 3, "n+1");
  bytes[348] = 1;
  for (std::size_t i = 0; i < extensions; ++i) {
    put<std::int32_t>(bytes, 352 + 16 * i, 16);
    put<std::int32_t>(bytes, 356 + 16 * i, nifti_text_extension);
  }
  return bytes;
}

class VolumeHeaderTest : public testing::Test {
 protected:
  VolumeHeader header_of(const std::string& name, const std::string& bytes) {
    write_bytes(folder_ / name, bytes);
    return read_volume_header(folder_ / name, *volume_format(name));
  }
  std::string refusal(const std::string& name, const std::string& bytes) {
    try {
      header_of(name, bytes);
    } catch (const Error& error) {
      return error.what();
    }
    return "taken";
  }

  tests::ScratchFolder folder_;
};

TEST_F(VolumeHeaderTest, ALongHeaderEndsWhereItsSamplesBegin) {
  const std::string header = nrrd(100000) + "\n";
  ASSERT_GT(header.size(), std::size_t{1} << 20);
  const VolumeHeader read = header_of("long.nrrd", header + std::string(16, '\0'));
  EXPECT_EQ(read.samples.file_at, header.size());
  EXPECT_EQ(read.field("key99999"), "a value");
  const std::string lines = meta(100000, "LOCAL");
  EXPECT_EQ(header_of("long.mha", lines + std::string(16, '\0')).samples.file_at, lines.size());
}

TEST_F(VolumeHeaderTest, AHeaderOfMoreThanFourMegabytesIsRefused) {
  write_bytes(folder_ / "data.raw", std::string(16, '\0'));
  for (const auto& [name, bytes] :
       {std::pair("without_end.nrrd", nrrd(300000)),
        {"more.nhdr", nrrd(300000) + "data file: data.raw\n"},
        {"more.mhd", meta(300000, "data.raw")},
        {"one_line.nrrd", "NRRD0004\ntype: " + std::string(std::size_t{5} << 20, 'a')}})
    EXPECT_NE(refusal(name, bytes).find("4 MB"), std::string::npos) << refusal(name, bytes).substr(0, 300);
}

TEST_F(VolumeHeaderTest, AShortHeaderBeforeManySamplesWithoutALineEndIsRead) {
  const std::string samples(std::size_t{8} << 20, '\0');
  std::string header = nrrd(0) + "\n";
  header.replace(header.find("2 2 2"), 5, "128 128 256");
  EXPECT_EQ(header_of("zeros.nrrd", header + samples).samples.file_at, header.size());
  std::string lines = meta(0, "LOCAL");
  lines.replace(lines.find("2 2 2"), 5, "128 128 256");
  EXPECT_EQ(header_of("zeros.mha", lines + samples).samples.file_at, lines.size());
}

TEST_F(VolumeHeaderTest, ExtensionsOfOthersArePassedOver) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{100000}}) {
    EXPECT_EQ(header_of("most.nii", nifti(count)).samples.byte_skip, 352 + 16 * count);
    EXPECT_EQ(refusal("most.nii.gz", tests::deflated(nifti(count), tests::gzip_window)), "taken");
  }
}

TEST_F(VolumeHeaderTest, AColonEndsAKeyOfMetaImageAsAnEqualsSignDoes) {
  const std::string samples(16, '\0');
  for (const std::string mark : {" = ", ": ", ":", " : ", "="}) {
    std::string lines = meta(2, "LOCAL") + samples;
    for (std::size_t at = 0; (at = lines.find(" = ", at)) != std::string::npos; at += mark.size())
      lines.replace(at, 3, mark);
    const VolumeHeader read = header_of("colon.mha", lines);
    EXPECT_EQ(read.geometry.dims, glm::ivec3(2)) << mark;
    EXPECT_EQ(read.field("key1"), "a value") << mark;
    EXPECT_EQ(read.samples.file_at, lines.size() - samples.size()) << mark;
  }
  const std::string both = "Comment = a: b\nlab:dose = 5\nlab:date = 6\n";
  EXPECT_EQ(header_of("both.mha", both + meta(0, "LOCAL") + samples).field("comment"), "a: b");
  EXPECT_NE(refusal("twice.mha", "NDims: 2\n" + meta(0, "LOCAL") + samples).find("twice"), std::string::npos);
}

TEST_F(VolumeHeaderTest, AFieldThatContradictsItselfIsRefused) {
  const std::string samples(16, '\0');
  EXPECT_EQ(refusal("twice.nrrd", "NRRD0004\nsizes: 2 2 2\n" + nrrd(0).substr(9) + "\n" + samples), "taken");
  EXPECT_NE(
      refusal("twice.nrrd", "NRRD0004\nsizes: 2 2 1\n" + nrrd(0).substr(9) + "\n" + samples).find("twice"),
      std::string::npos);
  EXPECT_NE(refusal("twice.mha", "NDims = 2\n" + meta(0, "LOCAL") + samples).find("twice"),
            std::string::npos);
  const std::string orders = "ElementByteOrderMSB = False\nBinaryDataByteOrderMSB = ";
  EXPECT_EQ(refusal("order.mha", orders + "False\n" + meta(0, "LOCAL") + samples), "taken");
  EXPECT_NE(refusal("order.mha", orders + "True\n" + meta(0, "LOCAL") + samples).find("contradict"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/volume_header.h"

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
/// Three lines and more.
std::string meta(std::size_t more_lines, const std::string& data_file) {
  return "NDims = 3\nDimSize = 2 2 2\n" + key_lines(more_lines, " = ") + "ElementDataFile = " + data_file +
         '\n';
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
  const std::string header = nrrd(8000) + "\n";
  ASSERT_GT(header.size(), std::size_t{1} << 16);
  const VolumeHeader read = header_of("long.nrrd", header + std::string(16, '\0'));
  EXPECT_EQ(read.data_at, header.size());
  EXPECT_EQ(read.field("key7999"), "a value");
  const std::string lines = meta(8000, "LOCAL");
  EXPECT_EQ(header_of("long.mha", lines + std::string(16, '\0')).data_at, lines.size());
}

TEST_F(VolumeHeaderTest, AHeaderOfMoreLinesThanTheLibraryBearsIsRefused) {
  write_bytes(folder_ / "data.raw", std::string(16, '\0'));
  const std::string samples(16, '\0');
  EXPECT_EQ(refusal("most.nrrd", nrrd(8185) + "\n" + samples), "taken");
  EXPECT_EQ(refusal("most.nhdr", nrrd(8185) + "data file: data.raw\n"), "taken");
  EXPECT_EQ(refusal("most.mhd", meta(8189, "data.raw")), "taken");
  for (const auto& [name, bytes] :
       {std::pair("more.nrrd", nrrd(8186) + "\n" + samples),
        {"without_end.nrrd", nrrd(100000)},
        {"more.nhdr", nrrd(8186) + "data file: data.raw\n"},
        {"more.mha", meta(8190, "LOCAL") + samples},
        {"more.mhd", meta(8190, "data.raw")},
        {"one_line.nrrd", "NRRD0004\ntype: " + std::string(std::size_t{5} << 20, 'a')}})
    EXPECT_NE(refusal(name, bytes).find("header is longer than 8192 lines or 4 MB"), std::string::npos)
        << refusal(name, bytes);
}

TEST_F(VolumeHeaderTest, MoreExtensionsThanTheLibraryBearsAreRefused) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1024}}) {
    EXPECT_EQ(header_of("most.nii", nifti(count)).data_at, 352 + 16 * count);
    EXPECT_EQ(refusal("most.nii.gz", tests::deflated(nifti(count), tests::gzip_window)), "taken");
  }
  for (const std::size_t count : {std::size_t{1025}, std::size_t{100000}}) {
    EXPECT_NE(refusal("more.nii", nifti(count)).find("more than 1024 extensions"), std::string::npos);
    EXPECT_NE(refusal("more.nii.gz", tests::deflated(nifti(count), tests::gzip_window))
                  .find("more than 1024 extensions"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace octotomy::voxel

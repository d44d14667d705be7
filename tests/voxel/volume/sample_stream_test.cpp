// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/sample_stream.h"

#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "tests/voxel/scan/deflated.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using tests::deflated, tests::gzip_window, tests::zlib_window;

/// Bytes with and without repetitions, which give stored, fixed and dynamic blocks.
std::string mixed_bytes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes(count, '\0');
  for (std::size_t i = 0; i < count; ++i)
    bytes[i] = static_cast<char>((i >> 14) % 3 == 0 ? random() : (i >> 5) * ((i >> 14) % 3));
  return bytes;
}

class SampleStreamTest : public testing::Test {
 protected:
  fs::path file_of(const std::string& bytes) {
    fs::path path = folder_.path() / ("file" + std::to_string(++count_));
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  /// All bytes, read a part at a time.
  static std::string all_of(SampleStream stream, std::size_t part_bytes) {
    std::string all, part(part_bytes, '\0');
    while (const std::size_t count = stream.read(part.data(), part.size())) all.append(part, 0, count);
    return all;
  }

  tests::ScratchFolder folder_;
  int count_ = 0;
};

TEST_F(SampleStreamTest, GivesWhatWasPackedHoweverItIsAskedFor) {
  const std::string bytes = mixed_bytes(3'000'017, 1);
  for (const int window : {gzip_window, zlib_window}) {
    const fs::path packed = file_of("head" + deflated(bytes, window));
    for (const std::size_t part : {std::size_t{1009}, std::size_t{1} << 18, bytes.size(), 2 * bytes.size()})
      EXPECT_TRUE(all_of(SampleStream(packed, 4, true), part) == bytes) << window << ' ' << part;
    EXPECT_EQ(SampleStream(packed, 4, true).skip_rest(), bytes.size());
  }
  EXPECT_TRUE(all_of(SampleStream(file_of("head" + bytes), 4, false), 1000) == bytes);
}

TEST_F(SampleStreamTest, StreamsOfGzipFollowEachOtherAndWhatElseFollowsIsLeft) {
  std::string packed, bytes;
  for (unsigned i = 0; i < 40; ++i) {
    const std::string member = mixed_bytes(i % 7 == 3 ? 0 : 60'000 + 997 * i, i);
    packed += deflated(member, gzip_window);
    bytes += member;
  }
  EXPECT_TRUE(all_of(SampleStream(file_of(packed), 0, true), 4096) == bytes);
  EXPECT_TRUE(all_of(SampleStream(file_of(packed + std::string(700, '\0')), 0, true), 4096) == bytes);
  const std::string one = mixed_bytes(5000, 3);
  EXPECT_EQ(all_of(SampleStream(file_of(deflated(one, zlib_window) + "more"), 0, true), 999), one);
}

TEST_F(SampleStreamTest, ADamagedOrShortenedStreamIsRefusedByName) {
  const std::string bytes = mixed_bytes(200'000, 5);
  for (const int window : {gzip_window, zlib_window}) {
    const std::string packed = deflated(bytes, window);
    std::vector<std::string> spoiled;
    for (std::size_t keep = 0; keep < packed.size(); keep += 1 + keep / 3)
      spoiled.push_back(packed.substr(0, keep));
    for (std::size_t back = 1; back <= 4; ++back) {  // within the checksum
      spoiled.push_back(packed.substr(0, packed.size() - back));
      std::string other = packed;
      other[packed.size() - back - (window == gzip_window ? 4 : 0)] ^= 1;
      spoiled.push_back(other);
    }
    std::mt19937 random(7);
    for (int i = 0; i < 200; ++i) {
      std::string other = packed;
      other[20 + random() % (packed.size() - 40)] ^= static_cast<char>(1 << random() % 8);
      spoiled.push_back(other);
    }
    for (const std::string& stream : spoiled) {
      const fs::path path = file_of(stream);
      try {
        SampleStream(path, 0, true).skip_rest();
        ADD_FAILURE() << "taken, " << stream.size() << " bytes of " << packed.size();
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Input);
        EXPECT_TRUE(std::string(error.what()).starts_with(path.string())) << error.what();
      }
      fs::remove(path);
    }
  }
}

TEST_F(SampleStreamTest, TellsPackedFilesByTheirFirstBytes) {
  EXPECT_TRUE(is_gzip(file_of(deflated("x", gzip_window))));
  EXPECT_FALSE(is_gzip(file_of(deflated("x", zlib_window))));
  EXPECT_FALSE(is_gzip(file_of("\x1f")));
  EXPECT_FALSE(is_gzip(folder_.path() / "none"));
}

}  // namespace
}  // namespace octotomy::voxel

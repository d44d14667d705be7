// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Every kind of doubtful or faulty folder is named rightly: the line of the audit, its verdict, its files. A
// sound folder has no such line.
#include "tests/voxel/scan/spoiled_series.h"

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <set>

#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {
namespace {

using tests::ScratchFolder;
using tests::SpoiledKind;

class SpoiledSeries : public testing::TestWithParam<SpoiledKind> {};

TEST_P(SpoiledSeries, IsNamedInTheAudit) {
  const SpoiledKind& kind = GetParam();
  const ScratchFolder folder;
  kind.write(folder / "scan");
  if (kind.check == "refused") {
    try {
      read_scene(folder / "scan");
      FAIL() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Input);
      EXPECT_NE(std::string(error.what()).find(kind.says), std::string::npos) << error.what();
    }
    return;
  }
  const Scene scene = read_scene(folder / "scan");
  std::string all;
  for (const Finding& line : scene.audit)
    if (line.verdict != Verdict::Pass) all += line.check + ": " + line.detail + "\n";
  const Finding* line = tests::finding(scene, kind.check);
  ASSERT_NE(line, nullptr) << all;
  EXPECT_EQ(line->verdict, kind.verdict) << all;
  EXPECT_NE(line->detail.find(kind.says), std::string::npos) << line->detail;
  EXPECT_EQ(std::set<std::string>(line->files.begin(), line->files.end()),
            std::set<std::string>(kind.files.begin(), kind.files.end()));
  for (std::size_t i = 0; i < kind.files.size() && kind.files.size() <= 8; ++i)
    EXPECT_NE(line->detail.find(kind.files[i]), std::string::npos) << line->detail;
  if (kind.verdict == Verdict::Pass) {
    EXPECT_EQ(all, "");
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, SpoiledSeries, testing::ValuesIn(tests::spoiled_kinds()),
                         [](const auto& kind) { return kind.param.name; });

TEST(SpoiledSeries, AreAtLeastSixtyKindsAndTheSoundOnePasses) {
  EXPECT_GE(tests::spoiled_kinds().size(), 60U);
  const ScratchFolder folder;
  SpoiledKind sound;
  sound.spoil = [](auto&) {};
  sound.write(folder / "scan");
  const Scene scene = read_scene(folder / "scan");
  for (const Finding& line : scene.audit)
    EXPECT_EQ(line.verdict, Verdict::Pass) << line.check << ": " << line.detail;
  EXPECT_TRUE(scene.holes.empty());
  // Files read in any coding hold the same samples.
  int coded = 0;
  for (const SpoiledKind& kind : tests::spoiled_kinds())
    if (kind.verdict == Verdict::Pass || kind.name == "positions_of_acr_nema") {
      kind.write(folder / kind.name);
      EXPECT_EQ(read_scene(folder / kind.name).samples, scene.samples) << kind.name;
      EXPECT_EQ(read_scene(folder / kind.name).lattice, scene.lattice) << kind.name;
      ++coded;
    }
  EXPECT_GE(coded, 8);
}

TEST(SpoiledSeries, AnyByteOfAHeaderMayBeSpoiled) {
  const ScratchFolder folder;
  int read = 0, named = 0;
  for (const SpoiledKind& kind : tests::spoiled_kinds()) {
    if (kind.name != "twelve_bits_packed" && kind.name != "big_endian_with_open_pixels" &&
        kind.name != "positions_of_acr_nema")
      continue;
    std::vector<tests::SpoiledImage> images = tests::sound_series(3);
    kind.spoil(images);
    for (const tests::SpoiledImage& image : images)
      std::ofstream(folder / image.name, std::ios::binary) << image.bytes();
    const std::string whole = images[1].bytes();
    const std::size_t header = whole.size() - 700;
    for (std::size_t at = images[1].has_preamble ? 132 : 0; at < header; at += 2) {
      std::string mutant = whole;
      mutant[at] = static_cast<char>(mutant[at] ^ 0x7f);
      std::ofstream(folder / images[1].name, std::ios::binary) << mutant;
      try {
        const Scene scene = read_scene(folder.path());
        // Nothing is made that the files could not hold: four slices for each of the stack.
        EXPECT_LE(scene.lattice.dims.z, 13) << kind.name << " at byte " << at;
        ++read;
        named += std::any_of(scene.audit.begin(), scene.audit.end(), [](const Finding& line) {
          return line.verdict != Verdict::Pass && line.check != "acr_nema";
        });
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Input) << error.what();
        ++named;
      }
    }
  }
  EXPECT_GT(read, 300);
  EXPECT_GT(named, 300);
}

}  // namespace
}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/octree_file.h"

#include <fstream>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <zlib.h>

#include "tests/voxel/code_subjects.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/tree/packed_treecode.h"

namespace octotomy::voxel {
namespace {

using tests::universe_of;
using Bytes = std::vector<std::uint8_t>;

// A universe whose every number must come back exactly.
Universe oblique_universe(int depth) {
  Universe universe = universe_of(depth);
  universe.lps_from_voxel[0] = glm::dvec4(-0.7, 1.0 / 3.0, 0, 0);
  universe.lps_from_voxel[3] = glm::dvec4(-100.1, 1e-30, 12345.6789, 1);
  return universe;
}

GreyOctree noisy_grey(int depth, std::uint64_t seed) {
  const Universe universe = oblique_universe(depth);
  Scene scene;
  scene.lattice = universe.lattice();
  const tests::Dense shape = tests::random_dense(universe.side(), seed);
  std::mt19937_64 random(seed);
  voxel::Int16Samples samples;
  for (const std::uint8_t voxel : shape.voxels)
    samples.push_back(
        static_cast<std::int16_t>(voxel != 0 ? static_cast<int>(random() % 65536) - 32768 : -1024));
  scene.samples = samples;
  return grey_octree_of(universe, scene);
}

bool same_samples(const GreyOctree& a, const GreyOctree& b) {
  const int side = a.universe().side();
  for (int z = -1; z <= side; ++z)
    for (int y = -1; y <= side; ++y)
      for (int x = -1; x <= side; ++x)
        if (a.sample({x, y, z}) != b.sample({x, y, z})) return false;
  for (int height = 2; height <= root_height(a.universe().depth); ++height) {
    const int count = std::max(1, side >> (2 * height));
    for (int i = 0; i < count * count * count; ++i) {
      const glm::ivec3 block(i % count, i / count % count, i / count / count);
      if (a.range(height, block).low != b.range(height, block).low ||
          a.range(height, block).high != b.range(height, block).high)
        return false;
    }
  }
  return a.universe() == b.universe() && a.background() == b.background();
}

OctreeFile decoded(const Bytes& bytes) {
  return octree_file_of_bytes(bytes, "x.octree");
}

TEST(OctreeFile, HoldsATreeWithItsUniverseNameAndMetadata) {
  tests::ScratchFolder scratch;
  tests::for_each_subject([&](const tests::Dense& dense, const Octree& octree) {
    const Octree placed = tests::octree_of(oblique_universe(octree.universe().depth), dense);
    write_octree({placed, "Sk\u00fcll", "{\"made\": \"by hand\"}"}, scratch / "a.octree");
    const OctreeFile file = read_octree(scratch / "a.octree");
    ASSERT_TRUE(std::get<Octree>(file.tree) == placed);
    ASSERT_EQ(file.name, "Sk\u00fcll");
    ASSERT_EQ(file.metadata, "{\"made\": \"by hand\"}");
  });
}

TEST(OctreeFile, OfTheLargestUniverseIsAsSmallAsItsObject) {
  for (const Octree& octree : tests::sparse_subjects()) {
    const Bytes bytes = octree_file_bytes({octree, "", ""});
    EXPECT_LT(bytes.size(), 40000U);
    EXPECT_TRUE(std::get<Octree>(decoded(bytes).tree) == octree);
  }
}

TEST(OctreeFile, HoldsEverySampleAndRangeOfAGreyOctree) {
  for (int depth = 2; depth <= 6; ++depth)
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      const GreyOctree grey = noisy_grey(depth, seed + 4);
      const OctreeFile file = decoded(octree_file_bytes({grey, "grey", ""}));
      EXPECT_TRUE(same_samples(std::get<GreyOctree>(file.tree), grey))
          << "depth " << depth << ", seed " << seed;
      EXPECT_EQ(file.name, "grey");
      EXPECT_FALSE(same_samples(noisy_grey(depth, seed + 5), noisy_grey(depth, seed + 4)) && seed < 2);
    }
}

TEST(OctreeFile, HoldsAGreyOctreeOfMoreBricksThanASection) {
  // 5^3 = 125 bricks of ramps and jumps over the whole of int16.
  const Universe universe = universe_of(7);
  Scene scene;
  scene.lattice = {{80, 80, 80}, universe.lps_from_voxel};
  voxel::Int16Samples samples;
  for (int i = 0; i < 80 * 80 * 80; ++i)
    samples.push_back(static_cast<std::int16_t>(i * 37 - (i % 5 == 0 ? 40000 : 0)));
  scene.samples = samples;
  const GreyOctree grey = grey_octree_of(universe, scene);
  EXPECT_TRUE(same_samples(std::get<GreyOctree>(decoded(octree_file_bytes({grey, "", ""})).tree), grey));
}

std::string damage(const Bytes& bytes);
void forge(Bytes& bytes);

// A scan of 20 x 18 x 22 voxels within the universe, in whose corner there is only the background's value.
GreyOctree grey_with_empty_corner() {
  const Universe universe = universe_of(5);
  Scene scene;
  scene.lattice = {{20, 18, 22}, universe.lps_from_voxel};
  voxel::Int16Samples samples(scene.lattice.sample_count(), 40);
  for (std::size_t i = 0; i < 20 * 18; ++i) samples[i] = -1024;
  scene.samples = samples;
  return grey_octree_of(universe, scene);
}

TEST(OctreeFile, HoldsTheScanOfAGreyOctreeWhereSamplesDoNotTellIt) {
  const GreyOctree grey = grey_with_empty_corner();
  ASSERT_FALSE(grey.scan() == scan_box(grey));
  const Bytes bytes = octree_file_bytes({grey, "", ""});
  EXPECT_EQ(bytes[8], 2);
  const OctreeFile file = decoded(bytes);
  EXPECT_TRUE(std::get<GreyOctree>(file.tree).scan() == grey.scan());
  EXPECT_TRUE(same_samples(std::get<GreyOctree>(file.tree), grey));
  // The same bytes said to be of version 1 have a section too many.
  Bytes spoiled = bytes;
  spoiled[8] = 1;
  forge(spoiled);
  EXPECT_NE(damage(spoiled).find("SCAN"), std::string::npos);
}

TEST(OctreeFile, HoldsTheStepOfSamplesThatAreNoWholeNumbers) {
  Universe universe;
  universe.depth = 4;
  Scene scene;
  scene.lattice = universe.lattice();
  FloatSamples samples(4096);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<float>(i) / 4096.0F;
  scene.samples = samples;
  const GreyOctree grey = grey_octree_of(universe, scene);
  ASSERT_LT(grey.step(), 1e-4);
  const OctreeFile file = decoded(octree_file_bytes({grey, "", ""}));
  EXPECT_EQ(std::get<GreyOctree>(file.tree).step(), grey.step());
  EXPECT_TRUE(same_samples(std::get<GreyOctree>(file.tree), grey));
  EXPECT_TRUE(std::get<GreyOctree>(file.tree).scan() == grey.scan());
}

TEST(OctreeFile, OfVersionOneHasTheBoxOfItsSamplesAsItsScan) {
  const Universe universe = universe_of(5);
  Scene scene;
  scene.lattice = {{20, 18, 22}, universe.lps_from_voxel};
  scene.samples = voxel::Int16Samples(scene.lattice.sample_count(), 40);
  const GreyOctree grey = grey_octree_of(universe, scene);
  const Bytes bytes = octree_file_bytes({grey, "", ""});
  EXPECT_EQ(bytes[8], 1);
  const OctreeFile file = decoded(bytes);
  EXPECT_EQ(std::get<GreyOctree>(file.tree).scan().voxel_count(), 20U * 18 * 22);
  Bytes spoiled = bytes;
  spoiled[8] = 2;
  forge(spoiled);
  EXPECT_NE(damage(spoiled).find("SCAN"), std::string::npos);
}

TEST(OctreeFile, HoldsThePartsOfAPartialOctree) {
  const Universe universe = universe_of(5);
  tests::Dense inner(32);
  tests::Dense outer(32);
  inner.for_each([&](const glm::ivec3& v) {
    const int d = (v.x - 15) * (v.x - 15) + (v.y - 13) * (v.y - 13) + (v.z - 17) * (v.z - 17);
    inner.at(v) = d < 81;
    outer.at(v) = d < 121;
  });
  PartialOctree partial{tests::octree_of(universe, inner), tests::octree_of(universe, outer), {}};
  const std::uint64_t count = partial.touching.voxel_count() - partial.inside.voxel_count();
  for (std::uint64_t i = 0; i < count; ++i)
    partial.fractions.push_back(static_cast<std::uint16_t>(1 + i * 7919));
  const OctreeFile file = decoded(octree_file_bytes({partial, "", ""}));
  const auto& read = std::get<PartialOctree>(file.tree);
  EXPECT_TRUE(read.inside == partial.inside);
  EXPECT_TRUE(read.touching == partial.touching);
  EXPECT_EQ(read.fractions, partial.fractions);
  partial.fractions.pop_back();
  EXPECT_THROW(octree_file_bytes({partial, "", ""}), std::invalid_argument);
}

TEST(OctreeFile, IsTheSameBytesForTheSameVoxelsOnAnyNumberOfThreads) {
  const Universe universe = universe_of(6);
  const Octree a = tests::octree_of(universe, tests::random_dense(64, 3));
  // The same voxels by another way: nodes that are shared and nodes that are not.
  const Octree b = combine(universe, Expression(a) & ~(Expression(a) ^ Expression(a)));
  const GreyOctree grey = noisy_grey(6, 3);
  std::vector<Bytes> one_thread;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    one_thread = {octree_file_bytes({a, "n", "m"}), octree_file_bytes({grey, "", ""})};
  }
  EXPECT_EQ(octree_file_bytes({b, "n", "m"}), one_thread[0]);
  EXPECT_EQ(octree_file_bytes({grey, "", ""}), one_thread[1]);
}

// Small files of each kind.
std::vector<Bytes> small_files() {
  const Universe universe = oblique_universe(2);
  const Octree figure = tests::octree_of(universe, tests::figure_3_1_voxels());
  return {
      octree_file_bytes({figure, "figure 3.1", "{}"}), octree_file_bytes({noisy_grey(2, 5), "", ""}),
      octree_file_bytes(
          {PartialOctree{figure, Octree::full(universe), std::vector<std::uint16_t>(64 - 13, 9)}, "", ""})};
}

std::string damage(const Bytes& bytes) {
  try {
    decoded(bytes);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST(OctreeFile, WithAnyBitFlippedIsFoundDamaged) {
  for (const Bytes& whole : small_files()) {
    ASSERT_EQ(damage(whole), "");
    for (std::size_t i = 0; i < whole.size(); ++i)
      for (int bit = 0; bit < 8; ++bit) {
        Bytes bytes = whole;
        bytes[i] ^= static_cast<std::uint8_t>(1 << bit);
        const std::string found = damage(bytes);
        ASSERT_EQ(found.substr(0, 10), "x.octree: ") << "byte " << i << ", bit " << bit;
        if (i >= 32) {
          ASSERT_NE(found.find(" byte "), std::string::npos) << found;
        }
      }
  }
}

TEST(OctreeFile, CutShortAnywhereOrGoingOnIsFoundDamaged) {
  for (const Bytes& whole : small_files()) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::string found =
          damage(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
      ASSERT_EQ(found.substr(0, 10), "x.octree: ") << "cut to " << size;
      if (size >= 8) {
        ASSERT_NE(found.find("cut short"), std::string::npos) << found;
      }
    }
    Bytes longer = whole;
    longer.push_back(0);
    EXPECT_NE(damage(longer).find("continues after its end"), std::string::npos);
  }
}

// Makes the header's and every section's checksum right again, as one who forges a file would.
void forge(Bytes& bytes) {
  const auto number = [&](std::size_t at) {
    return bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16) |
           (static_cast<std::uint32_t>(bytes[at + 3]) << 24);
  };
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  };
  if (bytes.size() < 32) return;
  put(16, static_cast<std::uint32_t>(bytes.size()));
  put(20, 0);
  put(28, static_cast<std::uint32_t>(crc32_z(0, bytes.data(), 28)));
  std::size_t at = 32;
  for (std::uint32_t section = 0; at + 16 <= bytes.size(); ++section) {
    const std::size_t stored = number(at + 12);
    if (stored > bytes.size() - at - 16) return;
    const std::array<std::uint8_t, 4> index{static_cast<std::uint8_t>(section), 0, 0, 0};
    auto sum = crc32_z(0, index.data(), 4);
    sum = crc32_z(sum, bytes.data() + at, 4);
    sum = crc32_z(sum, bytes.data() + at + 8, 8 + stored);
    put(at + 4, static_cast<std::uint32_t>(sum));
    at += 16 + stored;
  }
}

TEST(OctreeFile, ForgedWithRightChecksumsIsRefusedOrReadsAsAnotherTree) {
  int refused = 0;
  for (const Bytes& whole : small_files()) {
    Bytes same = whole;
    forge(same);
    ASSERT_EQ(same, whole);
    for (std::uint64_t seed = 0; seed < 4000; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      std::mt19937_64 random(seed);
      Bytes bytes = tests::mutated(whole, random, "");
      forge(bytes);
      try {
        const OctreeFile file = decoded(bytes);
        ASSERT_NO_THROW(decoded(octree_file_bytes(file)));
      } catch (const std::runtime_error& error) {
        ++refused;
        ASSERT_EQ(std::string(error.what()).substr(0, 10), "x.octree: ");
      }
    }
  }
  EXPECT_GT(refused, 9000);
}

TEST(OctreeFile, WhoseSectionsChangedPlacesIsFoundDamaged) {
  Bytes bytes = small_files()[0];
  // NAME and META, each a frame of its own.
  const auto section = [&](const char* name) {
    const auto found = std::search(bytes.begin(), bytes.end(), name, name + 4);
    return std::make_pair(found - bytes.begin(), 16 + *(found + 12));
  };
  const auto [name_at, name_size] = section("NAME");
  const auto [meta_at, meta_size] = section("META");
  ASSERT_EQ(name_at + name_size, meta_at);
  std::rotate(bytes.begin() + name_at, bytes.begin() + meta_at, bytes.begin() + meta_at + meta_size);
  EXPECT_NE(damage(bytes).find("does not match its checksum"), std::string::npos);
}

TEST(OctreeFile, ThatIsNoneSaysSo) {
  tests::ScratchFolder scratch;
  std::ofstream(scratch / "not.octree") << "solid ascii stl";
  try {
    read_octree(scratch / "not.octree");
    FAIL() << "was read";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("is not an octree file"), std::string::npos) << error.what();
  }
  EXPECT_THROW(read_octree(scratch / "absent.octree"), std::runtime_error);
  EXPECT_THROW(read_octree(scratch.path()), std::runtime_error);
  Bytes later = small_files()[0];
  later[8] = 4;
  forge(later);
  EXPECT_NE(damage(later).find("version 4"), std::string::npos);
}

TEST(OctreeFile, ThatCannotBeWrittenLeavesWhatWasThere) {
  tests::ScratchFolder scratch;
  const OctreeFile file{tests::figure_3_1(), "", ""};
  write_octree(file, scratch / "a.octree");
  EXPECT_THROW(write_octree(file, scratch / "absent" / "a.octree"), std::runtime_error);
  std::filesystem::create_directory(scratch / "folder.octree");
  EXPECT_THROW(write_octree(file, scratch / "folder.octree"), std::runtime_error);
  EXPECT_NO_THROW(read_octree(scratch / "a.octree"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch.path()), {}), 2);
}

}  // namespace
}  // namespace octotomy::voxel

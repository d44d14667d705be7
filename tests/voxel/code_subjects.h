// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/voxel/dense.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/octree.h"

// The subjects on which every representation of an object is tested.
namespace octotomy::tests {

inline voxel::Universe universe_of(int depth) {
  return {depth, glm::dmat4(1.0)};
}

/// Figure 3.1's object, from the one-runs that the thesis prints in section 3.2.3.
inline Dense figure_3_1_voxels() {
  Dense dense(4);
  for (const int i : {8, 9, 12, 13, 23, 24, 25, 26, 28, 29, 41, 44, 57})
    dense.voxels[static_cast<std::size_t>(i)] = 1;
  return dense;
}
inline voxel::Octree figure_3_1() {
  return octree_of(universe_of(2), figure_3_1_voxels());
}

/// A box of voxels low..high, both included, in a universe too large for a dense array.
inline voxel::Octree box_of(const voxel::Universe& universe, const glm::dvec3& low, const glm::dvec3& high) {
  return voxel::combine(universe, voxel::Box{low - 0.5, high + 0.5});
}

/// Objects of 4096^3 universes: nothing, single voxels at far corners and amid, thin beams, a small box
/// across the middle planes.
inline std::vector<voxel::Octree> sparse_subjects() {
  const voxel::Universe universe = universe_of(12);
  const auto voxel_at = [&](double x, double y, double z) {
    return voxel::Expression(box_of(universe, {x, y, z}, {x, y, z}));
  };
  const voxel::Expression corners =
      voxel_at(0, 0, 0) | voxel_at(4095, 0, 0) | voxel_at(0, 4095, 4095) | voxel_at(4095, 4095, 4095);
  return {voxel::Octree::empty(universe), voxel::combine(universe, corners),
          voxel::combine(universe, voxel_at(1234, 2345, 3456) | voxel_at(2047, 2048, 2047)),
          voxel::combine(universe, voxel::Expression(box_of(universe, {0, 17, 4095}, {4095, 17, 4095})) |
                                       voxel::Expression(box_of(universe, {77, 0, 33}, {77, 4095, 33}))),
          box_of(universe, {2040, 2043, 2046}, {2055, 2050, 2049})};
}

/// Calls `with` for random objects of every depth from 2 to 6, and for figure 3.1, empty and full objects.
inline void for_each_subject(const std::function<void(const Dense&, const voxel::Octree&)>& with) {
  for (int depth = 2; depth <= 6; ++depth)
    for (std::uint64_t seed = 0; seed < (depth < 6 ? 24 : 8); ++seed) {
      SCOPED_TRACE("depth " + std::to_string(depth) + ", seed " + std::to_string(seed));
      Dense dense = random_dense(1 << depth, seed + 1000 * static_cast<std::uint64_t>(depth));
      if (seed == 0) dense.voxels.assign(dense.voxels.size(), 0);
      if (seed == 1) dense.voxels.assign(dense.voxels.size(), 1);
      if (seed == 2 && depth == 2) dense = figure_3_1_voxels();
      with(dense, octree_of(universe_of(depth), dense));
      if (testing::Test::HasFatalFailure()) return;
    }
}

/// A text or code with a few bytes changed, inserted, removed, doubled or cut off.
template <typename Code>
Code mutated(Code code, std::mt19937_64& random, const std::string& alphabet) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (std::size_t edits = 1 + below(3); edits > 0; --edits) {
    if (code.empty()) return code;
    const auto at = code.begin() + static_cast<std::ptrdiff_t>(below(code.size()));
    const auto symbol = static_cast<typename Code::value_type>(
        alphabet.empty() ? below(256) : static_cast<unsigned char>(alphabet[below(alphabet.size())]));
    switch (below(5)) {
      case 0:
        *at = symbol;
        break;
      case 1:
        code.insert(at, symbol);
        break;
      case 2:
        code.erase(at);
        break;
      case 3:
        code.insert(at, code.begin(), code.begin() + static_cast<std::ptrdiff_t>(below(code.size())));
        break;
      default:
        code.resize(below(code.size()) + 1);
    }
  }
  return code;
}

/// Decodes mutations of a text. What is accepted must be written back as the same object, what is refused
/// must be refused as an invalid argument that begins with `what` and says where.
inline void fuzz_text(const std::string& start, const std::string& what, const std::string& alphabet,
                      const std::function<voxel::Octree(const std::string&)>& decode,
                      const std::function<std::string(const voxel::Octree&)>& encode) {
  int refused = 0;
  int accepted = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const std::string text = mutated(start, random, alphabet + (seed % 8 == 0 ? "\xff \n-" : ""));
    try {
      const voxel::Octree octree = decode(text);
      ++accepted;
      ASSERT_TRUE(decode(encode(octree)) == octree) << text;
    } catch (const std::invalid_argument& error) {
      ++refused;
      const std::string message = error.what();
      ASSERT_EQ(message.substr(0, what.size()), what) << message;
      ASSERT_NE(message.find_first_of("0123456789"), std::string::npos) << message;
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(accepted, 0);
}

/// The message of a call's refusal; empty if it succeeds.
inline std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace octotomy::tests

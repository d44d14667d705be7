// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/code_boolean.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::universe_of;

TEST(CodeBoolean, IsThatOfPlainArraysInEveryCode) {
  for (int depth = 2; depth <= 7; ++depth)
    for (std::uint64_t seed = 0; seed < (depth < 6 ? 24 : 3); ++seed) {
      SCOPED_TRACE("depth " + std::to_string(depth) + ", seed " + std::to_string(seed));
      const tests::Dense a = tests::random_dense(1 << depth, seed),
                         b = tests::random_dense(1 << depth, seed + 500);
      const Octree of_a = tests::octree_of(universe_of(depth), a),
                   of_b = tests::octree_of(universe_of(depth), b);
      for (const SetOperation operation :
           {SetOperation::Intersection, SetOperation::Union, SetOperation::Difference}) {
        tests::Dense expected(1 << depth);
        for (std::size_t i = 0; i < a.voxels.size(); ++i)
          expected.voxels[i] = operation == SetOperation::Intersection ? a.voxels[i] && b.voxels[i]
                               : operation == SetOperation::Union      ? a.voxels[i] || b.voxels[i]
                                                                       : a.voxels[i] && !b.voxels[i];
        const Octree octree = tests::octree_of(universe_of(depth), expected);
        ASSERT_EQ(combined(binary_array(of_a), binary_array(of_b), operation).bytes,
                  binary_array(octree).bytes);
        ASSERT_EQ(combined(marginal_index(of_a), marginal_index(of_b), operation).slices,
                  marginal_index(octree).slices);
        ASSERT_EQ(combined(run_length(of_a), run_length(of_b), operation).runs, run_length(octree).runs);
        ASSERT_EQ(combined(segment_index(of_a), segment_index(of_b), operation).slices,
                  segment_index(octree).slices);
      }
    }
}

TEST(CodeBoolean, OfDifferentUniversesIsRefused) {
  const Octree small = Octree::full(universe_of(2)), large = Octree::full(universe_of(3));
  EXPECT_THROW(combined(run_length(small), run_length(large), SetOperation::Union), std::invalid_argument);
  EXPECT_THROW(combined(binary_array(small), binary_array(large), SetOperation::Union),
               std::invalid_argument);
  EXPECT_THROW(combined(segment_index(small), segment_index(large), SetOperation::Union),
               std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The algebra of sets, held to by expressions of octrees: each law on many triples, both sides against each
// other and against a plain array.
#include <array>
#include <gtest/gtest.h>
#include <random>

#include "tests/voxel/dense.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;

struct Law {
  const char* name;
  Expression (*left)(const Expression&, const Expression&, const Expression&);
  Expression (*right)(const Expression&, const Expression&, const Expression&);
  bool (*rule)(bool, bool, bool);
};

using E = Expression;

const std::array<Law, 16> laws{{
    {"union commutes", [](const E& a, const E& b, const E&) { return a | b; },
     [](const E& a, const E& b, const E&) { return b | a; }, [](bool a, bool b, bool) { return a || b; }},
    {"intersection commutes", [](const E& a, const E& b, const E&) { return a & b; },
     [](const E& a, const E& b, const E&) { return b & a; }, [](bool a, bool b, bool) { return a && b; }},
    {"union associates", [](const E& a, const E& b, const E& c) { return (a | b) | c; },
     [](const E& a, const E& b, const E& c) { return a | (b | c); },
     [](bool a, bool b, bool c) { return a || b || c; }},
    {"intersection associates", [](const E& a, const E& b, const E& c) { return (a & b) & c; },
     [](const E& a, const E& b, const E& c) { return a & (b & c); },
     [](bool a, bool b, bool c) { return a && b && c; }},
    {"symmetric difference associates", [](const E& a, const E& b, const E& c) { return (a ^ b) ^ c; },
     [](const E& a, const E& b, const E& c) { return a ^ (b ^ c); },
     [](bool a, bool b, bool c) { return a != (b != c); }},
    {"intersection distributes over union", [](const E& a, const E& b, const E& c) { return a & (b | c); },
     [](const E& a, const E& b, const E& c) { return (a & b) | (a & c); },
     [](bool a, bool b, bool c) { return a && (b || c); }},
    {"union distributes over intersection", [](const E& a, const E& b, const E& c) { return a | (b & c); },
     [](const E& a, const E& b, const E& c) { return (a | b) & (a | c); },
     [](bool a, bool b, bool c) { return a || (b && c); }},
    {"de Morgan of union", [](const E& a, const E& b, const E&) { return ~(a | b); },
     [](const E& a, const E& b, const E&) { return ~a & ~b; },
     [](bool a, bool b, bool) { return !(a || b); }},
    {"de Morgan of intersection", [](const E& a, const E& b, const E&) { return ~(a & b); },
     [](const E& a, const E& b, const E&) { return ~a | ~b; },
     [](bool a, bool b, bool) { return !(a && b); }},
    {"absorption", [](const E& a, const E& b, const E&) { return a | (a & b); },
     [](const E& a, const E&, const E&) { return a; }, [](bool a, bool, bool) { return a; }},
    {"difference is intersection with the complement", [](const E& a, const E& b, const E&) { return a - b; },
     [](const E& a, const E& b, const E&) { return a & ~b; }, [](bool a, bool b, bool) { return a && !b; }},
    {"differences in a row", [](const E& a, const E& b, const E& c) { return (a - b) - c; },
     [](const E& a, const E& b, const E& c) { return a - (b | c); },
     [](bool a, bool b, bool c) { return a && !(b || c); }},
    {"symmetric difference", [](const E& a, const E& b, const E&) { return a ^ b; },
     [](const E& a, const E& b, const E&) { return (a - b) | (b - a); },
     [](bool a, bool b, bool) { return a != b; }},
    {"the thesis's three operands", [](const E& a, const E& b, const E& c) { return c | (a - b); },
     [](const E& a, const E& b, const E& c) { return (c | a) & (c | ~b); },
     [](bool a, bool b, bool c) { return c || (a && !b); }},
    {"excluded middle", [](const E& a, const E&, const E&) { return a | ~a; },
     [](const E& a, const E&, const E&) { return ~(a & ~a); }, [](bool, bool, bool) { return true; }},
    {"complement twice", [](const E& a, const E&, const E&) { return ~~a; },
     [](const E& a, const E&, const E&) { return a; }, [](bool a, bool, bool) { return a; }},
}};

// A triple whose third is the first one shifted in a quarter of the cases; nothing, everything and single
// voxels are among what random_dense() gives.
std::array<Dense, 3> triple(int side, std::uint64_t seed) {
  std::array<Dense, 3> dense{tests::random_dense(side, 3 * seed), tests::random_dense(side, 3 * seed + 1),
                             tests::random_dense(side, 3 * seed + 2)};
  if (seed % 4 == 0) {
    std::mt19937_64 random(seed);
    const glm::ivec3 by(random() % 3, random() % 3, random() % 3);
    dense[2] = Dense(side);
    dense[2].for_each([&](const glm::ivec3& v) {
      const glm::ivec3 from = v - by;
      if (glm::all(glm::greaterThanEqual(from, glm::ivec3(0)))) dense[2].at(v) = dense[0].at(from);
    });
  }
  return dense;
}

TEST(SetIdentities, HoldOnTenThousandTriplesAndAgainstAPlainArray) {
  int telling = 0;
  int single_voxels = 0;
  int homogeneous = 0;
  for (std::uint64_t seed = 0; seed < 10000; ++seed) {
    constexpr std::array<int, 8> depths{2, 2, 2, 2, 3, 3, 4, 5};
    const int depth = depths[seed / 4 % 8];
    const Universe universe{depth, glm::dmat4(1.0)};
    const std::array<Dense, 3> dense = triple(1 << depth, seed);
    const std::array<Octree, 3> trees{tests::octree_of(universe, dense[0]),
                                      tests::octree_of(universe, dense[1]),
                                      tests::octree_of(universe, dense[2])};
    for (const Octree& tree : trees) {
      single_voxels += tree.voxel_count() == 1;
      homogeneous += tree.is_empty() || tree == Octree::full(universe);
    }
    // Four laws a triple, so that each is tried on 2500 and all kinds of triples meet all laws.
    for (std::size_t i = 0; i < 4; ++i) {
      const Law& law = laws[(4 * seed + i + seed / 4) % laws.size()];
      const Octree left = combine(universe, law.left(trees[0], trees[1], trees[2]));
      const Octree right = combine(universe, law.right(trees[0], trees[1], trees[2]));
      ASSERT_TRUE(left == right) << law.name << ", seed " << seed;
      Dense expected(1 << depth);
      for (std::size_t v = 0; v < expected.voxels.size(); ++v)
        expected.voxels[v] =
            law.rule(dense[0].voxels[v] != 0, dense[1].voxels[v] != 0, dense[2].voxels[v] != 0);
      ASSERT_EQ(tests::dense_of(left).voxels, expected.voxels) << law.name << ", seed " << seed;
      telling += !left.is_empty() && !(left == Octree::full(universe));
    }
  }
  EXPECT_GT(telling, 15000) << "too few results were neither empty nor full";
  EXPECT_GT(single_voxels, 500);
  EXPECT_GT(homogeneous, 1000);
}

// Status of an octree's root as table 7.1 has it.
char status(const Octree& octree) {
  if (octree.is_empty()) return 'E';
  return octree == Octree::full(octree.universe()) ? 'F' : 'P';
}

TEST(SetIdentities, StatusesFollowTable7_1) {
  const Universe universe{5, glm::dmat4(1.0)};
  const Octree empty = Octree::empty(universe);
  const Octree full = Octree::full(universe);
  // Partial trees that complete, exclude and cross each other, so that P/E and P/F both take both values.
  const Octree half = combine(universe, Box{{-1, -1, -1}, {15.5, 40, 40}});
  const Octree other_half = combine(universe, ~Expression(half));
  const Octree ball = combine(universe, Sphere{{16, 16, 16}, 9});
  const auto check = [&](const Octree& a, const Octree& b, const std::array<std::string, 3>& allowed) {
    EXPECT_NE(allowed[0].find(status(combine(universe, Expression(a) & b))), std::string::npos);
    EXPECT_NE(allowed[1].find(status(combine(universe, Expression(a) - b))), std::string::npos);
    EXPECT_NE(allowed[2].find(status(combine(universe, Expression(a) | b))), std::string::npos);
  };
  check(full, full, {"F", "E", "F"});
  check(empty, full, {"E", "E", "F"});
  check(ball, full, {"P", "E", "F"});
  check(full, empty, {"E", "F", "F"});
  check(empty, empty, {"E", "E", "E"});
  check(ball, empty, {"E", "P", "P"});
  check(full, ball, {"P", "P", "F"});
  check(empty, ball, {"E", "E", "P"});
  check(half, other_half, {"E", "P", "F"});
  check(half, half, {"P", "E", "P"});
  check(half, ball, {"P", "P", "P"});
}

}  // namespace
}  // namespace octotomy::voxel

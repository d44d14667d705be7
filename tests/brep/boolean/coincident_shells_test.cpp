// SPDX-License-Identifier: AGPL-3.0-or-later
// Booleans of solids whose shells lie on each other, as a plug lies in its socket: all operations, either
// order, rounded and exact, against volumes in closed form.
#include "brep/boolean/coincident_shells.h"

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "brep/boolean/boolean.h"
#include "brep/boolean/exact_boolean.h"
#include "brep/boolean/near_boolean.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "tests/brep/shapes.h"
#include "tests/brep/told.h"

namespace octotomy::brep {
namespace {

using shapes::box;
using shapes::inside_out;
using shapes::together;
using tests::told;

bool tells_of_a_shift(const std::vector<std::string>& findings) {
  return told(findings).find("shifted: ") != std::string::npos;
}

/// The volume that the remedy may change: three steps over the area of the operand that was moved.
double shift_tolerance(const Solid& a, const Solid& b) {
  const Size &p = a.size(), &q = b.size();
  const double extent = glm::length(glm::max(p.high_mm, q.high_mm) - glm::min(p.low_mm, q.low_mm));
  return 3 * 0x1p-18 * extent * std::max(p.area_mm2, q.area_mm2);
}

enum class Way { Plain, AndExact };

/// Expects that all results in both orders have the volumes that follow from the common one: each computed
/// alone, all at once and, if requested, with exact numbers. Returns whether a result was shifted.
bool expect_common(const Solid& a, const Solid& b, double common_mm3, Way way, const std::string& what) {
  bool shifted = false;
  for (const bool swapped : {false, true}) {
    const Solid &p = swapped ? b : a, &q = swapped ? a : b;
    const double p_mm3 = volume_mm3(p), q_mm3 = volume_mm3(q);
    const auto expect = [&](const Solid& solid, double mm3, const std::vector<std::string>& findings,
                            const char* operation) {
      shifted |= tells_of_a_shift(findings);
      EXPECT_NEAR(volume_mm3(solid), mm3, tells_of_a_shift(findings) ? shift_tolerance(p, q) : 1e-9)
          << what << ": " << operation << (swapped ? ", swapped; " : "; ") << told(findings);
      const Health h = health(solid.triangles(), {.self_intersections = false});
      EXPECT_TRUE(solid.empty() || (h.closed && h.manifold && h.oriented)) << what << ": " << told(h);
    };
    const BooleanResult less = boolean(p, Operation::Difference, q),
                        more = boolean(q, Operation::Difference, p);
    const BooleanResult common = boolean(p, Operation::Intersection, q);
    const BooleanResult united = boolean(p, Operation::Union, q);
    expect(united.solid, p_mm3 + q_mm3 - common_mm3, united.findings, "union");
    expect(common.solid, common_mm3, common.findings, "intersection");
    expect(less.solid, p_mm3 - common_mm3, less.findings, "difference");
    // If surfaces cross, the differences meet in edges, which requires the shift.
    if (!tells_of_a_shift(less.findings) && !tells_of_a_shift(more.findings)) {
      const BooleanResult either = boolean(less.solid, Operation::Union, more.solid);
      const bool before = shifted;
      expect(either.solid, p_mm3 + q_mm3 - 2 * common_mm3, either.findings, "symmetric difference");
      shifted = before;
    }
    const Booleans all = booleans(p, q);
    expect(all.united.value(), p_mm3 + q_mm3 - common_mm3, all.findings, "union of all");
    expect(all.intersection.value(), common_mm3, all.findings, "intersection of all");
    expect(all.a_minus_b.value(), p_mm3 - common_mm3, all.findings, "difference of all");
    expect(all.b_minus_a.value(), q_mm3 - common_mm3, all.findings, "difference turned round of all");
    if (way == Way::Plain) continue;
    EXPECT_NEAR(exact_boolean(p, Operation::Union, q).result_mm3, p_mm3 + q_mm3 - common_mm3, 1e-9) << what;
    EXPECT_NEAR(exact_boolean(p, Operation::Intersection, q).result_mm3, common_mm3, 1e-9) << what;
    const ExactBoolean exact = exact_boolean(p, Operation::Difference, q);
    EXPECT_NEAR(exact.result_mm3, p_mm3 - common_mm3, 1e-9) << what;
    EXPECT_NEAR(exact.solid.empty() ? 0.0 : volume_mm3(exact.solid), p_mm3 - common_mm3, 1e-9) << what;
  }
  return shifted;
}

/// The box. Each of its sides is cut along one diagonal, the other, or both, as the bits of a number choose.
Triangles cut_box(const glm::dvec3& low, const glm::dvec3& high, std::uint64_t cuts) {
  Triangles t = box(low, high);
  for (std::size_t side = 0; side < 6; ++side, cuts /= 3) {
    // Both triangles of a side begin at the same corner, and the first ends where the second goes on.
    const auto [p, q, r] = t.faces[2 * side];
    const std::uint32_t s =
        t.faces[2 * side + 1][2] == p ? t.faces[2 * side + 1][1] : t.faces[2 * side + 1][2];
    if (cuts % 3 == 0) continue;
    if (cuts % 3 == 1) {
      t.faces[2 * side] = {p, q, s};
      t.faces[2 * side + 1] = {q, r, s};
      continue;
    }
    const auto middle = static_cast<std::uint32_t>(t.points_mm.size());
    t.points_mm.push_back(0.5 * (t.points_mm[p] + t.points_mm[r]));
    t.faces[2 * side] = {p, q, middle};
    t.faces[2 * side + 1] = {q, r, middle};
    t.faces.push_back({r, s, middle});
    t.faces.push_back({s, p, middle});
  }
  return t;
}

TEST(CoincidentShells, APlugInItsCavityHasNothingInCommonWithWhatIsAround) {
  const Triangles cube = box({0, 0, 0}, {10, 10, 10}), plug = box({2, 2, 2}, {8, 8, 8});
  const Solid around = solid_of(together(cube, inside_out(plug)));
  for (const std::uint64_t cuts : {0, 364, 728, 500})
    EXPECT_FALSE(expect_common(around, solid_of(cut_box({2, 2, 2}, {8, 8, 8}, cuts)), 0, Way::AndExact,
                               "plug of cuts " + std::to_string(cuts)));
  EXPECT_NEAR(volume_mm3(boolean(around, Operation::Union, solid_of(plug)).solid), 1000, 1e-12);
}

TEST(CoincidentShells, WhatIsNestedInTheCavityIsInThePlug) {
  const Triangles plug = box({2, 2, 2}, {8, 8, 8});
  const Triangles around = together(box({0, 0, 0}, {10, 10, 10}), inside_out(plug));
  EXPECT_FALSE(expect_common(solid_of(together(around, box({3, 3, 3}, {7, 7, 7}))), solid_of(plug), 64,
                             Way::AndExact, "nested box"));
}

TEST(CoincidentShells, ABallInABallOfTheSameCavity) {
  const Triangles ball = shapes::sphere({0.1, 0.2, 0.3}, 5, 3);
  const Solid around = solid_of(together(shapes::sphere({0.1, 0.2, 0.3}, 10, 3), inside_out(ball)));
  EXPECT_FALSE(expect_common(around, solid_of(ball), 0, Way::AndExact, "ball"));
}

TEST(CoincidentShells, BesideAFinerSurfaceThatIsCutElsewhere) {
  // Few triangles are near the cut, so whether the near ones suffice is not tested here.
  const Triangles plug = box({-1, -1, -1}, {1, 1, 1});
  const Solid around = solid_of(together(shapes::sphere({0, 0, 0}, 10, 5), inside_out(plug)));
  const Triangles knife = shapes::sphere({9.9, 3.1, 1.2}, 1.5, 3);
  const double common_mm3 = volume_mm3(
      boolean(solid_of(shapes::sphere({0, 0, 0}, 10, 5)), Operation::Intersection, solid_of(knife)).solid);
  EXPECT_FALSE(expect_common(around, solid_of(together(plug, knife)), common_mm3, Way::Plain, "knife"));
}

/// Boxes inside one another. Each operand uses some of them as shells: outward or inward by their depth.
struct NestedBox {
  glm::dvec3 low, high;
  int parent;
};
const std::vector<NestedBox>& nested_boxes() {
  static const std::vector<NestedBox> boxes = {{{0, 0, 0}, {16, 8, 8}, -1}, {{1, 1, 1}, {7, 7, 7}, 0},
                                               {{2, 2, 2}, {6, 6, 6}, 1},   {{3, 3, 3}, {5, 5, 5}, 2},
                                               {{9, 1, 1}, {15, 7, 7}, 0},  {{10, 2, 2}, {14, 6, 6}, 4},
                                               {{20, 1, 1}, {24, 5, 5}, -1}};
  return boxes;
}

/// Whether the space inside a box, but outside all smaller ones, is inside the operand that uses the boxes of
/// some bits.
bool is_within(int number, unsigned taken) {
  bool inside = false;
  for (; number >= 0; number = nested_boxes()[static_cast<std::size_t>(number)].parent)
    inside ^= (taken >> number & 1u) != 0;
  return inside;
}

Solid taken_boxes(unsigned taken, std::mt19937_64& random) {
  Triangles all;
  for (int i = 0; i < static_cast<int>(nested_boxes().size()); ++i) {
    if (!(taken >> i & 1u)) continue;
    const auto& [low, high, parent] = nested_boxes()[static_cast<std::size_t>(i)];
    const Triangles shell = cut_box(low, high, random() % 729);
    all = together(all, is_within(i, taken) ? shell : inside_out(shell));
  }
  return solid_of(all);
}

/// The volume inside both operands, computed box by box, without the boxes in it.
double common_boxes_mm3(unsigned a, unsigned b) {
  double sum = 0.0;
  for (int i = 0; i < static_cast<int>(nested_boxes().size()); ++i) {
    const auto& [low, high, parent] = nested_boxes()[static_cast<std::size_t>(i)];
    const glm::dvec3 sides = high - low;
    const double mm3 = sides.x * sides.y * sides.z;
    if (is_within(i, a) && is_within(i, b)) sum += mm3;
    if (parent >= 0 && is_within(parent, a) && is_within(parent, b)) sum -= mm3;
  }
  return sum;
}

TEST(CoincidentShells, AnyShellsOfNestedBoxesInAnyTwoOperandsAndAnyTriangles) {
  int contrary = 0, alike = 0, both = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    std::mt19937_64 random(seed);
    const auto a = static_cast<unsigned>(1 + random() % 127), b = static_cast<unsigned>(1 + random() % 127);
    int against = 0, with = 0;
    for (int i = 0; i < 7; ++i)
      if (a >> i & b >> i & 1u) ++(is_within(i, a) == is_within(i, b) ? with : against);
    contrary += against > 0;
    alike += with > 0;
    both += against > 0 && with > 0;
    EXPECT_FALSE(expect_common(taken_boxes(a, random), taken_boxes(b, random), common_boxes_mm3(a, b),
                               seed % 5 == 0 ? Way::AndExact : Way::Plain, "seed " + std::to_string(seed)));
  }
  EXPECT_GT(contrary, 30);
  EXPECT_GT(alike, 30);
  EXPECT_GT(both, 10);
}

TEST(CoincidentShells, PlugsThatTouchTheirSocketInPart) {
  const Triangles plug = box({2, 2, 2}, {8, 8, 8});
  const Solid around = solid_of(together(box({0, 0, 0}, {10, 10, 10}), inside_out(plug)));
  const Solid half =
      boolean(solid_of(box({0, 0, 0}, {10, 10, 5})), Operation::Difference, solid_of(plug)).solid;
  EXPECT_NEAR(volume_mm3(half), 500 - 108, 1e-11);
  EXPECT_FALSE(expect_common(half, solid_of(plug), 0, Way::AndExact, "half a socket"));
  // The plug extends from its cavity into the wall.
  EXPECT_FALSE(expect_common(around, solid_of(box({2, 2, 2}, {8, 8, 9})), 36, Way::AndExact, "too long"));
  EXPECT_FALSE(expect_common(around, solid_of(box({3, 3, 2}, {7, 7, 7})), 0, Way::AndExact, "on the floor"));
  EXPECT_FALSE(expect_common(around, solid_of(box({2, 2, 2}, {5, 8, 8})), 0, Way::AndExact, "half a plug"));
  EXPECT_FALSE(expect_common(around, solid_of(box({2, 2, 2}, {5, 5, 5})), 0, Way::AndExact, "in its corner"));
  EXPECT_FALSE(expect_common(around, solid_of(box({3, 3, 0}, {7, 7, 2})), 32, Way::AndExact, "in the wall"));
}

TEST(CoincidentShells, SolidsThatTouchAtAFaceAnEdgeOrACorner) {
  const Solid cube = solid_of(box({0, 0, 0}, {2, 2, 2}));
  EXPECT_FALSE(expect_common(cube, cube, 8, Way::AndExact, "itself"));
  EXPECT_FALSE(expect_common(cube, solid_of(cut_box({0, 0, 0}, {2, 2, 2}, 500)), 8, Way::AndExact, "cut"));
  EXPECT_FALSE(expect_common(cube, solid_of(box({2, 0, 0}, {4, 2, 2})), 0, Way::AndExact, "face"));
  EXPECT_FALSE(expect_common(cube, solid_of(box({2, 2, 0}, {4, 4, 2})), 0, Way::Plain, "edge"));
  EXPECT_FALSE(expect_common(cube, solid_of(box({2, 2, 2}, {4, 4, 4})), 0, Way::AndExact, "corner"));
  // Within a cavity: at an edge and at a corner of it.
  const Triangles hole = box({-5, -5, -5}, {5, 5, 5});
  const Solid around = solid_of(together(box({-9, -9, -9}, {9, 9, 9}), inside_out(hole)));
  EXPECT_FALSE(
      expect_common(around, solid_of(box({5, 5, 5}, {9, 9, 9})), 64, Way::AndExact, "corner, beyond"));
}

TEST(CoincidentShells, AreFoundWhateverTheOrderOfPointsAndOnlyWhereAllTrianglesAre) {
  const auto less = [](const glm::dvec3& p, const glm::dvec3& q) {
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  const auto plain = [](const Triangles& t) { return PointTriangles<glm::dvec3>{t.points_mm, t.faces}; };
  const Triangles cube = box({0, 0, 0}, {2, 2, 2}), other = box({3, 0, 0}, {5, 2, 2});
  const auto both = plain(together(cube, other));
  EXPECT_EQ(coincident_shells(both, plain(together(other, cube)), false, less).size(), 2u);
  EXPECT_EQ(coincident_shells(both, plain(together(other, cube)), true, less).size(), 0u);
  EXPECT_EQ(coincident_shells(both, plain(inside_out(cube)), true, less).size(), 1u);
  Triangles dented = inside_out(other);
  dented.points_mm.back() -= 0.5;
  EXPECT_EQ(coincident_shells(both, plain(dented), true, less).size(), 0u);
}

}  // namespace
}  // namespace octotomy::brep

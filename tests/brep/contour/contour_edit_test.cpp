// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/contour_edit.h"

#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace octotomy::brep {
namespace {

const Contour closed_square{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, true};
const Contour open_line{{{0, 0}, {1, 0}, {2, 1}}, false};

TEST(ContourEdit, PointsAreMovedInsertedAndDeleted) {
  EXPECT_NEAR(signed_area_mm2(point_moved(closed_square, 2, {6, 6})), 24.0, 1e-14);
  const Contour more = point_inserted(closed_square, 3, {-1, 2});
  EXPECT_EQ(more.points_mm.size(), 5u);
  EXPECT_NEAR(signed_area_mm2(more), 18.0, 1e-14);
  EXPECT_EQ(point_deleted(more, 4).points_mm, closed_square.points_mm);
  EXPECT_EQ(point_inserted(open_line, 0, {0.5, 3}).points_mm[1], glm::dvec2(0.5, 3));
  EXPECT_EQ(closed_square.points_mm.size(), 4u);
}

TEST(ContourEdit, SplitPartsHaveTheWholesAreaAndJoinBackToIt) {
  for (std::size_t first = 0; first < 4; ++first) {
    const auto [one, other] = split(closed_square, first, (first + 2) % 4);
    EXPECT_NEAR(signed_area_mm2(one), 8.0, 1e-14);
    EXPECT_NEAR(signed_area_mm2(other), 8.0, 1e-14);
    EXPECT_EQ(one.points_mm.front(), closed_square.points_mm[first]);
  }
  EXPECT_THROW(split(closed_square, 0, 1), std::invalid_argument);
  const auto [start, end] = split(open_line, 1);
  EXPECT_EQ(start.points_mm.back(), end.points_mm.front());
  EXPECT_NEAR(perimeter_mm(start) + perimeter_mm(end), perimeter_mm(open_line), 1e-15);
  EXPECT_NEAR(perimeter_mm(joined(start, end)), perimeter_mm(open_line), 1e-15);
  EXPECT_THROW(split(open_line, 0), std::invalid_argument);
}

TEST(ContourEdit, TwoAreJoinedThroughAGateWithTheObjectOnTheLeft) {
  // Side 1 of one, x = 4, and side 3 of the other, x = 6, face each other: the gate adds what lies between.
  Contour right = closed_square;
  for (glm::dvec2& p : right.points_mm) p.x += 6.0;
  const Contour both = joined(closed_square, 1, right, 3);
  EXPECT_NEAR(signed_area_mm2(both), 16 + 16 + 2 * 4, 1e-13);
  EXPECT_FALSE(first_crossing(both));
  // Sides that look away from each other cross.
  EXPECT_TRUE(first_crossing(joined(closed_square, 3, right, 1)));
  EXPECT_THROW(joined(open_line, 0, closed_square, 0), std::invalid_argument);
  EXPECT_THROW(joined(closed_square, open_line), std::invalid_argument);
}

TEST(ContourEdit, CrossingsAreFoundExactlyAndCornersAreNone) {
  EXPECT_FALSE(first_crossing(closed_square));
  EXPECT_FALSE(first_crossing(open_line));
  const auto crossed = first_crossing(point_moved(closed_square, 2, {-2, 2}));
  ASSERT_TRUE(crossed);
  EXPECT_EQ(*crossed, (std::pair<std::size_t, std::size_t>(1, 3)));
  // A spike that runs back over itself, and a point that touches a side by no more than its last place.
  EXPECT_TRUE(first_crossing({{{0, 0}, {4, 0}, {2, 0}, {2, 3}}, true}));
  const Contour touching{{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}, true};
  EXPECT_TRUE(first_crossing(touching));
  EXPECT_FALSE(first_crossing(point_moved(touching, 3, {2, std::numeric_limits<double>::denorm_min()})));
}

/// The first crossing by its definition over all pairs, for points on whole numbers.
std::optional<std::pair<std::size_t, std::size_t>> plainly_first_crossing(const Contour& contour) {
  const auto& p = contour.points_mm;
  const std::size_t count = contour.closed || p.empty() ? p.size() : p.size() - 1;
  const auto at = [&](std::size_t k) { return glm::i64vec2(p[k % p.size()]); };
  const auto side = [](const glm::i64vec2& a, const glm::i64vec2& b, const glm::i64vec2& c) {
    const std::int64_t twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    return (twice > 0) - (twice < 0);
  };
  const auto is_on = [&](const glm::i64vec2& c, const glm::i64vec2& a, const glm::i64vec2& b) {
    return side(a, b, c) == 0 && glm::all(glm::lessThanEqual(glm::min(a, b), c)) &&
           glm::all(glm::lessThanEqual(c, glm::max(a, b)));
  };
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      const auto a = at(i), b = at(i + 1), c = at(j), d = at(j + 1);
      const bool follows = j == i + 1, closes = contour.closed && i == 0 && j + 1 == count;
      bool meet = false;
      if (follows) meet = is_on(a, c, d) || is_on(d, a, b);
      if (closes) meet = meet || is_on(b, c, d) || is_on(c, a, b);
      if (!follows && !closes)
        meet = is_on(a, c, d) || is_on(b, c, d) || is_on(c, a, b) || is_on(d, a, b) ||
               (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0);
      if (meet) return std::pair(i, j);
    }
  return std::nullopt;
}

TEST(ContourEdit, TheFirstCrossingIsThatOfALookAtAllPairs) {
  std::size_t crossed = 0, uncrossed = 0, late = 0;
  for (unsigned seed = 0; seed < 3000; ++seed) {
    std::mt19937 random(seed);
    Contour contour;
    contour.closed = random() % 2 == 0;
    // Steps at random, mostly ahead, so that crossings come late or never.
    glm::dvec2 at(0);
    const int size = seed % 2 == 0 ? 3 : 40;
    for (std::size_t k = random() % 40; k > 0; --k) {
      contour.points_mm.push_back(at);
      at += glm::dvec2(static_cast<int>(random() % 5) - 1, static_cast<int>(random() % 5) - 2) *
            static_cast<double>(1 + static_cast<int>(random()) % size);
    }
    const auto found = first_crossing(contour), truth = plainly_first_crossing(contour);
    ASSERT_EQ(found, truth) << "seed " << seed;
    crossed += found.has_value();
    uncrossed += !found.has_value();
    late += found && found->first > 5;
  }
  EXPECT_GT(crossed, 1000U);
  EXPECT_GT(uncrossed, 300U);
  EXPECT_GT(late, 100U);
}

/// An edit of a contour, and the pieces that it changed.
struct Edited {
  Contour contour;
  std::vector<std::size_t> changed;
};

/// A point moved, inserted or deleted, or a part split off, near where the contour is.
Edited edited_at_random(const Contour& contour, std::mt19937& random) {
  const std::size_t points = contour.points_mm.size(), at = random() % points,
                    before = (at + points - 1) % points;
  // One after the other: compilers differ in the order of a call's arguments.
  const int up = static_cast<int>(random() % 9) - 4, right = static_cast<int>(random() % 9) - 4;
  const glm::dvec2 p = contour.points_mm[at] + glm::dvec2(right, up);
  switch (random() % 4) {
    case 0:
      return {point_moved(contour, at, p), {before, at}};
    case 1:
      return {point_inserted(contour, at, p), {at, at + 1}};
    case 2:
      if (points < 4) break;
      return {point_deleted(contour, at), {at == 0 ? points - 2 : at - 1}};
    default: {
      const std::size_t to = (at + 2 + random() % points) % points;
      if ((to + points - at) % points < 2 || (at + points - to) % points < 2) break;
      Contour part = split(contour, at, to).first;
      const std::size_t last = part.points_mm.size() - 1;
      return {std::move(part), {last}};
    }
  }
  return {contour, {}};
}

TEST(ContourEdit, AfterAnEditTheFirstCrossingOfWhatItChangedIsThatOfALookAtAllPairs) {
  std::size_t crossed = 0, uncrossed = 0, largest = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    Contour contour{{{0, 0}, {9, 0}, {9, 9}, {0, 9}}};
    for (int edit = 0; edit < 100; ++edit) {
      Edited edited = edited_at_random(contour, random);
      const auto found = first_crossing_of(edited.contour, edited.changed);
      ASSERT_EQ(found, plainly_first_crossing(edited.contour)) << "seed " << seed << ", edit " << edit;
      crossed += found.has_value();
      uncrossed += !found && !edited.changed.empty();
      largest = std::max(largest, edited.contour.points_mm.size());
      if (!found) contour = std::move(edited.contour);
    }
  }
  EXPECT_GT(crossed, 1000U);
  EXPECT_GT(uncrossed, 1000U);
  EXPECT_GT(largest, 12U);
}

TEST(ContourEdit, ALineIsClosedAndWhatWouldBeTooFewPointsIsRefused) {
  EXPECT_TRUE(closed(open_line).closed);
  EXPECT_THROW(closed(Contour{{{0, 0}, {1, 0}}, false}), std::invalid_argument);
  EXPECT_THROW(point_deleted(point_deleted(closed_square, 0), 0), std::invalid_argument);
  EXPECT_THROW(point_moved(closed_square, 4, {0, 0}), std::invalid_argument);
  EXPECT_THROW(point_inserted(open_line, 2, {0, 0}), std::invalid_argument);
  EXPECT_THROW(point_moved(closed_square, 0, {std::numeric_limits<double>::quiet_NaN(), 0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep

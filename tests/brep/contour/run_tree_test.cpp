// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/run_tree.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>

namespace octotomy::brep {
namespace {

TEST(RunTree, FindsTheFirstItemThatALookAtAllFinds) {
  std::size_t found_count = 0, asked_count = 0;
  for (unsigned seed = 0; seed < 500; ++seed) {
    std::mt19937 random(seed);
    const auto place = [&] { return glm::dvec2(random() % 30, random() % 30); };
    std::vector<PlaneBox> items(random() % 80);
    for (PlaneBox& item : items) {
      const glm::dvec2 corner = place();
      item.add(corner);
      item.add(corner + glm::dvec2(random() % 4, random() % 4));
    }
    const RunTree tree(items);
    for (int question = 0; question < 50; ++question) {
      const std::size_t from = random() % 90, until = random() % 90, divisor = 1 + random() % 3;
      PlaneBox sought;
      sought.add(place());
      std::optional<std::size_t> truth;
      for (std::size_t k = from; k < std::min(until, items.size()) && !truth; ++k)
        if (items[k].overlaps(sought) && k % divisor == 0) truth = k;
      const auto found = tree.first(
          from, until, [&](const PlaneBox& box) { return box.overlaps(sought); },
          [&](std::size_t k) {
            ++asked_count;
            return k % divisor == 0;
          });
      ASSERT_EQ(found, truth) << "seed " << seed << ", question " << question;
      found_count += found.has_value();
    }
  }
  EXPECT_GT(found_count, 500U);
  EXPECT_LT(asked_count, 50000U);
}

TEST(RunTree, AContoursRunsHoldItsPiecesAndTheirEnds) {
  const Contour line{{{0, 0}, {3, 1}, {5, -2}, {4, 7}, {1, 1}}, false};
  for (const bool closed : {false, true}) {
    Contour contour = line;
    contour.closed = closed;
    std::set<std::size_t> pieces;
    RunTree(contour).walk([&](const PlaneBox& box, std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k <= end; ++k) EXPECT_TRUE(box.holds(contour.points_mm[k % 5])) << k;
      if (end - begin == 1) pieces.insert(begin);
      return true;
    });
    EXPECT_EQ(pieces.size(), closed ? 5U : 4U);
  }
  RunTree(Contour{}).walk([](const PlaneBox&, std::size_t, std::size_t) {
    ADD_FAILURE() << "an empty contour has no runs";
    return true;
  });
}

TEST(RunTree, TheFarthestPointOfABoxIsACornerOfIt) {
  PlaneBox box;
  box.add({1, 2});
  box.add({4, 3});
  EXPECT_EQ(box.farthest({1, -1}), 5.0);
  EXPECT_EQ(box.farthest({4, 6}), 5.0);
  EXPECT_EQ(box.farthest({8, 0}), std::hypot(7.0, 3.0));
  EXPECT_TRUE(box.holds({4, 2}));
  EXPECT_FALSE(box.holds({4, 3.5}));
}

}  // namespace
}  // namespace octotomy::brep

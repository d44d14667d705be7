// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/interval/cell_table.h"

#include <gtest/gtest.h>
#include <map>
#include <random>

#include "verify/interval/ordered_parallel.h"

namespace octotomy::verify {
namespace {

TEST(CellTable, GathersByCellAndIsReadInTheirOrder) {
  // Cells that come one after the other, and cells that come again much later.
  std::mt19937_64 random(11);
  std::map<std::uint64_t, double> expected;
  CellTable<double> table;
  std::uint64_t cell = 0;
  for (int i = 0; i < 200'000; ++i) {
    if (random() % 4 == 0) cell = (random() % 20'000) << (random() % 44);
    const double value = static_cast<double>(random() % 1000);
    table.at(cell) += value;
    expected[cell] += value;
  }
  auto next = expected.begin();
  table.each([&](double sum) {
    ASSERT_NE(next, expected.end());
    EXPECT_EQ(sum, next++->second);
  });
  EXPECT_EQ(next, expected.end());
}

TEST(OrderedParallel, TakesEachItemOnceInAscendingOrder) {
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, std::size_t{1} << 14, std::size_t{100'003}}) {
    std::size_t taken = 0;
    ordered_parallel<std::size_t>(
        count, [](std::size_t i) { return 3 * i + 1; },
        [&](std::size_t i, std::size_t item) {
          ASSERT_EQ(i, taken++);
          ASSERT_EQ(item, 3 * i + 1);
        });
    EXPECT_EQ(taken, count);
  }
}

}  // namespace
}  // namespace octotomy::verify

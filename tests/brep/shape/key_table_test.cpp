// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/key_table.h"

#include <gtest/gtest.h>
#include <map>
#include <random>

namespace octotomy::brep {
namespace {

TEST(KeyTable, HoldsWhatAMapHolds) {
  KeyTable<double> table;
  std::map<std::uint64_t, double> truth;
  std::mt19937_64 random(1);
  // Keys of places differ in few bits of three coordinates.
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t key = (random() % 32) << 40 | (random() % 32) << 20 | random() % 32;
    EXPECT_EQ(table.contains(key), truth.contains(key));
    EXPECT_EQ(table.insert(key, i), truth.try_emplace(key, i).second);
  }
  EXPECT_EQ(table.size(), truth.size());
  for (const auto& [key, value] : truth) {
    ASSERT_EQ(table.at(key), value);
    table.set(key, -value);
    ASSERT_EQ(*table.find(key), -value);
  }
  EXPECT_EQ(table.find(std::uint64_t{1} << 59), nullptr);
}

TEST(KeyTable, OfNothingHasNoKey) {
  const KeyTable<double> table;
  EXPECT_EQ(table.find(0), nullptr);
  EXPECT_EQ(table.size(), 0u);
}

}  // namespace
}  // namespace octotomy::brep

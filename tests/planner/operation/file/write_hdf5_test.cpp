// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/write_hdf5.h"

#include <gtest/gtest.h>
#include <stdexcept>

#include "planner/operation/file/read_hdf5.h"

namespace octotomy::planner {
namespace {

TEST(WriteHdf5, EqualGroupsMakeEqualBytesWhoseEndIsStated) {
  Hdf5Group root;
  root.members = {{"a", std::string("text")}, {"b", std::vector<double>{1, 2}}, {"c", Hdf5Group{}}};
  const std::string bytes = hdf5_bytes(root);
  EXPECT_EQ(hdf5_bytes(root), bytes);
  // The address of the end, in the superblock: readers refuse a file that is shorter.
  std::uint64_t end = 0;
  for (std::size_t i = 8; i-- > 0;) end = end << 8 | static_cast<unsigned char>(bytes[40 + i]);
  EXPECT_EQ(end, bytes.size());
  const Hdf5File file(bytes);
  EXPECT_EQ(file.members("/"), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(file.text("/a"), "text");
  EXPECT_EQ(file.numbers("/b"), (std::vector<double>{1, 2}));
  EXPECT_TRUE(file.members("/c").empty());
}

TEST(WriteHdf5, WhatDoesNotFitIsRefused) {
  Hdf5Group many;
  for (char name = 'a'; name < 'a' + 8; ++name) many.members.emplace(std::string(1, name), std::string("x"));
  EXPECT_EQ(Hdf5File(hdf5_bytes(many)).members("/").size(), 8U);
  many.members.emplace("i", std::string("x"));
  EXPECT_THROW(hdf5_bytes(many), std::invalid_argument);
  Hdf5Group long_text, no_numbers;
  long_text.members.emplace("a", std::string(5000, 'x'));
  no_numbers.members.emplace("a", std::vector<double>());
  EXPECT_THROW(hdf5_bytes(long_text), std::invalid_argument);
  EXPECT_THROW(hdf5_bytes(no_numbers), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::planner

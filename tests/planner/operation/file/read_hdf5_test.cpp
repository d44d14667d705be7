// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/read_hdf5.h"

#include <gtest/gtest.h>
#include <random>
#include <stdexcept>

#include "planner/operation/file/write_hdf5.h"

namespace octotomy::planner {
namespace {

std::string subject() {
  Hdf5Group transform, list, root;
  transform.members = {{"TransformType", std::string("AffineTransform_double_3_3")},
                       {"TransformParameters", std::vector<double>{1, 0.1, -1.0 / 3.0}}};
  list.members.emplace("0", std::move(transform));
  root.members.emplace("TransformGroup", std::move(list));
  return hdf5_bytes(root);
}

/// Reads all values; false if the file is refused.
bool is_read(const std::string& bytes) {
  try {
    const Hdf5File file(bytes);
    for (const std::string& name : file.members("/TransformGroup")) {
      file.text("/TransformGroup/" + name + "/TransformType");
      file.numbers("/TransformGroup/" + name + "/TransformParameters");
    }
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

std::string refusal(const std::string& bytes, const std::string& path) {
  try {
    Hdf5File(bytes).numbers(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

/// Replaces the first occurrence after `behind`.
std::string with(std::string bytes, const std::string& old, const std::string& now) {
  bytes.replace(bytes.find(old), old.size(), now);
  return bytes;
}

TEST(ReadHdf5, ValuesComeBackToTheBit) {
  const std::string bytes = subject();
  const Hdf5File file(bytes);
  EXPECT_EQ(file.members("/TransformGroup"), std::vector<std::string>{"0"});
  EXPECT_EQ(file.text("/TransformGroup/0/TransformType"), "AffineTransform_double_3_3");
  EXPECT_EQ(file.numbers("/TransformGroup/0/TransformParameters"), (std::vector<double>{1, 0.1, -1.0 / 3.0}));
  EXPECT_FALSE(file.has("/TransformGroup/1"));
  EXPECT_FALSE(file.has("/TransformGroup/0/TransformParameter"));
}

TEST(ReadHdf5, AFileThatIsCutShortIsRefusedAtEachLength) {
  const std::string bytes = subject();
  for (std::size_t length = 0; length < bytes.size(); length += 7)
    EXPECT_FALSE(is_read(bytes.substr(0, length))) << length;
  EXPECT_TRUE(is_read(bytes));
}

TEST(ReadHdf5, GiantDimensionsAndWrongTypesAreRefusedByName) {
  const std::string bytes = subject(), path = "/TransformGroup/0/TransformParameters";
  const std::string dims("\x01\x01\0\0\0\0\0\0\x03\0\0\0\0\0\0\0", 16);
  EXPECT_NE(
      refusal(with(bytes, dims, std::string("\x01\x01\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff\xff\x7f", 16)),
              path)
          .find("more than a linear transform has"),
      std::string::npos);
  EXPECT_NE(refusal(with(bytes, dims, std::string("\x01\x02\0\0\0\0\0\0\x03\0\0\0\0\0\0\0", 16)), path)
                .find("2 dimensions"),
            std::string::npos);
  // More values than are stored.
  EXPECT_NE(refusal(with(bytes, dims, std::string("\x01\x01\0\0\0\0\0\0\x04\0\0\0\0\0\0\0", 16)), path)
                .find("fewer values than its header states"),
            std::string::npos);
  const std::string real("\x11\x20\x3f\0\x08\0\0\0", 8);
  EXPECT_NE(
      refusal(with(bytes, real, std::string("\x10\x08\0\0\x08\0\0\0", 8)), path).find("neither real numbers"),
      std::string::npos);
  EXPECT_NE(refusal(bytes, "/TransformGroup/0/TransformType").find("a text instead of numbers"),
            std::string::npos);
  EXPECT_NE(refusal(bytes, "/TransformGroup/0").find("not a row of values"), std::string::npos);
  EXPECT_NE(refusal(bytes, "/Nothing").find("has no /Nothing"), std::string::npos);
  EXPECT_NE(refusal("solid", "/").find("is no HDF5 file"), std::string::npos);
}

TEST(ReadHdf5, ATreeThatRefersToItselfEnds) {
  std::string bytes = subject();
  // Each node becomes one of level 1 whose child is itself.
  for (std::size_t at = bytes.find("TREE"); at != std::string::npos; at = bytes.find("TREE", at + 1)) {
    bytes[at + 5] = 1;
    for (std::size_t i = 0; i < 8; ++i) bytes[at + 32 + i] = static_cast<char>(at >> (8 * i) & 0xff);
  }
  EXPECT_FALSE(is_read(bytes));
}

TEST(ReadHdf5, DamagedBytesAreReadOrRefused) {
  const std::string bytes = subject();
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::mt19937 draw(static_cast<unsigned>(i));
    std::string spoiled = bytes;
    for (unsigned k = 0; k <= draw() % 5; ++k) {
      const std::size_t at = draw() % spoiled.size();
      for (std::size_t j = at; j < std::min(spoiled.size(), at + (draw() % 2 == 0 ? 1 : 8)); ++j)
        spoiled[j] = static_cast<char>(draw() % 3 == 0 ? 0xff : draw());
    }
    refused += is_read(spoiled) ? 0 : 1;
  }
  EXPECT_GT(refused, 100) << "the damage has to matter";
}

}  // namespace
}  // namespace octotomy::planner

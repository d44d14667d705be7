// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace octotomy::tests {

/// The rows of tables on a page of the manual that begin with `first`, in their order, without the tables'
/// heads.
inline std::vector<std::string> page_rows(const std::filesystem::path& page, const std::string& first) {
  std::vector<std::string> rows;
  std::ifstream file(page);
  bool was_row = false;
  for (std::string line; std::getline(file, line);) {
    if (was_row && line.starts_with("|-")) rows.pop_back();
    was_row = line.starts_with("| " + first);
    if (was_row) rows.push_back(line);
  }
  return rows;
}

/// Prints rows that a test has computed, and fails if the page of the manual does not contain the same rows.
inline void expect_on_page(const std::vector<std::string>& rows, const std::filesystem::path& page,
                           const std::string& first) {
  for (const std::string& row : rows) std::printf("%s\n", row.c_str());
  EXPECT_EQ(page_rows(page, first), rows) << page << ": put the rows that are printed above in its table";
}

}  // namespace octotomy::tests

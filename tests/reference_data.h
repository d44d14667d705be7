// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <gtest/gtest.h>

namespace octotomy::tests {

/// A file or folder of the reference data that lie beside the project in ../shared/data.
inline std::filesystem::path reference_data(const std::string& name) {
  return std::filesystem::path(OCTOTOMY_SOURCE_DIR) / "../shared/data" / name;
}

}  // namespace octotomy::tests

/// Skips the test with a line that says what is missing.
#define OCTOTOMY_NEEDS_DATA(name)                                      \
  if (!std::filesystem::exists(octotomy::tests::reference_data(name))) \
  GTEST_SKIP() << "reference data '" << (name) << "' is not in ../shared/data beside the project"

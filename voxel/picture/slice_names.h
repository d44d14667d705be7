// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::voxel {

/// The order of a stack's files by the numbers in their names, without folders and extensions:
/// - Numbers are compared as numbers: slice2 comes before slice10.
/// - A minus before a number is its sign if no letter or digit precedes it (z_-10), or if other files have a
///   plus or nothing in its place (z-10 and z10). Otherwise it is a separator (head-10, 2024-01-05).
/// - One dot within a number is a decimal point: 1.25 comes before 1.5. If the files have different counts of
///   digits after the dot, and a number with several such digits ends with 0, the dot is a separator: 1.10
///   comes after 1.9.
struct SliceNames {
  std::vector<std::filesystem::path> files;  ///< in the order of their numbers
  /// For each file the last number in its name; none if the name has no number, or one of more than nine
  /// digits.
  std::vector<std::optional<double>> number;
  std::vector<std::string> doubts;  ///< for each ambiguity in the names, the assumption made
};
/// Orders files by name. Names with equal numbers are ordered by their letters. Cost: n log n.
SliceNames ordered_by_name(const std::vector<std::filesystem::path>& files);

/// Lists the stacks of a folder, "ct_#.png (5 files) and mask_#.png (5 files)", if several files have the
/// same number but different letters. Empty if the names belong to a single stack.
std::string stacks_named(const std::vector<std::filesystem::path>& files);

/// A sentence that reports names with the same last number but different numbers before it ("s1_000" and
/// "s2_000"), which are several stacks in one folder or the blocks of one stack. Empty if no last number
/// occurs twice.
std::string numbered_alike(const SliceNames& names);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::voxel {

/// What the numbers in the names of a stack's files say, without their folders and extensions:
/// - Numbers are compared as numbers: slice2 comes before slice10.
/// - A minus before a number is its sign where no letter or digit stands before it (z_-10), or where other
///   files have a plus or nothing in its place (z-10 beside z10). Else it separates (head-10, 2024-01-05).
/// - One dot within a number is a decimal point: 1.25 comes before 1.5. Where the files have different counts
///   of digits behind it and one of several ends with 0, it separates: 1.10 comes behind 1.9.
struct SliceNames {
  std::vector<std::filesystem::path> files;   ///< in the order of their numbers
  std::vector<std::optional<double>> number;  ///< by file: the last in its name; of nine digits at most
  std::vector<std::string> doubts;            ///< where the names allow another order: what was assumed
};
/// Cost: n log n. Equal numbers are in the order of their names' letters.
SliceNames ordered_by_name(const std::vector<std::filesystem::path>& files);

/// The stacks of files whose names differ by more than numbers and have the same numbers: "ct_#.png (5 files)
/// and mask_#.png (5 files)". Empty where the names are those of one stack.
std::string stacks_named(const std::vector<std::filesystem::path>& files);

/// A sentence on names that have the same last numbers behind different numbers ("s1_000" and "s2_000"):
/// stacks in one folder, or the blocks of one stack. Empty where the last numbers are those of one stack.
std::string numbered_alike(const SliceNames& names);

}  // namespace octotomy::voxel

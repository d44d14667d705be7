// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

namespace octotomy::planner {

/// A group of an HDF5 file: texts, rows of numbers, and further groups, by their names.
struct Hdf5Group {
  using Member = std::variant<std::string, std::vector<double>, Hdf5Group>;
  std::map<std::string, Member> members;
};

/// The bytes of an HDF5 file in the oldest form, superblock 0, which every reader since 1998 reads. Numbers
/// are IEEE numbers of 8 bytes; texts have variable length, because ITK requires this. Equal groups give
/// equal bytes. Throws std::invalid_argument if a group has more than 8 members, all texts together have more
/// than 3 kB, or a row has no numbers. Source: HDF5 File Format Specification, version 3.0.
std::string hdf5_bytes(const Hdf5Group& root);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The contents of a pack, checked against its manifest.
struct PackContents {
  std::string plan;                 ///< the plan's text
  nlohmann::ordered_json manifest;  ///< as write_pack() returned it
  nlohmann::ordered_json result;    ///< result.json
};
/// Reads a pack. Throws voxel::Error (Input), which names the archive and the entry, if the file is no pack,
/// if an entry is missing or does not have the SHA-256 in the manifest, or if the format is not pack_format.
PackContents read_pack(const std::filesystem::path& path);

/// A value that differs between two packs.
struct DifferentValue {
  std::string where;             ///< "objects / maxilla / voxel / volume_mm3"
  std::string packed, replayed;  ///< as JSON; empty if the pack lacks the value
};
struct PackComparison {
  std::size_t values = 0;  ///< number of values in the packed result
  std::vector<DifferentValue> different_values;
  std::size_t entries = 0;  ///< number of entries in the packed archive
  std::vector<std::string> different_entries;
};
/// Compares a pack with the pack of a replay, value by value and entry by entry. Elements of lists are
/// matched by the first of "id", "object", "name" and "operation" that they have, or else by position.
PackComparison compare_packs(const PackContents& packed, const PackContents& replayed);

nlohmann::ordered_json to_json(const PackComparison& comparison);

}  // namespace octotomy::planner

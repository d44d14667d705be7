// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A pack's plan and results, read and checked against its own manifest.
struct PackContents {
  std::string plan;                 ///< the plan's text
  nlohmann::ordered_json manifest;  ///< as write_pack() returned it
  nlohmann::ordered_json result;    ///< result.json
};
/// Reads a pack. Throws voxel::Error (Input), which names the archive and the entry, if it is no pack, if an
/// entry is missing or does not have the stated SHA-256, or if its format is not pack_format.
PackContents read_pack(const std::filesystem::path& path);

/// A value that differs between two results.
struct DifferentValue {
  std::string where;             ///< "objects / maxilla / voxel / volume_mm3"
  std::string packed, replayed;  ///< as JSON; empty: the result has no such value
};
struct PackComparison {
  std::size_t values = 0;  ///< numbers, texts, truth values and nulls of the packed result
  std::vector<DifferentValue> different_values;
  std::size_t entries = 0;  ///< entries of the packed archive
  std::vector<std::string> different_entries;
};
/// Compares a pack with another of the same plan, value by value and entry by entry. Elements of a list are
/// matched by their "id", "object", "name" or "operation", the first that they have, else by their position.
PackComparison compare_packs(const PackContents& packed, const PackContents& replayed);

nlohmann::ordered_json to_json(const PackComparison& comparison);

}  // namespace octotomy::planner

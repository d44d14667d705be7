// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A list of objects as a table (RFC 4180): a column for each number, text or Boolean at any depth
/// ("mesh.volume_mm3"), in order of first occurrence. Lists of three numbers become x, y and z; other lists
/// are left out.
std::string csv_of(const nlohmann::ordered_json& rows);

/// The most severe verdict of the audits of a result's scans: "PASS", "WARN" or "FAIL"; empty if no scan was
/// read.
std::string gravest_scan_audit(const nlohmann::ordered_json& result);

/// A result's tables by their names in its folder: tables/measurements.csv, movements.csv, cephalometry.csv
/// and certificates.csv, if the result has rows for them. The measurements have a column `scan_audit` with
/// gravest_scan_audit(), because certificates cannot detect errors of the scan itself.
std::vector<std::pair<std::filesystem::path, std::string>> result_tables(
    const nlohmann::ordered_json& result);

}  // namespace octotomy::planner

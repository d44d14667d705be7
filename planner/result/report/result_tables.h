// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A list of objects as a table (RFC 4180): a column for each number, word or truth value at any depth,
/// "mesh.volume_mm3", in the order in which they first come; lists of three numbers are x, y and z. Other
/// lists are left out.
std::string csv_of(const nlohmann::ordered_json& rows);

/// The gravest verdict of the audits of a result's scans, "PASS", "WARN" or "FAIL"; empty where no scan was
/// read.
std::string gravest_scan_audit(const nlohmann::ordered_json& result);

/// A result's tables by their names in its folder: tables/measurements.csv, movements.csv, cephalometry.csv
/// and certificates.csv, as far as the result has rows for them. The measurements have a column `scan_audit`
/// of gravest_scan_audit(), as no certificate sees what was wrong with the scan itself.
std::vector<std::pair<std::filesystem::path, std::string>> result_tables(
    const nlohmann::ordered_json& result);

}  // namespace octotomy::planner

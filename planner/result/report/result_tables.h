// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A list of JSON objects as a CSV table (RFC 4180). Each number, text or truth value at any depth has a
/// column ("mesh.volume_mm3"), in the order in which they first occur. A list of three numbers has columns
/// for x, y and z. Other lists are left out.
std::string csv_of(const nlohmann::ordered_json& rows);

/// The most severe verdict in the audits of a result's scans: "PASS", "WARN" or "FAIL". Empty if no scan was
/// read.
std::string gravest_scan_audit(const nlohmann::ordered_json& result);

/// The tables of a result by their path in its folder: tables/measurements.csv, movements.csv,
/// cephalometry.csv and certificates.csv. A table without rows is left out. Measurements have a column
/// `scan_audit` with gravest_scan_audit(), because certificates cannot detect errors of the scan.
std::vector<std::pair<std::filesystem::path, std::string>> result_tables(
    const nlohmann::ordered_json& result);

}  // namespace octotomy::planner

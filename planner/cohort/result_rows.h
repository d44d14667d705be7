// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octotomy::planner {

/// A measured number of a subject.
struct ResultRow {
  std::string subject;
  std::string measurement;  ///< the step's name
  std::string object;
  std::string quantity;  ///< "volume"
  std::optional<double> value;
  std::string unit;                   ///< "mm3"
  std::optional<double> half_width;   ///< half-width of the interval, in the same unit
  std::optional<double> coverage;     ///< of the interval
  std::optional<double> voxel, mesh;  ///< the kernels' own answers
  std::string verdict;                ///< the most severe of its objects' certificates and `scan_audit`
  std::string version;                ///< of the program
  std::string plan;
  std::string plan_sha256;  ///< SHA-256 of the plan without its scans; the same for the whole cohort
  std::string scan_audit;   ///< the most severe verdict of all scans' audits; empty: no scan was read
};

/// The results of the audits of a result's scans.
struct ScanAudits {
  std::string gravest;                ///< "PASS", "WARN" or "FAIL"; empty: the result has no audit
  std::vector<std::string> findings;  ///< each WARN and FAIL: "FAIL, patient: ...", preceded by the scan's
                                      ///< name if there are several scans

  bool fails() const { return gravest == "FAIL"; }
};
/// The audits of a result.json. An audit without a FAIL or WARN has no finding.
ScanAudits scan_audits_of(const nlohmann::ordered_json& result);

/// The numbers of a result.json, in the order of the plan's measurements. No number's verdict is better than
/// the audits of the result's scans: certificates compare both kernels on the data that were read and cannot
/// detect data of another patient or half a scan. A number without a certificate has a verdict only if an
/// audit has a WARN or a FAIL.
std::vector<ResultRow> rows_of(const nlohmann::ordered_json& result, const std::string& subject);

/// SHA-256 of a plan's document without its scans.
std::string plan_sha256(const nlohmann::ordered_json& plan);

/// The long table: one row per subject and number.
std::string long_header();
std::string long_line(const ResultRow& row);
/// Reads the table that long_header() and long_line() make. Throws voxel::Error (Input) with the row's number.
std::vector<ResultRow> parse_long_table(std::string_view text);

}  // namespace octotomy::planner

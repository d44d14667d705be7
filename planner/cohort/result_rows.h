// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octotomy::planner {

/// A number that was measured on a subject: a row of the long table.
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
  std::string verdict;                ///< the most severe of `scan_audit` and the certificates of its objects
  std::string version;                ///< of the program
  std::string plan;
  std::string plan_sha256;  ///< SHA-256 of the plan without scans, equal for all subjects of a cohort
  std::string scan_audit;   ///< the most severe verdict of the scans' audits; empty if no scan was read
};

/// The verdicts and findings of the audits of a result's scans.
struct ScanAudits {
  std::string gravest;                ///< "PASS", "WARN" or "FAIL"; empty: the result has no audit
  std::vector<std::string> findings;  ///< each WARN and FAIL: "FAIL, patient: ...", preceded by the scan's
                                      ///< name if there are several scans

  bool fails() const { return gravest == "FAIL"; }
};
/// Reads the audits in a result.json.
ScanAudits scan_audits_of(const nlohmann::ordered_json& result);

/// The numbers in a result.json, in the order of the plan's measurements. The verdict of a number is at least
/// as severe as the audits of the scans: certificates compare the kernels on the samples that were read, so
/// they cannot detect the scan of another patient or half a scan. A number without a certificate has a
/// verdict only if an audit has a WARN or a FAIL.
std::vector<ResultRow> rows_of(const nlohmann::ordered_json& result, const std::string& subject);

/// SHA-256 of a plan's JSON without its scans.
std::string plan_sha256(const nlohmann::ordered_json& plan);

/// The long table: one row per subject and number.
std::string long_header();
std::string long_line(const ResultRow& row);
/// Reads a table of long_header() and lines of long_line(). Throws voxel::Error (Input) with the number of
/// the row that is invalid.
std::vector<ResultRow> parse_long_table(std::string_view text);

}  // namespace octotomy::planner

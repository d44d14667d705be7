// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/result_rows.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <set>

#include "planner/operation/table/csv.h"
#include "planner/operation/table/json.h"
#include "planner/plan/sha256.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

const std::vector<std::string> columns = {"subject", "measurement", "object",   "quantity",    "value",
                                          "unit",    "half_width",  "coverage", "voxel",       "mesh",
                                          "verdict", "octotomy",    "plan",     "plan_sha256", "scan_audit"};

constexpr std::array<const char*, 3> verdicts{"PASS", "WARN", "FAIL"};  ///< most severe last

/// The more severe of two verdicts. A text that is no verdict counts as less severe than PASS.
std::string graver(const std::string& a, const std::string& b) {
  const auto rank = [](const std::string& verdict) {
    const auto at = std::find(verdicts.begin(), verdicts.end(), verdict);
    return at == verdicts.end() ? -1 : static_cast<int>(at - verdicts.begin());
  };
  return rank(a) > rank(b) ? a : b;
}

std::string text_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<double> number_at(const Json& object, const std::string& key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

/// Splits a key such as "volume_mm3" into quantity and unit. None for a key without a unit, and for one that
/// describes another number, such as a half-width.
std::optional<std::pair<std::string, std::string>> quantity_and_unit(const std::string& key) {
  static constexpr std::array<const char*, 6> units{"mm3", "mm2", "mm", "degrees", "deg", "percent"};
  for (const char* tells : {"half_width", "difference", "tolerance"})
    if (key.find(tells) != std::string::npos) return std::nullopt;
  for (const std::string unit : units)
    if (key.size() > unit.size() + 1 && key.ends_with("_" + unit))
      return std::pair(key.substr(0, key.size() - unit.size() - 1), unit);
  return std::nullopt;
}

/// The most severe verdict of the certificates of all objects that a measurement names; empty if they have
/// none.
std::string verdict_of(const Json& measurement, const Json& result) {
  std::string gravest;
  const auto certificates = result.find("certificates");
  if (certificates == result.end()) return {};
  for (const char* key : {"object", "to", "a", "b"})
    for (const Json& certificate : *certificates) {
      const std::string name = text_at(measurement, key);
      if (name.empty() || text_at(certificate, "object") != name) continue;
      gravest = graver(text_at(certificate, "verdict"), gravest);
    }
  return gravest;
}

std::optional<double> kernel_answer(const Json& measurement, const char* kernel, const std::string& quantity,
                                    const std::string& unit) {
  const auto found = measurement.find(kernel);
  if (found == measurement.end() || !found->is_object()) return std::nullopt;
  return number_at(*found, quantity + "_" + unit);
}

/// The number under a key of a measurement, with its unit, half-width and both kernels' answers. None if the
/// key has no number.
std::optional<ResultRow> row_at(const Json& measurement, const std::string& key, const Json& value) {
  ResultRow row;
  if (value.is_object() && value.contains("value") && value.contains("unit")) {
    row.quantity = key;
    row.unit = text_at(value, "unit");
    row.value = number_at(value, "value");
    row.half_width = number_at(value, "half_width");
    row.coverage = number_at(value, "coverage");
    if (const auto flat = quantity_and_unit(key)) row.quantity = flat->first;
  } else if (const auto flat = quantity_and_unit(key); flat && (value.is_number() || value.is_null())) {
    std::tie(row.quantity, row.unit) = *flat;
    if (value.is_number()) row.value = value.get<double>();
    row.half_width = number_at(measurement, row.quantity + "_half_width_" + row.unit);
    if (row.half_width) row.coverage = 0.99;
  } else {
    return std::nullopt;
  }
  row.voxel = kernel_answer(measurement, "voxel", row.quantity, row.unit);
  row.mesh = kernel_answer(measurement, "mesh", row.quantity, row.unit);
  return row;
}

std::optional<double> number_of(const std::string& cell, std::size_t row) {
  if (cell.empty()) return std::nullopt;
  double number = 0.0;
  const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  if (read.ec != std::errc() || read.ptr != cell.data() + cell.size())
    throw voxel::Error(voxel::ErrorCode::Input,
                       "row " + std::to_string(row) + ": '" + cell + "' is no number");
  return number;
}

}  // namespace

std::string plan_sha256(const Json& plan) {
  Json document = plan;
  if (document.is_object()) document.erase("scans");
  return sha256_of(document.dump());
}

ScanAudits scan_audits_of(const Json& result) {
  ScanAudits audits;
  const auto scans = result.find("scans");
  if (scans == result.end() || !scans->is_array()) return audits;
  for (const Json& scan : *scans) {
    if (!scan.is_object() || !scan.contains("audit")) continue;
    for (const Json& line : scan["audit"]) {
      const std::string verdict = text_at(line, "verdict");
      audits.gravest = graver(verdict, audits.gravest);
      if (verdict != "WARN" && verdict != "FAIL") continue;
      audits.findings.push_back((scans->size() > 1 ? text_at(scan, "name") + ": " : "") + verdict + ", " +
                                text_at(line, "check") + ": " + text_at(line, "detail"));
    }
  }
  return audits;
}

std::vector<ResultRow> rows_of(const Json& result, const std::string& subject) {
  std::vector<ResultRow> rows;
  const Json plan = result.value("plan", Json::object());
  const std::string sha256 = plan_sha256(plan);
  const std::string audit = scan_audits_of(result).gravest;
  const auto measurements = result.find("measurements");
  if (measurements == result.end()) return rows;
  for (const Json& measurement : *measurements) {
    std::set<std::string> told;  // quantities already added; those with an interval come first
    std::vector<ResultRow> own;
    for (const bool with_interval : {true, false})
      for (const auto& [key, value] : measurement.items()) {
        if (value.is_object() != with_interval) continue;
        std::optional<ResultRow> row = row_at(measurement, key, value);
        if (row && told.insert(row->quantity).second) own.push_back(std::move(*row));
      }
    for (ResultRow& row : own) {
      row.subject = subject;
      row.measurement = text_at(measurement, "id");
      row.object = text_at(measurement, "object");
      row.verdict = verdict_of(measurement, result);
      row.scan_audit = audit;
      if (audit != "PASS") row.verdict = graver(row.verdict, audit);
      row.version = text_at(result, "octotomy");
      row.plan = text_at(plan, "name");
      row.plan_sha256 = sha256;
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::string long_header() {
  return csv_line(columns);
}

std::string long_line(const ResultRow& row) {
  return csv_line({row.subject, row.measurement, row.object, row.quantity, csv_number(row.value), row.unit,
                   csv_number(row.half_width), csv_number(row.coverage), csv_number(row.voxel),
                   csv_number(row.mesh), row.verdict, row.version, row.plan, row.plan_sha256,
                   row.scan_audit});
}

std::vector<ResultRow> parse_long_table(std::string_view text) {
  const auto table = parse_csv(text);
  std::vector<ResultRow> rows;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::vector<std::string>& cells = table[i];
    if (cells.size() != columns.size() || (i == 0 && cells != columns))
      throw voxel::Error(voxel::ErrorCode::Input,
                         "row " + std::to_string(i + 1) + " is not of this program's tables");
    if (i == 0) continue;
    rows.push_back({cells[0], cells[1], cells[2], cells[3], number_of(cells[4], i + 1), cells[5],
                    number_of(cells[6], i + 1), number_of(cells[7], i + 1), number_of(cells[8], i + 1),
                    number_of(cells[9], i + 1), cells[10], cells[11], cells[12], cells[13], cells[14]});
  }
  return rows;
}

}  // namespace octotomy::planner

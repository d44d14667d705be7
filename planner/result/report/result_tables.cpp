// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/result_tables.h"

#include <algorithm>
#include <map>

#include "planner/operation/table/csv.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/result/report/result_record.h"

namespace octotomy::planner {
namespace {

using Row = std::map<std::string, std::string>;

class Table {
 public:
  void add(const Json& object) {
    rows_.emplace_back();
    add_cells(object, "");
  }

  std::string text() const {
    std::string text = csv_line(columns_);
    for (const Row& row : rows_) {
      std::vector<std::string> cells;
      for (const std::string& column : columns_) {
        const auto found = row.find(column);
        cells.push_back(found == row.end() ? "" : found->second);
      }
      text += csv_line(cells);
    }
    return text;
  }

 private:
  void add_cells(const Json& value, const std::string& name) {
    if (value.is_object()) {
      for (const auto& [key, part] : value.items()) add_cells(part, name.empty() ? key : name + "." + key);
    } else if (is_point(value)) {
      for (std::size_t axis = 0; axis < 3; ++axis) add_cells(value[axis], name + "." + "xyz"[axis]);
    } else if (value.is_number()) {
      put(name, csv_number(value.get<double>()));
    } else if (value.is_string()) {
      put(name, value.get<std::string>());
    } else if (value.is_boolean()) {
      put(name, value.get<bool>() ? "true" : "false");
    }
  }
  static bool is_point(const Json& value) {
    return value.is_array() && value.size() == 3 &&
           std::all_of(value.begin(), value.end(), [](const Json& part) { return part.is_number(); });
  }
  void put(const std::string& column, std::string cell) {
    if (std::find(columns_.begin(), columns_.end(), column) == columns_.end()) columns_.push_back(column);
    rows_.back()[column] = std::move(cell);
  }

  std::vector<std::string> columns_;
  std::vector<Row> rows_;
};

/// Rows of the movement table: one for each piece's centroid and for each landmark on a piece.
Json movement_rows(const std::vector<ObjectMovement>& movements) {
  Json rows = Json::array();
  for (const ObjectMovement& moved : movements) {
    Json piece{{"object", moved.object}, {"point", "centroid"}};
    if (moved.centroid) piece.update(print_record(*moved.centroid));
    piece.update({{"pitch_deg", moved.pitch_deg}, {"yaw_deg", moved.yaw_deg}, {"roll_deg", moved.roll_deg}});
    rows.push_back(std::move(piece));
    for (const LandmarkMovement& landmark : moved.landmarks) {
      Json row{{"object", moved.object}, {"point", landmark.name}};
      row.update(print_record(landmark));
      row.erase("name");
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace

std::string csv_of(const Json& rows) {
  Table table;
  for (const Json& row : rows) table.add(row);
  return table.text();
}

std::string gravest_scan_audit(const Json& result) {
  static const std::vector<std::string> verdicts{"", "PASS", "WARN", "FAIL"};
  auto gravest = verdicts.begin();
  for (const ScanOfResult& scan : record_of<ResultRecord>(result).scans)
    for (const AuditLine& line : scan.audit)
      if (const auto found = std::find(verdicts.begin(), verdicts.end(), line.verdict);
          found != verdicts.end())
        gravest = std::max(gravest, found);
  return *gravest;
}

std::vector<std::pair<std::filesystem::path, std::string>> result_tables(const Json& result) {
  std::vector<std::pair<std::filesystem::path, std::string>> tables;
  const auto add = [&](const std::string& name, const Json& rows) {
    if (!rows.empty()) tables.emplace_back("tables/" + name + ".csv", csv_of(rows));
  };
  Json measurements = result.at("measurements");
  if (const std::string audit = gravest_scan_audit(result); !audit.empty())
    for (Json& row : measurements) row.update({{"scan_audit", audit}});
  add("measurements", measurements);
  const auto record = record_of<ResultRecord>(result);
  add("movements", movement_rows(record.movements));
  if (record.cephalometry) add("cephalometry", print_value(record.cephalometry->measures));
  add("certificates", result.at("certificates"));
  return tables;
}

}  // namespace octotomy::planner

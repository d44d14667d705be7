// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/csv.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "voxel/space/error.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

[[noreturn]] void refuse(std::size_t row, const std::string& why) {
  throw voxel::Error(voxel::ErrorCode::Input, "row " + std::to_string(row) + ": " + why);
}

}  // namespace

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) line += ',';
    if (cells[i].find_first_of(",\"\r\n") == std::string::npos) {
      line += cells[i];
      continue;
    }
    line += '"';
    for (const char symbol : cells[i]) line += symbol == '"' ? "\"\"" : std::string(1, symbol);
    line += '"';
  }
  return line + '\n';
}

std::string csv_number(const std::optional<double>& number) {
  if (!number) return {};
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), *number);
  return {text.data(), written.ptr};
}

std::vector<std::vector<std::string>> parse_csv(std::string_view text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row(1);
  const auto end_row = [&] {
    if (row.size() > 1 || !row.front().empty()) rows.push_back(std::move(row));
    row.assign(1, {});
  };
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // the byte-order mark of spreadsheets
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos)
    refuse(1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + zero, '\n')),
           "a byte 0, so it is no text or not UTF-8: save it as UTF-8");
  // Spreadsheets separate cells by semicolons if the decimal point of their locale is a comma.
  const std::string_view heading = text.substr(0, text.find_first_of("\r\n"));
  const bool has_semicolons =
      heading.find(',') == std::string_view::npos && heading.find(';') != std::string_view::npos;
  const char between = has_semicolons ? ';' : ',';
  std::size_t at = 0;
  while (at < text.size()) {
    const char symbol = text[at];
    if (symbol == between) {
      row.emplace_back();
      ++at;
    } else if (symbol == '\n' || symbol == '\r') {
      end_row();
      ++at;
    } else if (symbol == '"' && row.back().empty()) {
      std::string& cell = row.back();
      for (++at;; ++at) {
        if (at >= text.size())
          refuse(rows.size() + 1, "a quote is not closed: close it, or double quotes within a cell");
        if (text[at] != '"') {
          cell += text[at];
        } else if (at + 1 < text.size() && text[at + 1] == '"') {
          cell += text[at++];
        } else {
          break;
        }
      }
      ++at;
      if (at < text.size() && text[at] != between && text[at] != '\r' && text[at] != '\n')
        refuse(rows.size() + 1, "text follows a closed quote: double quotes within a cell");
    } else {
      row.back() += symbol;
      ++at;
    }
  }
  end_row();
  return rows;
}

std::vector<std::vector<std::string>> parse_tsv(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // the byte-order mark of spreadsheets
  if (text.find('\0') != std::string_view::npos)
    refuse(1, "a byte 0, so it is no text or not UTF-8: save it as UTF-8");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    const std::string_view line = text.substr(at, end - at);
    at = end + 1;
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    std::vector<std::string>& cells = rows.emplace_back();
    for (std::size_t from = 0; from <= line.size();) {
      const std::size_t to = std::min(line.find('\t', from), line.size());
      std::string cell = voxel::trimmed(std::string(line.substr(from, to - from)));
      if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
        cell = cell.substr(1, cell.size() - 2);
      cells.push_back(std::move(cell));
      from = to + 1;
    }
  }
  return rows;
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Tables as text: RFC 4180, UTF-8, with a line feed after each row.
namespace octotomy::planner {

/// A row as text. Cells with commas, quotes or line breaks are quoted.
std::string csv_line(const std::vector<std::string>& cells);

/// The shortest text from which the same number is read; empty if there is no number.
std::string csv_number(const std::optional<double>& number);

/// Reads all rows. Cells are separated by commas, or by semicolons if the first line has semicolons but no
/// commas. Line ends of any system are accepted, and blank lines are skipped. Throws voxel::Error (Input)
/// that states the row's number if a quote is not closed, text follows a closing quote, or there is a byte 0.
std::vector<std::vector<std::string>> parse_csv(std::string_view text);

/// Reads all rows of a table whose cells are separated by tabs, as in BIDS. Removes blanks at the ends of
/// cells, and quotes around a whole cell. Blank lines are skipped. Throws as parse_csv() for a byte 0.
std::vector<std::vector<std::string>> parse_tsv(std::string_view text);

}  // namespace octotomy::planner

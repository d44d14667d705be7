// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Tables as text: RFC 4180, UTF-8, a line feed after each row.
namespace octotomy::planner {

/// A row; cells with commas, quotes or line breaks are quoted.
std::string csv_line(const std::vector<std::string>& cells);

/// The shortest text that reads back to the same number; empty without a number.
std::string csv_number(const std::optional<double>& number);

/// All rows. Cells are separated by commas, or by semicolons if the first line has semicolons and no commas.
/// Line ends of any system are accepted; blank lines are skipped. Throws voxel::Error (Input) with the row's
/// number if a quote is not closed, text follows a closing quote, or there is a byte 0.
std::vector<std::vector<std::string>> parse_csv(std::string_view text);

/// All rows of a table whose cells are separated by tabs, as in BIDS. Removes blanks at the ends of cells and
/// quotes around a whole cell. Blank lines are skipped. Throws as parse_csv() for a byte 0.
std::vector<std::vector<std::string>> parse_tsv(std::string_view text);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Tables as text: RFC 4180, UTF-8, a line feed behind each row.
namespace octotomy::planner {

/// A row; cells with commas, quotes or line breaks are quoted.
std::string csv_line(const std::vector<std::string>& cells);

/// The shortest text that reads back to the same number; empty where there is none.
std::string csv_number(const std::optional<double>& number);

/// All rows. Cells are parted by commas, or by semicolons where the first line has these alone. Lines may end
/// as on any system; blank ones are passed over. Throws voxel::Error (Input) with the row's number where a
/// quote is not closed, text follows a closed one, or a byte 0 shows that it is no text.
std::vector<std::vector<std::string>> parse_csv(std::string_view text);

/// All rows of a table whose cells tabs part, as BIDS has them: without blanks at cells' ends and quotes
/// about a whole cell. Blank lines are passed over. Throws as parse_csv() of a byte 0.
std::vector<std::vector<std::string>> parse_tsv(std::string_view text);

}  // namespace octotomy::planner

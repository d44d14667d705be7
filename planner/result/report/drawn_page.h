// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "planner/operation/table/json.h"

// Pages that draw their data: one HTML file with styles, data as JSON, and the script of planner/result/page,
// which makes tables and pictures of them. It needs no network.
namespace octotomy::planner {

/// `data` has a `kind`, by which the script chooses what it draws. The page's content policy allows that
/// script alone. Without a script the page shows the title and `where_else`, which names the files that hold
/// the same numbers. Neither title nor data can become markup.
std::string drawn_page(const std::string& title, const Json& data, const std::string& where_else);

/// The script and the styles. Generated from planner/result/page when the program is built.
std::string_view page_script();
std::string_view page_style();
/// The source expression that allows the script in a content policy: "'sha256-...'".
std::string page_script_source();

/// Text with HTML's special characters escaped.
std::string escaped(std::string_view text);
std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace octotomy::planner

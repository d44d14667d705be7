// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "planner/operation/table/json.h"

// Pages that draw their data: an HTML file with styles, the data as JSON, and the script of
// planner/result/page, which draws tables and pictures. A page needs no network.
namespace octotomy::planner {

/// A page with this title. The script chooses by data["kind"] what it draws. The page's content security
/// policy allows no other script. If scripts do not run, the page shows the title and `where_else`, which
/// names files with the same numbers. Title and data are escaped, so that they cannot become markup.
std::string drawn_page(const std::string& title, const Json& data, const std::string& where_else);

/// The script and the styles, generated from planner/result/page when the program is built.
std::string_view page_script();
std::string_view page_style();
/// The source expression "'sha256-...'" with which a content security policy allows the script.
std::string page_script_source();

/// A text in which HTML's special characters are escaped.
std::string escaped(std::string_view text);
std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace octotomy::planner

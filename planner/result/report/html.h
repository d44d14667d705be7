// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "planner/result/report/report.h"

// The building stones of the program's HTML pages, which need nothing else: no script, no network.
namespace octotomy::planner {

/// A whole page with the house's styles, to be read on a screen and printed on A4. The title is escaped.
std::string html_page(const std::string& title, const std::string& body);

/// Text with what HTML reads as marks written out.
std::string escaped(std::string_view text);
std::string base64(const std::vector<std::uint8_t>& bytes);

/// <tag attributes>inside</tag>; neither is escaped.
std::string element(const std::string& tag, const std::string& inside);
/// Cells of a table: text, and numbers on the right. Not escaped.
std::string cell(const std::string& text);
std::string figure_cell(const std::string& text);
/// Lines as a list, escaped; nothing where there are none.
std::string list(const std::vector<std::string>& lines);
/// Two decimals.
std::string fixed(double value);
/// "1 step", "2 steps".
std::string plural(int count, const std::string& one);

/// The class that colours a verdict.
std::string css_class(voxel::Verdict verdict);
/// A verdict as a coloured label.
std::string pill(const std::string& css, const std::string& text);
std::string pill(voxel::Verdict verdict);
/// "PASS, not resolved" in grey: a certificate's, with what is not resolved marked.
std::string pill(voxel::Verdict verdict, bool resolved);
/// A bar as long as a value's share of what is allowed.
std::string gauge(double value, double allowed, voxel::Verdict verdict);
/// The colours of signed distances up to that one, with their ends named.
std::string colour_scale(double most_mm);
/// A sentence and the counts on the whole of the certificates; nothing where there are none.
std::string overall_verdict(const VerdictCounts& counts);

}  // namespace octotomy::planner

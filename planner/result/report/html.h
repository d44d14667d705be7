// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "planner/result/report/report.h"

// Building blocks of the program's HTML pages, which need neither scripts nor a network.
namespace octotomy::planner {

/// A whole page with the program's styles, for screens and for printing on A4. The title is escaped.
std::string html_page(const std::string& title, const std::string& body);

/// Text with HTML's special characters escaped.
std::string escaped(std::string_view text);
std::string base64(const std::vector<std::uint8_t>& bytes);

/// <tag attributes>inside</tag>; neither attributes nor content is escaped.
std::string element(const std::string& tag, const std::string& inside);
/// Cells of a table: text, and right-aligned numbers. Not escaped.
std::string cell(const std::string& text);
std::string figure_cell(const std::string& text);
/// Lines as a list, escaped; empty if there are none.
std::string list(const std::vector<std::string>& lines);
/// A number with two decimals.
std::string fixed(double value);
/// "1 step", "2 steps".
std::string plural(int count, const std::string& one);

/// The class that colours a verdict.
std::string css_class(voxel::Verdict verdict);
/// A verdict as a coloured label.
std::string pill(const std::string& css, const std::string& text);
std::string pill(voxel::Verdict verdict);
/// The label of a certificate's verdict; if its object is not resolved, "PASS, not resolved" in grey.
std::string pill(voxel::Verdict verdict, bool resolved);
/// A bar whose length is a value's share of the allowed one.
std::string gauge(double value, double allowed, voxel::Verdict verdict);
/// The colour scale of signed distances up to `most_mm`, with labels at its ends.
std::string colour_scale(double most_mm);
/// A sentence on all certificates and their counts; empty if there are none.
std::string overall_verdict(const VerdictCounts& counts);

}  // namespace octotomy::planner

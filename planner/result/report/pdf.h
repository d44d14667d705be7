// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <stop_token>
#include <string_view>

namespace octotomy::planner {

/// The line after the end of a PDF whose pages were made without names (leave_out_names()).
inline constexpr std::string_view anonymous_pdf_mark = "%octotomy: names nobody\n";

/// Throws std::runtime_error, naming the program to install, if no Chromium is on the PATH.
void need_pdf_printer();

/// Prints a page of this program, which needs no network, as an A4 PDF with Chromium, in a process of its own that a
/// stop ends. Chromium runs the script that draws the page. Throws as need_pdf_printer() does; voxel::Error
/// (Resource) if the program fails; Stopped. Cost: seconds.
void print_pdf(const std::filesystem::path& page, const std::filesystem::path& pdf,
               const std::stop_token& stop = {});

}  // namespace octotomy::planner

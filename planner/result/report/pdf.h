// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <stop_token>
#include <string_view>

namespace octotomy::planner {

/// A line that is appended to a PDF whose pages name nobody (leave_out_names()).
inline constexpr std::string_view anonymous_pdf_mark = "%octotomy: names nobody\n";

/// Throws std::runtime_error, which names the program to install, if there is no Chromium on the PATH.
void need_pdf_printer();

/// Prints a page of this program as an A4 PDF. Chromium does this in another process, which a stop ends; it
/// runs the script that draws the page, and needs no network. Throws as need_pdf_printer() does; voxel::Error
/// (Resource) if Chromium fails; Stopped. Cost: some seconds.
void print_pdf(const std::filesystem::path& page, const std::filesystem::path& pdf,
               const std::stop_token& stop = {});

}  // namespace octotomy::planner

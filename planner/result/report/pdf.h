// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <stop_token>

namespace octotomy::planner {

/// Throws std::runtime_error, with what to install, where no program that prints pages is on the PATH:
/// WeasyPrint or Chromium.
void need_pdf_printer();

/// Prints a page of ours, which needs no network, as an A4 PDF by the first of those programs, in a process
/// of its own that a stop ends. Throws as need_pdf_printer(); voxel::Error (Resource) where the program
/// fails; Stopped. Cost: seconds.
void print_pdf(const std::filesystem::path& page, const std::filesystem::path& pdf,
               const std::stop_token& stop = {});

}  // namespace octotomy::planner

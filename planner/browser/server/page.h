// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

namespace octotomy::planner::serve {

/// A file of the page, which the program contains.
struct PageFile {
  std::string_view path;  ///< "/app.js"
  std::string_view type;  ///< its media type
  std::string_view bytes;
};

/// The files of the page, generated from planner/browser/page when the program is built. "/index.html" is the
/// page itself.
const std::vector<PageFile>& page_files();

}  // namespace octotomy::planner::serve

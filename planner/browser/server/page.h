// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

namespace octotomy::planner::serve {

/// A file of the page, embedded in the program.
struct PageFile {
  std::string_view path;  ///< "/app.js"
  std::string_view type;  ///< its media type
  std::string_view bytes;
};

/// Generated from planner/browser/page when the program is built; "/index.html" is the page itself.
const std::vector<PageFile>& page_files();

}  // namespace octotomy::planner::serve

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <string>

#include "planner/operation/table/json.h"

namespace octotomy::tests {

/// The data of a page that drawn_page() made.
inline planner::Json page_data(const std::string& page) {
  const std::string begin = "id=\"data\">";
  const std::size_t from = page.find(begin), to = page.find("</script>", from);
  EXPECT_NE(from, std::string::npos);
  return planner::Json::parse(page.substr(from + begin.size(), to - from - begin.size()));
}

}  // namespace octotomy::tests

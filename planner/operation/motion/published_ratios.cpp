// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/motion/published_ratios.h"

#include <algorithm>

#include "planner/operation/table/record.h"

namespace octotomy::planner {

/// Names and texts of the tables in this folder. CMake writes this list.
const std::vector<std::pair<std::string, std::string>>& ratios_files();

namespace {

struct RatioTable {
  std::vector<PublishedRatio> ratios;
};
constexpr auto members_of(const RatioTable&) {
  return std::tuple(member("ratios", &RatioTable::ratios));
}

}  // namespace

constexpr auto members_of(const PublishedRatio&) {
  using R = PublishedRatio;
  return std::tuple(member("soft", &R::soft), member("bone", &R::bone), member("ratio", &R::ratio),
                    member("deviation", &R::deviation), member("source", &R::source));
}

const std::vector<PublishedRatio>& published_ratios() {
  static const std::vector<PublishedRatio> all = [] {
    std::vector<PublishedRatio> made;
    for (const auto& [file, text] : ratios_files())
      for (const PublishedRatio& one : record_of<RatioTable>(Json::parse(text)).ratios) made.push_back(one);
    return made;
  }();
  return all;
}

std::optional<PublishedRatio> published_ratio(const std::string& soft, const std::string& bone) {
  const auto& all = published_ratios();
  const auto found = std::find_if(all.begin(), all.end(), [&](const PublishedRatio& one) {
    return one.soft == soft && one.bone == bone;
  });
  return found == all.end() ? std::nullopt : std::optional(*found);
}

std::string published_pairs() {
  std::string text;
  for (const PublishedRatio& one : published_ratios())
    text += (text.empty() ? "" : ", ") + one.soft + " with " + one.bone;
  return text;
}

}  // namespace octotomy::planner

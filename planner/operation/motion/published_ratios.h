// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A published ratio: the share of a bone landmark's motion with which a landmark of the skin moves.
struct PublishedRatio {
  std::string soft, bone;  ///< names as in the cephalometric definitions
  double ratio = 0.0;
  double deviation = 0.0;  ///< standard deviation: about half the spread between studies
  std::string source;      ///< author and year
};

/// The ratios in the files *.ratios.json of this folder, in the files' order.
const std::vector<PublishedRatio>& published_ratios();
/// The published ratio for this pair of landmarks; none if there is none.
std::optional<PublishedRatio> published_ratio(const std::string& soft, const std::string& bone);
/// A list of all pairs: "pronasale with ans, subnasale with ans, ...".
std::string published_pairs();

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The published share of a bone landmark's motion with which a landmark of the skin moves.
struct PublishedRatio {
  std::string soft, bone;  ///< names as in the cephalometric definitions
  double ratio = 0.0;
  double deviation = 0.0;  ///< standard deviation: about half the spread between studies
  std::string source;      ///< author and year
};

/// The ratios of the *.ratios.json of this folder, in their order.
const std::vector<PublishedRatio>& published_ratios();
/// None if there is no ratio for this pair of landmarks.
std::optional<PublishedRatio> published_ratio(const std::string& soft, const std::string& bone);
/// "pronasale with ans, subnasale with ans, ...".
std::string published_pairs();

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace octotomy::verify {

/// A value that the thesis prints, and the recomputed one.
struct ThesisEntry {
  std::string where;    ///< "table 3.1, sphere"
  std::string item;     ///< "level 4, Partial"
  std::string printed;  ///< as printed; numbers without blanks and commas
  std::string ours;
  std::string note = {};  ///< how the printed value was read, if that is not obvious

  bool agrees() const { return printed == ours; }
};

/// A printed value that is not recomputed, and why.
struct ThesisGap {
  std::string where;
  std::string why;
};

/// Recomputes those tables and worked examples of the thesis whose inputs it prints: figure 3.1's object in
/// every representation, the sphere of table 3.1, the octal codes of figure 4.6, the children of table 4.3,
/// the shading cases of table 5.1, the Boolean rules of table 7.1, and the motions of marked points of
/// section 8.3. Cost: about a second, most of it for the sphere's fractions.
std::vector<ThesisEntry> thesis_tables();
const std::vector<ThesisGap>& thesis_gaps();

}  // namespace octotomy::verify

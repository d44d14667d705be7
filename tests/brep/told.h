// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "brep/mesh/health.h"

namespace octotomy::tests {

/// Findings in one line, for the output of a failed test.
inline std::string told(const std::vector<std::string>& findings) {
  std::string text;
  for (const std::string& finding : findings) text += finding + "; ";
  return text;
}
inline std::string told(const brep::Health& health) {
  return told(health.findings);
}

}  // namespace octotomy::tests

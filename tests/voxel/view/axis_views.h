// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>

namespace octotomy::tests {

/// The views along the axes of LPS.
inline constexpr std::array<const char*, 6> axis_views{"anterior", "posterior", "left",
                                                       "right",    "superior",  "inferior"};

}  // namespace octotomy::tests

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace octotomy::voxel {

/// A window in Hounsfield units by the name of what it holds. Windows of neighbouring tissues touch or
/// overlap: a first guess to look at, not a diagnosis. They are of CT; cone-beam scanners' units stray from
/// Hounsfield's by hundreds.
struct Tissue {
  std::string_view name;
  std::optional<double> low;   ///< none: all below `high`
  std::optional<double> high;  ///< none: all from `low` on
  std::string_view source;     ///< where the bounds come from
};

/// bone, cortical_bone, trabecular_bone, teeth, soft_tissue, fat, skin and air.
std::span<const Tissue> tissues();

/// The tissue of that name; none where there is no such.
std::optional<Tissue> tissue(std::string_view name);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// A named window of CT in Hounsfield units. Windows of neighbouring tissues touch or overlap. They are a
/// first guess: samples of cone-beam scanners differ from Hounsfield units by hundreds.
struct Tissue {
  std::string_view name;
  std::optional<double> low;   ///< none: every sample up to `high`
  std::optional<double> high;  ///< none: every sample from `low` on
  std::string_view source;     ///< of the bounds
};

/// bone, cortical_bone, trabecular_bone, teeth, soft_tissue, fat, skin and air.
std::span<const Tissue> tissues();

/// The tissue of that name; none if the name is unknown.
std::optional<Tissue> tissue(std::string_view name);

/// Name and bounds for display: "bone (from 300 HU)", "fat (-190 to -30 HU)".
std::string described(const Tissue& tissue);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "voxel/solid/expression.h"
#include "voxel/space/scene.h"

namespace octotomy::planner {

/// A range of samples, both bounds included, in the scan's unit.
struct SampleWindow {
  double low = 0.0;
  std::optional<double> high = {};  ///< none: no upper limit
  std::string tissue = {};          ///< the tissue whose window this is; its bounds are in Hounsfield units

  double high_or_infinity() const { return high.value_or(std::numeric_limits<double>::infinity()); }
};

/// Reads LOW:HIGH or LOW:, or a tissue's name (voxel/filter/tissue.h). Throws std::runtime_error that states
/// an example or the nearest tissue.
SampleWindow parse_sample_window(const std::string& text);

/// The text from which parse_sample_window() reads the same window, such as "300:1500" or "bone".
std::string to_string(const SampleWindow& window);

/// The window on an octree's samples, as a part of expressions.
voxel::Window window_on(const voxel::GreyOctree& grey, const SampleWindow& window);

/// Throws std::runtime_error if the window is a tissue's and the samples are not in Hounsfield units.
void need_hounsfield(const SampleWindow& window, const voxel::Scene& scene);

}  // namespace octotomy::planner

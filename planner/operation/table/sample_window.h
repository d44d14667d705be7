// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "voxel/solid/expression.h"
#include "voxel/space/scene.h"

namespace octotomy::planner {

/// Samples from one value to another, in the scan's unit.
struct SampleWindow {
  double low = 0.0;
  std::optional<double> high = {};  ///< none: no upper limit
  std::string tissue = {};          ///< the tissue that defined the bounds, which are then Hounsfield units

  double high_or_infinity() const { return high.value_or(std::numeric_limits<double>::infinity()); }
};

/// Reads LOW:HIGH or LOW:, or a tissue's name (voxel/filter/tissue.h). Throws std::runtime_error with an
/// example or the nearest tissue.
SampleWindow parse_sample_window(const std::string& text);

/// The text from which parse_sample_window() returns the same window: "300:1500", "bone".
std::string to_string(const SampleWindow& window);

/// The window as a leaf of expressions.
voxel::Window window_on(const voxel::GreyOctree& grey, const SampleWindow& window);

/// Throws std::runtime_error if the window is that of a tissue and the samples are not Hounsfield units.
void need_hounsfield(const SampleWindow& window, const voxel::Scene& scene);

}  // namespace octotomy::planner

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
  std::string tissue = {};          ///< the name that gave the bounds, which are Hounsfield units then

  double high_or_infinity() const { return high.value_or(std::numeric_limits<double>::infinity()); }
};

/// Reads LOW:HIGH, LOW: or LOW, or a tissue's name (voxel/filter/tissue.h). Throws std::runtime_error with an
/// example or the nearest tissue.
SampleWindow parse_sample_window(const std::string& text);

/// The text that parse_sample_window() reads back: "300:1500", "bone".
std::string to_string(const SampleWindow& window);

/// The window as a leaf of expressions.
voxel::Window window_on(const voxel::GreyOctree& grey, const SampleWindow& window);

/// Throws std::runtime_error where the window is a tissue's and the samples are no Hounsfield units.
void need_hounsfield(const SampleWindow& window, const voxel::Scene& scene);

}  // namespace octotomy::planner

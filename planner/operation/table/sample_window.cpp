// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/sample_window.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "planner/operation/table/comma_numbers.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/number_format.h"
#include "voxel/filter/tissue.h"

namespace octotomy::planner {
namespace {

std::vector<std::string> tissue_names() {
  std::vector<std::string> names;
  for (const voxel::Tissue& tissue : voxel::tissues()) names.emplace_back(tissue.name);
  return names;
}

}  // namespace

SampleWindow parse_sample_window(const std::string& text) {
  if (const std::optional<voxel::Tissue> tissue = voxel::tissue(text)) {
    // Below any sample: the lower bound of a window that states none.
    constexpr double lowest = std::numeric_limits<std::int16_t>::min();
    return {tissue->low.value_or(lowest), tissue->high, text};
  }
  const auto colon = text.find(':');
  const std::string high = colon == std::string::npos ? "" : text.substr(colon + 1);
  const std::optional<double> low_value = number_in(text.substr(0, colon)), high_value = number_in(high);
  if (colon == std::string::npos || !low_value || (!high.empty() && !high_value))
    throw std::runtime_error("'" + text + "' is no window: give LOW:HIGH or LOW:, for example 300:3000, " +
                             "or a tissue" + suggestion(text, tissue_names()));
  if (high_value && *high_value < *low_value)
    throw std::runtime_error("'" + text + "' ends before it begins: exchange LOW and HIGH");
  return {*low_value, high_value};
}

std::string to_string(const SampleWindow& window) {
  if (!window.tissue.empty()) return window.tissue;
  return plain(window.low) + ":" + (window.high ? plain(*window.high) : "");
}

voxel::Window window_on(const voxel::GreyOctree& grey, const SampleWindow& window) {
  return voxel::window_of(grey, window.low, window.high);
}

void need_hounsfield(const SampleWindow& window, const voxel::Scene& scene) {
  if (window.tissue.empty() || scene.meaning == voxel::Meaning::Hounsfield) return;
  throw std::runtime_error(scene.source + ": '" + window.tissue +
                           "' is a window in Hounsfield units, but the samples are in another unit: write "
                           "LOW:HIGH; octotomy segment --otsu suggests bounds");
}

}  // namespace octotomy::planner

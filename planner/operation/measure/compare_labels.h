// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// Whether a file contains samples, by its extension: a label map or segmentation, not a surface.
bool is_label_map(const std::filesystem::path& path);

/// Compares the labels of two label maps, paired by name if both maps have names, else by number
/// (contradictions are findings): volumes, Dice, and distances, point to triangle, between surfaces half way
/// between samples. Maps of different lattices are compared at the first one's samples, extended over both.
/// Refuses maps that state different patients, studies or frames of reference unless `other_identity`. Throws
/// std::runtime_error if a scene is not a label map or two labels share a name. Cost: that of
/// brep::difference() per label.
FileAnswer compare_label_maps(const std::filesystem::path& a, const std::filesystem::path& b,
                              bool other_identity, const FileBench& bench);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// Whether a file holds samples, by its extension: a label map or segmentation, and no surface.
bool is_label_map(const std::filesystem::path& path);

/// Holds the labels of two label maps against each other, by name where both maps have names, else by number
/// (findings say where these contradict): volumes, Dice, and distances of
/// the surfaces that lie half-way between samples, point to triangle. Maps of different lattices are compared
/// at the first one's samples, continued over both. Refuses maps that state different patients, studies or
/// frames of reference unless `other_identity`. Throws std::runtime_error where a scene is no label map or
/// two labels share a name. Cost: that of brep::difference() a label.
FileAnswer compare_label_maps(const std::filesystem::path& a, const std::filesystem::path& b,
                              bool other_identity, const FileBench& bench);

}  // namespace octotomy::planner

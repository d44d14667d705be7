// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// Whether a file has the extension of a volume, such as a label map or segmentation, and not of a surface.
bool is_label_map(const std::filesystem::path& path);

/// Compares the labels of two label maps: volumes, Dice, and distances, point to triangle, between surfaces
/// half-way between samples. Labels are paired by name if both maps have names, else by number;
/// contradictions are findings. Maps with different lattices are compared at the samples of the first,
/// extended over both. Throws std::runtime_error if a file is not a label map, if two labels of a map have
/// the same name, or if the maps state different patients, studies or frames of reference and
/// `other_identity` is false. Cost: that of brep::difference() for each label.
FileAnswer compare_label_maps(const std::filesystem::path& a, const std::filesystem::path& b,
                              bool other_identity, const FileBench& bench);

}  // namespace octotomy::planner

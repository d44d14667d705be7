// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace octotomy::voxel {

/// The folder of the running program, beside which lie what it loads and starts on demand.
std::filesystem::path program_folder();

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/program_folder.h"

namespace octotomy::voxel {

std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/helper_file.h"

#include <cstdlib>
#include <system_error>
#include <vector>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

fs::path& chosen_folder() {
  static fs::path folder;
  return folder;
}

std::vector<fs::path> folders() {
  if (!chosen_folder().empty()) return {chosen_folder()};
  const char* named = std::getenv("OCTOTOMY_HELPERS");
  if (named != nullptr && *named != '\0') return {named};
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  return {program, (program / OCTOTOMY_HELPERS_FROM_PROGRAM).lexically_normal(), OCTOTOMY_HELPERS_INSTALLED,
          "/usr/libexec/octotomy"};  // the Debian package's
}

}  // namespace

void set_helper_folder(const fs::path& folder) {
  chosen_folder() = folder;
}

fs::path helper_file(const std::string& name) {
  std::string places;
  std::error_code ignored;
  for (const fs::path& folder : folders()) {
    if (fs::exists(folder / name, ignored)) return folder / name;
    places += (places.empty() ? "" : ", ") + folder.string();
  }
  throw Error(ErrorCode::Resource, name + " is missing in " + places +
                                       ": set OCTOTOMY_HELPERS to the folder that holds it, or install it");
}

}  // namespace octotomy::voxel

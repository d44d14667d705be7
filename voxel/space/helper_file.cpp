// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/helper_file.h"

#include <cstdlib>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
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

/// Throws if another user could have put the file there or everyone may change it. The owner of the running
/// program is trusted, because that program already runs.
void need_trusted(const fs::path& file) {
  struct stat program {};
  const bool is_known = ::stat("/proc/self/exe", &program) == 0;
  for (const fs::path& path : {fs::canonical(file), fs::canonical(file).parent_path()}) {
    struct stat found {};
    if (::stat(path.c_str(), &found) != 0) continue;
    const bool is_ours =
        found.st_uid == 0 || found.st_uid == ::geteuid() || (is_known && found.st_uid == program.st_uid);
    if (!is_ours || (found.st_mode & S_IWOTH) != 0)
      throw Error(ErrorCode::Resource, path.string() +
                                           ": others may write there, so it is not started: remove that "
                                           "permission, or install Octotomy again");
  }
}

}  // namespace

void set_helper_folder(const fs::path& folder) {
  chosen_folder() = folder;
}

fs::path helper_file(const std::string& name) {
  std::string places;
  std::error_code ignored;
  for (const fs::path& folder : folders()) {
    if (fs::exists(folder / name, ignored)) {
      need_trusted(folder / name);
      return folder / name;
    }
    places += (places.empty() ? "" : ", ") + folder.string();
  }
  throw Error(ErrorCode::Resource,
              name + " is missing in " + places +
                  ": set OCTOTOMY_HELPERS to the folder that contains it, or install it");
}

}  // namespace octotomy::voxel

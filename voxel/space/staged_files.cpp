// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/staged_files.h"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <vector>

#include "voxel/space/error.h"

namespace octotomy::voxel {

namespace fs = std::filesystem;

StagedFiles::StagedFiles(const fs::path& destination)
    : destination_(destination.empty() ? "." : destination) {
  std::string name = (destination_ / ".octotomy-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw Error(code_of_errno(errno),
                destination_.string() + ": cannot be written to: " + std::generic_category().message(errno) +
                    "; choose a folder that exists and is yours");
  folder_ = name;
}

StagedFiles::~StagedFiles() {
  std::error_code ignored;  // what is left over is hidden and harmless
  fs::remove_all(folder_, ignored);
}

void StagedFiles::commit(const fs::path& last) {
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    if (entry.path().filename() != last) names.push_back(entry.path().filename());
  if (!last.empty()) names.push_back(last);
  for (const fs::path& name : names) {
    std::error_code error;
    fs::rename(folder_ / name, destination_ / name, error);
    if (error)
      throw Error(code_of_errno(error.value()),
                  (destination_ / name).string() + ": cannot be written: " + error.message());
  }
}

}  // namespace octotomy::voxel

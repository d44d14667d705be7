// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/staging.h"

#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace octotomy::voxel {

namespace fs = std::filesystem;

Staging::Staging(const fs::path& destination) : destination_(destination.empty() ? "." : destination) {
  std::string name = (destination_ / ".octotomy-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw std::runtime_error(destination_.string() +
                             ": cannot be written to: " + std::generic_category().message(errno) +
                             "; choose a folder that exists and is yours");
  folder_ = name;
}

Staging::~Staging() {
  std::error_code ignored;  // what is left over is hidden and harmless
  fs::remove_all(folder_, ignored);
}

void Staging::commit(const fs::path& last) {
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    if (entry.path().filename() != last) names.push_back(entry.path().filename());
  if (!last.empty()) names.push_back(last);
  for (const fs::path& name : names) {
    std::error_code error;
    fs::rename(folder_ / name, destination_ / name, error);
    if (error)
      throw std::runtime_error((destination_ / name).string() + ": cannot be written: " + error.message());
  }
}

}  // namespace octotomy::voxel

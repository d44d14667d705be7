// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/workspace.h"

#include <limits>
#include <unistd.h>

#include "brep/io/write_mesh.h"
#include "convert/surface/isosurface.h"
#include "tests/bench/subjects.h"

namespace octotomy::bench {

const std::filesystem::path& workspace() {
  struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("octotomy-bench-" + std::to_string(::getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

std::filesystem::path bone_file(const std::string& extension) {
  std::filesystem::path path = workspace() / ("bone" + extension);
  if (!std::filesystem::exists(path))
    brep::write_mesh(convert::isosurface(grey_skull(256), 300.0, std::numeric_limits<double>::infinity()),
                     path);
  return path;
}

}  // namespace octotomy::bench

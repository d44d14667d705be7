// SPDX-License-Identifier: AGPL-3.0-or-later
// Any content is an octree in a chosen representation or is refused with std::invalid_argument; what is read
// is written and read again as the same octree.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "planner/operation/file/representation.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  static const std::vector<std::string> names = octotomy::planner::representation_names();
  const std::string& name = names[data[0] % names.size()];
  const octotomy::voxel::Universe universe{2 + data[1] % 4, glm::dmat4(1.0)};
  const std::string content(reinterpret_cast<const char*>(data + 2), size - 2);
  try {
    const octotomy::voxel::Octree octree =
        octotomy::planner::octree_of_representation(universe, name, content);
    const std::string written = octotomy::planner::represented({octree}, name);
    if (!(octotomy::planner::octree_of_representation(universe, name, written) == octree)) std::abort();
  } catch (const std::invalid_argument&) {
    return 0;
  }
  return 0;
}

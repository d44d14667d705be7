// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace octotomy::bench {

/// The folder of all files that benchmarks write; removed at the end.
const std::filesystem::path& workspace();

/// The phantom's bone as a surface file of an extension such as ".stl": 667,716 triangles, written at the
/// first call.
std::filesystem::path bone_file(const std::string& extension);

}  // namespace octotomy::bench

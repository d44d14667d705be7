// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace octotomy::planner {

/// The versions of the libraries that the program uses, by name: for a shared library that of the loaded
/// file, for others that at build time.
nlohmann::ordered_json library_versions();

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The bytes of a .npy file (NumPy's format 1.0) with a two-dimensional array of little-endian doubles.
/// Precondition: the number of values is a multiple of `columns`.
std::string numpy_array(const std::vector<double>& values, std::size_t columns);
std::string numpy_array(const std::vector<std::int32_t>& values, std::size_t columns);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace octotomy::voxel {

/// Inflates a raw deflate stream (RFC 1951, without a header). Throws std::runtime_error with the reason,
/// without a path, where it is damaged or cut short. Memory: what it holds, at most 1032 times its bytes.
std::string inflate_raw(std::string_view deflated);

/// Inflates a gzip stream, or several one after the other. Throws likewise.
std::string inflate_gzip(std::string_view deflated);

}  // namespace octotomy::voxel

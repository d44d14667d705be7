// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace octotomy::voxel {

/// Inflates a raw deflate stream (RFC 1951, without a header). Throws Error (Input) with the reason, but
/// without a path, if the stream is damaged or cut short. Memory: the output, at most 1032 times the input.
std::string inflate_raw(std::string_view deflated);

}  // namespace octotomy::voxel

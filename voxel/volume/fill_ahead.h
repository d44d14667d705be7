// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace octotomy::voxel {

/// Fills new memory: calls `fill(part, bytes)` on this thread for the memory's parts in ascending order.
/// Meanwhile other threads touch the pages of the next parts, so that the system allocates and zeroes them.
/// Intended for fills that cannot run in parallel, such as inflating: allocating a page can take as long as
/// inflating the page's content. `fill` returns the number of bytes that it filled; a number below `bytes`
/// ends the loop. Returns the total. Rethrows exceptions of `fill`. Memory: at most 64 MiB are touched before
/// they are filled.
std::size_t fill_ahead(char* memory, std::size_t bytes,
                       const std::function<std::size_t(char* part, std::size_t bytes)>& fill);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace octotomy::voxel {

/// Fills new memory: calls `fill(part, bytes)` on this thread for its parts in ascending order, while others
/// touch the pages some parts ahead, which writes zeros to them. Meant for a fill that cannot be shared out,
/// as inflating: to hand out a page can take as long as to inflate what it holds. Returns how many bytes were
/// filled: `fill` returns how many of its part it filled, and less than all ends it. Passes on what `fill`
/// throws. Memory beyond the part at hand: at most 64 MiB are touched before they are filled.
std::size_t fill_ahead(char* memory, std::size_t bytes,
                       const std::function<std::size_t(char* part, std::size_t bytes)>& fill);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <stop_token>

#include "brep/boolean/corefine.h"
#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// corefine() in batches, in parallel. Parts of a surface are connected across edges; parts whose boxes do not
/// overlap, not even through other parts' boxes, neither meet nor contain each other, so each result is that of all
/// batches together. A batch has at least `batch_size` triangles and parts of both surfaces; where there is no
/// second batch, the answer is that of corefine(), bit for bit. Batches do not depend on the number of threads. Cost:
/// n log n, with the memory of one batch for each thread, and all pairs of parts whose boxes overlap, up to 64 for
/// each part.
Corefined corefine_in_batches(const Mesh& a, const Mesh& b, const Wanted& wanted,
                              const std::stop_token& stop = {}, std::size_t batch_size = 20'000);

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <stop_token>

#include "brep/boolean/corefine.h"
#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// corefine() in batches, in parallel. Parts of a surface are connected across edges; parts whose boxes do
/// not overlap, not even through other parts' boxes, neither meet nor contain each other, so each result is
/// the sum of the batches' results. Each batch has parts of both surfaces and, as far as possible, at least
/// `batch_size` triangles. If only one batch is possible, the answer is that of corefine(), bit for bit.
/// Batches do not depend on the number of threads. Cost: n log n, and the pairs of parts whose boxes overlap,
/// at most 64 for each part. Memory: one batch for each thread.
Corefined corefine_in_batches(const Mesh& a, const Mesh& b, const Wanted& wanted,
                              const std::stop_token& stop = {}, std::size_t batch_size = 20'000);

}  // namespace octotomy::brep

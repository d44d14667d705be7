// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/answer.h"

namespace octotomy::planner {

/// The answers of an evaluation's measure steps, in their order, each number with its half-width and the
/// terms that make it: sizes of objects by both kernels, gaps between two, distances and angles of points.
Json measurements_json(const Evaluation& evaluation);

}  // namespace octotomy::planner

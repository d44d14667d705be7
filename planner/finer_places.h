// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "convert/finer.h"
#include "planner/evaluate.h"

namespace octotomy::planner {

/// Where an export step wants finer elements: its points, and the meshes of its objects. Throws
/// std::runtime_error where an object has no mesh or an empty one.
std::vector<convert::Finer> finer_places(const Evaluation& evaluation, const ExportStep& step);

/// What of a step says where elements are finer, as a key: equal where it is.
std::string finer_key(const ExportStep& step);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>

#include "planner/operation/table/scope.h"

namespace octotomy::planner {

/// Reads the file of a step's field while the document is checked, so that a file of the wrong kind is
/// refused at that field. `place` is the place of the field; `file` is relative to the document's folder.
/// Does nothing if the file is missing; the step then fails when it is evaluated, like an import of a missing
/// mesh. Throws the errors of `read`, with the field's place.
void check_field_file(const FieldLocation& place, const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& read);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/field_file.h"

#include "planner/operation/table/fault.h"

namespace octotomy::planner {

void check_field_file(const FieldLocation& place, const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& read) {
  if (place.scope == nullptr || !std::filesystem::exists(place.scope->folder() / file)) return;
  try {
    read(place.scope->folder() / file);
  } catch (const std::exception& error) {
    rethrow_at(place.where + ": ", error);
  }
}

}  // namespace octotomy::planner

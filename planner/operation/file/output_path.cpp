// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/output_path.h"

#include <algorithm>

#include "planner/operation/table/control_character.h"
#include "planner/operation/table/nearest_name.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/unfinished_folder.h"

namespace octotomy::planner {

void check_output_path(const std::filesystem::path& path, const std::vector<std::string>& extensions,
                       const FieldLocation& place) {
  const std::string name = output_path(path).generic_string();
  if (has_control(name)) place.refuse("the path has control characters: choose another name");
  if (std::none_of(extensions.begin(), extensions.end(),
                   [&](const std::string& known) { return name.ends_with(known); }))
    place.refuse("no file can be written with the extension of '" + name + "'" +
                 suggestion(path.extension().string(), extensions));
  if (place.scope == nullptr) return;
  if (path.is_absolute() || name.starts_with("..") || name.starts_with("views/"))
    place.refuse("'" + name + "' must be a path within the result folder, outside of views/");
  place.scope->take_path(place.where, name);
}

std::filesystem::path output_file(const std::filesystem::path& folder, const std::filesystem::path& path) {
  const std::filesystem::path name = output_path(path);
  voxel::create_folders_in(folder, name.parent_path());
  return folder / name;
}

std::filesystem::path output_path(const std::filesystem::path& path) {
  return path.lexically_normal().generic_string();
}

}  // namespace octotomy::planner

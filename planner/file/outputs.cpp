// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/file/outputs.h"

#include <stdexcept>

#include "brep/mesh/error.h"
#include "planner/file/file_kind.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_twice(const fs::path& out, const fs::path& other) {
  throw std::runtime_error(out.string() + ": is the same file as " + other.string() +
                           ", which is written, too: choose another name");
}

/// A message with one path in place of another.
std::string renamed(std::string message, const std::string& hidden, const std::string& shown) {
  for (std::size_t at = 0; (at = message.find(hidden, at)) != std::string::npos; at += shown.size())
    message.replace(at, hidden.size(), shown);
  return message;
}

}  // namespace

void need_unread(const fs::path& out, const std::vector<fs::path>& read) {
  std::error_code is_none;
  for (const fs::path& each : read)
    if (fs::equivalent(out, each, is_none))
      throw std::runtime_error(out.string() + ": would replace " + each.string() +
                               ", which is read: choose another name");
}

void need_outputs(const std::vector<fs::path>& outs, const std::vector<fs::path>& read) {
  std::vector<fs::path> named;
  for (const fs::path& out : outs) {
    if (out.empty()) continue;
    need_folder_of(out);
    for (const fs::path& other : named)
      if (voxel::are_one_file(out, other)) refuse_twice(out, other);
    named.push_back(out);
  }
  if (named.size() < 2) return;
  for (const fs::path& out : named) need_unread(out, read);
}

void Outputs::write(const fs::path& out, const std::function<void(const fs::path& file)>& write) {
  const fs::path file = staged_.beside(out);
  const auto shown = [&](const std::exception& error) {
    return renamed(error.what(), file.string(), out.string());
  };
  try {
    write(file);
  } catch (const voxel::Stopped&) {
    throw;
  } catch (const brep::Stopped&) {
    throw;
  } catch (const voxel::Error& error) {
    throw voxel::Error(error.code(), shown(error));
  } catch (const brep::Error& error) {
    throw brep::Error(error.code(), shown(error));
  }
}

}  // namespace octotomy::planner

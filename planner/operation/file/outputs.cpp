// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/outputs.h"

#include <fstream>
#include <stdexcept>

#include "brep/mesh/error.h"
#include "planner/operation/file/path_checks.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_twice(const fs::path& out, const fs::path& other) {
  throw std::runtime_error(out.string() + ": is the same file as " + other.string() +
                           ", which this run also writes: choose another name");
}

/// The message with the path `shown` in place of the path `hidden`.
std::string renamed(std::string message, const std::string& hidden, const std::string& shown) {
  for (std::size_t at = 0; (at = message.find(hidden, at)) != std::string::npos; at += shown.size())
    message.replace(at, hidden.size(), shown);
  return message;
}

/// Whether the beginning of a file shows that Octotomy wrote it as a surface: by its comment, or in a .glb by
/// its generator.
bool is_own_surface(const fs::path& file) {
  if (!fs::is_regular_file(fs::symlink_status(file))) return false;
  std::string head(128, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return head.find("octotomy, ") != std::string::npos ||
         head.find("\"generator\":\"octotomy\"") != std::string::npos;
}

}  // namespace

void need_unread(const fs::path& out, const std::vector<fs::path>& read) {
  std::error_code is_none;
  for (const fs::path& each : read)
    if (fs::equivalent(out, each, is_none))
      throw std::runtime_error(out.string() + ": would replace " + each.string() +
                               ", which this run reads: choose another name");
}

void need_untyped_surface(const fs::path& out, const std::vector<fs::path>& read) {
  need_folder_of(out);
  need_unread(out, read);
  if (fs::exists(fs::symlink_status(out)) && !is_own_surface(out))
    throw std::runtime_error(
        out.string() +
        ": is there already and was not written by Octotomy: move it away, or choose another name");
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
  const fs::path place = staged_.beside(out);
  const fs::path file = place.parent_path() / voxel::staged_scene_name(out);
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
  if (file != place) fs::rename(file, place);
  if (const auto samples = voxel::own_data_file(out)) older_samples_.push_back(*samples);
}

void Outputs::commit() {
  staged_.commit();
  std::error_code stays;
  for (const fs::path& samples : older_samples_) fs::remove(samples, stays);
}

}  // namespace octotomy::planner

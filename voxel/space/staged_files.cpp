// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/staged_files.h"

#include <algorithm>
#include <cerrno>
#include <list>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <vector>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr const char* prefix = ".octotomy-";

void check(const std::error_code& error, const fs::path& target) {
  if (error)
    throw Error(code_of_errno(error.value()), target.string() + ": cannot be written: " + error.message());
}

/// A staged file or folder and its destination.
struct Move {
  fs::path staged, target;
};

/// Checks that a target may be replaced, and copies the target's permissions to the staged file.
void need_replaceable(const fs::path& target, const fs::path& staged) {
  struct stat of_old {};
  if (::lstat(target.c_str(), &of_old) != 0) return;
  const bool is_folder = fs::is_directory(staged);
  if (is_folder ? !S_ISDIR(of_old.st_mode) : !S_ISREG(of_old.st_mode))
    throw Error(ErrorCode::Input, target.string() + ": is no " + (is_folder ? "folder" : "regular file") +
                                      " and is not replaced: choose another name");
  if (!is_folder) ::chmod(staged.c_str(), of_old.st_mode & 07777);
}

/// Moves a staged file or folder into a folder beside its target, which may lie on another disk behind a
/// link.
void bring(Move& move, std::list<StagedFiles>& folders) {
  const StagedFiles& there = folders.emplace_back(move.target.parent_path());
  const fs::path staged = there.folder() / move.target.filename();
  std::error_code error;
  fs::rename(move.staged, staged, error);
  if (error == std::errc::cross_device_link)
    fs::copy(move.staged, staged, fs::copy_options::recursive, error);
  check(error, move.target);
  move.staged = staged;
}

/// A second hard link to a file that is replaced, from which the old file can be restored. If the file system
/// does not support hard links, the old file cannot be restored.
class OldFile {
 public:
  explicit OldFile(const Move& move) : target_(move.target), kept_(move.staged.string() + ".old") {
    std::error_code error;
    was_there_ = fs::exists(fs::symlink_status(target_, error));
    if (was_there_) fs::create_hard_link(target_, kept_, error);
  }
  /// Restores the old file or, if there was none, removes the new one.
  void restore() const {
    std::error_code ignored;
    was_there_ ? fs::rename(kept_, target_, ignored) : static_cast<void>(fs::remove_all(target_, ignored));
  }

 private:
  fs::path target_, kept_;
  bool was_there_ = false;
};

/// Renames all files into place. If one fails, undoes the others.
void rename_all(std::vector<Move>& moves) {
  for (const Move& move : moves) need_replaceable(move.target, move.staged);
  std::list<StagedFiles> elsewhere;
  for (Move& move : moves)
    if (move.staged.parent_path().parent_path() != move.target.parent_path()) bring(move, elsewhere);
  std::vector<OldFile> old;
  std::error_code error;
  const NamesChange change;
  for (const Move& move : moves) {
    if (moves.size() > 1) old.emplace_back(move);
    fs::rename(move.staged, move.target, error);
    if (!error) continue;
    if (!old.empty()) old.pop_back();
    std::for_each(old.rbegin(), old.rend(), [](const OldFile& each) { each.restore(); });
    check(error, move.target);
  }
}

/// The names in a folder, `last` at the end.
std::vector<fs::path> names_in(const fs::path& folder, const fs::path& last) {
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().filename() != last) names.push_back(entry.path().filename());
  if (!last.empty()) names.push_back(last);
  return names;
}

/// A path after removal of a redundant "/" or "/." at its end.
fs::path without_end(fs::path path) {
  while (path.has_relative_path() && (!path.has_filename() || path.filename() == "."))
    path = path.parent_path();
  return path;
}

}  // namespace

fs::path behind_links(fs::path path) {
  for (int links = 0; fs::is_symlink(fs::symlink_status(path)); ++links) {
    if (links == 40)
      throw Error(ErrorCode::Input, path.string() + ": is a link that leads to itself: choose another name");
    path = without_end(path.parent_path() / fs::read_symlink(path));
  }
  return path;
}

fs::path place_of(const fs::path& path) {
  const fs::path file = behind_links(without_end(fs::absolute(path)));
  std::error_code fails;
  const bool is_folder = file.filename() == ".." || !file.has_relative_path();
  const fs::path folder = fs::weakly_canonical(is_folder ? file : file.parent_path(), fails);
  if (fails) return file.lexically_normal();
  return is_folder ? folder : folder / file.filename();
}

fs::path absolute_of(const fs::path& path) {
  const fs::path whole = fs::absolute(path);
  fs::path plain = whole.lexically_normal();
  std::error_code fails;
  if (!fs::exists(whole, fails) || fs::equivalent(whole, plain, fails)) return plain;
  return fs::weakly_canonical(whole);
}

bool are_one_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  if (fs::equivalent(a, b, ignored)) return true;
  return place_of(a) == place_of(b);
}

StagedFiles::StagedFiles(const fs::path& destination)
    : destination_(destination.empty() ? "." : destination),
      unfinished_((remove_abandoned(destination_, prefix), destination_), prefix) {}

void StagedFiles::commit(const fs::path& last) {
  std::vector<Move> moves;
  for (const fs::path& name : names_in(folder(), last))
    moves.push_back({folder() / name, behind_links(destination_ / name)});
  rename_all(moves);
}

fs::path StagedOutputs::beside(const fs::path& place) {
  const fs::path folder = place_of(fs::absolute(place).parent_path());
  const StagedFiles& files = folders_.try_emplace(folder, folder).first->second;
  places_.push_back(folder / place.filename());
  return files.folder() / place.filename();
}

void StagedOutputs::commit() {
  std::vector<Move> moves, last;
  for (const fs::path& place : places_)
    last.push_back({folders_.at(place.parent_path()).folder() / place.filename(), behind_links(place)});
  for (const auto& [destination, files] : folders_)
    for (const fs::path& name : names_in(files.folder(), {}))
      if (std::find(places_.begin(), places_.end(), destination / name) == places_.end())
        moves.push_back({files.folder() / name, behind_links(destination / name)});
  moves.insert(moves.end(), last.begin(), last.end());
  rename_all(moves);
}

}  // namespace octotomy::voxel

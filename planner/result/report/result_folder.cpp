// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The steps of publishing; the process may be killed between any two:
// 1. the list of the new files is written among them;
// 2. other files in the old folder (not listed) are hard-linked into the new one;
// 3. the two folders exchange their names (renameat2);
// 4. the old folder, now hidden, is emptied: listed files and second links are removed; a file that is
//    neither, because it appeared after step 2 or could not be linked, is moved into the new folder.
// A hidden folder without a list therefore never contained other files; one with a list is emptied as in step
// 4 by the next run. A lock on the hidden folder shows that its process is running.
#include "planner/result/report/result_folder.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <set>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "planner/operation/table/control_character.h"
#include "planner/plan/sha256.h"
#include "voxel/space/disk_need.h"
#include "voxel/space/error.h"
#include "voxel/space/staged_files.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using voxel::ErrorCode;
using voxel::place_of;

constexpr const char* steps_suffix = "-earlier";
constexpr const char* list_name = ".octotomy-result";

[[noreturn]] void refuse(const std::string& message) {
  throw voxel::Error(ErrorCode::Input, message);
}

/// The place of a folder. Refuses a name with control characters, which could control a terminal or spoil a
/// list.
fs::path plain_place_of(const fs::path& folder) {
  if (has_control(folder.native()))
    refuse(folder.string() + ": a folder's name has no control characters: choose another -o");
  return place_of(folder);
}

bool is_there(const fs::path& path) {
  return fs::symlink_status(path).type() != fs::file_type::not_found;
}

bool same_file(const fs::path& a, const fs::path& b) {
  struct stat of_a {
  }, of_b{};
  return ::lstat(a.c_str(), &of_a) == 0 && ::lstat(b.c_str(), &of_b) == 0 && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

/// Renames a file if there is nothing at the new path. Returns whether it did.
bool rename_to_new(const fs::path& from, const fs::path& to) {
  return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0 ||
         (errno == EINVAL && !is_there(to) && ::rename(from.c_str(), to.c_str()) == 0);
}

void write_list(const fs::path& folder) {
  ResultList list;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      list.emplace(entry.path().lexically_relative(folder).generic_string(), sha256_of_path(entry.path()));
  std::string text =
      "# Octotomy " OCTOTOMY_VERSION
      " wrote these files and may replace them while they are unchanged. It keeps all others.\n";
  for (const auto& [name, sum] : list) {
    text += sum;
    text += "  ";
    text += name;
    text += '\n';
  }
  // The list is written to another name and renamed, because files that a partial list lacks would count as
  // the user's.
  const fs::path part = folder / (std::string(list_name) + "-part");
  voxel::write_file(part, text);
  fs::rename(part, folder / list_name);
}

bool unchanged(const fs::path& path, const std::string& sum) {
  return fs::is_regular_file(fs::symlink_status(path)) && sha256_of_path(path) == sum;
}

/// Whether `inner` is `outer` or lies below it.
bool lies_in(const fs::path& inner, const fs::path& outer) {
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

fs::path hidden_prefix(const fs::path& place) {
  return "." + place.filename().string() + ".octotomy-";
}

void need_writable(const fs::path& folder, const fs::path& named) {
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse(named.string() + ": " + folder.string() + " cannot be written to: choose another -o");
}

/// Throws if the folder, or its nearest existing parent, cannot be written. Creates a folder as a test,
/// because permissions alone do not show this. Its name must differ from a result's hidden folder, which may
/// contain other files.
void try_to_write(fs::path folder, const fs::path& named) {
  constexpr const char* prefix = ".octotomy-";
  while (!is_there(folder)) folder = folder.parent_path();
  try {
    voxel::remove_abandoned(folder, prefix);
    const voxel::UnfinishedFolder trial(folder, prefix);
  } catch (const voxel::Error& error) {
    throw voxel::Error(error.code(), named.string() + ": " + error.what());
  }
}

dev_t device_of(const fs::path& path) {
  struct stat of_path {};
  return ::lstat(path.c_str(), &of_path) == 0 ? of_path.st_dev : 0;
}

/// The list of the earlier result in `folder`; empty if the folder is empty. Refuses a folder with other
/// contents. `named` is the folder in error messages.
ResultList need_earlier_result(const fs::path& folder, const fs::path& named) {
  if (fs::is_empty(folder)) return {};
  ResultList list = result_list(folder);
  if (list.empty())
    refuse(named.string() + ": contains files but no list of an earlier result (" + list_name +
           "), so they may be yours: choose another -o, or move them");
  for (const auto& [name, sum] : list)
    if (is_there(folder / name) && !unchanged(folder / name, sum))
      refuse((named / name).string() +
             ": was changed after Octotomy wrote it: move or delete it, or choose another -o");
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (device_of(entry.path()) != device_of(folder))
      refuse((named / entry.path().lexically_relative(folder)).string() +
             ": is mounted there, and a result replaces its folder: choose another -o");
  return list;
}

/// Refuses if `name`, or a folder in its path, is occupied by a file that is not in the list.
void need_free(const fs::path& folder, const ResultList& list, const fs::path& name, const fs::path& named) {
  fs::path part;
  for (const fs::path& step : name) {
    part /= step;
    const bool last = part == name;
    if (!is_there(folder / part)) return;
    if (last ? !list.contains(part.generic_string()) : !fs::is_directory(fs::symlink_status(folder / part)))
      refuse((named / part).string() +
             ": is not Octotomy's, and the result needs that name: move it, or choose another -o");
  }
}

/// As need_result_folder(), for a path without links. Returns the list of the earlier result.
ResultList need_place(const fs::path& place, const fs::path& named, const std::vector<fs::path>& names) {
  if (lies_in(fs::current_path(), fs::weakly_canonical(place)))
    refuse(named.string() +
           ": is the working folder or contains it, and writing a result puts a new folder in its place: "
           "choose a folder inside the working folder, such as -o report");
  constexpr std::size_t longest_beside = 20;  // "." before it, ".octotomy-" with six letters and "~" after
  if (place.filename().native().size() + longest_beside > NAME_MAX)
    refuse(named.string() + ": is too long a name: choose a shorter -o");
  if (!is_there(place)) {
    fs::path above = place.parent_path();
    while (!is_there(above)) above = above.parent_path();
    if (!fs::is_directory(above))
      refuse(named.string() + ": " + above.string() + " is a file: choose another -o");
    need_writable(above, named);
    return {};
  }
  if (!fs::is_directory(place))
    refuse(named.string() + ": is a file, a result needs a folder: choose another -o");
  if (device_of(place) != device_of(place.parent_path()))
    refuse(named.string() +
           ": is mounted there, and a result replaces its folder: choose a folder in it, as " +
           (named / "report").string());
  need_writable(place.parent_path(), named);
  need_writable(place, named);
  ResultList list = need_earlier_result(place, named);
  for (const fs::path& name : names) need_free(place, list, name.lexically_normal(), named);
  return list;
}

/// Keeps other runs from renaming folders at the same place. Has no effect on file systems without locks.
class PlaceLock {
 public:
  explicit PlaceLock(const fs::path& parent) : file_(::open(parent.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (file_ >= 0) ::flock(file_, LOCK_EX);
  }
  PlaceLock(const PlaceLock&) = delete;
  PlaceLock& operator=(const PlaceLock&) = delete;
  ~PlaceLock() {
    if (file_ >= 0) ::close(file_);
  }

 private:
  int file_;
};

/// Gives a new file or folder the permissions of the old one, if both exist.
void keep_mode(const fs::path& old, const fs::path& made) {
  struct stat of_old {};
  if (fs::exists(fs::symlink_status(made)) && ::lstat(old.c_str(), &of_old) == 0 && !S_ISLNK(of_old.st_mode))
    ::chmod(made.c_str(), of_old.st_mode & 07777);
}

/// Step 2: hard-links into `made` the files of `old` that are not in its list, and copies permissions. Throws
/// Error if a name is taken.
void take_over(const fs::path& old, const ResultList& list, const fs::path& made, const fs::path& named) {
  std::vector<fs::path> kept{""};
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(old)) {
    const fs::path name = entry.path().lexically_relative(old);
    kept.push_back(name);
    if (name == list_name || list.contains(name.generic_string())) continue;
    if (fs::is_directory(entry.symlink_status())) {
      // A folder that contains listed files is created only if it also contains other files.
      const std::string prefix = name.generic_string() + "/";
      const auto first = list.lower_bound(prefix);
      if (first != list.end() && first->first.starts_with(prefix)) continue;
      if (!fs::is_directory(made / name)) need_free(made, {}, name, named);
      voxel::create_folders_in(made, name);
    } else {
      need_free(made, {}, name, named);
      voxel::create_folders_in(made, name.parent_path());
      // Step 4 moves the file if it cannot be linked, because the file system has no links or the file
      // belongs to another user.
      [[maybe_unused]] const int linked =
          ::linkat(AT_FDCWD, entry.path().c_str(), AT_FDCWD, (made / name).c_str(), 0);
    }
  }
  // Inner folders come first, because the new permissions of a folder may prevent access to it.
  for (auto name = kept.rbegin(); name != kept.rend(); ++name) keep_mode(old / *name, made / *name);
}

/// Removes those listed files that are unchanged, the list, and folders that are then empty. Also removes
/// `place` if it is empty and did not exist before (`was_there`).
void take_back(const fs::path& place, const ResultList& list, bool was_there) {
  std::set<fs::path> folders;
  for (const auto& [name, sum] : list) {
    for (fs::path above = fs::path(name).parent_path(); !above.empty(); above = above.parent_path())
      folders.insert(above);
    if (unchanged(place / name, sum)) fs::remove(place / name);
  }
  fs::remove(place / list_name);
  // Inner folders come first. A folder in which a user's file remains is not removed.
  for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder) ::rmdir((place / *folder).c_str());
  if (!was_there) ::rmdir(place.c_str());
}

/// Step 4: empties and removes a hidden folder. A file that is not in its list, or has been changed, is moved
/// to `place`, unless `place` has it already. `sure`: the listed files need not be compared with the list.
void discard(const fs::path& hidden, const fs::path& place, bool sure) {
  std::error_code ignored;
  if (!is_there(hidden / list_name)) {
    fs::remove_all(hidden, ignored);
    return;
  }
  const ResultList list = result_list(hidden);
  std::vector<fs::path> folders;
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(hidden))
    (fs::is_directory(entry.symlink_status()) ? folders : files).push_back(entry.path());
  for (const fs::path& file : files) {
    const fs::path name = file.lexically_relative(hidden);
    const auto listed = list.find(name.generic_string());
    if (name == list_name) continue;
    if (same_file(file, place / name) ||
        (listed != list.end() && (sure || unchanged(file, listed->second)))) {
      fs::remove(file, ignored);
    } else {
      fs::create_directories((place / name).parent_path(), ignored);
      rename_to_new(file, place / name);
    }
  }
  std::sort(folders.rbegin(), folders.rend());
  bool empty = true;
  for (const fs::path& folder : folders) empty = ::rmdir(folder.c_str()) == 0 && empty;
  for (const fs::directory_entry& entry : fs::directory_iterator(hidden))
    empty = empty && entry.path().filename() == list_name;
  if (empty) fs::remove_all(hidden, ignored);
}

/// Exchanges two folders on file systems that cannot do so in one step. Between the renames, the old result
/// has another name, beside its place.
void exchange_in_steps(const fs::path& staged, const fs::path& place) {
  const fs::path old = staged.string() + steps_suffix;
  fs::rename(place, old);
  try {
    fs::rename(staged, place);
  } catch (const fs::filesystem_error&) {
    fs::rename(old, place);
    throw;
  }
  fs::rename(old, staged);
}

/// Removes leftovers of killed runs beside the place. An earlier result that exists only there is moved back.
void discard_leftovers(const fs::path& place) {
  const std::string prefix = hidden_prefix(place).string();
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(place.parent_path())) {
    std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix) || !fs::is_directory(entry.symlink_status())) continue;
    const bool earlier = name.ends_with(steps_suffix);
    if (earlier) name.resize(name.size() - std::string_view(steps_suffix).size());
    if (!earlier && name.ends_with('~')) name.pop_back();
    const std::string letters = name.substr(prefix.size());
    if (letters.size() != 6 || !std::all_of(letters.begin(), letters.end(),
                                            [](unsigned char letter) { return std::isalnum(letter) != 0; }))
      continue;
    if (!earlier || !rename_to_new(entry.path(), place)) found.push_back(entry.path());
  }
  for (const fs::path& hidden : found)
    voxel::if_abandoned(
        hidden,
        [](const fs::path& folder, void* place_of_it) {
          discard(folder, *static_cast<const fs::path*>(place_of_it), false);
        },
        const_cast<fs::path*>(&place));
}

/// Gives a folder the permissions of a newly created one.
void take_usual_mode(const fs::path& folder) {
  const fs::path probe = folder / "probe";
  fs::create_directory(probe);
  keep_mode(probe, folder);
  fs::remove(probe);
}

}  // namespace

ResultList result_list(const fs::path& folder) {
  ResultList list;
  if (!fs::is_regular_file(folder / list_name)) return list;
  std::ifstream file(folder / list_name);
  std::string line;
  while (std::getline(file, line))
    if (line.size() > 66 && line[0] != '#') list.emplace(line.substr(66), line.substr(0, 64));
  return list;
}

void need_result_folder(const fs::path& folder, const std::vector<fs::path>& names) {
  const fs::path place = plain_place_of(folder);
  need_place(place, folder, names);
  try_to_write(place.parent_path(), folder);
  // Size in bytes of a page without pictures, its tables and the list.
  constexpr std::uint64_t least_bytes = 24000;
  voxel::need_disk(folder, least_bytes);
}

bool may_hold_result(const fs::path& folder) {
  const fs::path place = place_of(folder);
  if (!is_there(place)) return true;
  return fs::is_directory(place) && (fs::is_empty(place) || !result_list(place).empty());
}

bool is_of_result(const fs::path& file) {
  const fs::path place = place_of(file);
  for (fs::path above = place.parent_path();; above = above.parent_path()) {
    if (result_list(above).contains(place.lexically_relative(above).generic_string())) return true;
    if (!above.has_relative_path()) return false;
  }
}

ResultFolder::ResultFolder(const fs::path& folder) : final_(plain_place_of(folder)) {
  fs::create_directories(final_.parent_path());
  const PlaceLock held(final_.parent_path());
  discard_leftovers(final_);
  staged_ = std::make_unique<voxel::UnfinishedFolder>(final_.parent_path(), hidden_prefix(final_).string());
  take_usual_mode(path());
}

void ResultFolder::keep_beside(const std::string& reason, const fs::path& hidden) {
  for (int number = 1;; ++number) {
    const fs::path kept = final_.string() + ".new" + (number == 1 ? "" : std::to_string(number));
    if (is_there(kept)) continue;
    const fs::path from = staged_->is_kept() ? hidden : path();
    if (!rename_to_new(from, kept))
      throw fs::filesystem_error("cannot keep", from, kept, {errno, std::generic_category()});
    if (!staged_->is_kept()) staged_->keep();
    refuse(reason + ". The new result is complete in " + kept.string());
  }
}

void ResultFolder::copy_rest() {
  for (const auto& [name, sum] : result_list(final_)) {
    if (is_there(path() / name) || !fs::is_regular_file(fs::symlink_status(final_ / name))) continue;
    voxel::create_folders_in(path(), fs::path(name).parent_path());
    fs::copy_file(final_ / name, path() / name);
  }
}

void ResultFolder::publish() {
  put_in_place([] {});
}

std::unique_ptr<voxel::Undo> ResultFolder::publish_early() {
  std::unique_ptr<voxel::Undo> undo;
  if (replaces()) return undo;
  const bool was_there = is_there(final_);
  put_in_place([&] {
    undo = std::make_unique<voxel::Undo>([place = final_, list = result_list(final_), was_there] {
      if (result_list(place) == list) take_back(place, list, was_there);
    });
  });
  return undo;
}

bool ResultFolder::replaces() const {
  return is_there(final_) && !(fs::is_directory(final_) && fs::is_empty(final_));
}

void ResultFolder::put_in_place(const std::function<void()>& then) {
  write_list(path());
  const PlaceLock held(final_.parent_path());
  const bool exchanges = replaces();
  try {
    const ResultList earlier = need_place(final_, final_, {});
    if (exchanges) take_over(final_, earlier, path(), final_);
  } catch (const std::exception& error) {
    keep_beside(error.what());
  }
  if (!exchanges) keep_mode(final_, path());
  fs::path old;
  {
    const voxel::NamesChange change;
    // From here on the process's end must not remove the hidden folder: after the exchange it may contain the
    // user's files.
    old = staged_->keep();
    // rename() replaces an empty folder, but no file and no folder with contents.
    const bool done = exchanges
                          ? ::renameat2(AT_FDCWD, old.c_str(), AT_FDCWD, final_.c_str(), RENAME_EXCHANGE) == 0
                          : ::rename(old.c_str(), final_.c_str()) == 0;
    if (!done && exchanges && (errno == EINVAL || errno == ENOSYS))
      exchange_in_steps(old, final_);
    else if (!done)
      keep_beside(final_.string() + ": " + std::generic_category().message(errno), old);
    then();
  }
  if (!exchanges) return;
  try {
    discard(old, final_, true);
  } catch (const std::exception&) {
    // The new result is in place. The next run removes the rest of the old one.
  }
}

}  // namespace octotomy::planner

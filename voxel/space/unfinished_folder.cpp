// The owner of a folder holds a lock on it. A folder is created first and locked afterwards. In between,
// remove_abandoned() in another process may lock and remove the folder. After locking, the owner therefore
// checks that the folder still exists, and otherwise creates another one.
#include "voxel/space/unfinished_folder.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t letter_count = 6;
/// Suffix of a folder's name while the folder is being emptied. It is renamed before, so that no thread
/// writes into it.
constexpr const char* leaving = "~";

/// The folders of this process; never destroyed, since threads may outlive main(). The mutex is held while a
/// folder is created or removed: if two threads emptied the same folder, one would fail at an entry that the
/// other has removed, and leave the rest. It is recursive, because an allocation that fails while it is held
/// may end the process on the same thread.
struct Folders {
  std::recursive_timed_mutex mutex;
  std::vector<fs::path> paths;
  std::vector<const std::function<void()>*> undone_at_end;
};
Folders& folders() {
  static auto* all = new Folders;
  return *all;
}

std::timed_mutex& names_mutex() {
  static auto* mutex = new std::timed_mutex;
  return *mutex;
}

void forget(const fs::path& path) {
  const std::lock_guard held(folders().mutex);
  std::erase(folders().paths, path);
}

/// Precondition: the calling thread holds the mutex of folders().
void remove_folder(const fs::path& path) {
  std::error_code ignored;
  const fs::path gone = path.string() + leaving;
  fs::rename(path, gone, ignored);
  fs::remove_all(gone, ignored);
  fs::remove_all(path, ignored);  // removes the folder under its old name if it could not be renamed
}

/// Ignores exceptions: a folder that cannot be removed remains, hidden or marked as unfinished, until the
/// next run removes it.
template <typename Work>
void quietly(const Work& work) {
  try {
    work();
  } catch (...) {
    return;
  }
}

/// Locks a folder and returns its descriptor; -1 if the folder no longer exists or the file system has no
/// locks.
int locked(const fs::path& path, int how) {
  const int file = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return -1;
  if (::flock(file, how) == 0) return file;
  ::close(file);
  return -1;
}

}  // namespace

UnfinishedFolder::UnfinishedFolder(const fs::path& beside, const std::string& prefix) {
  for (;;) {
    std::string name = (beside / (prefix + std::string(letter_count, 'X'))).string();
    {
      const std::lock_guard held(folders().mutex);
      if (mkdtemp(name.data()) == nullptr)
        throw Error(code_of_errno(errno),
                    beside.string() + ": cannot be written to: " + std::generic_category().message(errno) +
                        "; choose an existing folder in which you may write");
      folders().paths.emplace_back(name);
    }
    path_ = name;
    lock_ = locked(path_, LOCK_EX);
    struct stat of_folder {};
    if (::lstat(path_.c_str(), &of_folder) == 0) return;
    forget(path_);
    if (lock_ >= 0) ::close(lock_);
  }
}

UnfinishedFolder::~UnfinishedFolder() {
  if (!path_.empty()) {
    const std::lock_guard held(folders().mutex);
    remove_folder(path_);
    forget(path_);
  }
  if (lock_ >= 0) ::close(lock_);
}

fs::path UnfinishedFolder::keep() {
  forget(path_);
  return std::exchange(path_, {});
}

Undo::Undo(std::function<void()> undo) : undo_(std::move(undo)) {
  const std::lock_guard held(folders().mutex);
  folders().undone_at_end.push_back(&undo_);
}

Undo::~Undo() {
  const std::lock_guard held(folders().mutex);
  std::erase(folders().undone_at_end, &undo_);
  quietly(undo_);
}

void create_folders_in(const fs::path& folder, const fs::path& name) {
  fs::path made = folder;
  for (const fs::path& part : name) fs::create_directory(made /= part);
}

bool if_abandoned(const fs::path& folder, void (*work)(const fs::path&, void*), void* argument) {
  const int file = locked(folder, LOCK_EX | LOCK_NB);
  if (file < 0) return false;
  work(folder, argument);
  ::close(file);
  return true;
}

void remove_abandoned(const fs::path& beside, const std::string& prefix) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(beside, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    std::string name = entry->path().filename().string();
    if (name.ends_with(leaving)) name.pop_back();
    if (name.size() != prefix.size() + letter_count || !name.starts_with(prefix)) continue;
    struct stat of_folder {};
    if (::lstat(entry->path().c_str(), &of_folder) == 0 && S_ISDIR(of_folder.st_mode) &&
        (of_folder.st_mode & 07777) == 0700 && of_folder.st_uid == ::geteuid())
      found.push_back(entry->path());
  }
  for (const fs::path& folder : found)
    if_abandoned(
        folder, [](const fs::path& path, void*) { fs::remove_all(path); }, nullptr);
}

NamesChange::NamesChange() : held_(names_mutex()) {}

void remove_unfinished() noexcept {
  // Neither mutex is unlocked afterwards, so nothing more is renamed into place and no other thread creates
  // or removes a folder.
  const bool settled = names_mutex().try_lock_for(std::chrono::milliseconds(100));
  static_cast<void>(settled);
  if (!folders().mutex.try_lock_for(std::chrono::seconds(10))) return;  // the next run removes the others
  for (const fs::path& path : folders().paths) quietly([&path] { remove_folder(path); });
  for (const auto* undo : folders().undone_at_end) quietly(*undo);
}

}  // namespace octotomy::voxel

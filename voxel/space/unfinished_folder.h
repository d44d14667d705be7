// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>

namespace octotomy::voxel {

/// A folder for unfinished work. Its name is new (mkdtemp), only its owner may access it, and it is locked
/// during the owner's lifetime, so that a later process recognises a folder that a killed process left. The
/// destructor removes it.
class UnfinishedFolder {
 public:
  /// Creates `beside`/`prefix` with six letters added. Throws Error (Input or Resource) that names `beside`.
  UnfinishedFolder(const std::filesystem::path& beside, const std::string& prefix);
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;
  ~UnfinishedFolder();

  const std::filesystem::path& path() const { return path_; }
  /// Whether keep() was called.
  bool is_kept() const { return path_.empty(); }
  /// Passes the folder to the caller: it is no longer removed or listed. Returns its path.
  std::filesystem::path keep();

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

/// Undoes a step that is visible to others before it is finished. Runs when the object is destroyed or in
/// remove_unfinished(), whichever comes first.
class Undo {
 public:
  explicit Undo(std::function<void()> undo);
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;
  ~Undo();

 private:
  std::function<void()> undo_;
};

/// Creates the subfolders of `folder` along the path `name`, but never `folder` itself, because
/// remove_unfinished() may have removed it. Throws std::filesystem::filesystem_error.
void create_folders_in(const std::filesystem::path& folder, const std::filesystem::path& name);

/// If the owner of an unfinished folder is gone, calls `work` while holding the folder's lock, so that no
/// other process does the same, and returns true. Returns false otherwise, and where the file system has no
/// locks.
bool if_abandoned(const std::filesystem::path& folder, void (*work)(const std::filesystem::path&, void*),
                  void* argument);
/// Removes the folders in `beside` whose names are `prefix` and six letters and whose owners are gone.
void remove_abandoned(const std::filesystem::path& beside, const std::string& prefix);

/// Held while finished files are renamed into place. remove_unfinished() waits for that step.
class NamesChange {
 public:
  NamesChange();

 private:
  std::unique_lock<std::timed_mutex> held_;
};

/// Removes every unfinished folder of this process and runs every Undo, for a process that ends without its
/// destructors. Afterwards no folder can be created or removed: a thread that tries blocks until the process
/// ends. Waits at most 100 ms for a NamesChange, and 10 s for a folder that is being removed; after that it
/// leaves the folders to the next run.
void remove_unfinished() noexcept;

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>

namespace octotomy::voxel {

/// A folder for unfinished work. Its name is new (mkdtemp), only its user may access it, and it is locked
/// during the lifetime of this object, so that another process can recognise a folder that a killed process
/// left. The destructor removes the folder.
class UnfinishedFolder {
 public:
  /// Creates the folder `beside`/`prefix` with six letters added to its name. Throws Error (Input or
  /// Resource) with `beside`.
  UnfinishedFolder(const std::filesystem::path& beside, const std::string& prefix);
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;
  ~UnfinishedFolder();

  const std::filesystem::path& path() const { return path_; }
  /// Whether keep() was called.
  bool is_kept() const { return path_.empty(); }
  /// Passes the folder to the caller and returns its path: neither the destructor nor remove_unfinished()
  /// removes it any more.
  std::filesystem::path keep();

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

/// Calls a function that undoes a step which is visible to others before it is finished. The function is
/// called by the destructor or by remove_unfinished(), once.
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

/// If the process that owned an unfinished folder has ended, calls `work` while the folder is locked, so that
/// no other process does the same, and returns true. Otherwise, or if the file system has no locks, returns
/// false.
bool if_abandoned(const std::filesystem::path& folder, void (*work)(const std::filesystem::path&, void*),
                  void* argument);
/// Removes the folders in `beside` whose names are `prefix` and six letters and whose processes have ended.
void remove_abandoned(const std::filesystem::path& beside, const std::string& prefix);

/// An object that exists while finished files are renamed into place. remove_unfinished() waits for its end.
class NamesChange {
 public:
  NamesChange();

 private:
  std::unique_lock<std::timed_mutex> held_;
};

/// Removes every unfinished folder of this process and runs every Undo, for a process that ends without its
/// destructors. Afterwards no folder can be created or removed: a thread that tries blocks until the process
/// ends. Waits at most 100 ms for a NamesChange, and at most 10 s for a folder that is being removed; after
/// that the next run removes the folders.
void remove_unfinished() noexcept;

}  // namespace octotomy::voxel

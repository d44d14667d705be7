// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>

namespace octotomy::voxel {

/// A folder that must not outlive unfinished work. It has a name that was free (mkdtemp), is closed to
/// others, and is locked while its owner lives, so that a later process knows what a killed one left behind.
/// Removed with the object.
class UnfinishedFolder {
 public:
  /// Makes `beside`/`prefix` with six letters added. Throws Error, Input or Resource, that names `beside`.
  UnfinishedFolder(const std::filesystem::path& beside, const std::string& prefix);
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;
  ~UnfinishedFolder();

  const std::filesystem::path& path() const { return path_; }
  /// Whether its files were given away by keep().
  bool is_kept() const { return path_.empty(); }
  /// From now on the folder is somebody else's: it is neither removed nor listed. Returns its path.
  std::filesystem::path keep();

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

/// What takes back something that others see already and that is not finished: called when the object goes,
/// or by remove_unfinished(), whichever comes first.
class Undo {
 public:
  explicit Undo(std::function<void()> undo);
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;
  ~Undo();

 private:
  std::function<void()> undo_;
};

/// Makes the folders that a name in a folder leads through, and that folder itself never: it may have been
/// removed for good meanwhile, by remove_unfinished(). Throws std::filesystem::filesystem_error.
void create_folders_in(const std::filesystem::path& folder, const std::filesystem::path& name);

/// Whether the owner of an unfinished folder is gone; then `work` is called while nobody else can find the
/// same. False, too, where the file system knows no locks.
bool if_abandoned(const std::filesystem::path& folder, void (*work)(const std::filesystem::path&, void*),
                  void* argument);
/// Removes the folders in `beside` whose names are `prefix` and six letters, and whose owners are gone.
void remove_abandoned(const std::filesystem::path& beside, const std::string& prefix);

/// Held while finished files take their names: remove_unfinished() lets that step end.
class NamesChange {
 public:
  NamesChange();

 private:
  std::unique_lock<std::timed_mutex> held_;
};

/// Removes every unfinished folder of this process and calls what each Undo holds, for a process that ends
/// without its destructors. No folder can be made or removed afterwards: a thread that tries waits for the
/// end. Waits at most 100 ms for a NamesChange, and 10 s for a folder that is being removed; after that it
/// leaves all to the next run.
void remove_unfinished() noexcept;

}  // namespace octotomy::voxel

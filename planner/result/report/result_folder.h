// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "voxel/space/unfinished_folder.h"

namespace octotomy::planner {

/// Refuses an output folder before the work starts. Throws voxel::Error (Input), which names the file and a
/// remedy, if `folder`
/// - is a file, or contains files but no list `.octotomy-result` of an earlier result;
/// - contains a listed file that was changed since;
/// - contains a file that is not listed under one of `names`, the paths that the result will write;
/// - is or contains the working folder, or is a mount point, because publishing replaces the folder itself;
/// - cannot be created or written.
/// Throws voxel::Error (Resource) if the disk has no room for the smallest page. A symbolic link to a folder
/// counts as that folder.
void need_result_folder(const std::filesystem::path& folder,
                        const std::vector<std::filesystem::path>& names = {});

/// Whether a result may probably be written to a path: nothing is there, or a folder that is empty or has a
/// list `.octotomy-result`. Reads only the list; need_result_folder() makes the complete check.
bool may_hold_result(const std::filesystem::path& folder);

/// Whether a file is in the list of a result in one of its parent folders.
bool is_of_result(const std::filesystem::path& file);

/// The SHA-256 of each file by its path within the folder.
using ResultList = std::map<std::string, std::string>;
/// The list `.octotomy-result` in a folder; empty if there is none.
ResultList result_list(const std::filesystem::path& folder);

/// A folder of results that appears only when it is complete. Its files are written into a hidden folder
/// beside its place, and publish() exchanges the two folders in one step. The file `.octotomy-result` lists
/// the written files with their SHA-256, in the form of `sha256sum -c`. A later result replaces the listed
/// files. All other files in the folder stay, and so do permissions.
class ResultFolder {
 public:
  /// Creates the hidden folder, and removes those of killed runs. Precondition: need_result_folder() has
  /// accepted the folder. publish() checks the folder again. Throws voxel::Error (Input, Resource) if the
  /// hidden folder cannot be created, and std::filesystem::filesystem_error if the folder above it cannot.
  explicit ResultFolder(const std::filesystem::path& folder);
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// The hidden folder, which exists. Files are written there until publish().
  const std::filesystem::path& path() const { return staged_->path(); }
  /// Copies files of the earlier result that this result has not written, for a result that is written again
  /// with additions. Cost: a copy of these files.
  void copy_rest();
  /// Puts the result at its place. If the process is killed before or during this, the earlier result is
  /// complete at the place; afterwards, the new one is. Throws voxel::Error (Input) if a file at the place
  /// was changed during the work or is in the way of a new one. The result is then complete beside the place,
  /// under the name in the message. Cost: reads all files, old and new.
  void publish();
  /// Whether there is anything at the place but an empty folder.
  bool replaces() const;
  /// Puts a first part of the result at its place; its page lists the missing parts. Does nothing and returns
  /// null if replaces(), because an earlier complete result is worth more. The returned object removes these
  /// files again, unless a later result has replaced them.
  std::unique_ptr<voxel::Undo> publish_early();

 private:
  /// Puts the result at its place and calls `then`. The process cannot end between the two.
  void put_in_place(const std::function<void()>& then);
  /// Throws, with the reason and the name of the complete result beside its place. `hidden` is the folder of
  /// that result, if it has already left staged_.
  [[noreturn]] void keep_beside(const std::string& reason, const std::filesystem::path& hidden = {});

  std::filesystem::path final_;                      ///< absolute; its last part is no link
  std::unique_ptr<voxel::UnfinishedFolder> staged_;  ///< beside it
};

}  // namespace octotomy::planner

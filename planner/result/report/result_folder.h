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

/// Refuses an output folder before the work. Throws voxel::Error (Input) naming the file and the way out if
/// `folder`
/// - is a file, or has files in it but no list `.octotomy-result` of what an earlier result wrote;
/// - holds a file of that list that was changed since;
/// - holds a file of somebody else under one of `names`, the paths that the result will write;
/// - is the working folder or holds it, or is a mounted one: publishing replaces the folder itself;
/// - cannot be made or written to;
/// or (Resource) whose disk has no room for the barest page.
/// A symbolic link to a folder stands for that folder.
void need_result_folder(const std::filesystem::path& folder,
                        const std::vector<std::filesystem::path>& names = {});

/// Whether a result may be put there by the look of it: nothing stands there, or a folder that is empty or
/// has the list `.octotomy-result`. Reads no file but the list; need_result_folder() tells more.
bool may_hold_result(const std::filesystem::path& folder);

/// Whether the list of a result, in a folder above, names this file.
bool is_of_result(const std::filesystem::path& file);

/// SHA-256 by path within the folder.
using ResultList = std::map<std::string, std::string>;
/// What `.octotomy-result` in a folder says was written there; empty without that list.
ResultList result_list(const std::filesystem::path& folder);

/// A folder of results that appears whole or not at all. Files are written into a hidden folder beside the
/// place; publish() exchanges the two in one step. The file `.octotomy-result` lists what was written with
/// its SHA-256 (`sha256sum -c` reads it). The next result replaces the listed files; all others stay, as do
/// permissions.
class ResultFolder {
 public:
  /// Makes the hidden folder and removes those that killed runs left. Precondition: need_result_folder()
  /// accepted the folder before the work. Does not check the folder again: publish() does, and keeps the
  /// result if the check fails. Throws voxel::Error (Input, Resource) if the hidden folder cannot be made,
  /// and std::filesystem::filesystem_error if the folder above cannot.
  explicit ResultFolder(const std::filesystem::path& folder);
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// The folder to write into until publish(); exists.
  const std::filesystem::path& path() const { return staged_->path(); }
  /// Copies the files of the earlier result that were not written anew; for a result that is written again
  /// with more in it. Cost: a copy of these files.
  void copy_rest();
  /// Puts the result in its place. A process that is killed before or within leaves the earlier result whole
  /// under its name; after, the new one. Throws voxel::Error (Input) if a file of the place was changed or
  /// put in the way during the work; the result then stays complete beside it, under the name in the message.
  /// Cost: one reading of all files, old and new.
  void publish();
  /// Whether anything stands in its place by now but an empty folder.
  bool replaces() const;
  /// As publish(), for a first part of the result that says what it lacks; not where it replaces(),
  /// since an earlier result is worth more than a part of the next: then it does nothing and returns null.
  /// The answer takes the files out again, unless a later result has replaced them by then.
  std::unique_ptr<voxel::Undo> publish_early();

 private:
  /// Calls `then` before any ending can come between.
  void put_in_place(const std::function<void()>& then);
  /// `hidden` is where the staged files are once they were kept.
  [[noreturn]] void keep_beside(const std::string& reason, const std::filesystem::path& hidden = {});

  std::filesystem::path final_;                      ///< absolute, without links at its end
  std::unique_ptr<voxel::UnfinishedFolder> staged_;  ///< beside it
};

}  // namespace octotomy::planner

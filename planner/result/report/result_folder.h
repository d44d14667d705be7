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
/// - is a file, or has files in it but no list `.octotomy-result` of an earlier result;
/// - contains a file of that list that was changed since;
/// - contains a file that is not in that list under one of `names`, the paths that the result will write;
/// - is or contains the working folder, or is a mount point: publishing replaces the folder itself;
/// - cannot be made or written to; or (Resource) if the disk has no room for the smallest page. A symbolic
///   link to a folder counts as that folder.
void need_result_folder(const std::filesystem::path& folder,
                        const std::vector<std::filesystem::path>& names = {});

/// A quick check whether a result may be written there: the path does not exist, or is a folder that is empty
/// or has the list `.octotomy-result`. Reads only the list; need_result_folder() checks completely.
bool may_hold_result(const std::filesystem::path& folder);

/// Whether the list of a result in a parent folder contains this file.
bool is_of_result(const std::filesystem::path& file);

/// SHA-256 by path within the folder.
using ResultList = std::map<std::string, std::string>;
/// The files in a folder's `.octotomy-result`; empty without that list.
ResultList result_list(const std::filesystem::path& folder);

/// A folder of results that appears completely or not at all. Files are written into a hidden folder beside
/// the place; publish() exchanges the two in one step. The file `.octotomy-result` lists the written files
/// with their SHA-256 (readable by `sha256sum -c`). The next result replaces the listed files; all other
/// files and permissions are preserved.
class ResultFolder {
 public:
  /// Makes the hidden folder and removes those of killed runs. Precondition: need_result_folder() accepted
  /// the folder before the work. Does not check the folder again: publish() does, and preserves the result if
  /// the check fails. Throws voxel::Error (Input, Resource) if the hidden folder cannot be made, and
  /// std::filesystem::filesystem_error if the folder above cannot.
  explicit ResultFolder(const std::filesystem::path& folder);
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// The folder to write into until publish(); exists.
  const std::filesystem::path& path() const { return staged_->path(); }
  /// Copies the files of the earlier result that were not written again, for a result that is rewritten with
  /// additions. Cost: a copy of these files.
  void copy_rest();
  /// Publishes the result at its place. If the process is killed before or during this, the earlier result is
  /// complete under its name; afterwards, the new one. Throws voxel::Error (Input) if a file of the place was
  /// changed or added in the way during the work; the result is then complete beside it, under the name in
  /// the message. Cost: one reading of all files, old and new.
  void publish();
  /// Whether its place now contains anything but an empty folder.
  bool replaces() const;
  /// Publishes a first part of the result, which lists the missing parts. Does nothing and returns null if
  /// replaces(), because an earlier complete result is worth more. The returned object removes the files
  /// again, unless a later result has replaced them.
  std::unique_ptr<voxel::Undo> publish_early();

 private:
  /// Publishes and calls `then` before the process can end in between.
  void put_in_place(const std::function<void()>& then);
  /// `hidden` is the folder of the staged files after keep().
  [[noreturn]] void keep_beside(const std::string& reason, const std::filesystem::path& hidden = {});

  std::filesystem::path final_;                      ///< absolute, without links at its end
  std::unique_ptr<voxel::UnfinishedFolder> staged_;  ///< beside it
};

}  // namespace octotomy::planner

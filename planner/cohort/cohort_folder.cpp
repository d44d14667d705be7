// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A file in code/ belongs to Octotomy if the list has its name with the SHA-256 of its content. A line is
// added before the file is written and never removed, so that after a kill between the two the next command
// still recognises the file as Octotomy's.
#include "planner/cohort/cohort_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <sys/file.h>
#include <unistd.h>

#include "planner/operation/table/json.h"
#include "planner/plan/sha256.h"
#include "planner/result/report/result_folder.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"
#include "voxel/space/write_failure.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

constexpr const char* plan_name = "plan.plan.json";
constexpr const char* description_name = "dataset_description.json";
constexpr const char* list_begin =
    "# What octotomy cohort wrote here and may replace while it is unchanged.\n";

fs::path list_of(const fs::path& out) {
  return out / "code/octotomy.sha256";
}

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
  voxel::refuse(path, why + ", or choose another OUT");
}

/// Refuses a path at which there is something else than a regular file: reading a pipe, for example, would
/// block.
void need_file(const fs::path& path) {
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(path)) && !fs::is_regular_file(path, ignored))
    refuse(path, "is no regular file: move it");
}

/// Refuses a path that is not a folder or cannot be written. If it does not exist, checks its nearest
/// existing parent. Creates a file as a test, because permissions alone do not show whether writing succeeds.
void need_writable_folder(fs::path folder, const fs::path& out) {
  while (!fs::exists(fs::symlink_status(folder))) folder = folder.parent_path();
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) refuse(folder, "is no folder: move it");
  try {
    const voxel::StagedFiles trial(folder);
  } catch (const voxel::Error& error) {
    throw voxel::Error(error.code(), out.string() + ": " + error.what());
  }
}

std::string description_text(const std::string& version) {
  const Json description{{"Name", "Octotomy"},
                         {"BIDSVersion", "1.8.0"},
                         {"DatasetType", "derivative"},
                         {"GeneratedBy", {{{"Name", "octotomy"}, {"Version", version}}}}};
  return description.dump(2) + "\n";
}

/// Who has written the file dataset_description.json: this program, a person who edited it, or another
/// program.
enum class Description { None, Generated, Edited, Foreign };

Description description_of(const fs::path& path) {
  if (!fs::exists(fs::symlink_status(path))) return Description::None;
  const std::string text = voxel::file_bytes(path);
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("GeneratedBy") || !json["GeneratedBy"].is_array())
    return Description::Foreign;
  for (const Json& maker : json["GeneratedBy"]) {
    if (!maker.is_object() || maker.value("Name", Json()) != "octotomy") continue;
    const Json version = maker.value("Version", Json());
    return version.is_string() && text == description_text(version.get<std::string>())
               ? Description::Generated
               : Description::Edited;
  }
  return Description::Foreign;
}

Description need_description(const fs::path& out) {
  const fs::path path = out / description_name;
  const Description found = description_of(path);
  if (found == Description::Foreign)
    refuse(path, "describes a dataset that octotomy cohort has not written: move it");
  return found;
}

bool is_ours(const fs::path& out, const std::string& name) {
  const fs::path path = out / "code" / name;
  if (!fs::exists(fs::symlink_status(path))) return true;
  if (!fs::is_regular_file(path)) return false;
  // GNU parallel appends to its log, so the log has no fixed checksum.
  if (name == cohort_log) return voxel::file_bytes(path).starts_with("Seq\tHost\tStarttime");
  const std::string list = voxel::file_bytes(list_of(out));
  if (list.empty()) return description_of(out / description_name) != Description::None;
  return list.starts_with(list_begin) &&
         list.find(sha256_of_path(path) + "  " + name + "\n") != std::string::npos;
}

void need_ours(const fs::path& out, const std::string& name) {
  if (!is_ours(out, name))
    refuse(out / "code" / name, "is not Octotomy's, or was changed after Octotomy wrote it: move it");
}

/// The list `code/octotomy.sha256`, open and locked. Only one process at a time can hold the lock and write
/// to code/.
class LockedList {
 public:
  explicit LockedList(const fs::path& out)
      : path_(list_of(out)), file_(::open(path_.c_str(), O_CREAT | O_RDWR | O_APPEND | O_CLOEXEC, 0666)) {
    if (file_ < 0) voxel::refuse_unwritten(path_, errno);
    ::flock(file_, LOCK_EX);
    is_new_ = voxel::file_bytes(path_).empty();
  }
  LockedList(const LockedList&) = delete;
  LockedList& operator=(const LockedList&) = delete;
  ~LockedList() { ::close(file_); }

  bool is_new() const { return is_new_; }
  void add(const std::string& lines) const {
    const std::string text = (is_new_ ? list_begin : "") + lines;
    errno = 0;
    if (::write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      voxel::refuse_unwritten(path_, errno);
  }

 private:
  fs::path path_;
  int file_;
  bool is_new_ = true;
};

}  // namespace

fs::path cohort_plan(const fs::path& out) {
  return out / "code" / plan_name;
}

fs::path cohort_locks(const fs::path& out) {
  return out / "code/locks";
}

void need_cohort_folder(const fs::path& out, const CohortNeeds& needs) {
  const fs::path place = voxel::place_of(out);
  for (const fs::path& file : {out / description_name, list_of(out), cohort_plan(out)}) need_file(file);
  need_description(out);
  const std::string list = voxel::file_bytes(list_of(out));
  if (!list.empty() && !list.starts_with(list_begin)) refuse(list_of(out), "is not Octotomy's: move it");
  if (!needs.plan_text.empty() && voxel::file_bytes(cohort_plan(out)) != needs.plan_text)
    need_ours(out, plan_name);
  for (const std::string& name : needs.files) need_ours(out, name);
  for (const std::string& name : needs.folders)
    if (!may_hold_result(out / name)) refuse(out / name, "is not a result, so it may be yours: move it");
  for (const fs::path& folder : {place, place / "code", cohort_locks(place)})
    need_writable_folder(folder, out);
}

void prepare_cohort_folder(const fs::path& out, const std::string& plan_text) {
  fs::create_directories(voxel::place_of(out) / "code");
  const Description found = need_description(out);
  {
    const LockedList list(out);
    if (list.is_new()) {
      // A cohort's folder without the list is from an earlier version. Its files in code/ are taken to be
      // Octotomy's.
      std::string lines;
      if (found != Description::None)
        for (const char* name : {plan_name, cohort_labels, cohort_participant_script, cohort_group_script})
          if (const fs::path path = out / "code" / name; fs::is_regular_file(path))
            lines += sha256_of_path(path) + "  " + name + "\n";
      list.add(lines);
    }
  }
  const std::string description = description_text(OCTOTOMY_VERSION);
  if (found != Description::Edited && voxel::file_bytes(out / description_name) != description)
    voxel::write_whole(out / description_name, description);
  if (!plan_text.empty()) write_cohort_file(out, plan_name, plan_text);
}

void write_cohort_file(const fs::path& out, const std::string& name, const std::string& text) {
  const fs::path path = out / "code" / name;
  const LockedList list(out);
  if (fs::exists(path) && voxel::file_bytes(path) == text) return;
  need_ours(out, name);
  list.add(sha256_of(text) + "  " + name + "\n");
  voxel::write_whole(path, text);
}

}  // namespace octotomy::planner

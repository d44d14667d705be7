// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// The files and folders that a command will write into a cohort's folder.
struct CohortNeeds {
  std::string plan_text;             ///< stored as cohort_plan(); empty: the stored plan is not changed
  std::vector<std::string> files;    ///< files that engines write into code/, such as cohort_labels
  std::vector<std::string> folders;  ///< folders of results: "sub-01", "group"
};

/// Names in code/ that engines write.
inline constexpr const char* cohort_labels = "subjects.txt";
inline constexpr const char* cohort_participant_script = "participant.sbatch";
inline constexpr const char* cohort_group_script = "group.sbatch";
inline constexpr const char* cohort_log = "parallel.log";

/// The plan that was last applied to every subject.
std::filesystem::path cohort_plan(const std::filesystem::path& out);
/// The folder with one file per subject, locked by the process that works on the subject.
std::filesystem::path cohort_locks(const std::filesystem::path& out);

/// Refuses a cohort's folder before anything is written to it. Throws voxel::Error (Input) that names the
/// file and the way out if
/// - `dataset_description.json` does not name Octotomy in GeneratedBy;
/// - the kept plan, unless it is the same, or a file of `needs` was not written by a cohort, or was changed
/// since;
/// - the list `code/octotomy.sha256` is another file;
/// - the description, the list or the kept plan is not a regular file;
/// - a folder of `needs` holds files but no result (may_hold_result());
/// - `out`, `code` or cohort_locks() is not a folder, or cannot be made or written to (or Resource, by the
///   cause). A link to a missing folder counts as that folder. A folder that was made before the list existed
///   counts as Octotomy's by its description. Cost: reads each folder.
void need_cohort_folder(const std::filesystem::path& out, const CohortNeeds& needs);

/// Makes the folder, its description and the kept plan. Precondition: need_cohort_folder(). Throws as that
/// does, and std::filesystem::filesystem_error or voxel::Error if the disk is full or fails.
void prepare_cohort_folder(const std::filesystem::path& out, const std::string& plan_text);

/// Writes a file `name` in code/ by a temporary file that is renamed into place, unless it exists with this
/// text. By the list `code/octotomy.sha256`, later commands recognise the text as Octotomy's. Several
/// processes may do this at once. Throws as prepare_cohort_folder() does.
void write_cohort_file(const std::filesystem::path& out, const std::string& name, const std::string& text);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// The files and folders that a command will write into a cohort's folder.
struct CohortNeeds {
  std::string plan_text;             ///< text to be stored as cohort_plan(); empty: the stored plan stays
  std::vector<std::string> files;    ///< files that engines write into code/, such as "subjects.txt"
  std::vector<std::string> folders;  ///< folders of results: "sub-01", "group"
};

/// Names of the files that engines write into code/.
inline constexpr const char* cohort_labels = "subjects.txt";
inline constexpr const char* cohort_participant_script = "participant.sbatch";
inline constexpr const char* cohort_group_script = "group.sbatch";
inline constexpr const char* cohort_log = "parallel.log";

/// The file with the plan that the cohort's last command used.
std::filesystem::path cohort_plan(const std::filesystem::path& out);
/// The folder with a file for each subject. A process that works on the subject holds a lock on that file.
std::filesystem::path cohort_locks(const std::filesystem::path& out);

/// Checks a cohort's folder before anything is written to it. Throws voxel::Error (Input), with the file and
/// what to do, in these cases:
/// - `dataset_description.json` does not name Octotomy in GeneratedBy.
/// - A file of `needs`, or a stored plan that differs from that of `needs`, was not written by a cohort or
///   was changed since.
/// - The list `code/octotomy.sha256` is another file.
/// - The description, the list or the stored plan is not a regular file.
/// - A folder of `needs` contains files but no result (may_hold_result()).
/// - `out`, `code` or cohort_locks() is not a folder, or cannot be created or written to (or Resource, by the
///   cause). A link to a missing folder counts as that folder.
/// A folder that was made before the list existed counts as Octotomy's by its description. Cost: reads each
/// folder.
void need_cohort_folder(const std::filesystem::path& out, const CohortNeeds& needs);

/// Creates the cohort's folder with its description, and stores the plan in it. Precondition:
/// need_cohort_folder(). Throws as need_cohort_folder() does, and std::filesystem::filesystem_error or
/// voxel::Error if the disk is full or fails.
void prepare_cohort_folder(const std::filesystem::path& out, const std::string& plan_text);

/// Writes a text as the file `name` in code/ and records its checksum in `code/octotomy.sha256`, by which
/// later commands recognise the file as Octotomy's. The file is replaced as a whole, and only if its text
/// differs. Several processes may do this at once. Throws as prepare_cohort_folder() does.
void write_cohort_file(const std::filesystem::path& out, const std::string& name, const std::string& text);

}  // namespace octotomy::planner

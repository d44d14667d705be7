// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// A person of a cohort in one session.
struct Subject {
  std::string label;  ///< "01", or "01_ses-2" if there are sessions; letters, digits, _ and -
  std::map<std::string, std::filesystem::path> scans;  ///< by their names in the plan
  std::string trouble = {};                            ///< why its scans are unknown; empty: they are known
  std::filesystem::path place = {};  ///< the BIDS folder with its files; empty: a table names its scans

  std::string folder() const { return "sub-" + label; }
  /// Total size of its scans' files, including all files in folders.
  std::uint64_t scan_bytes() const;
};

/// The subjects of a cohort, by label. `input` is
/// - a BIDS folder: sub-LABEL, optionally with ses-LABEL in it. If a subject has sessions and also scans
///   outside them, these form one more subject. A plan's scan NAME is the file of a subject that ends in
///   _NAME before its extension, or the subject's only scan; label maps (_dseg, _mask, ...) are not counted
///   as scans there;
/// - a .csv, or a .tsv of tabs: a column participant_id (or subject), and one column per scan of the plan; a plan's
///   only scan may have the column `scan`. Paths are relative to the table. For BIDS's participants.tsv, which has no
///   columns of scans, the subjects are the folders beside it. Throws voxel::Error (Input) with path and reason: a
///   path that is neither a folder nor a file; no subjects; a duplicate label or one with other characters; a missing
///   column. A subject whose scans are unknown has `trouble` set.
std::vector<Subject> find_subjects(const std::filesystem::path& input, const Plan& plan);

/// Doubts about the whole cohort, one sentence each: subjects that share the path of a scan, and unused
/// columns of a table of scans. None for BIDS's participants.tsv, whose columns describe people. Throws as
/// find_subjects() does if the table cannot be read.
std::vector<std::string> doubts_of_cohort(const std::filesystem::path& input, const Plan& plan,
                                          const std::vector<Subject>& subjects);

/// A file that a step reads and that is not beside the plan: the file in the subject's folder that has this
/// name, or a name that ends in "_" and this name. Empty if there is none or the subject has no folder.
/// Throws voxel::Error (Input) if there are several.
std::filesystem::path file_of_subject(const Subject& subject, const std::filesystem::path& name);

/// The subjects with one of these labels, with or without "sub-"; if no subject has exactly this label, all
/// its sessions; all subjects if there are no labels. Throws voxel::Error (Input), with the nearest label, if
/// one does not exist.
std::vector<Subject> chosen_subjects(std::vector<Subject> subjects, const std::vector<std::string>& labels);

}  // namespace octotomy::planner

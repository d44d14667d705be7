// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// Someone of a cohort, at one time.
struct Subject {
  std::string label;  ///< "01", or "01_ses-2" where there are sessions; letters, digits, _ and -
  std::map<std::string, std::filesystem::path> scans;  ///< by their names in the plan
  std::string trouble = {};                            ///< why its scans are unknown; empty: they are known
  std::filesystem::path place = {};  ///< the BIDS folder with its files; empty: a table names its scans

  std::string folder() const { return "sub-" + label; }
  /// Bytes of its scans' files; folders count with what they hold.
  std::uint64_t scan_bytes() const;
};

/// The subjects of a cohort, by label. `input` is
/// - a BIDS folder: sub-LABEL, with ses-LABEL in it or not. A subject with sessions and scans of its own
///   outside of them is one more. A plan's scan NAME is the file of a subject that ends in _NAME before its
///   extension, or the subject's only scan; label maps (_dseg, _mask, ...) are not counted as scans there;
/// - a .csv, or a .tsv of tabs: a column participant_id (or subject), and a column a plan's scan; `scan`
///   stands for a plan's only one. Paths are relative to the table. Of BIDS's participants.tsv, which has no
///   column of scans, the subjects' folders beside it.
/// Throws voxel::Error (Input) with path and reason: no folder or file, but a pipe or device; no subjects, a
/// label said twice or not of those letters, a missing column. A subject without its scans has its trouble
/// told.
std::vector<Subject> find_subjects(const std::filesystem::path& input, const Plan& plan);

/// What is doubtful about a cohort as a whole, a sentence each: subjects that have one scan's path in common,
/// and columns of a table of scans that nothing reads. Nothing of BIDS's participants.tsv, whose columns
/// describe people. Throws as find_subjects() where the table cannot be read.
std::vector<std::string> doubts_of_cohort(const std::filesystem::path& input, const Plan& plan,
                                          const std::vector<Subject>& subjects);

/// A file that a step reads and that is not beside the plan: the file of the subject's folder with this name,
/// or with this name behind "_". Empty where there is none or the subject has no folder. Throws voxel::Error
/// (Input) where there are several.
std::filesystem::path file_of_subject(const Subject& subject, const std::filesystem::path& name);

/// Those with one of these labels, "sub-" before them or not; of a label that none has whole, its sessions;
/// all where there are no labels. Throws
/// voxel::Error (Input) with the nearest label where one is not there.
std::vector<Subject> chosen_subjects(std::vector<Subject> subjects, const std::vector<std::string>& labels);

}  // namespace octotomy::planner

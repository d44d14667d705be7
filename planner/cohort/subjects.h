// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// A subject of a cohort: a person, or a person in one session.
struct Subject {
  std::string label;  ///< "01", or "01_ses-2" if there are sessions; letters, digits, _ and -
  std::map<std::string, std::filesystem::path> scans;  ///< files of the scans, by the plan's names of scans
  std::string trouble = {};                            ///< why a scan could not be found; empty if all were
  std::filesystem::path place = {};  ///< the subject's BIDS folder; empty if a table names the scans

  std::string folder() const { return "sub-" + label; }
  /// Total size of the files of its scans; for a scan that is a folder, of all files in it.
  std::uint64_t scan_bytes() const;
};

/// Finds the subjects of a cohort, sorted by label. `input` is one of:
/// - A BIDS folder with folders sub-LABEL, which may contain ses-LABEL. Each session is a subject; scans
///   outside of sessions form another one. A plan's scan NAME is the file that ends in _NAME before its
///   extension, or else the subject's only scan. Label maps (_dseg, _mask, ...) do not count as scans.
/// - A .csv, or a .tsv with tabs: a column participant_id (or subject), and a column for each scan of the
///   plan. If the plan has one scan, its column may be called `scan`. Paths are relative to the table. For
///   BIDS's participants.tsv, which has no columns of scans, the subjects are the folders beside it.
/// Throws voxel::Error (Input), with path and reason, if the path is neither a folder nor a file, if there is
/// no subject, if a label occurs twice or has other characters than letters, digits, _ and -, or if a column
/// is missing. A subject whose scans cannot be found has `trouble` set.
std::vector<Subject> find_subjects(const std::filesystem::path& input, const Plan& plan);

/// Doubts about the cohort as a whole, one sentence each: subjects that share the file of a scan, and columns
/// of a table of scans that no scan of the plan uses. Columns of BIDS's participants.tsv raise no doubt,
/// because they describe people. Throws as find_subjects() does if the table cannot be read.
std::vector<std::string> doubts_of_cohort(const std::filesystem::path& input, const Plan& plan,
                                          const std::vector<Subject>& subjects);

/// The subject's own file for a file that a step reads: in the subject's folder, a file of the same name, or
/// one whose name ends in "_" and that name. Empty if there is none or the subject has no folder. Throws
/// voxel::Error (Input) if there are several.
std::filesystem::path file_of_subject(const Subject& subject, const std::filesystem::path& name);

/// The subjects with these labels, with or without "sub-". A label that no subject has chooses all sessions
/// of the person with this label. Returns all subjects if there are no labels. Throws voxel::Error (Input),
/// with the most similar label, if a label chooses no subject.
std::vector<Subject> chosen_subjects(std::vector<Subject> subjects, const std::vector<std::string>& labels);

}  // namespace octotomy::planner

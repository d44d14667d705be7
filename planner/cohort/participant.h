// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "planner/cohort/subjects.h"
#include "planner/operation/table/fault.h"
#include "planner/plan/plan.h"

namespace octotomy::planner {

/// The state of a subject's answer. Stored in subject.json in the subject's folder.
struct SubjectRecord {
  /// Done and Doubtful have an answer; Doubtful: the audit of a scan has a FAIL. Changed: a file of the
  /// answer was changed after it was written, so its numbers are not used. Failed and Missing have none.
  enum class State { Done, Doubtful, Failed, Missing, Changed };

  State state = State::Missing;
  std::string reason;  ///< why there is no answer
  /// The kind of error that ended the evaluation; none if there was none. Internal is a mistake in the
  /// program.
  std::optional<Fault> fault = {};
  /// Each WARN and FAIL of the scans' audits, worded as in ScanAudits.
  std::vector<std::string> audit_findings = {};
  std::string key;  ///< covers plan, scans and the program's version; equal keys mean equal answers
  double seconds = 0.0;
  double peak_mb = 0.0;             ///< the process's largest memory
  std::uint64_t scan_bytes = 0;     ///< total size of the scans' files
  bool was_kept = false;            ///< this run used an earlier answer with the same key
  bool is_another_at_work = false;  ///< this run did nothing, because another process works on the subject

  bool has_answer() const { return state == State::Done || state == State::Doubtful; }
};

std::string to_string(SubjectRecord::State state);

struct ParticipantOptions {
  std::stop_token stop;
  std::function<void(const std::string& doing, double fraction)> progress;
  bool again = false;    ///< evaluates subjects again whose answer has the same key
  bool reports = false;  ///< also writes each subject's report and files
};

/// Evaluates the plan on a subject's scans and writes the answer into out/sub-LABEL: subject.json, rows.csv
/// (the subject's rows of the long table), result.json and picture.png; with `reports` also the whole result,
/// in report/. The folder is replaced as a whole when the answer is complete. An answer with the same key is
/// used again. A subject in the state Changed is not evaluated. If the evaluation fails, the record states
/// the reason. Throws Stopped, and voxel::Error if the answer cannot be written.
SubjectRecord run_participant(const Plan& plan, const Subject& subject, const std::filesystem::path& out,
                              const ParticipantOptions& options = {});

/// Reads the record of a subject. Its state is Missing if there is none or a file of the answer is missing,
/// and Changed if subject.json, rows.csv or result.json differs from the folder's list. Does not block on
/// pipes. Cost: reads these files.
SubjectRecord subject_record(const std::filesystem::path& out, const Subject& subject);

}  // namespace octotomy::planner

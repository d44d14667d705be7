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

/// The state of a subject, as recorded in its folder's subject.json.
struct SubjectRecord {
  /// Doubtful: there is an answer, and the audit of a scan has a FAIL. Changed: a file of the answer was
  /// changed after it was written, so the subject's numbers are not used.
  enum class State { Done, Doubtful, Failed, Missing, Changed };

  State state = State::Missing;
  std::string reason;  ///< why there is no answer
  /// The kind of the error that ended the evaluation of a subject. Internal: a mistake in the program.
  std::optional<Fault> fault = {};
  /// Every WARN and FAIL of the audits of its scans, as ScanAudits has them.
  std::vector<std::string> audit_findings = {};
  std::string key;  ///< key of the plan, the program's version and the scans; equal keys mean equal answers
  double seconds = 0.0;
  double peak_mb = 0.0;             ///< the process's largest memory
  std::uint64_t scan_bytes = 0;     ///< total size of the scans' files
  bool was_kept = false;            ///< an earlier run's answer with the same key was kept
  bool is_another_at_work = false;  ///< nothing was done, because another process works on the subject

  bool has_answer() const { return state == State::Done || state == State::Doubtful; }
};

std::string to_string(SubjectRecord::State state);

struct ParticipantOptions {
  std::stop_token stop;
  std::function<void(const std::string& doing, double fraction)> progress;
  bool again = false;    ///< also evaluates subjects that are done
  bool reports = false;  ///< writes each subject's report and files as well
};

/// Evaluates the plan on a subject's scans into out/sub-LABEL: subject.json, rows.csv (the long table's
/// rows), result.json and picture.png; with `reports` the whole result in report/. The folder appears
/// completely or not at all, so after a kill the earlier folder remains. A subject that is done with the same
/// key is kept. A changed subject is not evaluated; its record has the state Changed. A failure is also
/// recorded, with its reason. Throws Stopped, and voxel::Error if the answer cannot be written to disk.
SubjectRecord run_participant(const Plan& plan, const Subject& subject, const std::filesystem::path& out,
                              const ParticipantOptions& options = {});

/// The record of a subject's folder. Missing if there is none or a file of the answer is absent. Changed if
/// subject.json, rows.csv or result.json does not agree with the folder's list. Never blocks on a pipe. Cost:
/// reads these files.
SubjectRecord subject_record(const std::filesystem::path& out, const Subject& subject);

}  // namespace octotomy::planner

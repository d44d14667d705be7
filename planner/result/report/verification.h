// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/measure/result_json.h"
#include "planner/result/report/report.h"
#include "verify/certificate/certificate.h"

namespace octotomy::planner {

/// What was verified and what came of it.
struct Verification {
  std::string subject;  ///< a plan, two files and their operation, or a suite
  VerdictCounts counts;
  Json answer;  ///< whole: "certificates", "counts", "timings_ms" and what a suite adds
  /// What was asked and has no certificate, a sentence each.
  std::vector<std::string> not_covered;
  std::optional<verify::Contested> worst;  ///< the objects that take up most of a tolerance
};

/// One HTML page: verdicts, the differences as shares of what is allowed for each quantity, pictures of the
/// worst, the suite's own tables, and what was not covered.
std::string verification_html(const Verification& verification);

/// Writes a folder with report.html and result.json, whole or not at all. Precondition and errors: as of
/// ResultFolder.
void write_verification(const Verification& verification, const std::filesystem::path& folder);

}  // namespace octotomy::planner

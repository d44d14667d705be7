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

/// The subject and results of a verification.
struct Verification {
  std::string subject;  ///< a plan, two files and their operation, or a suite
  VerdictCounts counts;
  Json answer;  ///< complete: "certificates", "counts", "timings_ms" and members that a suite adds
  /// Requests without a certificate, one sentence each.
  std::vector<std::string> not_covered;
  std::optional<verify::Contested> worst;  ///< the objects with the largest share of a tolerance
};

/// One HTML page: verdicts, the differences as shares of the tolerance of each quantity, pictures of the
/// worst, the suite's own tables, and requests that were not covered.
std::string verification_html(const Verification& verification);

/// Writes a folder with report.html and result.json, completely or not at all. Precondition and errors are
/// those of ResultFolder.
void write_verification(const Verification& verification, const std::filesystem::path& folder);

}  // namespace octotomy::planner

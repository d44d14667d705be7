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

/// The subject and the results of a verification.
struct Verification {
  std::string subject;  ///< a plan, two files with an operation, or a suite
  VerdictCounts counts;
  Json answer;  ///< complete: "certificates", "counts", "timings_ms" and members that a suite adds
  /// Why there is no certificate for a part of the request, one sentence for each part.
  std::vector<std::string> not_covered;
  std::optional<verify::Contested> worst;  ///< the object with the largest share of a tolerance
};

/// One HTML page: verdicts, differences as shares of their tolerances, pictures of the worst object, the
/// suite's own tables, and the requests without a certificate.
std::string verification_html(const Verification& verification);

/// Writes a folder with report.html and result.json, which appears only when it is complete. Precondition and
/// exceptions as for ResultFolder.
void write_verification(const Verification& verification, const std::filesystem::path& folder);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// A person's statement to have read and approved a plan. It contains checksums of the plan and its scans, so
/// that later changes are detected. It does not prove who signed.
struct Signature {
  std::string by, as, note;  ///< name, role ("second reader") and remark; `note` may be empty
  std::string at;            ///< UTC, "2026-01-31T12:00:00Z"
  std::string plan_sha256;   ///< sum_of_plan()
  std::map<std::string, std::string> scans_sha256;  ///< by the names of the scans in the plan
};

/// SHA-256 of a plan's content: its JSON with sorted keys, without signatures and without paths of scans. It
/// depends neither on the layout of the text nor on the folder.
std::string sum_of_plan(const std::string& text);

/// The signatures in a plan's text, in their order. Throws std::runtime_error, with the place in the text, if
/// one is invalid.
std::vector<Signature> signatures_of(const std::string& text);

/// Makes a signature for the current plan and scans. Throws std::runtime_error if a scan cannot be read.
/// Cost: reads all files of the scans.
Signature sign(const Plan& plan, const std::string& by, const std::string& as, const std::string& note);

/// The text of a plan with a further signature.
std::string with_signature(const std::string& text, const Signature& signature);

/// SHA-256 of each scan whose files exist, by the scan's name in the plan. Cost: reads all files of the
/// scans.
std::map<std::string, std::string> sums_of_scans(const Plan& plan);

/// The parts that have changed after a signature, such as "the plan" or "scan ct". Empty: the signature is
/// valid. `sums` are checksums of the present scans; a scan that it lacks counts as unchanged.
std::vector<std::string> changed_since(const Signature& signature, const std::string& text,
                                       const std::map<std::string, std::string>& sums);

/// {"by", "as", "note", "at", "plan_sha256", "scans_sha256"}.
nlohmann::ordered_json to_json(const Signature& signature);

}  // namespace octotomy::planner

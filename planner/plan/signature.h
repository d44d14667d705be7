// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// Who has read a plan and stands by it. It says what was read by sums, so that a later change is seen; it is
/// no proof of who signed.
struct Signature {
  std::string by, as, note;  ///< name, role ("second reader"), what the reader adds; `note` may be empty
  std::string at;            ///< UTC, "2026-01-31T12:00:00Z"
  std::string plan_sha256;   ///< sum_of_plan()
  std::map<std::string, std::string> scans_sha256;  ///< by the plan's names of scans
};

/// The SHA-256 of what a plan does: its JSON without signatures and without the paths of scans, keys in
/// order, so that neither layout nor another folder changes it.
std::string sum_of_plan(const std::string& text);

/// The signatures in a plan's text, in their order. Throws std::runtime_error with the place in it.
std::vector<Signature> signatures_of(const std::string& text);

/// A reader's signature of a plan as it is, on its scans as they are. Throws std::runtime_error where a scan
/// cannot be read. Cost: reads the scans' files.
Signature sign(const Plan& plan, const std::string& by, const std::string& as, const std::string& note);

/// The plan's text with one more signature.
std::string with_signature(const std::string& text, const Signature& signature);

/// What has changed since: "the plan", "scan ct"; empty where the signature holds. Scans that `sums` does not
/// name are passed over.
std::vector<std::string> changed_since(const Signature& signature, const std::string& text,
                                       const std::map<std::string, std::string>& sums);

/// {"by", "as", "note", "at", "plan_sha256", "scans_sha256"}.
nlohmann::ordered_json to_json(const Signature& signature);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// A statement that a person has read and approved a plan. It identifies the plan and scans by checksums, so
/// that later changes are detected. It does not prove who signed.
struct Signature {
  std::string by, as, note;  ///< name, role ("second reader") and remark; `note` may be empty
  std::string at;            ///< UTC, "2026-01-31T12:00:00Z"
  std::string plan_sha256;   ///< sum_of_plan()
  std::map<std::string, std::string> scans_sha256;  ///< by the plan's names of scans
};

/// The SHA-256 of a plan's content: its JSON without signatures and paths of scans, with sorted keys, so it
/// depends neither on the layout nor on the folder.
std::string sum_of_plan(const std::string& text);

/// The signatures in a plan's text, in the order of the text. Throws std::runtime_error with the position in
/// the text.
std::vector<Signature> signatures_of(const std::string& text);

/// A reader's signature of the current plan and scans. Throws std::runtime_error if a scan cannot be read.
/// Cost: reads the scans' files.
Signature sign(const Plan& plan, const std::string& by, const std::string& as, const std::string& note);

/// The plan's text with one more signature.
std::string with_signature(const std::string& text, const Signature& signature);

/// The SHA-256 of each scan whose file exists, by the plan's names. Cost: reads the scans' files.
std::map<std::string, std::string> sums_of_scans(const Plan& plan);

/// The parts that have changed since: "the plan", "scan ct"; empty if the signature is valid. Ignores scans
/// that `sums` does not name.
std::vector<std::string> changed_since(const Signature& signature, const std::string& text,
                                       const std::map<std::string, std::string>& sums);

/// {"by", "as", "note", "at", "plan_sha256", "scans_sha256"}.
nlohmann::ordered_json to_json(const Signature& signature);

}  // namespace octotomy::planner

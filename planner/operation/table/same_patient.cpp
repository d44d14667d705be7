// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/same_patient.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "voxel/dicom/identity.h"

namespace octotomy::planner {
namespace {

std::string joined(const std::vector<std::string>& words, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? last : ", ") + words[i];
  return text;
}

bool states_nothing(const voxel::Identity& identity) {
  return identity.patient_id.empty() && identity.patient_name.empty() && identity.study_uids.empty() &&
         identity.frame_uids.empty();
}

/// A WARN if `laid` refers only to images of other series than that of the scan; empty if either of them
/// states no series.
std::vector<std::string> other_series(const IdentityOf& scan, const IdentityOf& laid) {
  const std::string& own = scan.identity.series_uid;
  const std::vector<std::string>& referred = laid.identity.referred_series_uids;
  if (own.empty() || referred.empty() || std::find(referred.begin(), referred.end(), own) != referred.end())
    return {};
  return {"WARN: series: " + laid.name + " refers to images of the series " + joined(referred, " and ") +
          ", and " + scan.name + " is of the series " + own +
          ": they fit only if the patient lay in the same position in both; choose the series on which the "
          "contours were drawn, or compare the contours with the images"};
}

}  // namespace

voxel::Finding identity_finding(const IdentityOf& scan, const IdentityOf& laid) {
  const voxel::IdentityComparison found = voxel::compared(scan.identity, laid.identity);
  const std::string both = scan.name + " and " + laid.name;
  if (!found.differing.empty())
    return {"identity", voxel::Verdict::Fail,
            both + " are not of one patient, study and frame of reference: " + joined(found.differing, ", ")};
  if (found.unstated.empty())
    return {"identity", voxel::Verdict::Pass, both + " state one patient, study and frame of reference"};
  const bool is_scan = states_nothing(scan.identity), is_laid = states_nothing(laid.identity);
  const std::string who = is_scan && is_laid ? "both state nothing"
                          : is_scan          ? scan.name + " states nothing"
                          : is_laid          ? laid.name + " states nothing"
                                             : "they do not both state this";
  return {
      "identity", voxel::Verdict::Warn,
      "whether " + both + " are of one " + joined(found.unstated, " and ") + " could not be checked: " + who};
}

bool quotes_identity(const std::string& check) {
  return check == "identity" || check == "patient" ||
         (check.starts_with("patient_") && check != "patient_position" && check != "patient_orientation");
}

bool is_of_series(const std::vector<voxel::Finding>& audit) {
  return std::any_of(audit.begin(), audit.end(),
                     [](const voxel::Finding& line) { return line.check == "series"; });
}

std::vector<std::string> need_same_patient(const IdentityOf& scan, const IdentityOf& laid, bool is_allowed,
                                           const std::string& option) {
  const voxel::Finding finding = identity_finding(scan, laid);
  if (finding.verdict == voxel::Verdict::Fail && !is_allowed)
    throw std::runtime_error(finding.detail + "; if that is intended, " + option +
                             " continues with a finding that begins with FAIL");
  std::vector<std::string> lines;
  if (finding.verdict == voxel::Verdict::Fail) lines.push_back("FAIL: identity: " + finding.detail);
  if (finding.verdict == voxel::Verdict::Warn) lines.push_back("identity: " + finding.detail);
  for (std::string& line : other_series(scan, laid)) lines.push_back(std::move(line));
  return lines;
}

}  // namespace octotomy::planner

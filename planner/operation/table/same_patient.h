// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::planner {

/// The identity of one of two files that are used together.
struct IdentityOf {
  std::string name;  ///< name for messages
  const voxel::Identity& identity;
};

/// The audit's line on whether two files have the same patient, study and frame of reference. A Fail lists
/// each value that differs. A Warn lists values that could not be compared, because a file does not state
/// them.
voxel::Finding identity_finding(const IdentityOf& scan, const IdentityOf& laid);

/// Whether details of this check may quote differing patients, studies and series from files.
bool quotes_identity(const std::string& check);

/// Whether an audit belongs to a DICOM series.
bool is_of_series(const std::vector<voxel::Finding>& audit);

/// Throws std::runtime_error if identity_finding() fails; the message names `option` as the way to continue.
/// With `is_allowed`, returns the failure as a finding instead. Adds a WARN if `laid` is a structure set that
/// was drawn only on other series than that of the scan. Returns no findings if the files agree.
std::vector<std::string> need_same_patient(const IdentityOf& scan, const IdentityOf& laid, bool is_allowed,
                                           const std::string& option);

}  // namespace octotomy::planner

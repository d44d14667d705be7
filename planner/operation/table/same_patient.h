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

/// The audit's line on whether two files are of one patient, study and frame of reference. A Fail lists each
/// value that differs; a Warn lists values that could not be compared because a file does not state them.
voxel::Finding identity_finding(const IdentityOf& scan, const IdentityOf& laid);

/// Whether the details of this check may quote differing patients, studies and series from files.
bool quotes_identity(const std::string& check);

/// Whether an audit is that of a DICOM series.
bool is_of_series(const std::vector<voxel::Finding>& audit);

/// Throws std::runtime_error if identity_finding() fails and names `option` as the way to proceed; with
/// `is_allowed`, returns the failure instead. Adds a WARN if `laid` is a structure set that was drawn only on
/// other series than the scan's. Returns no lines if the files agree.
std::vector<std::string> need_same_patient(const IdentityOf& scan, const IdentityOf& laid, bool is_allowed,
                                           const std::string& option);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::planner {

/// One of two files that are laid onto each other.
struct IdentityOf {
  std::string name;  ///< for people
  const voxel::Identity& identity;
};

/// The audit's line on whether two files are of one patient, study and frame of reference. Fail names each
/// value that differs; Warn says what could not be compared because a file does not state it.
voxel::Finding identity_finding(const IdentityOf& scan, const IdentityOf& laid);

/// Whether details of an audit's check quote what files state of patients, studies and series where these
/// differ.
bool quotes_identity(const std::string& check);

/// Throws std::runtime_error where identity_finding() fails, with `option` as the way to go on; where
/// `is_allowed` returns the failure instead. A WARN follows where `laid` is a structure set that was drawn on
/// other series than the scan's alone. Returns no line where the files agree in all.
std::vector<std::string> need_same_patient(const IdentityOf& scan, const IdentityOf& laid, bool is_allowed,
                                           const std::string& option);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

class DicomFile;

/// Patient, study and frame of reference at the top level of a DICOM file.
Identity identity_of(const DicomFile& file);

/// The result of comparing two identities. Patients are compared by identifier, or by name if one side has no
/// identifier. Birth date, sex, and the issuers of equal identifiers are compared if both sides state them.
/// Studies differ if the two sides have no study UID in common, and so do frames of reference.
struct IdentityComparison {
  std::vector<std::string> differing;  ///< "patient 'A17' and 'B23'", the first side's value first
  /// "patient", "study" or "frame of reference", if one side states none.
  std::vector<std::string> unstated;
};
IdentityComparison compared(const Identity& a, const Identity& b);

}  // namespace octotomy::voxel

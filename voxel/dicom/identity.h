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
/// identifier. The issuer of equal identifiers, birth date and sex are compared if both sides state them.
/// Studies and frames of reference differ if the two sides have no UID in common.
struct IdentityComparison {
  std::vector<std::string> differing;  ///< "patient 'A17' and 'B23'", the first side's value first
  std::vector<std::string> unstated;   ///< "patient", "study" or "frame of reference", if one side states
                                       ///< none
};
IdentityComparison compared(const Identity& a, const Identity& b);

}  // namespace octotomy::voxel

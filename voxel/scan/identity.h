// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

class DicomFile;

/// Patient, study and frame of reference at the top level of a DICOM file.
Identity identity_of(const DicomFile& file);

/// Two identities held against each other. Patients are compared by their identifiers, or by their names if
/// one side has no identifier, and by the issuers of equal identifiers, birth dates and sexes where both
/// sides state them; studies and frames of reference differ if no UID of one side is the other's.
struct IdentityComparison {
  std::vector<std::string> differing;  ///< "patient 'A17' and 'B23'", the first side's value first
  std::vector<std::string> unstated;   ///< "patient", "study", "frame of reference": one side has none
};
IdentityComparison compared(const Identity& a, const Identity& b);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/scan/dicom_series.h"

namespace octotomy::voxel {

/// Judges by their headers what the slices of a stack have in common; each line of the audit names the slices
/// that differ from most others: the attributes of dicom_traits, uniform, compression, photometric,
/// pixel_format, slice_thickness, instance_order, spacing_tag, acr_nema. The last four only if there is a
/// doubt. Precondition: the stack is ordered and not empty.
void audit_stack(const DicomStack& stack, std::vector<Finding>& audit);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/scan/dicom_series.h"

namespace octotomy::voxel {

/// Checks whether the headers of a stack's slices agree. Each line of the audit lists the slices that differ
/// from most others. There are lines for the attributes of dicom_traits, and uniform, compression,
/// photometric, pixel_format, slice_thickness, instance_order, spacing_tag, acr_nema, decimal_commas,
/// real_world_values, pixel_aspect, frame_positions, pixel_data, image_kind, coding, patient_orientation. The
/// lines from instance_order on appear only if there is a doubt. Precondition: the stack is ordered and not
/// empty.
void audit_stack(const DicomStack& stack, std::vector<Finding>& audit);

/// Adds the line "join", a Fail, with the attributes in which the images of a joined stack differ, and the
/// distances between the slices. Precondition: that of audit_stack().
void audit_join(const DicomStack& stack, std::vector<Finding>& audit);

/// Adds the lines image_count and concatenation if there are fewer images, or fewer parts of an image, than
/// the headers state.
void audit_counts(const DicomStack& stack, std::vector<Finding>& audit);

}  // namespace octotomy::voxel

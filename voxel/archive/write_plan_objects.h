// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "voxel/archive/png_pixels.h"
#include "voxel/scan/dicom_source.h"

namespace octotomy::voxel {

/// A picture of a plan, without any name in its pixels.
struct PlanPicture {
  std::string label;  ///< description of the view, at most 64 characters
  ColourPixels pixels;
};

/// The parts of a plan that are written to an archive.
struct PlanObjects {
  std::string title;       ///< 1 to 64 characters
  std::string document;    ///< HL7 CDA (XML) that contains the plan
  std::string identifier;  ///< the UID in the document's <id>
  std::vector<PlanPicture> pictures;
};

/// Writes a plan as DICOM objects of one study: `plan.dcm`, and its pictures as `picture_001.dcm`, ..., one
/// series each.
/// - The plan is Encapsulated CDA Storage (PS3.3, A.45.2). The standard also encapsulates PDF, STL, OBJ and
///   MTL, but only the body of a CDA may be of any media type (HL7 CDA R2, nonXMLBody). Any XML reader can
///   unpack a CDA.
/// - A picture is an uncompressed image of the class Secondary Capture Image Storage (A.8.1), which every
///   viewer shows. The multi-frame class would require pictures of one size.
/// `source` is the series of the plan's scan: its patient and study are copied, its images listed. None: the
/// plan gets a new study. Unique identifiers are computed from the content. All files appear together, or
/// none. Returns their names. Throws InvalidInput if a text is empty or too long; Error (Input or Resource)
/// with path and reason.
std::vector<std::filesystem::path> write_plan_objects(const PlanObjects& plan,
                                                      const std::filesystem::path& folder,
                                                      const std::optional<DicomSource>& source);

}  // namespace octotomy::voxel

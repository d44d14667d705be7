// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "voxel/space/scene.h"
#include "voxel/volume/frame_words.h"

namespace octotomy::voxel {

/// The positions that a volume file's header states for its samples, in the file's own axes and unit.
struct StatedGeometry {
  glm::ivec3 dims{1};
  glm::dmat4 file_from_voxel{1.0};
  std::optional<PatientFrame> frame = {};     ///< frame of the file's axes; none if the file states none
  PatientFrame assumed_frame = {};            ///< frame that is assumed if the file states none
  std::string frame_says = {};                ///< the file's words, such as "space right-anterior-superior"
  std::optional<std::string> unit_says = {};  ///< the file's words; none if it states no unit of length
  glm::dvec3 mm_per_unit{1.0};                ///< along the file's axes
};

/// The lattice of a volume in LPS millimetres. Adds one line about the frame and one about the unit to the
/// audit. Each contains the file's statement and the value used. `frame` and `unit`, if set, override the
/// file (--frame, --unit). A guess, or an option that contradicts the file, is a warning.
Lattice placed(const StatedGeometry& stated, const std::optional<PatientFrame>& frame,
               const std::optional<LengthUnit>& unit, std::vector<Finding>& audit);

}  // namespace octotomy::voxel

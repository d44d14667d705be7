// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Separates the patient in a scan from things that carry, hold or mark the patient.
namespace octotomy::voxel {

struct PatientOptions {
  double threshold = -300.0;  ///< samples of at least this value are solid
  double detach_mm = 6.0;     ///< links into which no ball of this radius fits are cut
  /// Parts wholly within this distance of the patient, such as a cut-off ear, bone fragments or teeth, are
  /// not supports. Values below detach_mm plus four millimetres are raised to this sum, to include the
  /// patient's surface, which the ball does not reach.
  double near_mm = 25.0;
  /// Largest thickness of a solid board, above 0. A couch may be twice as thick if air surrounds it.
  double board_mm = 40.0;
  double rim_mm = 2.0;              ///< width of the patient's blurred edge, which is never a support's
  std::vector<glm::dvec3> keep_mm;  ///< LPS points in parts that are not supports, such as a dry skull's jaw
  Progress progress{};
};

/// Samples of at least this value, in Hounsfield units, are as dense as bone.
constexpr double dense_hu = 300.0;

/// Class of a sample.
enum class Belongs : std::uint8_t {
  Air,      ///< samples below the threshold that belong neither to the patient nor to a support
  Patient,  ///< the patient, cavities and blurred edge included
  Support,  ///< boards, couches, foam and holders behind the patient's coronal middle
  /// Solid parts of the patient or of a support: in front of the coronal middle, or inseparable from the
  /// patient.
  Doubtful,
};

struct PatientParts {
  std::vector<Belongs> of;  ///< for each sample, in the scene's order
  /// The LPS y of the patient's coronal middle: half-way between the foremost and the rearmost point of the
  /// patient, or some millimetres farther back, because the tip of the nose is not counted and a mask may
  /// cover the face. No sample in front of it is classed as a support.
  double middle_y_mm = 0.0;
  /// Shift of the table per millimetre along it: to the side and to the back.
  glm::dvec2 table_slope{0.0};
  double front_mm3 = 0.0;           ///< volume of doubtful samples in front of the middle
  double behind_mm3 = 0.0;          ///< volume of doubtful samples behind the middle
  double extruded_front_mm3 = 0.0;  ///< the part of front_mm3 that belongs to a board or cradle
};

/// Separates the patient from supports. A support repeats along the table (extrusion_of()), is foam or cloth
/// outside the skin, or is connected to the patient from behind only by a link thinner than a ball of
/// detach_mm. The patient is the solid part into which the largest ball fits, or, for thin objects such as a
/// dry skull, the largest part. Another part that is as thick as a body and contains bone is doubtful,
/// because it may be a limb. Everything that the skin or bone encloses slice by slice belongs to the patient.
/// Foam is searched for only in Hounsfield units and below the threshold. LPS frame of the scene. Throws
/// std::invalid_argument if samples are not int16 or an option is out of its range; Error (Geometry) if
/// nothing is solid; Stopped. Same bits on any thread count. Cost: linear; memory: three bytes per sample and
/// 25 per cell of two millimetres.
PatientParts patient_parts(const Scene& scene, const PatientOptions& options = {});

}  // namespace octotomy::voxel

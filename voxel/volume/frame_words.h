// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// The patient's directions along which the axes of a file's coordinates grow.
struct PatientFrame {
  std::string name =
      "LPS";  ///< one letter per axis: Left or Right, Posterior or Anterior, Superior or Inferior
  glm::dmat3 lps_from_frame{1.0};
};

/// Reads three letters ("RAS") or three words ("left-anterior-superior"), in any order of the axes and in
/// upper or lower case. None for anything else.
std::optional<PatientFrame> patient_frame(std::string_view words);

struct LengthUnit {
  std::string name = "mm";
  double mm = 1.0;  ///< millimetres in one unit
};

/// Reads a unit's symbol or its name, singular or plural, British or American: "um", "microns", "inch",
/// "metres". Quotes around it are ignored. None for anything else.
std::optional<LengthUnit> length_unit(std::string_view word);

/// patient_frame() and length_unit() for a user's input. Throw std::invalid_argument with examples.
PatientFrame parse_frame(const std::string& text);
LengthUnit parse_unit(const std::string& text);

/// The sides of the patient at which axes (in LPS) start, in the letters of MetaImage's
/// AnatomicalOrientation: "RAI" for axes along LPS.
std::string sides_of_origin(const glm::dmat3& axes);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// The patient's directions in which the coordinates of a file grow, one for each axis.
struct PatientFrame {
  std::string name =
      "LPS";  ///< one letter per axis: Left or Right, Posterior or Anterior, Superior or Inferior
  glm::dmat3 lps_from_frame{1.0};
};

/// Reads three letters ("RAS") or three words ("left-anterior-superior"), with the axes in any order, in
/// upper or lower case. None for any other text.
std::optional<PatientFrame> patient_frame(std::string_view words);

struct LengthUnit {
  std::string name = "mm";
  double mm = 1.0;  ///< millimetres in one unit
};

/// Reads a unit's symbol or its name, singular or plural, British or American: "um", "microns", "inch",
/// "metres". Quotes around the text are ignored. None for any other text.
std::optional<LengthUnit> length_unit(std::string_view word);

/// Parse a user's input as patient_frame() and length_unit() do, but throw std::invalid_argument with
/// examples for any other text.
PatientFrame parse_frame(const std::string& text);
LengthUnit parse_unit(const std::string& text);

/// MetaImage's AnatomicalOrientation for axes given in LPS: the letters of the patient's sides at which the
/// axes start, "RAI" for axes along LPS.
std::string sides_of_origin(const glm::dmat3& axes);

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

// Finds sentences in headers, comments and titles that state a unit of length or a frame: "File units =
// meters", "Units are in mm", "SPACE=RAS". A sentence is read as a whole, because the words of units and
// frames have other meanings: "in" is a preposition, m/s a speed, "Unit M" a hospital's ward, "lip" is not a
// frame.
namespace octotomy::brep {

struct TextStatement {
  enum class Kind {
    Stated,   ///< `words` is a unit or a frame
    Unknown,  ///< `words` is in the place of a unit or frame but is neither
    Unclear   ///< `words` mentions a unit or frame but is ambiguous
  };
  Kind kind = Kind::Stated;
  std::string words;
  std::string key;  ///< the key that the sentence is about: "unit", "units", "space", "coordinate system"
};

/// Statements that follow "unit" or "units", either directly or after =, :, a bracket, or words such as "are
/// in" or "of length in". Empty if the text mentions no unit, or only units of other quantities ("volume
/// unit", "units of time"). "in" means inch only at the end of the sentence after = or :.
std::vector<TextStatement> stated_units(std::string_view text);

/// Statements that follow "space", "coordinate system" or "coordinateSystem". After =, any name that
/// frame_named() accepts is a frame; elsewhere a frame is one of: "lps" or "ras" in any case, words joined by
/// hyphens, or capitals that are no English word.
std::vector<TextStatement> stated_frames(std::string_view text);

}  // namespace octotomy::brep

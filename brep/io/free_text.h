// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

// Sentences of headers, comments and titles that speak of a unit of length or of a frame: "File units =
// meters", "Units are in mm", "SPACE=RAS". A sentence is read as a whole, because the words of units and
// frames have other meanings: "in" is a preposition, m/s a speed, "Unit M" a hospital's ward, "lip" no frame.
namespace octotomy::brep {

struct TextStatement {
  enum class Kind {
    Stated,   ///< `words` is a unit or a frame
    Unknown,  ///< `words` stands where the unit or frame belongs, and is none
    Unclear   ///< `words` speaks of a unit or frame and can be read in more than one way
  };
  Kind kind = Kind::Stated;
  std::string words;
  std::string key;  ///< the key that the sentence is about: "unit", "units", "space", "coordinate system"
};

/// What follows unit or units, with =, :, a bracket, words such as "are in" or "of length in" or nothing in
/// between. Empty where the text speaks of no unit, or of the unit of something else than length ("volume
/// unit", "units of time"). "in" is the inch only where it ends the sentence behind = or :.
std::vector<TextStatement> stated_units(std::string_view text);

/// What follows space, "coordinate system" or coordinateSystem. Behind = any name of frame_named() is one;
/// elsewhere only capitals, lps, ras, or words joined by hyphens, and no capitals that are an English word.
std::vector<TextStatement> stated_frames(std::string_view text);

}  // namespace octotomy::brep

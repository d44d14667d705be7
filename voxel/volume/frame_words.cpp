// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/frame_words.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "voxel/space/error.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

struct Direction {
  const char* word;
  int axis;  ///< of LPS
  double sign;
};
constexpr std::array<Direction, 6> all_directions{{{"left", 0, 1.0},
                                                   {"right", 0, -1.0},
                                                   {"posterior", 1, 1.0},
                                                   {"anterior", 1, -1.0},
                                                   {"superior", 2, 1.0},
                                                   {"inferior", 2, -1.0}}};

/// The direction that is written as a whole word or as its first letter alone; null if there is none.
const Direction* direction_of(std::string_view word) {
  for (const Direction& direction : all_directions)
    if (word == direction.word || (word.size() == 1 && word[0] == direction.word[0])) return &direction;
  return nullptr;
}

/// The units of length and their names. British and American endings are unified before comparison.
constexpr std::array<std::pair<LengthUnit (*)(), std::array<std::string_view, 6>>, 8> all_units{{
    {[] {
       return LengthUnit{"mm", 1.0};
     },
     {"mm", "millimeter"}},
    {[] {
       return LengthUnit{"cm", 10.0};
     },
     {"cm", "centimeter"}},
    {[] {
       return LengthUnit{"dm", 100.0};
     },
     {"dm", "decimeter"}},
    {[] {
       return LengthUnit{"m", 1e3};
     },
     {"m", "meter"}},
    // The Greek letter mu and the micro sign in UTF-8, and the micro sign in Latin-1.
    {[] {
       return LengthUnit{"um", 1e-3};
     },
     {"um", "micron", "micrometer", "\xce\xbcm", "\xc2\xb5m", "\xb5m"}},
    {[] {
       return LengthUnit{"nm", 1e-6};
     },
     {"nm", "nanometer"}},
    {[] {
       return LengthUnit{"inch", 25.4};
     },
     {"in", "inch", "inche"}},
    {[] {
       return LengthUnit{"ft", 304.8};
     },
     {"ft", "foot", "feet"}},
}};

}  // namespace

std::optional<PatientFrame> patient_frame(std::string_view words) {
  const std::string text = lower_case(trimmed(std::string(words)));
  std::array<std::string, 3> axes;
  if (text.size() == 3 && text.find('-') == std::string::npos) {
    for (std::size_t i = 0; i < 3; ++i) axes[i] = text.substr(i, 1);
  } else {
    std::size_t at = 0;
    for (std::string& axis : axes) {
      const std::size_t end = std::min(text.find('-', at), text.size());
      axis = text.substr(at, end - at);
      at = std::min(end + 1, text.size());
    }
    if (at != text.size()) return std::nullopt;
  }
  PatientFrame frame{"", glm::dmat3(0.0)};
  std::array<bool, 3> seen{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Direction* const direction = direction_of(axes[i]);
    if (direction == nullptr || std::exchange(seen[static_cast<std::size_t>(direction->axis)], true))
      return std::nullopt;
    frame.name += static_cast<char>(direction->word[0] - 'a' + 'A');
    frame.lps_from_frame[static_cast<int>(i)][direction->axis] = direction->sign;
  }
  return frame;
}

std::optional<LengthUnit> length_unit(std::string_view word) {
  std::string text = lower_case(trimmed(std::string(word)));
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    text = trimmed(text.substr(1, text.size() - 2));
  if (text.size() > 3 && text.ends_with('s')) text.pop_back();
  if (text.ends_with("metre")) text.replace(text.size() - 2, 2, "er");
  for (const auto& [unit, names] : all_units)
    for (const std::string_view name : names)
      if (!name.empty() && name == text) return unit();
  return std::nullopt;
}

PatientFrame parse_frame(const std::string& text) {
  if (const std::optional<PatientFrame> frame = patient_frame(text)) return *frame;
  throw InvalidInput("'" + text +
                     "' is not a patient frame: give the directions of the three axes, for example "
                     "RAS, LPS or LAS");
}

LengthUnit parse_unit(const std::string& text) {
  if (const std::optional<LengthUnit> unit = length_unit(text)) return *unit;
  throw InvalidInput("'" + text + "' is not a unit of length: give mm, cm, m, um or inch");
}

std::string sides_of_origin(const glm::dmat3& axes) {
  constexpr std::array<std::string_view, 3> sides{"RL", "AP", "IS"};
  std::string letters;
  for (int axis = 0; axis < 3; ++axis) {
    int longest = 0;
    for (int i = 1; i < 3; ++i)
      if (std::abs(axes[axis][i]) > std::abs(axes[axis][longest])) longest = i;
    letters += sides[static_cast<std::size_t>(longest)][axes[axis][longest] >= 0.0 ? 0 : 1];
  }
  return letters;
}

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/mesh_audit.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "brep/io/mesh_scanner.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

/// The LPS axis that a direction lies on, and its sign there.
struct Direction {
  char letter;
  int axis;
  double sign;
  std::string_view word;
};
constexpr std::array<Direction, 6> directions{{{'L', 0, 1.0, "left"},
                                               {'R', 0, -1.0, "right"},
                                               {'P', 1, 1.0, "posterior"},
                                               {'A', 1, -1.0, "anterior"},
                                               {'S', 2, 1.0, "superior"},
                                               {'I', 2, -1.0, "inferior"}}};

const Direction* direction_of(char letter) {
  for (const Direction& each : directions)
    if (each.letter == letter) return &each;
  return nullptr;
}

double longest_side_mm(const Extent& extent) {
  const glm::dvec3 side = extent.high_mm - extent.low_mm;
  return std::max({side.x, side.y, side.z});
}

bool meet(const Extent& a, const Extent& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.high_mm[axis] < b.low_mm[axis] || b.high_mm[axis] < a.low_mm[axis]) return false;
  return true;
}

/// Whether a side has a likely size compared with the other object: from a small screw to twice the other's
/// length.
bool is_likely(double side_mm, double other_mm) {
  return side_mm >= other_mm / 50.0 && side_mm <= 2.0 * other_mm;
}

/// "; read as metres it is 180 mm: try --unit m", for the first unit in which a side has a likely size; else
/// advice to check the file.
std::string unit_advice(double side_mm, double other_mm) {
  constexpr std::array<std::pair<const char*, const char*>, 4> tried{
      {{"m", "metres"}, {"um", "micrometres"}, {"inch", "inches"}, {"cm", "centimetres"}}};
  for (const auto& [name, words] : tried)
    if (const double right_mm = side_mm * length_unit(name)->mm; is_likely(right_mm, other_mm))
      return std::string("; read as ") + words + " it is " + short_text(right_mm) + " mm: try --unit " + name;
  return "; its size is likely in no usual unit: check that it is the right file";
}

}  // namespace

std::string to_string(MeshVerdict verdict) {
  return verdict == MeshVerdict::Pass ? "PASS" : verdict == MeshVerdict::Warn ? "WARN" : "FAIL";
}

std::optional<std::string> frame_named(std::string_view name) {
  std::string letters;
  if (name.find('-') == std::string_view::npos) {
    for (const char c : name) letters += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  } else {
    const std::string words = lower_case(name) + '-';
    for (std::size_t at = 0, end = words.find('-'); end != std::string::npos;
         at = end + 1, end = words.find('-', at)) {
      const auto found = std::find_if(directions.begin(), directions.end(),
                                      [word = std::string_view(words).substr(at, end - at)](
                                          const Direction& d) { return d.word == word; });
      if (found == directions.end()) return std::nullopt;
      letters += found->letter;
    }
  }
  std::array<bool, 3> has{};
  if (letters.size() != 3) return std::nullopt;
  for (const char letter : letters) {
    const Direction* direction = direction_of(letter);
    if (direction == nullptr || has[static_cast<std::size_t>(direction->axis)]) return std::nullopt;
    has[static_cast<std::size_t>(direction->axis)] = true;
  }
  return letters;
}

glm::dmat3 lps_from(const std::string& frame) {
  glm::dmat3 lps(0.0);
  for (int column = 0; column < 3; ++column) {
    const Direction& direction = *direction_of(frame[static_cast<std::size_t>(column)]);
    lps[column][direction.axis] = direction.sign;
  }
  return lps;
}

std::optional<LengthUnit> length_unit(std::string_view word) {
  struct Named {
    LengthUnit unit;
    std::vector<std::string> words;
  };
  static const std::vector<Named> known{
      {{"nm", 1e-6}, {"nm", "nanometer", "nanometers", "nanometre", "nanometres"}},
      {{"um", 1e-3},
       {"um", "micron", "microns", "micrometer", "micrometers", "micrometre", "micrometres", "\u00b5m",
        "\u03bcm"}},
      {{"mm", 1.0}, {"mm", "millimeter", "millimeters", "millimetre", "millimetres"}},
      {{"cm", 10.0}, {"cm", "centimeter", "centimeters", "centimetre", "centimetres"}},
      {{"dm", 100.0}, {"dm", "decimeter", "decimeters", "decimetre", "decimetres"}},
      {{"m", 1000.0}, {"m", "meter", "meters", "metre", "metres"}},
      {{"mil", 0.0254}, {"mil", "mils", "thou"}},
      {{"inch", 25.4}, {"inch", "inches", "in"}},
      {{"foot", 304.8}, {"foot", "feet", "ft"}}};
  const std::string wanted = lower_case(word);
  for (const Named& named : known)
    for (const std::string& each : named.words)
      if (each == wanted) return named.unit;
  return std::nullopt;
}

std::vector<MeshFinding> findings_beside(const Extent& mesh, const Extent& other, const std::string& beside) {
  std::vector<MeshFinding> findings;
  const double side_mm = longest_side_mm(mesh), other_mm = longest_side_mm(other);
  if (!(side_mm > 0.0) || !(other_mm > 0.0)) return findings;
  const double ratio = side_mm / other_mm;
  if (ratio < 0.01 || ratio > 10.0)
    findings.push_back({"scale", MeshVerdict::Warn,
                        short_text(side_mm) + " mm at its longest, " +
                            short_text(ratio < 1.0 ? 1.0 / ratio : ratio) + " times " +
                            (ratio < 1.0 ? "smaller" : "larger") + " than " + beside + " (" +
                            short_text(other_mm) + " mm)" + unit_advice(side_mm, other_mm)});
  if (!findings.empty() || meet(mesh, other)) return findings;
  const Extent turned{{-mesh.high_mm.x, -mesh.high_mm.y, mesh.low_mm.z},
                      {-mesh.low_mm.x, -mesh.low_mm.y, mesh.high_mm.z}};
  findings.push_back({"place", MeshVerdict::Warn,
                      "it lies wholly outside of " + beside +
                          (meet(turned, other) ? "; with x and y negated the two meet: try --frame RAS, or "
                                                 "--frame LPS where the file says RAS"
                                               : "")});
  return findings;
}

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
// Sources: 3D Slicer writes and reads SPACE=RAS and SPACE=LPS in headers and comments of STL, PLY, OBJ and
// legacy VTK, and a field SPACE in VTK's XML files (vtkMRMLModelStorageNode); SketchUp's exporter of OBJ
// writes "# File units = meters".
#include "brep/io/mesh_statements.h"

#include <algorithm>
#include <cctype>

#include "brep/io/mesh_scanner.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

bool is_word_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' ||
         (static_cast<unsigned char>(c) & 0x80);
}

/// Calls f with the words behind each occurrence of a key that stands alone, and with the = or : between,
/// else 0; a letter before or behind the key makes it another word.
template <typename F>
void behind_key(std::string_view text, std::string_view key, const F& f) {
  const std::string folded = lower_case(text);
  for (std::size_t at = folded.find(key); at != std::string::npos; at = folded.find(key, at + 1)) {
    const std::size_t end = at + key.size();
    if ((at > 0 && (is_word_letter(text[at - 1]) || text[at - 1] == '_')) ||
        (end < text.size() && is_word_letter(text[end])))
      continue;
    std::size_t begin = text.find_first_not_of(" \t\"'", end);
    if (begin == std::string_view::npos) return;
    const char sign = text[begin] == '=' || text[begin] == ':' ? text[begin] : '\0';
    if (sign != '\0') begin = text.find_first_not_of(" \t\"'", begin + 1);
    f(begin == std::string_view::npos ? std::string_view{} : text.substr(begin), sign);
  }
}

std::string_view first_word(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && is_word_letter(text[end])) ++end;
  return text.substr(0, end);
}

/// As far as it can be printed, blanks at the ends left out, at most 80 characters.
std::string printable(std::string_view text) {
  std::string made;
  for (const char c : text.substr(0, 200)) {
    if (c == '\0' || c == '\n') break;
    made += c >= ' ' && c < 0x7f ? c : (c == '\t' || c == '\r') ? ' ' : '?';
  }
  const std::size_t begin = made.find_first_not_of(' ');
  if (begin == std::string::npos) return {};
  made = made.substr(begin, made.find_last_not_of(' ') + 1 - begin);
  return made.substr(0, 80);
}

std::string both(const std::string& first, const std::string& second) {
  return "the file contradicts itself: " + first + ", and " + second;
}

}  // namespace

void MeshStatements::add_frame(const std::string& name, const std::string& words) {
  if (const std::optional<std::string> frame = frame_named(name))
    frames_.push_back({*frame, words});
  else
    warn("frame", words + " is no frame that is known");
}

void MeshStatements::add_unit(const std::string& name, const std::string& words) {
  if (const std::optional<LengthUnit> unit = length_unit(name))
    units_.push_back({unit->name, words});
  else
    warn("unit", words + " is no unit that is known");
}

void MeshStatements::add_writer(std::string_view text) {
  if (writer_.empty()) writer_ = printable(text);
}

void MeshStatements::read_frame(std::string_view text, const std::string& where) {
  for (const std::string_view key : {"space", "coordinate system", "coordinatesystem"})
    behind_key(text, key, [&](std::string_view rest, char sign) {
      const std::string_view word = first_word(rest);
      // Without = only a frame's name makes it a statement: "3D space" is none, nor "colour space: sRGB".
      if (sign == '=' || frame_named(word))
        add_frame(std::string(word),
                  (key == "space" ? "SPACE=" : "coordinate system ") + printable(word) + " in " + where);
    });
  if (text.find("LPS millimetres") != std::string_view::npos) {
    add_frame("LPS", "'LPS millimetres' in " + where);
    add_unit("mm", "'LPS millimetres' in " + where);
  }
}

void MeshStatements::read_unit(std::string_view text, const std::string& where) {
  for (const std::string_view key : {"unit", "units"})
    behind_key(text, key, [&](std::string_view rest, char sign) {
      std::string_view word = first_word(rest);
      if (const std::string filler = lower_case(word);
          sign == '\0' && (filler == "is" || filler == "are" || filler == "in")) {
        rest = rest.substr(word.size());
        rest.remove_prefix(std::min(rest.find_first_not_of(" \t\"'"), rest.size()));
        word = first_word(rest);
      }
      if (length_unit(word))
        add_unit(std::string(word), "unit " + printable(word) + " in " + where);
      else if (sign == '=')
        warn("unit", "'" + printable(rest.substr(0, 20)) + "' in " + where + " is no unit that is known");
    });
}

void MeshStatements::read_text(std::string_view text, const std::string& where) {
  read_frame(text, where);
  read_unit(text, where);
}

MeshStatements::Resolved MeshStatements::resolved(const std::optional<std::string>& frame,
                                                  const std::optional<std::string>& unit) const {
  Resolved made;
  const auto contradicts = [](const std::vector<Statement>& all) -> const Statement* {
    for (const Statement& each : all)
      if (each.name != all.front().name) return &each;
    return nullptr;
  };
  const auto pass = [&](const char* check, const std::string& detail) {
    made.audit.push_back({check, MeshVerdict::Pass, detail});
  };
  const auto guess = [&](const char* check, const std::string& detail) {
    made.audit.push_back({check, MeshVerdict::Warn, detail});
  };
  // What was given against what the file says.
  const auto override_by = [&](const char* check, const std::string& name,
                               const std::vector<Statement>& says) {
    for (const Statement& each : says)
      if (each.name != name)
        return guess(check, name + " as --" + check + " gives it, against the file: " + each.words);
    pass(check, name + " as --" + check + " gives it" + (says.empty() ? "; the file is silent" : ""));
  };

  if (frame) {
    const std::optional<std::string> named = frame_named(*frame);
    if (!named)
      throw Error(ErrorCode::Input, "'" + *frame +
                                        "' is no frame: give three letters for where x, y and z "
                                        "point, for example LPS or RAS");
    override_by("frame", made.frame = *named, frames_);
  } else if (const Statement* other = contradicts(frames_)) {
    throw Error(ErrorCode::Input, both(frames_.front().words, other->words) + ": choose one by --frame");
  } else if (!frames_.empty()) {
    made.frame = frames_.front().name;
    const bool is_mirrored = glm::determinant(lps_from(made.frame)) < 0.0;
    pass("frame",
         frames_.front().words +
             (made.frame == "LPS"   ? ""
              : made.frame == "RAS" ? ": x and y are negated to LPS"
                                    : ": turned to LPS") +
             (is_mirrored ? ", and the triangles' sides with it, as this frame is left-handed" : ""));
  } else {
    guess("frame", silent_frame_.empty()
                       ? "the file names no frame: LPS is assumed; --frame RAS where its program means that"
                       : silent_frame_);
  }

  if (unit) {
    const std::optional<LengthUnit> named = length_unit(*unit);
    if (!named) throw Error(ErrorCode::Input, "'" + *unit + "' is no unit: give um, mm, cm, m, inch or foot");
    made.unit = *named;
    override_by("unit", named->name, units_);
  } else if (const Statement* other = contradicts(units_)) {
    throw Error(ErrorCode::Input, both(units_.front().words, other->words) + ": choose one by --unit");
  } else if (!units_.empty()) {
    made.unit = *length_unit(units_.front().name);
    pass("unit", units_.front().words);
  } else {
    guess("unit", "the file names no unit: mm is assumed");
  }
  pass("writer", writer_.empty() ? "not stated" : writer_);
  made.audit.insert(made.audit.end(), doubts_.begin(), doubts_.end());
  return made;
}

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
// Sources: 3D Slicer writes and reads SPACE=RAS and SPACE=LPS in headers and comments of STL, PLY, OBJ and
// legacy VTK, and a field SPACE in VTK's XML files (vtkMRMLModelStorageNode); SketchUp's exporter of OBJ
// writes "# File units = meters".
#include "brep/io/mesh_statements.h"

#include <algorithm>

#include "brep/io/free_text.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

/// The printable part of a text, without blanks at the ends, at most 80 characters.
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
    warn("frame", words + " is not a known frame");
}

void MeshStatements::add_unit(const std::string& name, const std::string& words) {
  if (const std::optional<LengthUnit> unit = length_unit(name))
    units_.push_back({unit->name, words});
  else
    warn("unit", words + " is not a known unit");
}

void MeshStatements::add_writer(std::string_view text) {
  if (writer_.empty()) writer_ = printable(text);
}

void MeshStatements::read_text(std::string_view text, const std::string& where) {
  const auto unclear = [&](const char* check, const TextStatement& each) {
    warn(check, "'" + printable(each.words) + "' in " + where + " can be read in more than one way and was " +
                    "not followed: give --" + check);
  };
  for (const TextStatement& each : stated_frames(text))
    if (each.kind == TextStatement::Kind::Unclear)
      unclear("frame", each);
    else
      add_frame(each.words, (each.key == "space" ? "SPACE=" : "coordinate system ") + printable(each.words) +
                                " in " + where);
  if (text.find("LPS millimetres") != std::string_view::npos) {
    add_frame("LPS", "'LPS millimetres' in " + where);
    add_unit("mm", "'LPS millimetres' in " + where);
  }
  for (const TextStatement& each : stated_units(text))
    if (each.kind == TextStatement::Kind::Stated)
      add_unit(each.words, "unit " + printable(each.words) + " in " + where);
    else if (each.kind == TextStatement::Kind::Unclear)
      unclear("unit", each);
    else
      warn("unit", "'" + printable(each.words) + "' in " + where + " is not a known unit of length");
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
  const auto is_doubted = [&](const char* check) {
    return std::any_of(doubts_.begin(), doubts_.end(),
                       [&](const MeshFinding& doubt) { return doubt.check == check; });
  };
  // Compares an option with the file's statements.
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
                                        "' is not a frame: give three letters for the directions of x, y and "
                                        "z, for example LPS or RAS");
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
             (is_mirrored ? ", and the triangles are reversed, because this frame is left-handed" : ""));
  } else {
    guess("frame",
          !silent_frame_.empty() ? silent_frame_
          : is_doubted("frame")
              ? "no frame could be taken from the file: LPS is assumed; use --frame RAS if its program "
                "writes RAS"
              : "the file names no frame: LPS is assumed; use --frame RAS if its program writes RAS");
  }

  if (unit) {
    const std::optional<LengthUnit> named = length_unit(*unit);
    if (!named)
      throw Error(ErrorCode::Input, "'" + *unit + "' is not a unit: give um, mm, cm, m, inch or foot");
    made.unit = *named;
    override_by("unit", named->name, units_);
  } else if (const Statement* other = contradicts(units_)) {
    throw Error(ErrorCode::Input, both(units_.front().words, other->words) + ": choose one by --unit");
  } else if (!units_.empty()) {
    made.unit = *length_unit(units_.front().name);
    pass("unit", units_.front().words);
  } else {
    guess("unit", is_doubted("unit") ? "no unit could be taken from the file: mm is assumed"
                                     : "the file names no unit: mm is assumed");
  }
  pass("writer", writer_.empty() ? "not stated" : writer_);
  made.audit.insert(made.audit.end(), doubts_.begin(), doubts_.end());
  return made;
}

}  // namespace octotomy::brep

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "brep/io/mesh_audit.h"
#include "brep/io/polygons.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// What a file states about its frame and unit, gathered while it is read.
class MeshStatements {
 public:
  /// Takes the statements of stated_frames() and stated_units() (free_text.h) in a header, comment or title,
  /// which `where` names ("the header"); "LPS millimetres" is our own.
  void read_text(std::string_view text, const std::string& where);
  /// A statement of the format itself or of a field.
  void add_frame(const std::string& name, const std::string& words);
  void add_unit(const std::string& name, const std::string& words);
  /// The program, of a header's free text: the first text that says anything is kept, as far as it can be
  /// printed.
  void add_writer(std::string_view text);
  void warn(const std::string& check, const std::string& detail) {
    doubts_.push_back({check, MeshVerdict::Warn, detail});
  }
  void tell(const std::string& check, const std::string& detail) {
    doubts_.push_back({check, MeshVerdict::Pass, detail});
  }
  /// Said instead of "the file names no frame" where the format has one of its own.
  void silent_frame(std::string words) { silent_frame_ = std::move(words); }

  /// The frame and unit to take, with the audit's lines about both, the writer and all doubts. Throws Error
  /// (Input) where statements contradict one another and nothing was given, or what was given is none.
  struct Resolved {
    std::string frame = "LPS";
    LengthUnit unit{"mm", 1.0};
    std::vector<MeshFinding> audit;
  };
  Resolved resolved(const std::optional<std::string>& frame, const std::optional<std::string>& unit) const;

 private:
  struct Statement {
    std::string name;   ///< the frame or the unit
    std::string words;  ///< "SPACE=RAS in the header"
  };
  std::vector<Statement> frames_, units_;
  std::vector<MeshFinding> doubts_;
  std::string writer_, silent_frame_;
};

/// What a file holds, in its own frame and unit.
struct MeshContent {
  Triangles triangles;
  double scale = 1.0;  ///< that the coordinates were multiplied by already: numbers of the file times this
  MeshStatements says;
  PolygonCounts polygons;
};

}  // namespace octotomy::brep

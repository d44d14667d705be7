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

/// A file's statements about its frame and unit, collected while it is read.
class MeshStatements {
 public:
  /// Adds the statements that stated_frames() and stated_units() (free_text.h) find in a header, comment or
  /// title, named by `where` ("the header"). "LPS millimetres", which this program writes, states both.
  void read_text(std::string_view text, const std::string& where);
  /// Adds a statement that follows from the format or stands in a field of the file.
  void add_frame(const std::string& name, const std::string& words);
  void add_unit(const std::string& name, const std::string& words);
  /// The writing program, from a header's free text. Stores the printable part of the first non-empty text.
  void add_writer(std::string_view text);
  void warn(const std::string& check, const std::string& detail) {
    doubts_.push_back({check, MeshVerdict::Warn, detail});
  }
  void tell(const std::string& check, const std::string& detail) {
    doubts_.push_back({check, MeshVerdict::Pass, detail});
  }
  /// The message for files without a statement, in place of "the file names no frame". For formats that
  /// define a frame.
  void silent_frame(std::string words) { silent_frame_ = std::move(words); }

  /// The frame and unit to use, with the audit's lines about both, the writer and all doubts. Throws Error
  /// (Input) if statements contradict one another and no option decides, or if an option is not a frame or
  /// unit.
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

/// The contents of a file, in its own frame and unit.
struct MeshContent {
  Triangles triangles;
  double scale = 1.0;  ///< factor by which the reader has already multiplied the file's coordinates
  MeshStatements says;
  PolygonCounts polygons;
};

}  // namespace octotomy::brep

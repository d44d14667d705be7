// SPDX-License-Identifier: AGPL-3.0-or-later
// Names for points, which later steps use in place of coordinates.
#include <algorithm>

#include "planner/operation/file/landmarks_file.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Landmarks {
  std::vector<NamedPoint> points;
  std::filesystem::path file;
};

void check(const Landmarks& landmarks, const FieldLocation& place) {
  if (landmarks.points.empty() && landmarks.file.empty())
    place.refuse("names no point: add 'points', or 'file'");
  if (place.scope == nullptr) return;
  for (std::size_t i = 0; i < landmarks.points.size(); ++i)
    place.scope->bind_landmark(place.at("points[" + std::to_string(i) + "]").where, landmarks.points[i]);
  if (landmarks.file.empty()) return;
  const FieldLocation file = place.at("file");
  if (!std::filesystem::is_regular_file(place.scope->folder() / landmarks.file))
    file.refuse(landmarks.file.string() + " does not exist: state its path relative to the plan's folder");
  std::vector<brep::Landmark> read;
  try {
    read = read_landmarks(place.scope->folder() / landmarks.file);
  } catch (const std::exception& error) {
    rethrow_at(file.where + ": ", error);
  }
  if (read.empty())
    file.refuse(landmarks.file.string() + " contains no placed point: place one, or leave the file out");
  for (const brep::Landmark& landmark : read)
    place.scope->bind_landmark(file.where, {landmark.name, landmark.p_mm});
}

}  // namespace

Operation landmarks_operation() {
  return Describe<Landmarks>("landmarks",
                             "Names points. Later steps can use these names instead of coordinates.",
                             Makes::Names)
      .takes(records("points", &Landmarks::points, "The points.",
                     {field("name", &NamedPoint::name, "The name, for example ans.").required(),
                      field("point_mm", &NamedPoint::p_mm, "The point [x, y, z], LPS.").required()}))
      .takes(field("file", &Landmarks::file,
                   "A file of named points, relative to the plan's folder: {\"landmarks\": [{\"name\", "
                   "\"point_mm\"}]}, or 3D "
                   "Slicer's .mrk.json or .fcsv.")
                 .a_file())
      .example(R"({"id": "marks", "do": "landmarks", "points": [{"name": "ans", "point_mm": [0, -88, -28]},
        {"name": "pns", "point_mm": [0, -45, -28]}]})")
      .check(check);
}

}  // namespace octotomy::planner

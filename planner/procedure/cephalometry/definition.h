// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The definition of a measure by its points. A line runs from its first point to its second.
enum class CephalometricKind {
  Angle,  ///< a, v, b: at v, 0 to 180 degrees
  Bend,   ///< a, v, b: 180 degrees minus the angle at v; negative if v lies behind the line a, b (a above b)
  Lines,  ///< a, b, c, d: between the directions a to b and c to d, 0 to 180 degrees
  Tilt,   ///< a, b: angle of a to b above the horizontal, degrees; positive if b is higher
  Distance,    ///< a, b: mm
  Along,       ///< a, b, p, q: from p to q along the line a, b, mm
  Across,      ///< a, b, p, q: from p to q perpendicular to the line a, b, mm; upward is positive if a to b
               ///< points forward
  Difference,  ///< of two measures: the first minus the second
  Share,       ///< of two measures: the first as per cent of the second
};
/// The plane of a measure: landmarks are projected along the head's left-right or front-back direction, or
/// not at all.
enum class CephalometricPlane { Lateral, Frontal, Space };

struct CephalometricMeasure {
  std::string name;  ///< "SNA"
  std::string says;
  CephalometricKind kind = CephalometricKind::Angle;
  CephalometricPlane plane = CephalometricPlane::Lateral;
  std::vector<std::string> points;  ///< landmarks
  std::vector<std::string> of;      ///< measures, for Difference and Share
  std::optional<double> norm, deviation;
  std::string source;  ///< source of the norm; one of Cephalometry::sources, if there are any

  const char* unit() const;
};

struct CephalometricLandmark {
  std::string name;
  std::string says;
  /// If the landmark itself is not placed, it is the mean of these landmarks, for example of both sides.
  std::vector<std::string> mean_of;
  /// It lies on the skin, which does not move as the bone below it does.
  bool is_of_skin = false;
};

/// A publication of norms, and the people whom its norms describe.
struct CephalometricSource {
  std::string name;  ///< "Downs 1948"
  std::string says;
};

struct Cephalometry {
  std::string name, says;
  std::vector<CephalometricSource> sources;
  std::vector<CephalometricLandmark> landmarks;
  std::vector<CephalometricMeasure> measures;
};

/// Landmarks' positions by their names, in any frame.
using LandmarkPlaces = std::map<std::string, glm::dvec3>;
/// Adds each landmark that was not placed but is the mean of landmarks that are known.
LandmarkPlaces with_means(const Cephalometry& definitions, LandmarkPlaces points);

/// Throws std::runtime_error with the position in the text for an unknown key, kind, landmark, source or measure (a
/// measure must be defined before it is used), or a wrong number of points.
Cephalometry parse_cephalometry(const std::string& json);
/// Reads definitions: those of the program by their name, or a file that ends in .json. Throws
/// std::runtime_error, with the nearest name, if the program has none of this name.
Cephalometry read_cephalometry(const std::string& name_or_path);
std::vector<std::string> cephalometries();

}  // namespace octotomy::planner

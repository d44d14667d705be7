// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::planner {

/// How a measure follows from its points. A line goes from its first point to its second.
enum class CephalometricKind {
  Angle,       ///< a, v, b: at v, 0 to 180 degrees
  Bend,        ///< a, v, b: 180 degrees less the angle at v; negative where v lies behind the line a, b
  Lines,       ///< a, b, c, d: between the directions a to b and c to d, 0 to 180 degrees
  Tilt,        ///< a, b: of a to b over the horizontal, degrees; positive where b is higher
  Distance,    ///< a, b: mm
  Along,       ///< a, b, p, q: from p to q along the line a, b, mm
  Across,      ///< a, b, p, q: from p to q square to the line a, b, mm; upwards where a to b goes forward
  Difference,  ///< of two measures: the first less the second
  Share,       ///< of two measures: the first of the second, per cent
};
/// Where a measure is taken: landmarks are projected along the head's left-right or front-back direction.
enum class CephalometricPlane { Lateral, Frontal, Space };

struct CephalometricMeasure {
  std::string name;  ///< "SNA"
  std::string says;
  CephalometricKind kind = CephalometricKind::Angle;
  CephalometricPlane plane = CephalometricPlane::Lateral;
  std::vector<std::string> points;  ///< landmarks
  std::vector<std::string> of;      ///< measures, of Difference and Share
  std::optional<double> norm, deviation;
  std::string source;  ///< of the norm

  const char* unit() const;
};

struct CephalometricLandmark {
  std::string name;
  std::string says;
  /// It is the mean of these where it is not placed itself: both sides, upper and lower.
  std::vector<std::string> mean_of;
};

struct Cephalometry {
  std::string name, says;
  std::vector<CephalometricLandmark> landmarks;
  std::vector<CephalometricMeasure> measures;
};

/// Landmarks' places by their names, in any frame.
using LandmarkPlaces = std::map<std::string, glm::dvec3>;
/// The landmarks as placed, and those that are means of others and were not placed themselves.
LandmarkPlaces with_means(const Cephalometry& definitions, LandmarkPlaces points);

/// Throws std::runtime_error with the place in it: an unknown key, kind, landmark or measure (one is used
/// after it is defined), a wrong number of points.
Cephalometry parse_cephalometry(const std::string& json);
/// Definitions of the program by their name, or in a file that ends in .json. Throws std::runtime_error with
/// the nearest name where there are none.
Cephalometry read_cephalometry(const std::string& name_or_path);
std::vector<std::string> cephalometries();

}  // namespace octotomy::planner

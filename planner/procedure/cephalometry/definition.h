// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::planner {

/// How a measure is computed from its points a, b, ... A line runs from its first point to its second.
enum class CephalometricKind {
  Angle,  ///< a, v, b: angle at v, 0 to 180 degrees
  Bend,   ///< a, v, b: 180 degrees minus the angle at v; negative if v lies behind the line a, b (a above b)
  Lines,  ///< a, b, c, d: angle between a to b and c to d, 0 to 180 degrees
  Tilt,   ///< a, b: angle of a to b above the horizontal, degrees; positive if b is higher
  Distance,    ///< a, b: mm
  Along,       ///< a, b, p, q: from p to q along the line a, b, mm
  Across,      ///< a, b, p, q: from p to q perpendicular to the line a, b, mm; upward is positive if a to b
               ///< points forward
  Difference,  ///< of two other measures: the first minus the second
  Share,       ///< of two other measures: the first in per cent of the second
};
/// The plane in which a measure is taken. For Lateral, landmarks are projected along the head's left-right
/// direction, for Frontal along its front-back direction; for Space they are not projected.
enum class CephalometricPlane { Lateral, Frontal, Space };

struct CephalometricMeasure {
  std::string name;  ///< "SNA"
  std::string says;
  CephalometricKind kind = CephalometricKind::Angle;
  CephalometricPlane plane = CephalometricPlane::Lateral;
  std::vector<std::string> points;  ///< landmarks
  std::vector<std::string> of;      ///< names of the two measures of a Difference or Share
  std::optional<double> norm, deviation;
  std::string source;  ///< source of the norm; one of Cephalometry::sources, if there are any

  const char* unit() const;
};

struct CephalometricLandmark {
  std::string name;
  std::string says;
  /// Landmarks whose mean takes the place of this one if it is not placed, for example those of both sides.
  std::vector<std::string> mean_of;
  /// True if the landmark lies on the skin, which does not move like the bone below it.
  bool is_of_skin = false;
};

/// A publication of norms. `says` describes the people whom its norms describe.
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

/// Positions of landmarks by name, in any common frame.
using LandmarkPlaces = std::map<std::string, glm::dvec3>;
/// Adds the landmarks that are not placed but are the mean of placed ones.
LandmarkPlaces with_means(const Cephalometry& definitions, LandmarkPlaces points);

/// Parses definitions. Throws std::runtime_error, with the place in the text, for an unknown key, kind,
/// landmark, source or measure (a measure must be defined before another one uses it), or for a wrong number
/// of points.
Cephalometry parse_cephalometry(const std::string& json);
/// Reads definitions: those of the program with this name, or those of a file that ends in .json. Throws
/// std::runtime_error, with the most similar name, if the program has none of this name.
Cephalometry read_cephalometry(const std::string& name_or_path);
std::vector<std::string> cephalometries();

}  // namespace octotomy::planner

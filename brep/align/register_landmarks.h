// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace octotomy::brep {

/// A named point in LPS millimetres.
struct Landmark {
  std::string name;
  glm::dvec3 p_mm{0.0};
  double weight = 1.0;  ///< above 0; a pair has the product of both landmarks' weights
};

struct LandmarkFit {
  glm::dmat4 fixed_from_moving{1.0};  ///< maps points of the moving set to the fixed set
  double scale = 1.0;
  double rms_mm = 0.0;                ///< weighted, over the pairs
  std::vector<std::string> paired;    ///< names that occur in both sets, in the moving set's order
  std::vector<std::string> left_out;  ///< names that occur in one set only, moving set first
  std::vector<double> residuals_mm;   ///< of each of `paired`
};

enum class MotionModel {
  rigid,
  similarity,    ///< rigid, and one scale
  three_points,  ///< rigid: the first pair coincides, then the directions to the second pair, then the planes
                 ///< with the third pair; further pairs do not affect the motion
};

/// The motion that maps landmarks to those of the same name with the least weighted sum of squared distances;
/// never a reflection. three_points matches the first pair (in the moving set's order) exactly, for sets in
/// which one landmark is the most reliable. Throws std::invalid_argument, which names the landmark or what is
/// missing, if a name occurs twice in one set, a weight or point is out of range, fewer than three names
/// occur in both sets, or the shared landmarks lie on one line, which leaves a rotation undetermined. Cost:
/// linear. Source: Horn, "Closed-form solution of absolute orientation using unit quaternions", JOSA A 4,
/// 1987; three points: Ong 1992, 8.3.
LandmarkFit register_landmarks(const std::vector<Landmark>& moving, const std::vector<Landmark>& fixed,
                               MotionModel motion = MotionModel::rigid);

}  // namespace octotomy::brep

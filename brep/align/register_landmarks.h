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
  double weight = 1.0;  ///< above 0, of the pair: the product of both landmarks' weights counts
};

struct LandmarkFit {
  glm::dmat4 fixed_from_moving{1.0};  ///< takes points of the moving set to the fixed set's place
  double scale = 1.0;
  double rms_mm = 0.0;                ///< weighted, over the pairs
  std::vector<std::string> paired;    ///< names found in both, in the moving set's order
  std::vector<std::string> left_out;  ///< names found in one only, moving set first
  std::vector<double> residuals_mm;   ///< of each of `paired`
};

enum class Motion {
  rigid,
  similarity,    ///< one scale beside it
  three_points,  ///< rigid: lays the first pair on each other, then the direction to the second, then the
                 ///< plane of the third; further pairs are judged only
};

/// The motion that takes landmarks to those of the same name with the least weighted sum of squared
/// distances; never a reflection. With three_points the first pair, in the moving set's order, is trusted
/// most, as a surgeon often is surest of one. Throws std::invalid_argument where a name occurs twice in one
/// set, a weight or point is out of range, fewer than three names are in both, or those lie on one line,
/// which leaves a turn open; each names the landmark or says what is missing. Cost: linear. Source: Horn,
/// "Closed-form solution of absolute orientation using unit quaternions", JOSA A 4, 1987; three points: Ong
/// 1992, 8.3.
LandmarkFit register_landmarks(const std::vector<Landmark>& moving, const std::vector<Landmark>& fixed,
                               Motion motion = Motion::rigid);

}  // namespace octotomy::brep

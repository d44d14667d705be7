// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/record.h"

// The report of a landmark_ratios step: records in the `details` of its object.
namespace octotomy::planner {

/// A landmark of the skin, and its displacement by the ratio of a bone landmark's motion.
struct RatioLandmark {
  std::string name;          ///< empty: a typed point
  std::string follows;       ///< the bone's landmark; empty: the landmark of the skin stays where it is
  glm::dvec3 at_mm{0.0};     ///< before the operation, LPS
  double off_skin_mm = 0.0;  ///< distance of the landmark from the object's surface
  std::optional<double> ratio, ratio_up, deviation;
  std::string source;                            ///< of the ratio
  glm::dvec3 bone_moved_mm{0.0}, moved_mm{0.0};  ///< LPS
  double forward_mm = 0.0, left_mm = 0.0, up_mm = 0.0;
  std::string words;
  /// In 99 of 100 patients the displacement's length differs by at most this, if ratios have the stated
  /// deviation; none without a deviation.
  std::optional<double> half_width_mm;
};
constexpr auto members_of(const RatioLandmark&) {
  using L = RatioLandmark;
  return std::tuple(member("name", &L::name), member("follows", &L::follows), member("at_mm", &L::at_mm),
                    member("off_skin_mm", &L::off_skin_mm), member("ratio", &L::ratio),
                    member("ratio_up", &L::ratio_up), member("deviation", &L::deviation),
                    member("source", &L::source), member("bone_moved_mm", &L::bone_moved_mm),
                    member("moved_mm", &L::moved_mm), member("forward_mm", &L::forward_mm),
                    member("left_mm", &L::left_mm), member("up_mm", &L::up_mm), member("words", &L::words),
                    member("half_width_mm", &L::half_width_mm));
}

struct MeasuredRatios {
  double fade_mm = 0.0, largest_displacement_mm = 0.0;
  std::vector<RatioLandmark> landmarks;
};
constexpr auto members_of(const MeasuredRatios&) {
  using M = MeasuredRatios;
  return std::tuple(member("fade_mm", &M::fade_mm),
                    member("largest_displacement_mm", &M::largest_displacement_mm),
                    member("landmarks", &M::landmarks));
}

/// A landmark in two predictions of the same skin, a and b.
struct LandmarkDifference {
  std::string name;
  glm::dvec3 at_mm{0.0};                        ///< before the operation, LPS
  glm::dvec3 a_moved_mm{0.0}, b_moved_mm{0.0};  ///< LPS
  double difference_mm = 0.0;                   ///< length of the difference of both displacements
};
constexpr auto members_of(const LandmarkDifference&) {
  using L = LandmarkDifference;
  return std::tuple(member("name", &L::name), member("at_mm", &L::at_mm),
                    member("a_moved_mm", &L::a_moved_mm), member("b_moved_mm", &L::b_moved_mm),
                    member("difference_mm", &L::difference_mm));
}

/// The difference of two predictions of the same skin, point by point.
struct FaceDifference {
  std::string skin;  ///< the object of the skin before the operation
  double mean_mm = 0.0, largest_mm = 0.0;
  glm::dvec3 largest_at_mm{0.0};  ///< before the operation, LPS
  double area_mm2 = 0.0;
  std::string definition;
  std::vector<LandmarkDifference> landmarks;
};
constexpr auto members_of(const FaceDifference&) {
  using D = FaceDifference;
  return std::tuple(member("skin", &D::skin), member("mean_mm", &D::mean_mm),
                    member("largest_mm", &D::largest_mm), member("largest_at_mm", &D::largest_at_mm),
                    member("area_mm2", &D::area_mm2), member("definition", &D::definition),
                    member("landmarks", &D::landmarks));
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "planner/plan/evaluate.h"
#include "planner/procedure/template/procedure.h"
#include "voxel/solid/combine.h"

// Procedures on the head phantom.
namespace octotomy::tests {

/// The head phantom's landmarks, read off its pictures.
inline std::vector<brep::Landmark> head_landmarks() {
  return {{"piriform_left", {12, -84, -25}},
          {"piriform_right", {-12, -84, -25}},
          {"buttress_left", {30, -68, -28}},
          {"buttress_right", {-30, -68, -28}},
          {"pterygoid_left", {20, -39, -30}},
          {"pterygoid_right", {-20, -39, -30}},
          {"incisor", {0, -85, -57.5}},
          {"molar_left", {27, -52, -57.5}},
          {"molar_right", {-27, -52, -57.5}},
          {"foramen_left", {22, -74, -82}},
          {"foramen_right", {-22, -74, -82}},
          {"border_left", {33, -55, -91}},
          {"border_right", {-33, -55, -91}},
          {"pogonion", {0, -87, -93}},
          {"menton", {0, -82, -101}},
          {"split_front_left", {39, -46, -80}},
          {"split_front_right", {-39, -46, -80}},
          {"split_back_left", {46.5, -25, -45}},
          {"split_back_right", {-46.5, -25, -45}},
          {"lower_incisor", {0, -84, -61}},
          {"lower_molar_left", {27, -54, -61}},
          {"lower_molar_right", {-27, -54, -61}},
          {"lingula_left", {48, -22, -45}},
          {"lingula_right", {-48, -22, -45}},
          {"notch_left", {47, -20, -30}},
          {"notch_right", {-47, -20, -30}},
          {"nasion", {0, -84, 10}},
          {"orbital_rim_left", {25, -75, -7}},
          {"orbital_rim_right", {-25, -75, -7}},
          {"ramus_border_left", {50, -24, -78}},
          {"ramus_border_right", {-50, -24, -78}},
          {"condyle_left", {50, -6, -13}},
          {"condyle_right", {-50, -6, -13}},
          {"coronoid_left", {47, -37, -22}},
          {"coronoid_right", {-47, -37, -22}},
          {"coronoid_front_left", {46, -43, -55}},
          {"frontonasal", {0, -84, 14}},
          {"lateral_rim_left", {51, -66, 13}},
          {"lateral_rim_right", {-51, -66, 13}},
          {"zygoma_left", {60, -42, -13}},
          {"zygoma_right", {-60, -42, -13}},
          {"cheek_left", {47, -64, -12}},
          {"cheek_right", {-47, -64, -12}},
          {"brow", {0, -84, 27}},
          {"ramus_back_left", {49.5, -8, -48}},
          {"ramus_back_right", {-49.5, -8, -48}},
          {"body_crest_left", {14.5, -68.5, -70}},
          {"body_crest_right", {-14.5, -68.5, -70}},
          {"body_border_left", {29, -67, -95}},
          {"body_border_right", {-29, -67, -95}},
          {"interdental_left", {17, -66, -58}},
          {"interdental_right", {-17, -66, -58}},
          {"graft_ramus", {49, -13, -54}},
          {"graft_joint", {50, -5, -10}},
          {"flap_1", {-38, -55, -80}},
          {"flap_2", {-24, -76, -86}},
          {"flap_3", {24, -76, -86}},
          {"flap_4", {38, -55, -80}},
          {"flap_before", {-44.5, -38, -74}},
          {"flap_after", {44.5, -38, -74}},
          {"donor_from", {30, 12, 105}},
          {"donor_to", {33, 16, -105}},
          {"donor_face", {45, 12, 105}},
          {"midline_front", {0, -84, 10}},
          {"midline_back", {0, 90, 10}},
          {"midline_top", {0, 0, 100}},
          {"rim_1", {20, -80, 40}},
          {"rim_2", {30, -78, 32}},
          {"rim_3", {40, -75, 40}},
          {"rim_4", {44, -72, 50}},
          {"rim_5", {40, -70, 60}},
          {"rim_6", {30, -72, 64}},
          {"rim_7", {20, -76, 60}},
          {"rim_8", {16, -78, 50}}};
}

inline planner::ProcedureInput head_input() {
  planner::ProcedureInput input;
  input.scan = {{"path", "head.nrrd"}};
  input.landmarks = head_landmarks();
  input.folder = ".";
  return input;
}

/// Whether a piece has a voxel within 4 mm of a landmark.
inline bool has(const planner::Evaluation& evaluation, const char* piece, const std::string& name) {
  for (const brep::Landmark& mark : head_landmarks())
    if (mark.name == name)
      return !voxel::combine(evaluation.universe, voxel::Expression(evaluation.object(piece).voxel.octree) &
                                                      voxel::Expression(voxel::Sphere{mark.p_mm, 4.0}))
                  .is_empty();
  ADD_FAILURE() << name;
  return false;
}

/// How far a step moves a landmark of the phantom.
inline glm::dvec3 way_mm(const planner::Evaluation& evaluation, const char* moved, const std::string& name) {
  for (const brep::Landmark& mark : head_landmarks())
    if (mark.name == name)
      return glm::dvec3(evaluation.object(moved).moved->motion * glm::dvec4(mark.p_mm, 1.0)) - mark.p_mm;
  ADD_FAILURE() << name;
  return {};
}

}  // namespace octotomy::tests

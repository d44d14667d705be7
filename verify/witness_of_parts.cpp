// SPDX-License-Identifier: AGPL-3.0-or-later
#include <memory>
#include <utility>
#include <vector>

#include "verify/necks.h"
#include "verify/witness.h"

namespace octotomy::verify {

Witness witness_of_parts(Witness whole) {
  if (!whole) return {};
  std::vector<PartChoice> choices = whole.choices();
  choices.push_back({});
  return Witness([whole = std::move(whole)](const glm::dvec3& p_mm, double slack_mm, Asked asked) -> Reading {
           const auto part = [](const Word& word) { return word == certainly_in ? untold : word; };
           const Reading reading = whole(p_mm, slack_mm, asked);
           return {part(reading.voxel), part(reading.mesh), reading.surfaces};
         })
      .with_choices(std::move(choices));
}

Witness witness_of_parts(Witness whole, ChosenParts chosen) {
  if (!whole) return {};
  const auto necks = std::make_shared<const Necks>(std::move(chosen.voxels), std::move(chosen.mesh), whole,
                                                   std::move(chosen.decided_mm));
  Witness parts = witness_of_parts(std::move(whole));
  std::vector<PartChoice> choices = parts.choices();
  choices.back().necks = necks;
  return std::move(parts).with_choices(std::move(choices));
}

Witness witness_of_filled(Witness hollow) {
  if (!hollow) return {};
  std::vector<PartChoice> choices = hollow.choices();
  return Witness(
             [hollow = std::move(hollow)](const glm::dvec3& p_mm, double slack_mm, Asked asked) -> Reading {
               const auto filled = [](const Word& word) { return word == certainly_out ? untold : word; };
               const Reading reading = hollow(p_mm, slack_mm, asked);
               return {filled(reading.voxel), filled(reading.mesh), reading.surfaces};
             })
      .with_choices(std::move(choices));
}

}  // namespace octotomy::verify

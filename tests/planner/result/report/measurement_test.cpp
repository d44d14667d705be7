// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/measurement.h"

#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

TEST(Measurement, HasThePartThatItsStepMeasuredAndNoOther) {
  const std::vector<Measurement> all = measurements_of(Json::parse(R"([
    {"id": "size", "object": "skull", "volume_mm3": 3, "mesh": null, "difference_mm3": null},
    {"id": "gap", "object": "rest", "to": "moved", "gap_mm": null, "finding": "there is no gap"},
    {"id": "line", "points_mm": [[0, 0, 0], [3, 4, 0]], "distance_mm": 5, "distance_half_width_mm": 0.5},
    {"id": "bite", "object": "a", "against": "b", "contacts": [{"at_mm": [1, 2, 3], "nearest_mm": -0.2}]},
    {"id": "other", "insertion_mm": 3}])"));
  ASSERT_EQ(all.size(), 5u);
  EXPECT_EQ(all[0].id, "size");
  ASSERT_TRUE(all[0].size && !all[0].gap && !all[0].contacts);
  EXPECT_EQ(all[0].size->volume_mm3, 3.0);
  EXPECT_FALSE(all[0].size->mesh || all[0].size->difference_mm3 || all[0].size->volume);
  ASSERT_TRUE(all[1].gap && !all[1].size);
  EXPECT_FALSE(all[1].gap->gap_mm);
  EXPECT_EQ(all[1].gap->finding, "there is no gap");
  ASSERT_TRUE(all[2].distance && !all[2].angle);
  EXPECT_EQ(all[2].distance->points_mm.at(1), glm::dvec3(3, 4, 0));
  EXPECT_EQ(all[2].distance->distance_half_width_mm, 0.5);
  ASSERT_TRUE(all[3].contacts);
  EXPECT_EQ(all[3].contacts->contacts.at(0).at_mm, glm::dvec3(1, 2, 3));
  EXPECT_FALSE(all[3].contacts->certain_count);
  const Measurement& other = all[4];
  EXPECT_FALSE(other.size || other.gap || other.distance || other.angle || other.contacts || other.airway ||
               other.flap || other.landmarks || other.trials);
}

TEST(Measurement, EachKindReadsBackWhatItPrints) {
  MeasuredSection section{3.0, {1, 2, 3}, {0, 0, 1}, 20.0, 2.0, 19.0, 20.0, {}};
  MeasuredAirway airway{"air", {900.0, 20.0, 910.0, 40.0, section, {section, section}}, {"a finding"}};
  airway.airway.narrowest.half_width_terms = {{{"voxels", "v", 1.5}}};
  EXPECT_EQ(print_record(record_of<MeasuredAirway>(print_record(airway))), print_record(airway));
  MeasuredFlap flap;
  flap.flap_segments.emplace_back().angle_to_last_deg = 12.0;
  flap.osteotomies.emplace_back().between = {"bone", "segment"};
  EXPECT_EQ(print_record(record_of<MeasuredFlap>(print_record(flap))), print_record(flap));
  MeasuredTrials trials;
  trials.errors.seating_deg = 0.75;
  trials.doubts.push_back({"gap", "a to b", 1.5, "mm", 0.9, 0.99, {{"seating", 0.9}}});
  EXPECT_EQ(print_record(record_of<MeasuredTrials>(print_record(trials))), print_record(trials));
}

}  // namespace
}  // namespace octotomy::planner

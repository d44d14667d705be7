// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/headrest.h"

#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "tests/voxel/field_scene.h"
#include "voxel/filter/components.h"

namespace octotomy::voxel {
namespace {

using tests::field_scene;
using tests::for_each_index;
using tests::sample_at;

const Lattice headrest_lattice = axis_aligned_lattice({70, 80, 30}, {1, 1, 2}, {-35, -40, -29});
constexpr double head_radius_mm = 22.0;
const glm::dvec3 head_mm(0, -8, 0);

bool in_ball_head(const glm::dvec3& p) {
  return glm::distance(p, head_mm) < head_radius_mm;
}
bool in_tooth(const glm::dvec3& p) {  // apart from the head, but near it
  return glm::distance(p, head_mm + glm::dvec3(0, -27, 0)) < 3.0;
}
// A shell behind the head, `gap_mm` from it, wider than the head.
bool in_rest(const glm::dvec3& p, double gap_mm) {
  const double surface = head_mm.y + head_radius_mm + gap_mm;
  return p.y >= surface && p.y < surface + 4 && std::abs(p.x) < 34;
}

Scene scanned(double gap_mm) {
  return field_scene<std::int16_t>(headrest_lattice, [&](const glm::dvec3& p) {
    if (in_ball_head(p)) return 40.0;
    if (in_tooth(p)) return 2000.0;
    if (in_rest(p, gap_mm)) return 100.0;
    if (in_rest(p + glm::dvec3(0, 1, 0), gap_mm) || in_rest(p - glm::dvec3(0, 1, 0), gap_mm)) return -600.0;
    return -1000.0;
  });
}

// The numbers of solid samples of the head (or tooth) and of the rest.
std::pair<int, int> solid(const Scene& scene, double gap_mm) {
  std::pair<int, int> counts{0, 0};
  for_each_index(scene.lattice, 0, [&](const glm::ivec3& p) {
    const glm::dvec3 p_mm = scene.lattice.lps_mm(p);
    if (sample_at(scene, p) < -300) return;
    counts.first += in_ball_head(p_mm) || in_tooth(p_mm);
    counts.second += in_rest(p_mm, gap_mm) && !in_ball_head(p_mm);
  });
  return counts;
}

TEST(Headrest, ApartFromTheHeadIsTakenOutWithItsRimAndTheHeadStays) {
  const Scene scene = scanned(5.0);
  const auto [head_before, rest_before] = solid(scene, 5.0);
  ASSERT_GT(rest_before, 5000);
  const HeadrestRemoval removal = remove_headrest(scene, {});
  EXPECT_EQ(removal.parts, 1U);
  EXPECT_EQ(solid(removal.scene, 5.0), std::make_pair(head_before, 0));
  EXPECT_EQ(removal.solid_mm3, 2.0 * rest_before);
  // The rim of partial volume, -600, is gone too.
  for_each_index(headrest_lattice, 0, [&](const glm::ivec3& p) {
    const double sample = sample_at(removal.scene, p);
    ASSERT_TRUE(sample == 40 || sample == 2000 || sample == -1000) << sample;
  });
  EXPECT_GT(removal.voxels, removal.solid.voxel_count());
}

TEST(Headrest, ComesBackBitByBit) {
  const Scene scene = scanned(5.0);
  HeadrestRemoval removal = remove_headrest(scene, {});
  ASSERT_NE(std::get<Int16Samples>(removal.scene.samples), std::get<Int16Samples>(scene.samples));
  EXPECT_EQ(restore(removal.scene, removal.removed), removal.voxels);
  EXPECT_EQ(std::get<Int16Samples>(removal.scene.samples), std::get<Int16Samples>(scene.samples));
  // Samples cannot be restored into another scan.
  Scene moved = scene;
  moved.lattice.lps_from_voxel[3].x += 1.0;
  EXPECT_THROW(restore(moved, removal.removed), std::invalid_argument);
}

TEST(Headrest, ThatTouchesTheHeadIsCutOff) {
  const Scene scene = scanned(-1.0);  // the head lies a millimetre deep in it
  const auto [head_before, rest_before] = solid(scene, -1.0);
  const auto [head_after, rest_after] = solid(remove_headrest(scene, {}).scene, -1.0);
  EXPECT_GE(head_after, head_before * 0.99);
  EXPECT_LE(rest_after, rest_before * 0.05);
}

// A small head of constant outline, a bridge of 2 mm, and a larger board that a ball of detach_mm fits into.
// The board runs along the whole scan, or over half of it as a holder does.
TEST(Headrest, ThatIsLargerThanASmallHeadOnAThinBridgeIsRemovedAndTheHeadStays) {
  const Lattice lattice = axis_aligned_lattice({150, 70, 40}, {1, 1, 1}, {-74.5, -24.5, -19.5});
  for (const double radius : {12.0, 16.0, 20.0})
    for (const bool is_whole : {true, false}) {
      SCOPED_TRACE(::testing::Message() << "radius " << radius << (is_whole ? ", board" : ", holder"));
      const auto in_head = [&](const glm::dvec3& p) {
        return glm::length(p * glm::dvec3(1, 1, 0.25)) < radius;
      };
      const auto in_board = [&](const glm::dvec3& p) {
        return p.y > radius + 4 && p.y < radius + 18 && std::abs(p.x) < 70 && (is_whole || p.z < 0);
      };
      const Scene scene = field_scene<std::int16_t>(lattice, [&](const glm::dvec3& p) {
        const bool in_bridge = std::abs(p.x) < 1 && std::abs(p.z + 10) < 8 && p.y > 0 && p.y < radius + 6;
        return in_head(p) || in_board(p) || in_bridge ? 60.0 : -1000.0;
      });
      const HeadrestRemoval removal = remove_headrest(scene);
      int head = 0, head_gone = 0, board = 0, board_left = 0;
      for_each_index(lattice, 0, [&](const glm::ivec3& p) {
        const glm::dvec3 p_mm = lattice.lps_mm(p);
        const bool is_solid = sample_at(removal.scene, p) > 0;
        head += in_head(p_mm);
        head_gone += in_head(p_mm) && !is_solid;
        board += in_board(p_mm);
        // A foot of up to 5 mm of the link may stay on the head.
        board_left += in_board(p_mm) && p_mm.y > radius + 5 && is_solid;
      });
      ASSERT_GT(board, is_whole ? head : head / 2);
      EXPECT_EQ(head_gone, 0) << "of " << head;
      EXPECT_EQ(board_left, 0) << "of " << board;
    }
}

TEST(Headrest, NothingInFrontOfTheCoronalMiddleIsRemoved) {
  HeadrestOptions options;
  options.patient.near_mm = 1.0;  // the tooth lies farther away
  const HeadrestRemoval removal = remove_headrest(scanned(5.0), options);
  EXPECT_EQ(removal.parts, 1U);
  // Never in front of the middle; behind it by half a mask and half a cell, 2 and 1 mm, and a cell's
  // rounding.
  EXPECT_GE(removal.middle_y_mm, head_mm.y);
  EXPECT_LE(removal.middle_y_mm, head_mm.y + 4.0);
  EXPECT_EQ(sample_at(removal.scene,
                      glm::ivec3(glm::round(headrest_lattice.voxel(head_mm + glm::dvec3(0, -27, 0))))),
            2000);
  // The same behind a head that lies on its face: a board before it is kept and counted.
  const Scene prone = field_scene<std::int16_t>(headrest_lattice, [](const glm::dvec3& p) {
    const glm::dvec3 q(p.x, -16.0 - p.y, p.z);
    return in_ball_head(q) ? 40.0 : in_rest(q, 5.0) ? 100.0 : -1000.0;
  });
  const HeadrestRemoval kept = remove_headrest(prone, {});
  EXPECT_EQ(kept.voxels, 0U);
  EXPECT_GT(kept.front_mm3, 10000.0);
}

TEST(Headrest, IsTheSameOnOneThreadAndOnTwo) {
  const Scene scene = scanned(3.0);
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::get<Int16Samples>(remove_headrest(scene, {}).scene.samples);
  };
  EXPECT_EQ(on(1), on(2));
}

TEST(Headrest, RefusesWhatItCannotJudge) {
  Scene scene = scanned(5.0);
  HeadrestOptions options;
  options.patient.threshold = 4000;
  EXPECT_THROW(remove_headrest(scene, options), std::runtime_error);
  options = {};
  options.patient.near_mm = -1;
  EXPECT_THROW(remove_headrest(scene, options), std::invalid_argument);
  options = {};
  std::stop_source stop;
  stop.request_stop();
  options.patient.progress.stop = stop.get_token();
  EXPECT_THROW(remove_headrest(scene, options), Stopped);
  scene.samples = FloatSamples(headrest_lattice.sample_count());
  EXPECT_THROW(remove_headrest(scene, {}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel

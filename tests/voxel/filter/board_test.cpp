// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/board.h"

#include <functional>
#include <gtest/gtest.h>

#include "tests/reference_data.h"
#include "tests/voxel/field_scene.h"
#include "voxel/filter/headrest.h"
#include "voxel/filter/slice_work.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

using tests::field_scene;
using tests::for_each_index;
using tests::sample_at;

const Lattice board_lattice = axis_aligned_lattice({120, 130, 60}, {2, 2, 3}, {-119, -119, -88.5});
constexpr double back_mm = 95.0;  // of the head
using Inside = std::function<bool(const glm::dvec3&)>;

/// An egg of a head with a neck; the vertex lies within the scan.
bool in_egg_head(const glm::dvec3& p) {
  const glm::dvec3 q = (p - glm::dvec3(0, 0, -10)) / glm::dvec3(75, 95, 85);
  return glm::dot(q, q) < 1.0 || (p.z < -40 && p.x * p.x + (p.y - 10) * (p.y - 10) < 55 * 55);
}
bool flat_board(const glm::dvec3& p) {
  return p.y >= back_mm - 1 && p.y < back_mm + 11 && std::abs(p.x) < 100;
}
/// Part of a tube about the head's axis, which the head lies in.
bool curved_board(const glm::dvec3& p) {
  const double r = glm::length(glm::dvec2(p.x, p.y + 25));
  return r >= 120 && r < 128 && p.y > 20;
}
/// Two skins of 4 mm about foam.
bool hollow_couch(const glm::dvec3& p) {
  const double depth = p.y - back_mm;
  const bool within = depth >= 0 && depth < 24 && std::abs(p.x) < 105;
  return within && (depth < 4 || depth >= 20 || std::abs(p.x) > 100);
}
bool strap(const glm::dvec3& p) {
  const glm::dvec3 q = (p - glm::dvec3(0, 0, -10)) / glm::dvec3(79, 99, 89);
  return glm::dot(q, q) < 1.0 && std::abs(p.z) < 15 && !in_egg_head(p);
}
/// A stereotactic ring on four posts.
bool frame(const glm::dvec3& p) {
  const double r = glm::length(glm::dvec2(p));
  return (r > 105 && r < 115 && std::abs(p.z + 30) < 8) ||
         (std::abs(std::abs(p.x) - 60) < 5 && std::abs(std::abs(p.y) - 85) < 12 && std::abs(p.z + 30) < 8);
}

Scene scanned(const Inside& support, const Inside& head = in_egg_head) {
  return field_scene<std::int16_t>(board_lattice, [&](const glm::dvec3& p) {
    return head(p) ? 40.0 : support(p) ? 200.0 : -1000.0;
  });
}

/// Samples of the head, and of the support outside of the head, that are still solid.
std::pair<int, int> solid(const Scene& scene, const Inside& support, const Inside& head = in_egg_head) {
  std::pair<int, int> counts{0, 0};
  for_each_index(scene.lattice, 0, [&](const glm::ivec3& p) {
    if (sample_at(scene, p) < -300) return;
    const glm::dvec3 p_mm = scene.lattice.lps_mm(p);
    counts.first += head(p_mm);
    counts.second += support(p_mm) && !head(p_mm);
  });
  return counts;
}

HeadrestOptions with_board() {
  HeadrestOptions options;
  options.board_mm = BoardOptions{}.thick_mm;
  return options;
}

TEST(Board, FlatCurvedOrHollowAndFlushWithTheHeadIsTakenOutAndTheHeadStays) {
  for (const auto& [name, support] : {std::pair<const char*, Inside>{"flat", flat_board},
                                      {"curved", curved_board},
                                      {"hollow", hollow_couch}}) {
    SCOPED_TRACE(name);
    const Scene scene = scanned(support);
    const auto [head_before, support_before] = solid(scene, support);
    ASSERT_GT(support_before, 5000);
    const std::optional<Board> board = board_of(scene);
    ASSERT_TRUE(board);
    EXPECT_NEAR(board->volume_mm3 / (12.0 * support_before), 1.0, 0.03);
    const auto [head, left] = solid(remove_headrest(scene, with_board()).scene, support);
    EXPECT_GE(head, 0.995 * head_before);
    EXPECT_LE(left, 0.02 * support_before);
    // The twin: without the option the board that touches stays, so the test would see one that is missed.
    EXPECT_GT(solid(remove_headrest(scene, {}).scene, support).second, 0.9 * support_before);
  }
}

TEST(Board, BesideAHeadThatIsCutAtBothEndsOfTheScanIsFoundAndTheHeadsCoreIsNot) {
  const Inside cut_head = [](const glm::dvec3& p) {
    const glm::dvec3 q = p / glm::dvec3(75, 95, 200);
    return glm::dot(q, q) < 1.0;
  };
  const Scene scene = scanned(flat_board, cut_head);
  const auto [head_before, support_before] = solid(scene, flat_board, cut_head);
  const auto [head, left] = solid(remove_headrest(scene, with_board()).scene, flat_board, cut_head);
  EXPECT_GE(head, 0.99 * head_before);
  EXPECT_LE(left, 0.05 * support_before);
  EXPECT_FALSE(board_of(scanned([](const glm::dvec3&) { return false; }, cut_head)));
}

TEST(Board, IsNotSeenInACoreWithARaggedOutline) {
  // Airways and folds make a core's outline long for its area; it is as thick as before.
  const Inside core = [](const glm::dvec3& p) {
    const glm::dvec3 q = p / glm::dvec3(75, 95, 200);
    const bool slit = std::abs(std::remainder(p.x, 24.0)) < 2.0 && std::abs(p.y) > 18.0;
    return glm::dot(q, q) < 1.0 && !slit;
  };
  EXPECT_FALSE(board_of(scanned([](const glm::dvec3&) { return false; }, core)));
  EXPECT_TRUE(board_of(scanned(flat_board, core)));
}

TEST(Board, IsNotSeenInAHeadAloneAFoamCradleAStrapAFrameOrADrySkullsTube) {
  const Inside nothing = [](const glm::dvec3&) { return false; };
  EXPECT_FALSE(board_of(scanned(nothing)));
  EXPECT_FALSE(board_of(scanned(strap)));
  EXPECT_FALSE(board_of(scanned(frame)));
  EXPECT_FALSE(
      board_of(scanned(nothing, [](const glm::dvec3& p) { return glm::length(glm::dvec2(p)) < 80.0; })));
  // Foam is no solid part; a cradle of it needs no removal.
  Scene cradle = field_scene<std::int16_t>(board_lattice, [](const glm::dvec3& p) {
    return in_egg_head(p) ? 40.0 : curved_board(p) || flat_board(p) ? -900.0 : -1000.0;
  });
  EXPECT_FALSE(board_of(cradle));
}

TEST(Board, LiesBehindThePatientForAnyOrderOfTheAxes) {
  // Stored from the back to the front, and by sagittal slices.
  Lattice turned = board_lattice;
  turned.dims = {130, 60, 120};
  turned.lps_from_voxel = glm::dmat4(glm::dvec4(0, -2, 0, 0), glm::dvec4(0, 0, 3, 0), glm::dvec4(2, 0, 0, 0),
                                     glm::dvec4(-119, 139, -88.5, 1));
  const auto field = [](const glm::dvec3& p) {
    return in_egg_head(p) ? 40.0 : flat_board(p) ? 200.0 : -1000.0;
  };
  const std::optional<Board> straight = board_of(field_scene<std::int16_t>(board_lattice, field));
  const std::optional<Board> other = board_of(field_scene<std::int16_t>(turned, field));
  ASSERT_TRUE(straight && other);
  EXPECT_DOUBLE_EQ(other->volume_mm3, straight->volume_mm3);
  EXPECT_DOUBLE_EQ(other->wide_mm, straight->wide_mm);
}

TEST(Board, OfRealHeadsNoneIsSeenAndOneThatIsLaidFlushUnderThemIsTakenOut) {
  for (const std::string name : {"ct_unc_cthead.nrrd", "ct_invesalius_cranium.nii.gz"}) {
    SCOPED_TRACE(name);
    OCTOTOMY_NEEDS_DATA(name);
    const Scene head = remove_headrest(read_scene(tests::reference_data(name)), {}).scene;
    EXPECT_FALSE(board_of(head)) << "a head's core is no board";
    // Two samples deep in the patient's back, 12 mm thick.
    const glm::dvec3 spacing_mm = head.lattice.spacing_mm();
    const bool back_grows = head.lattice.lps_from_voxel[1].y > 0.0;
    int back = -1;
    for_each_index(head.lattice, 0, [&](const glm::ivec3& p) {
      if (sample_at(head, p) >= -300) back = std::max(back, back_grows ? p.y : head.lattice.dims.y - 1 - p.y);
    });
    Scene laid = head;
    auto& samples = std::get<Int16Samples>(laid.samples);
    std::uint64_t board_voxels = 0, head_voxels = 0;
    std::vector<std::uint8_t> is_board(samples.size(), 0);
    for_each_index(head.lattice, 0, [&](const glm::ivec3& p) {
      const int depth = (back_grows ? p.y : head.lattice.dims.y - 1 - p.y) - (back - 1);
      std::int16_t& sample = samples[sample_index(head.lattice.dims, p)];
      head_voxels += sample >= -300;
      if (sample >= -300 || depth < 0 || depth * spacing_mm.y >= 12.0 || p.x < 20 ||
          p.x >= head.lattice.dims.x - 20)
        return;
      sample = 100;
      is_board[sample_index(head.lattice.dims, p)] = 1;
      ++board_voxels;
    });
    ASSERT_GT(board_voxels, 10000u);
    const Scene clean = remove_headrest(laid, with_board()).scene;
    std::uint64_t left = 0, head_left = 0;
    for_each_index(head.lattice, 0, [&](const glm::ivec3& p) {
      const bool is_solid = sample_at(clean, p) >= -300;
      (is_board[sample_index(head.lattice.dims, p)] != 0 ? left : head_left) += is_solid;
    });
    EXPECT_LT(static_cast<double>(left), 0.02 * static_cast<double>(board_voxels));
    EXPECT_GT(static_cast<double>(head_left), 0.999 * static_cast<double>(head_voxels));
  }
}

TEST(Board, LengthsThatCannotBeAreRefused) {
  EXPECT_THROW(board_of(scanned(flat_board), {-300.0, 0.0}), std::invalid_argument);
  HeadrestOptions options;
  options.board_mm = -1.0;
  EXPECT_THROW(remove_headrest(scanned(flat_board), options), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The allowed distance of a right answer's surface:
//   smooth    Each of 2 n steps adds up the coordinates of some neighbours, six on average and rarely over
//             thirty: 32 roundings of numbers as large as the largest coordinate. Steps in and out leave
//             waves nearly as they were or take them off, so that roundings add up and do not grow.
//   decimate  The largest requested error. The step measures both surfaces at samples and undoes what lies
//             farther off. Between the samples a right answer may lie somewhat farther, which is a WARN.
#include "verify/witness/reshaped_witness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <tbb/task_arena.h>
#include <utility>
#include <vector>

#include "verify/witness/witness.h"

namespace octotomy::verify {
namespace {

/// The neighbours of each vertex, each once.
std::vector<std::vector<std::uint32_t>> neighbours_of(const brep::Triangles& triangles) {
  std::vector<std::vector<std::uint32_t>> neighbours(triangles.points_mm.size());
  for (const auto& face : triangles.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      neighbours[face[k]].push_back(face[(k + 1) % 3]);
      neighbours[face[k]].push_back(face[(k + 2) % 3]);
    }
  for (std::vector<std::uint32_t>& own : neighbours) {
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  }
  return neighbours;
}

/// Computes the surface at the first use; copies share it. If a box cuts the object, `cut` reads the box's
/// points.
class ReshapedReader {
 public:
  explicit ReshapedReader(std::function<Reshaped()> make) : state_(std::make_shared<State>()) {
    state_->make = std::move(make);
  }

  ReshapedReader(const ReshapedReader& whole, Witness cut) : state_(whole.state_), cut_(std::move(cut)) {}

  const Reshaped& made() const {
    std::call_once(state_->once, [this] {
      // Isolated: while this thread waits for its own tasks it must not run another task, which might wait
      // here as well.
      tbb::this_task_arena::isolate([this] { state_->made.emplace(state_->make()); });
      state_->make = nullptr;
    });
    return *state_->made;
  }

  Reading operator()(const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked) const {
    if (cut_) return cut_(p_mm, slack_mm, asked);
    const Reshaped& by = made();
    if (by.sides) {
      // The voxels were digitised from these triangles, so the mesh's side is also that of the voxels.
      Reading reading =
          by.sides(p_mm, slack_mm, needs_surfaces(asked) ? ReadingNeeds::MeshOnly : ReadingNeeds::MeshSides);
      reading.voxel = reading.mesh;
      if (reading.mesh.near) reading.surfaces = 2;
      return reading;
    }
    const double near_mm = reach_doubt * by.expected.reach_mm + rounded_mm(p_mm) + slack_mm;
    const TriangleGrid& surface = by.expected.surface;
    const AllowedSides allowed = surface.has_within(p_mm, near_mm) ? on_surface
                                 : surface.has_inside(p_mm)        ? certainly_in
                                                                   : certainly_out;
    return {allowed, allowed, allowed.near ? 2 : 0};
  }

 private:
  struct State {
    std::once_flag once;
    std::function<Reshaped()> make;
    std::optional<Reshaped> made;
  };
  std::shared_ptr<State> state_;
  Witness cut_;
};

}  // namespace

Witness witness_of_reshaped(std::function<Reshaped()> make) {
  return ReshapedReader(std::move(make));
}

Witness cut_by_box(const Witness& whole, const voxel::Box& box) {
  Witness cut = both(whole, witness_of_box(box));
  const auto* reader = whole.reader<ReshapedReader>();
  if (reader == nullptr) return cut;
  LineReading lines = cut.lines();
  std::vector<PartChoice> choices = cut.choices();
  return Witness(ReshapedReader(*reader, std::move(cut)))
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

bool is_reshaped(const Witness& witness) {
  return witness.reader<ReshapedReader>() != nullptr;
}

const ReshapedSurface& expected_surface(const Witness& witness) {
  return witness.reader<ReshapedReader>()->made().expected;
}

ReshapedSurface surface_smoothed(const brep::Triangles& still, int rounds, double pass_band) {
  constexpr double inward = 0.5;
  const double outward = 1.0 / (pass_band - 1.0 / inward);
  const std::vector<std::vector<std::uint32_t>> neighbours = neighbours_of(still);
  brep::Triangles made = still;
  std::vector<glm::dvec3> before;
  for (int step = 0; step < 2 * rounds; ++step) {
    before = made.points_mm;
    const double share = step % 2 == 0 ? inward : outward;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (neighbours[i].empty()) continue;
      glm::dvec3 mean_mm(0.0);
      for (const std::uint32_t beside : neighbours[i])
        mean_mm += before[beside] / static_cast<double>(neighbours[i].size());
      made.points_mm[i] = (1.0 - share) * before[i] + share * mean_mm;
    }
  }
  double farthest_mm = 1.0;
  for (const glm::dvec3& p_mm : still.points_mm) farthest_mm = std::max(farthest_mm, glm::length(p_mm));
  const double reach_mm = 2.0 * rounds * 32.0 * std::numeric_limits<double>::epsilon() * farthest_mm;
  return {TriangleGrid(std::move(made)), reach_mm, "64 eps |p| a round: the same steps by other code"};
}

ReshapedSurface surface_decimated(const brep::Triangles& still, double max_error_mm) {
  return {TriangleGrid(still), max_error_mm, "the largest error requested"};
}

}  // namespace octotomy::verify

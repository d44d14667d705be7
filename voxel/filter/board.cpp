// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 Count, for each place of the plane across the patient's axis, the slices on which it is solid.
// 2 Join places that are solid on nine of ten slices to profiles, and choose those that may be a board's.
// 3 The board is what is solid in those profiles.
#include "voxel/filter/board.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "voxel/filter/label_map.h"
#include "voxel/tree/build.h"

namespace octotomy::voxel {
namespace {

constexpr double share_of_slices() {
  return 0.9;
}
/// Less is a strap's, a tube's or an arm's.
constexpr double least_width_mm() {
  return 40.0;
}

/// A board is at least so many times as wide as it is thick.
constexpr double least_aspect() {
  return 3.0;
}

/// The lattice's axes: along the patient, and across it to the back and to a side.
struct Axes {
  int along = 2, back = 1, side = 0;
  bool back_grows = true;  ///< indices grow to the patient's back
};

Axes axes_of(const Lattice& lattice) {
  const auto nearest = [&](int patient, int taken) {
    int best = -1;
    double most = -1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dvec3 direction = glm::normalize(glm::dvec3(lattice.lps_from_voxel[axis]));
      if (axis == taken || std::abs(direction[patient]) <= most) continue;
      most = std::abs(direction[patient]);
      best = axis;
    }
    return best;
  };
  Axes axes;
  axes.along = nearest(2, -1);
  axes.back = nearest(1, axes.along);
  axes.side = 3 - axes.along - axes.back;
  axes.back_grows = lattice.lps_from_voxel[axes.back].y > 0.0;
  return axes;
}

/// Places that are joined by their sides.
struct Profile {
  std::vector<glm::ivec2> places;  ///< side, back
  std::uint64_t voxels = 0;
  double thick_mm = 0.0;    ///< side of the largest square within
  int low = 0, high = 0;    ///< along the side
  double back_index = 0.0;  ///< mean
};

class Finder {
 public:
  Finder(const Scene& scene, const BoardOptions& options)
      : scene_(scene), options_(options), axes_(axes_of(scene.lattice)) {
    const auto* samples = std::get_if<Int16Samples>(&scene.samples);
    if (samples == nullptr)
      throw std::invalid_argument(scene.source + ": a board is sought among int16 samples");
    samples_ = samples;
    size_ = {dims()[axes_.side], dims()[axes_.back]};
    spacing_ = scene.lattice.spacing_mm();
  }

  std::optional<Board> run() {
    count();
    std::vector<Profile> boards;
    for (Profile& profile : profiles())
      if (is_board(profile)) boards.push_back(std::move(profile));
    if (boards.empty()) return std::nullopt;
    const Profile& widest = *std::max_element(boards.begin(), boards.end(), [](const auto& a, const auto& b) {
      return a.high - a.low < b.high - b.low;
    });
    Board board{Octree::empty(universe_on(scene_.lattice)), 0.0, widest.thick_mm, width_mm(widest)};
    std::vector<std::uint8_t> in(counts_.size(), 0);
    for (const Profile& profile : boards)
      for (const glm::ivec2& place : profile.places) in[at(place)] = 1;
    Scene only = scene_;
    auto& samples = std::get<Int16Samples>(only.samples);
    std::uint64_t voxels = 0;
    each([&](const glm::ivec2& place, std::size_t index) {
      const bool stays = in[at(place)] != 0 && samples[index] >= options_.threshold;
      samples[index] = stays ? 1 : 0;
      voxels += stays;
    });
    board.solid = octree_of_window(universe_on(scene_.lattice), only, 1.0, 1.0);
    board.volume_mm3 = static_cast<double>(voxels) * scene_.lattice.voxel_mm3();
    return board;
  }

 private:
  const glm::ivec3& dims() const { return scene_.lattice.dims; }
  std::size_t at(const glm::ivec2& place) const {
    return static_cast<std::size_t>(place.y) * static_cast<std::size_t>(size_.x) +
           static_cast<std::size_t>(place.x);
  }
  double width_mm(const Profile& profile) const {
    return (profile.high - profile.low + 1) * spacing_[axes_.side];
  }

  /// Every sample, in the order of storage, with its place across the patient.
  template <typename Visit>
  void each(const Visit& visit) const {
    std::size_t index = 0;
    glm::ivec3 p(0);
    for (p.z = 0; p.z < dims().z; ++p.z)
      for (p.y = 0; p.y < dims().y; ++p.y)
        for (p.x = 0; p.x < dims().x; ++p.x) visit(glm::ivec2(p[axes_.side], p[axes_.back]), index++);
  }

  void count() {
    counts_.assign(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y), 0);
    each([&](const glm::ivec2& place, std::size_t index) {
      counts_[at(place)] += (*samples_)[index] >= options_.threshold;
    });
    double back = 0.0;
    for (int y = 0; y < size_.y; ++y)
      for (int x = 0; x < size_.x; ++x) {
        solid_ += counts_[at({x, y})];
        back += static_cast<double>(y) * counts_[at({x, y})];
      }
    middle_back_ = solid_ > 0 ? back / static_cast<double>(solid_) : 0.0;
  }

  bool lasts(const glm::ivec2& place) const {
    return place.x >= 0 && place.y >= 0 && place.x < size_.x && place.y < size_.y &&
           counts_[at(place)] >= share_of_slices() * dims()[axes_.along];
  }

  std::vector<Profile> profiles() const {
    std::vector<Profile> all;
    std::vector<std::uint8_t> seen(counts_.size(), 0);
    for (int y = 0; y < size_.y; ++y)
      for (int x = 0; x < size_.x; ++x)
        if (lasts({x, y}) && seen[at({x, y})] == 0) all.push_back(flood({x, y}, seen));
    return all;
  }

  Profile flood(const glm::ivec2& first, std::vector<std::uint8_t>& seen) const {
    Profile profile;
    profile.low = profile.high = first.x;
    profile.places.push_back(first);
    seen[at(first)] = 1;
    for (std::size_t i = 0; i < profile.places.size(); ++i) {
      const glm::ivec2 place = profile.places[i];
      profile.voxels += counts_[at(place)];
      profile.low = std::min(profile.low, place.x);
      profile.high = std::max(profile.high, place.x);
      profile.back_index += place.y;
      for (int k = 0; k < 4; ++k) {
        const glm::ivec2 beside = place + glm::ivec2(k == 0   ? 1
                                                     : k == 1 ? -1
                                                              : 0,
                                                     k == 2   ? 1
                                                     : k == 3 ? -1
                                                              : 0);
        if (!lasts(beside) || seen[at(beside)] != 0) continue;
        seen[at(beside)] = 1;
        profile.places.push_back(beside);
      }
    }
    profile.back_index /= static_cast<double>(profile.places.size());
    profile.thick_mm = thick_mm(profile);
    return profile;
  }

  /// The side of the largest square of places, by the largest that ends at each place.
  double thick_mm(const Profile& profile) const {
    std::vector<glm::ivec2> places = profile.places;
    std::sort(places.begin(), places.end(), [](const glm::ivec2& a, const glm::ivec2& b) {
      return std::pair(a.y, a.x) < std::pair(b.y, b.x);
    });
    std::vector<int> square(counts_.size(), 0);
    int largest = 0;
    for (const glm::ivec2& p : places) {
      const auto before = [&](int x, int y) {
        return p.x < x || p.y < y ? 0 : square[at(p - glm::ivec2(x, y))];
      };
      square[at(p)] = 1 + std::min({before(1, 0), before(0, 1), before(1, 1)});
      largest = std::max(largest, square[at(p)]);
    }
    return largest * std::min(spacing_[axes_.back], spacing_[axes_.side]);
  }

  bool is_board(const Profile& profile) const {
    const double behind = (profile.back_index - middle_back_) * (axes_.back_grows ? 1.0 : -1.0);
    return width_mm(profile) >= std::max(least_width_mm(), least_aspect() * profile.thick_mm) &&
           behind > 0.0 && profile.thick_mm <= options_.thick_mm && 2 * profile.voxels <= solid_;
  }

  const Scene& scene_;
  const BoardOptions& options_;
  Axes axes_;
  const Int16Samples* samples_ = nullptr;
  glm::ivec2 size_{0};
  glm::dvec3 spacing_{1.0};
  std::vector<std::uint32_t> counts_;  ///< of slices on which a place is solid
  std::uint64_t solid_ = 0;
  double middle_back_ = 0.0;
};

}  // namespace

std::optional<Board> board_of(const Scene& scene, const BoardOptions& options) {
  if (!(options.thick_mm > 0.0)) throw std::invalid_argument("a board's thickness must be above 0 mm");
  return Finder(scene, options).run();
}

}  // namespace octotomy::voxel

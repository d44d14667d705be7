// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/measured.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <tbb/parallel_for.h>
#include <vector>

#include "voxel/filter/slice_work.h"

namespace octotomy::voxel {
namespace {

/// The samples of one slice, and which of them are padding.
template <typename Sample>
class Slice {
 public:
  Slice(Sample* samples, const Lattice& lattice, double padding)
      : samples_(samples),
        width_(lattice.dims.x),
        height_(lattice.dims.y),
        spacing_mm_(lattice.spacing_mm()),
        padding_(padding) {}

  bool is_padded(int x, int y) const { return static_cast<double>(samples_[index(x, y)]) == padding_; }

  bool has_measured() const {
    return std::any_of(samples_, samples_ + static_cast<std::ptrdiff_t>(width_) * height_,
                       [&](Sample sample) { return static_cast<double>(sample) != padding_; });
  }

  /// Replaces each padded sample by the nearest measured one. Precondition: has_measured().
  void fill() {
    const std::vector<int> nearest = nearest_in_rows();
    std::vector<Sample> filled(samples_, samples_ + static_cast<std::ptrdiff_t>(width_) * height_);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x)
        if (is_padded(x, y)) filled[index(x, y)] = samples_[nearest_to(x, y, nearest)];
    std::copy(filled.begin(), filled.end(), samples_);
  }

 private:
  static constexpr int none = -1;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  /// For each sample, the column of the nearest measured sample in its row; of two equally near ones, the
  /// lower column.
  std::vector<int> nearest_in_rows() const {
    std::vector<int> nearest(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), none);
    for (int y = 0; y < height_; ++y) {
      int last = none;
      for (int x = 0; x < width_; ++x) {
        if (!is_padded(x, y)) last = x;
        nearest[index(x, y)] = last;
      }
      last = none;
      for (int x = width_ - 1; x >= 0; --x) {
        if (!is_padded(x, y)) last = x;
        int& left = nearest[index(x, y)];
        if (last != none && (left == none || last - x < x - left)) left = last;
      }
    }
    return nearest;
  }

  /// The index of the nearest measured sample. Searches the rows in the order of their distances, until no
  /// further row can contain a nearer sample.
  std::size_t nearest_to(int x, int y, const std::vector<int>& in_rows) const {
    double least_mm = std::numeric_limits<double>::infinity();
    std::size_t found = index(x, y);
    for (int away = 0; away < height_ && away * spacing_mm_.y < least_mm; ++away)
      for (const int row : {y - away, y + away}) {
        if (row < 0 || row >= height_) continue;
        const int column = in_rows[index(x, row)];
        if (column == none) continue;
        const double mm = std::hypot((column - x) * spacing_mm_.x, away * spacing_mm_.y);
        if (!(mm < least_mm)) continue;
        least_mm = mm;
        found = index(column, row);
      }
    return found;
  }

  Sample* samples_;
  int width_, height_;
  glm::dvec3 spacing_mm_;
  double padding_;
};

/// Replaces padding by the nearest measured samples; without measured samples nothing changes.
template <typename Sample>
void fill(Samples<Sample>& samples, const Lattice& lattice, double padding) {
  const std::size_t size = slice_size(lattice);
  const auto slice = [&](int k) {
    return Slice<Sample>(samples.data() + static_cast<std::size_t>(k) * size, lattice, padding);
  };
  std::vector<char> has(static_cast<std::size_t>(lattice.dims.z), 0);
  tbb::parallel_for(0, lattice.dims.z, [&](int k) {
    if (!slice(k).has_measured()) return;
    has[static_cast<std::size_t>(k)] = 1;
    slice(k).fill();
  });
  if (std::find(has.begin(), has.end(), 1) == has.end()) return;
  tbb::parallel_for(0, lattice.dims.z, [&](int k) {
    if (has[static_cast<std::size_t>(k)] != 0) return;
    int away = 1;
    const auto is_there = [&](int at) {
      return at >= 0 && at < lattice.dims.z && has[static_cast<std::size_t>(at)] != 0;
    };
    while (!is_there(k - away) && !is_there(k + away)) ++away;
    const int from = is_there(k - away) ? k - away : k + away;
    std::copy_n(samples.data() + static_cast<std::size_t>(from) * size, size,
                samples.data() + static_cast<std::size_t>(k) * size);
  });
}

/// A padding value below all samples: the old padding if it is below all of them. For int16 there may be no
/// value below the least sample, but means and medians of samples always exceed the old padding.
template <typename Sample>
Sample mark_below(const Samples<Sample>& made, double padding) {
  const auto least = static_cast<double>(*std::min_element(made.begin(), made.end()));
  return rounded<Sample>(least > padding ? padding : least - std::max(1.0, std::abs(least)));
}

}  // namespace

Scene on_measured(const Scene& scene, const std::function<Scene(const Scene&)>& filter) {
  check(scene);
  if (!scene.padding) return filter(scene);
  Scene whole = scene;
  whole.padding.reset();
  const double padding = *scene.padding;
  std::visit([&](auto& samples) { fill(samples, scene.lattice, padding); }, whole.samples);
  Scene made = filter(whole);
  std::visit(
      [&](const auto& read, auto& written) {
        using Sample = typename std::decay_t<decltype(written)>::value_type;
        const Sample mark = mark_below(written, padding);
        made.padding = static_cast<double>(mark);
        tbb::parallel_for(std::size_t{0}, written.size(), [&](std::size_t i) {
          if (static_cast<double>(read[i]) == padding) written[i] = mark;
        });
      },
      scene.samples, made.samples);
  return made;
}

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 Mark what is extruded along the table.
// 2 Average the rest over cells of about two millimetres, and find the patient's core: the largest part into
//   which a ball of detach_mm fits.
// 3 Judge every other part: near the patient it stays; what hangs behind the core is a support.
// 4 Close the patient, and fill what it encloses in each slice and in space.
// 5 Class each sample by its cell, its mark and its place before or behind the coronal middle.
#include "voxel/filter/patient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "voxel/filter/extrusion.h"
#include "voxel/filter/slice_work.h"
#include "voxel/measure/distance_map.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

constexpr double cell_mm = 2.0;
constexpr double above_air = 40.0;        ///< HU of a cell's mean; the noise of a mean is a fraction of it
constexpr double contact_mm = 3.0;        ///< what is cut off leaves this much where it hung on the core
constexpr double silhouette_mm = 10.0;    ///< within the core's outline from behind: where no ear is
constexpr double close_mm = 4.0;          ///< gaps in the skin up to twice this width are closed
constexpr double foam_limit = -200.0;     ///< HU: from here on soft tissue lies below the threshold
constexpr double least_core_share = 0.3;  ///< of the largest part; less, and the object is thin throughout
constexpr double most_front_share = 0.25;  ///< a thick part that lies farther in front is no support
constexpr double thick_mm = 4.0;           ///< a part is thick if it holds a ball of this radius

using Cells = std::vector<std::uint8_t>;

/// Cells of whole samples on the scene's lattice.
struct Grid {
  glm::ivec3 factor{1}, dims{0};
  glm::dvec3 mm{1.0};

  explicit Grid(const Lattice& lattice) {
    const glm::dvec3 spacing = lattice.spacing_mm();
    for (int k = 0; k < 3; ++k) factor[k] = std::max(1, static_cast<int>(std::lround(cell_mm / spacing[k])));
    dims = (lattice.dims + factor - 1) / factor;
    mm = spacing * glm::dvec3(factor);
  }
  std::size_t count() const {
    return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
           static_cast<std::size_t>(dims.z);
  }
  std::size_t at(const glm::ivec3& p) const { return sample_index(dims, p); }
  bool holds(const glm::ivec3& p) const {
    return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < dims.x && p.y < dims.y && p.z < dims.z;
  }
  glm::ivec3 cell(std::size_t i) const {
    const auto x = static_cast<std::size_t>(dims.x), y = static_cast<std::size_t>(dims.y);
    return {static_cast<int>(i % x), static_cast<int>(i / x % y), static_cast<int>(i / (x * y))};
  }
};

constexpr std::array<std::array<int, 3>, 6> faces{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

/// Squared distances to the cells that are set. The grid's border is no cell: outside is unknown.
std::vector<float> distances(const Grid& grid, const Cells& set, bool to_unset = false) {
  DistanceMap map{{glm::ivec3(0), grid.dims - 1}, {}};
  map.square_mm2.resize(grid.count());
  for (std::size_t i = 0; i < set.size(); ++i)
    map.square_mm2[i] = (set[i] != 0) != to_unset ? 0.0F : std::numeric_limits<float>::infinity();
  Universe universe;
  for (int k = 0; k < 3; ++k) universe.lps_from_voxel[k][k] = grid.mm[k];
  spread(map, universe);
  return std::move(map.square_mm2);
}

Cells dilated(const Grid& grid, const Cells& set, double radius_mm) {
  const std::vector<float> away = distances(grid, set);
  Cells result(set.size());
  for (std::size_t i = 0; i < set.size(); ++i)
    result[i] = static_cast<double>(away[i]) <= radius_mm * radius_mm ? 1 : 0;
  return result;
}

/// Dilates by a length plus half a cell along each axis, and by one cell at least.
Cells with_edge(const Grid& grid, const Cells& set, double edge_mm) {
  Grid scaled = grid;
  for (int k = 0; k < 3; ++k) scaled.mm[k] /= std::max(edge_mm + 0.5 * grid.mm[k], 1.001 * grid.mm[k]);
  return dilated(scaled, set, 1.0);
}

Cells eroded(const Grid& grid, const Cells& set, double radius_mm) {
  const std::vector<float> depth = distances(grid, set, true);
  Cells result(set.size());
  for (std::size_t i = 0; i < set.size(); ++i)
    result[i] = static_cast<double>(depth[i]) > radius_mm * radius_mm ? 1 : 0;
  return result;
}

/// Calls `visit` with the cells of each part that is joined by faces, in the order of their first cells.
template <typename Visit>
void for_each_part(const Grid& grid, const Cells& set, const Visit& visit) {
  Cells seen(set.size(), 0);
  std::vector<std::size_t> part;
  for (std::size_t first = 0; first < set.size(); ++first) {
    if (set[first] == 0 || seen[first] != 0) continue;
    part.assign(1, first);
    seen[first] = 1;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const glm::ivec3 p = grid.cell(part[i]);
      for (const auto& face : faces) {
        const glm::ivec3 q = p + glm::ivec3(face[0], face[1], face[2]);
        if (!grid.holds(q)) continue;
        const std::size_t next = grid.at(q);
        if (set[next] == 0 || seen[next] != 0) continue;
        seen[next] = 1;
        part.push_back(next);
      }
    }
    visit(part);
  }
}

std::vector<std::size_t> largest(const Grid& grid, const Cells& set) {
  std::vector<std::size_t> most;
  for_each_part(grid, set, [&](const std::vector<std::size_t>& part) {
    if (part.size() > most.size()) most = part;
  });
  return most;
}

Cells cells_of(const Grid& grid, const std::vector<std::size_t>& part) {
  Cells cells(grid.count(), 0);
  for (const std::size_t i : part) cells[i] = 1;
  return cells;
}

/// Fills what the set encloses in each plane across an axis.
void fill_slices(const Grid& grid, Cells& set, int along) {
  const int u = (along + 1) % 3, v = (along + 2) % 3;
  tbb::parallel_for(0, grid.dims[along], [&](int slice) {
    const glm::ivec2 size(grid.dims[u], grid.dims[v]);
    const auto index = [&](const glm::ivec2& q) {
      glm::ivec3 p(0);
      p[along] = slice;
      p[u] = q.x;
      p[v] = q.y;
      return grid.at(p);
    };
    Cells outside(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 0);
    std::vector<glm::ivec2> stack;
    const auto reach = [&](const glm::ivec2& q) {
      if (q.x < 0 || q.y < 0 || q.x >= size.x || q.y >= size.y) return;
      std::uint8_t& seen = outside[static_cast<std::size_t>(q.y) * static_cast<std::size_t>(size.x) +
                                   static_cast<std::size_t>(q.x)];
      if (seen != 0 || set[index(q)] != 0) return;
      seen = 1;
      stack.push_back(q);
    };
    for (int x = 0; x < size.x; ++x) reach({x, 0}), reach({x, size.y - 1});
    for (int y = 0; y < size.y; ++y) reach({0, y}), reach({size.x - 1, y});
    while (!stack.empty()) {
      const glm::ivec2 q = stack.back();
      stack.pop_back();
      for (const glm::ivec2& step : {glm::ivec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) reach(q + step);
    }
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        if (outside[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) +
                    static_cast<std::size_t>(x)] == 0)
          set[index({x, y})] = 1;
  });
}

class Parter {
 public:
  Parter(const Scene& scene, const Int16Samples& samples, const PatientOptions& options)
      : scene_(scene), samples_(samples), options_(options), axes_(patient_axes(scene.lattice)),
        grid_(scene.lattice) {
    const bool hounsfield = scene.meaning == Meaning::Hounsfield;
    air_ = hounsfield ? air_level(scene, samples) : options.threshold - 700.0;
    seeks_foam_ = hounsfield && options.threshold <= foam_limit;
    back_sign_ = scene.lattice.lps_from_voxel[axes_.back].y > 0.0 ? 1 : -1;
  }

  PatientParts run() {
    ExtrusionOptions extruded{options_.threshold, air_, options_.board_mm, {}};
    extruded.progress.stop = options_.progress.stop;
    extrusion_ = extrusion_of(scene_, extruded);
    options_.progress.at(0.4);
    average();
    find_core();
    options_.progress.at(0.6);
    judge_parts();
    options_.progress.at(0.8);
    protect();
    find_foam();
    return classed();
  }

 private:
  double y_mm(const glm::ivec3& cell) const {
    return scene_.lattice.lps_mm((glm::dvec3(cell) + 0.5) * glm::dvec3(grid_.factor) - 0.5).y;
  }

  void average() {
    mean_.resize(grid_.count());
    solid_.assign(grid_.count(), 0);
    const glm::ivec3 dims = scene_.lattice.dims;
    tbb::parallel_for(0, grid_.dims.z, [&](int z) {
      for (int y = 0; y < grid_.dims.y; ++y)
        for (int x = 0; x < grid_.dims.x; ++x) {
          const glm::ivec3 low = glm::ivec3(x, y, z) * grid_.factor;
          const glm::ivec3 high = glm::min(low + grid_.factor, dims);
          double sum = 0.0, own = 0.0;
          for (int k = low.z; k < high.z; ++k)
            for (int j = low.y; j < high.y; ++j)
              for (int i = low.x; i < high.x; ++i) {
                const std::size_t at = sample_index(dims, {i, j, k});
                sum += samples_[at];
                own += extrusion_.marks[at] != 0 ? air_ : samples_[at];
              }
          const glm::ivec3 size = high - low;
          const double count = size.x * size.y * size.z;
          const std::size_t cell = grid_.at({x, y, z});
          mean_[cell] = static_cast<float>(sum / count);
          solid_[cell] = own / count >= options_.threshold ? 1 : 0;
        }
    });
  }

  void find_core() {
    const std::vector<std::size_t> whole = largest(grid_, solid_);
    if (whole.empty())
      throw Error(ErrorCode::Geometry,
                  scene_.source + ": no sample beside the table is at or above " +
                      std::to_string(options_.threshold) + ": choose another threshold");
    const Cells opened = dilated(
        grid_, cells_of(grid_, largest(grid_, eroded(grid_, solid_, options_.detach_mm))), options_.detach_mm);
    core_.assign(grid_.count(), 0);
    std::size_t count = 0;
    for (std::size_t i = 0; i < core_.size(); ++i) count += core_[i] = opened[i] & solid_[i];
    if (static_cast<double>(count) < least_core_share * static_cast<double>(whole.size()))
      core_ = cells_of(grid_, whole);
    set_middle();
  }

  /// Half-way between the foremost and the rearmost cell of the core and of what hangs on it and is near, such
  /// as the nose, with half a cell of care.
  void set_middle() {
    Cells rest(grid_.count(), 0);
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = solid_[i] != 0 && core_[i] == 0 ? 1 : 0;
    away_ = distances(grid_, core_);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const auto add = [&](std::size_t i) {
      const double y = y_mm(grid_.cell(i));
      low = std::min(low, y);
      high = std::max(high, y);
    };
    for (std::size_t i = 0; i < core_.size(); ++i)
      if (core_[i] != 0) add(i);
    const double touch2 = glm::dot(grid_.mm, grid_.mm), near2 = options_.near_mm * options_.near_mm;
    for_each_part(grid_, rest, [&](const std::vector<std::size_t>& part) {
      const auto is_within = [&](double limit) {
        return [this, limit](std::size_t i) { return static_cast<double>(away_[i]) <= limit; };
      };
      if (std::any_of(part.begin(), part.end(), is_within(touch2)) &&
          std::all_of(part.begin(), part.end(), is_within(near2)))
        std::for_each(part.begin(), part.end(), add);
    });
    middle_y_mm_ = 0.5 * (low + high) + 0.5 * grid_.mm[axes_.back];
  }

  /// For each line from the front to the back, the core's rearmost cell, where the line lies well within the
  /// core's outline; otherwise none.
  std::vector<int> backs() const {
    const int sides = grid_.dims[axes_.side], slices = grid_.dims[axes_.along];
    Grid plane = grid_;
    plane.dims = {sides, slices, 1};
    plane.mm = {grid_.mm[axes_.side], grid_.mm[axes_.along], 1.0};
    std::vector<int> back(plane.count(), -1);
    Cells outline(plane.count(), 0);
    for (std::size_t i = 0; i < core_.size(); ++i) {
      if (core_[i] == 0) continue;
      const glm::ivec3 p = grid_.cell(i);
      const std::size_t line = plane.at({p[axes_.side], p[axes_.along], 0});
      back[line] = std::max(back[line], depth(p));
      outline[line] = 1;
    }
    const Cells inner = eroded(plane, outline, silhouette_mm);
    for (std::size_t i = 0; i < back.size(); ++i)
      if (inner[i] == 0) back[i] = std::numeric_limits<int>::max();
    return back;
  }

  /// A cell's place from the front to the back.
  int depth(const glm::ivec3& cell) const {
    return back_sign_ > 0 ? cell[axes_.back] : grid_.dims[axes_.back] - 1 - cell[axes_.back];
  }

  /// Joins to the core what belongs to the patient; collects supports and what is neither.
  void judge_parts() {
    Cells rest(grid_.count(), 0), keeps(grid_.count(), 0);
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = solid_[i] != 0 && core_[i] == 0 ? 1 : 0;
    for (const glm::dvec3& p_mm : options_.keep_mm) {
      const glm::ivec3 cell = glm::ivec3(glm::floor(scene_.lattice.voxel(p_mm) + 0.5)) / grid_.factor;
      if (grid_.holds(cell)) keeps[grid_.at(cell)] = 1;
    }
    const std::vector<float>& away = away_;
    const std::vector<int> back = backs();
    const Cells thick = eroded(grid_, solid_, thick_mm);
    body_ = core_;
    support_.assign(grid_.count(), 0);
    doubtful_.assign(grid_.count(), 0);
    for_each_part(grid_, rest, [&](const std::vector<std::size_t>& part) {
      const double near2 = options_.near_mm * options_.near_mm;
      const bool is_kept = std::any_of(part.begin(), part.end(), [&](auto i) { return keeps[i] != 0; });
      const bool reaches = std::any_of(part.begin(), part.end(),
                                       [&](auto i) { return static_cast<double>(away[i]) > near2; });
      const auto front = std::count_if(part.begin(), part.end(),
                                       [&](auto i) { return y_mm(grid_.cell(i)) < middle_y_mm_; });
      const bool is_ahead =
          static_cast<double>(front) > most_front_share * static_cast<double>(part.size()) &&
          std::any_of(part.begin(), part.end(), [&](auto i) { return thick[i] != 0; });
      for (const std::size_t i : part) {
        const glm::ivec3 p = grid_.cell(i);
        const int rear = back[grid_line(p)];
        const bool is_behind = rear >= 0 && depth(p) > rear;
        const bool is_far = static_cast<double>(away[i]) > near2;
        if (is_kept || !reaches)
          body_[i] = 1;
        else if (is_ahead)
          (is_far ? doubtful_ : body_)[i] = 1;
        else if (is_far || (is_behind && static_cast<double>(away[i]) > contact_mm * contact_mm))
          support_[i] = 1;
        else
          body_[i] = 1;
      }
    });
  }

  std::size_t grid_line(const glm::ivec3& p) const {
    return static_cast<std::size_t>(p[axes_.along]) * static_cast<std::size_t>(grid_.dims[axes_.side]) +
           static_cast<std::size_t>(p[axes_.side]);
  }

  /// The patient's cells with what they enclose and their blurred edge, and the edge of supports.
  void protect() {
    Cells closed = eroded(grid_, dilated(grid_, body_, close_mm), close_mm);
    for (std::size_t i = 0; i < closed.size(); ++i) closed[i] |= body_[i];
    fill_slices(grid_, closed, axes_.along);
    for (std::size_t i = 0; i < closed.size(); ++i) {
      if (closed[i] == 0) continue;
      support_[i] = 0;
      doubtful_[i] = 0;
    }
    inside_ = std::move(closed);
    edge_ = with_edge(grid_, inside_, options_.rim_mm);
    Cells others = support_;
    const glm::ivec3 dims = scene_.lattice.dims;
    std::size_t at = 0;
    for (int z = 0; z < dims.z; ++z)
      for (int y = 0; y < dims.y; ++y)
        for (int x = 0; x < dims.x; ++x, ++at)
          if (extrusion_.marks[at] != 0) others[grid_.at(glm::ivec3(x, y, z) / grid_.factor)] = 1;
    rim_ = with_edge(grid_, others, options_.rim_mm);
  }

  /// Calls `visit` with the cell and the up to 27 cells around each cell behind the middle.
  template <typename Visit>
  void for_each_box_behind(const Visit& visit) const {
    tbb::parallel_for(0, grid_.dims.z, [&](int z) {
      std::vector<std::size_t> box;
      for (int y = 0; y < grid_.dims.y; ++y)
        for (int x = 0; x < grid_.dims.x; ++x) {
          const glm::ivec3 p(x, y, z);
          const std::size_t cell = grid_.at(p);
          if (inside_[cell] != 0 || y_mm(p) < middle_y_mm_ - 2.0 * grid_.mm[axes_.back]) continue;
          box.clear();
          const glm::ivec3 low = glm::max(p - 1, 0), high = glm::min(p + 1, grid_.dims - 1);
          for (int k = low.z; k <= high.z; ++k)
            for (int j = low.y; j <= high.y; ++j)
              for (int i = low.x; i <= high.x; ++i) box.push_back(grid_.at({i, j, k}));
          visit(cell, box);
        }
    });
  }

  /// Cells whose surroundings are denser than air on average, and most of whose neighbours are such cells:
  /// foam and cloth, but not the blurred edge of skin.
  void find_foam() {
    foam_.assign(grid_.count(), 0);
    if (!seeks_foam_) return;
    Cells dense(grid_.count(), 0);
    for_each_box_behind([&](std::size_t cell, const std::vector<std::size_t>& box) {
      float sum = 0.0F;
      for (const std::size_t i : box) sum += std::min(mean_[i], static_cast<float>(options_.threshold));
      dense[cell] = static_cast<double>(sum) > (air_ + above_air) * static_cast<double>(box.size()) ? 1 : 0;
    });
    for_each_box_behind([&](std::size_t cell, const std::vector<std::size_t>& box) {
      std::size_t count = 0;
      for (const std::size_t i : box) count += dense[i];
      foam_[cell] = dense[cell] != 0 && 2 * count > box.size() ? 1 : 0;
    });
  }

  Belongs class_of(std::size_t at, std::size_t cell, bool is_front) const {
    const bool is_solid = samples_[at] >= options_.threshold;
    if (extrusion_.marks[at] != 0)
      return !is_front ? Belongs::Support : is_solid ? Belongs::Doubtful : Belongs::Air;
    if (inside_[cell] != 0) return Belongs::Patient;
    if (edge_[cell] != 0 && support_[cell] == 0)
      return static_cast<double>(samples_[at]) > air_ + above_air ? Belongs::Patient : Belongs::Air;
    if (is_front || doubtful_[cell] != 0) return is_solid ? Belongs::Doubtful : Belongs::Air;
    if (support_[cell] != 0 || rim_[cell] != 0 || is_solid) return Belongs::Support;
    return foam_[cell] != 0 ? Belongs::Support : Belongs::Air;
  }

  PatientParts classed() const {
    PatientParts parts;
    parts.of.resize(samples_.size());
    parts.middle_y_mm = middle_y_mm_;
    parts.table_slope = extrusion_.slope;
    const glm::ivec3 dims = scene_.lattice.dims;
    struct Counts {
      std::uint64_t front = 0, behind = 0, extruded = 0;
    };
    std::vector<Counts> counts(static_cast<std::size_t>(dims.z));
    tbb::parallel_for(0, dims.z, [&](int z) {
      Counts& count = counts[static_cast<std::size_t>(z)];
      for (int y = 0; y < dims.y; ++y)
        for (int x = 0; x < dims.x; ++x) {
          const glm::ivec3 p(x, y, z);
          const std::size_t at = sample_index(dims, p);
          const bool is_front = scene_.lattice.lps_mm(p).y < middle_y_mm_;
          parts.of[at] = class_of(at, grid_.at(p / grid_.factor), is_front);
          if (parts.of[at] != Belongs::Doubtful) continue;
          ++(is_front ? count.front : count.behind);
          count.extruded += is_front && extrusion_.marks[at] != 0;
        }
    });
    Counts sum;
    for (const Counts& count : counts) {
      sum.front += count.front;
      sum.behind += count.behind;
      sum.extruded += count.extruded;
    }
    const double mm3 = scene_.lattice.voxel_mm3();
    parts.front_mm3 = static_cast<double>(sum.front) * mm3;
    parts.behind_mm3 = static_cast<double>(sum.behind) * mm3;
    parts.extruded_front_mm3 = static_cast<double>(sum.extruded) * mm3;
    return parts;
  }

  const Scene& scene_;
  const Int16Samples& samples_;
  const PatientOptions& options_;
  PatientAxes axes_;
  Grid grid_;
  double air_ = -1000.0, middle_y_mm_ = 0.0;
  bool seeks_foam_ = false;
  int back_sign_ = 1;
  Extrusion extrusion_;
  std::vector<float> mean_, away_;  ///< of cells: mean sample; squared distance from the core
  Cells solid_, core_, body_, support_, doubtful_, inside_, edge_, rim_, foam_;
};

void check_options(const PatientOptions& options) {
  const auto is_length = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!std::isfinite(options.threshold) || !is_length(options.detach_mm) || !is_length(options.near_mm) ||
      !is_length(options.rim_mm) || !is_length(options.board_mm) || options.board_mm == 0.0)
    throw std::invalid_argument("a headrest's threshold must be finite, its lengths finite and not negative");
}

}  // namespace

PatientParts patient_parts(const Scene& scene, const PatientOptions& options) {
  check(scene);
  check_options(options);
  const auto* samples = std::get_if<Int16Samples>(&scene.samples);
  if (samples == nullptr)
    throw std::invalid_argument(scene.source +
                                ": a headrest can be removed from 16-bit integer samples only, and these are "
                                "floats");
  options.progress.at(0.0);
  return Parter(scene, *samples, options).run();
}

}  // namespace octotomy::voxel

// 1 Mark the parts that are extruded along the table.
// 2 Average the other samples over cells of about two millimetres, and find the patient's core: the largest
//   part into which a ball of detach_mm fits.
// 3 Judge every other part: parts near the patient belong to it; parts that hang behind the core are
//   supports.
// 4 Close the patient, and fill everything that it encloses in each slice and in space.
// 5 Class each sample by its cell, its mark and its position before or behind the coronal middle.
#include "voxel/filter/patient.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "voxel/filter/cells.h"
#include "voxel/filter/extrusion.h"
#include "voxel/filter/slice_work.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

constexpr double cell_mm = 2.0;
/// HU above air at which a cell's mean counts as material; the mean's noise is a fraction of this.
constexpr double above_air = 40.0;
/// Length of the stump that remains on the core where a part was cut off.
constexpr double contact_mm = 3.0;
constexpr double mask_mm = 4.0;  ///< largest thickness of a mask on the face
/// Distance inside the core's outline, seen from behind, at which there is no ear.
constexpr double silhouette_mm = 10.0;
constexpr double close_mm = 4.0;       ///< gaps in the skin up to twice this width are closed
constexpr double foam_limit = -200.0;  ///< HU; a threshold of at least this value lies above soft tissue
/// Least share of the largest part that the core contains; with less, the object is thin throughout.
constexpr double least_core_share = 0.3;
/// A thick part with a larger share in front of the middle is no support.
constexpr double most_front_share = 0.25;
constexpr double thick_mm = 4.0;  ///< a part is thick if it contains a ball of this radius
/// Least share of bone in a limb's samples; in an arm it is about a tenth.
constexpr double least_bone_share = 0.01;

class Parter {
 public:
  Parter(const Scene& scene, const Int16Samples& samples, const PatientOptions& options)
      : scene_(scene),
        samples_(samples),
        options_(options),
        axes_(patient_axes(scene.lattice)),
        grid_(scene.lattice, cell_mm) {
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

  /// Raised so that the patient's own surface always counts as near, although a ball of detach_mm does not
  /// reach it.
  double near_mm() const { return std::max(options_.near_mm, options_.detach_mm + 2.0 * cell_mm); }

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

  /// The part that contains the largest ball. The scan's sides and back count as surfaces of the part.
  std::vector<std::size_t> thickest(const Cells& set) const {
    std::vector<std::size_t> best;
    double most = -1.0;
    for (std::vector<std::size_t>& part : parts_of(grid_, set)) {
      double thick = 0.0;
      for (const std::size_t i : part) thick = std::max(thick, depth_mm(i));
      if (thick < most || (thick == most && part.size() <= best.size())) continue;
      most = thick;
      best = std::move(part);
    }
    return best;
  }

  /// The depth of a solid cell below the surface, in millimetres.
  double depth_mm(std::size_t i) const {
    double depth = std::sqrt(static_cast<double>(depth2_[i]));
    for (const int axis : {axes_.side, axes_.back}) {
      const glm::ivec3 p = grid_.cell(i);
      depth = std::min(depth, (std::min(p[axis], grid_.dims[axis] - 1 - p[axis]) + 1) * grid_.mm[axis]);
    }
    return depth;
  }

  void find_core() {
    const std::vector<std::vector<std::size_t>> parts = parts_of(grid_, solid_);
    const auto whole = std::max_element(parts.begin(), parts.end(),
                                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (whole == parts.end())
      throw Error(ErrorCode::Geometry, scene_.source + ": no sample beside the table is at or above " +
                                           std::to_string(options_.threshold) + ": choose another threshold");
    depth2_ = distances(grid_, solid_, true);
    const Cells inner = deeper(depth2_, options_.detach_mm);
    const std::vector<std::size_t> heart = thickest(inner);
    const Cells opened = dilated(grid_, cells_of(grid_, heart), options_.detach_mm);
    core_.assign(grid_.count(), 0);
    std::size_t count = 0;
    for (std::size_t i = 0; i < core_.size(); ++i) count += core_[i] = opened[i] & solid_[i];
    const bool is_thin = std::none_of(heart.begin(), heart.end(),
                                      [&](std::size_t i) { return depth_mm(i) > 0.5 * options_.board_mm; });
    if (is_thin && static_cast<double>(count) < least_core_share * static_cast<double>(whole->size()))
      core_ = cells_of(grid_, *whole);
    is_reached_ = reached();
    set_middle();
  }

  /// For each sample, whether solid samples connect it to the core by faces. Cells would not suffice, because
  /// they connect parts across gaps of less than two millimetres.
  std::vector<std::uint8_t> reached() const {
    const glm::ivec3 dims = scene_.lattice.dims;
    std::vector<std::uint8_t> seen(samples_.size(), 0);
    std::vector<glm::ivec3> stack;
    const auto reach = [&](const glm::ivec3& p) {
      const std::size_t at = sample_index(dims, p);
      if (seen[at] != 0 || !is_own_solid(at)) return;
      seen[at] = 1;
      stack.push_back(p);
    };
    for (std::size_t cell = 0; cell < core_.size(); ++cell)
      if (core_[cell] != 0) for_each_sample(cell, [&](const glm::ivec3& p, std::size_t) { reach(p); });
    while (!stack.empty()) {
      const glm::ivec3 p = stack.back();
      stack.pop_back();
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          glm::ivec3 q = p;
          q[axis] += step;
          if (q[axis] >= 0 && q[axis] < dims[axis]) reach(q);
        }
    }
    return seen;
  }

  /// Whether a sample is solid and not part of an extrusion.
  bool is_own_solid(std::size_t at) const {
    return extrusion_.marks[at] == 0 && samples_[at] >= options_.threshold;
  }

  template <typename Visit>
  void for_each_sample(std::size_t cell, const Visit& visit) const {
    const glm::ivec3 low = grid_.cell(cell) * grid_.factor;
    const glm::ivec3 high = glm::min(low + grid_.factor, scene_.lattice.dims);
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x)
          visit(glm::ivec3(x, y, z), sample_index(scene_.lattice.dims, {x, y, z}));
  }

  /// The share of a part's solid samples for which `counts` returns true.
  template <typename Counts>
  double share_of(const std::vector<std::size_t>& part, const Counts& counts) const {
    double all = 0.0, counted = 0.0;
    for (const std::size_t cell : part)
      for_each_sample(cell, [&](const glm::ivec3&, std::size_t at) {
        if (!is_own_solid(at)) return;
        all += 1.0;
        counted += counts(at);
      });
    return all > 0.0 ? counted / all : 0.0;
  }

  /// Whether a part may be a limb: thicker than a board, and with bone unless the scene's unit does not show
  /// bone.
  bool is_limb(const std::vector<std::size_t>& part) const {
    const bool is_thick = std::any_of(part.begin(), part.end(),
                                      [&](std::size_t i) { return depth_mm(i) > 0.5 * options_.board_mm; });
    return is_thick && (scene_.meaning != Meaning::Hounsfield || share_of(part, [&](std::size_t at) {
                                                                   return samples_[at] >= dense_hu;
                                                                 }) > least_bone_share);
  }

  /// Computes the coronal middle, half-way between the core's foremost cell and the rearmost cell of the core
  /// and of near parts that hang on the core, plus half a cell and half of a mask's thickness for safety.
  /// Parts that hang on the core in front may be a nose or a marker: without them the middle lies farther
  /// back, so less is removed.
  void set_middle() {
    Cells rest(grid_.count(), 0);
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = solid_[i] != 0 && core_[i] == 0 ? 1 : 0;
    away_ = distances(grid_, core_);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < core_.size(); ++i) {
      if (core_[i] == 0) continue;
      low = std::min(low, y_mm(grid_.cell(i)));
      high = std::max(high, y_mm(grid_.cell(i)));
    }
    const double touch2 = glm::dot(grid_.mm, grid_.mm), near2 = near_mm() * near_mm();
    for (const std::vector<std::size_t>& part : parts_of(grid_, rest)) {
      const auto is_within = [&](double limit) {
        return [this, limit](std::size_t i) { return static_cast<double>(away_[i]) <= limit; };
      };
      if (std::any_of(part.begin(), part.end(), is_within(touch2)) &&
          std::all_of(part.begin(), part.end(), is_within(near2)))
        for (const std::size_t i : part) high = std::max(high, y_mm(grid_.cell(i)));
    }
    middle_y_mm_ = 0.5 * (low + high) + 0.5 * (grid_.mm[axes_.back] + mask_mm);
  }

  /// For each line from front to back, the core's rearmost cell on the line if it lies well within the core's
  /// outline. For other lines, the rearmost cell of all lines within near_mm along the table, so that ears
  /// lie in front of it.
  std::vector<int> backs() const {
    const int sides = grid_.dims[axes_.side], slices = grid_.dims[axes_.along];
    CellGrid plane = grid_;
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
    const int reach = static_cast<int>(std::ceil(near_mm() / plane.mm.y));
    std::vector<int> rearmost(static_cast<std::size_t>(slices), -1);
    for (std::size_t line = 0; line < back.size(); ++line) {
      const int slice = plane.cell(line).y;
      for (int k = std::max(0, slice - reach); k <= std::min(slices - 1, slice + reach); ++k)
        rearmost[static_cast<std::size_t>(k)] = std::max(rearmost[static_cast<std::size_t>(k)], back[line]);
    }
    for (std::size_t line = 0; line < back.size(); ++line)
      if (inner[line] == 0) back[line] = rearmost[static_cast<std::size_t>(plane.cell(line).y)];
    return back;
  }

  /// A cell's index from the front to the back.
  int depth(const glm::ivec3& cell) const {
    return back_sign_ > 0 ? cell[axes_.back] : grid_.dims[axes_.back] - 1 - cell[axes_.back];
  }

  /// Joins the patient's other parts to the core; collects supports and doubtful parts.
  void judge_parts() {
    Cells rest(grid_.count(), 0), keeps(grid_.count(), 0);
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = solid_[i] != 0 && core_[i] == 0 ? 1 : 0;
    for (const glm::dvec3& p_mm : options_.keep_mm) {
      const glm::ivec3 cell = glm::ivec3(glm::floor(scene_.lattice.voxel(p_mm) + 0.5)) / grid_.factor;
      if (grid_.holds(cell)) keeps[grid_.at(cell)] = 1;
    }
    const std::vector<float>& away = away_;
    const std::vector<int> back = backs();
    const Cells thick = deeper(depth2_, thick_mm);
    body_ = core_;
    support_.assign(grid_.count(), 0);
    doubtful_.assign(grid_.count(), 0);
    for (const std::vector<std::size_t>& part : parts_of(grid_, rest)) {
      const double near2 = near_mm() * near_mm();
      const bool is_kept = std::any_of(part.begin(), part.end(), [&](auto i) { return keeps[i] != 0; });
      const bool reaches =
          std::any_of(part.begin(), part.end(), [&](auto i) { return static_cast<double>(away[i]) > near2; });
      const bool hangs = reaches && share_of(part, [&](std::size_t at) { return is_reached_[at]; }) > 0.5;
      const auto front =
          std::count_if(part.begin(), part.end(), [&](auto i) { return y_mm(grid_.cell(i)) < middle_y_mm_; });
      const bool is_ahead =
          static_cast<double>(front) > most_front_share * static_cast<double>(part.size()) &&
          std::any_of(part.begin(), part.end(), [&](auto i) { return thick[i] != 0; });
      const bool is_doubtful = reaches && !is_kept && is_limb(part);
      for (const std::size_t i : part) {
        const glm::ivec3 p = grid_.cell(i);
        const int rear = back[grid_line(p)];
        const bool is_behind = rear >= 0 && depth(p) > rear;
        const bool is_far = static_cast<double>(away[i]) > near2;
        if (is_kept || !reaches)
          body_[i] = 1;
        else if (is_ahead || is_doubtful)
          (is_far ? doubtful_ : body_)[i] = 1;
        else if (is_far || !hangs || (is_behind && static_cast<double>(away[i]) > contact_mm * contact_mm))
          support_[i] = 1;
        else
          body_[i] = 1;
      }
    }
  }

  std::size_t grid_line(const glm::ivec3& p) const {
    return static_cast<std::size_t>(p[axes_.along]) * static_cast<std::size_t>(grid_.dims[axes_.side]) +
           static_cast<std::size_t>(p[axes_.side]);
  }

  /// Computes the patient's cells, including all cells that they enclose and their blurred edge, and the edge
  /// of supports.
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
    // The blurred edge of a doubtful part also counts as doubtful.
    Cells beside = with_edge(grid_, doubtful_, options_.rim_mm);
    for (std::size_t i = 0; i < beside.size(); ++i) beside[i] &= support_[i] ^ 1;
    doubtful_ = std::move(beside);
    Cells others = support_;
    const glm::ivec3 dims = scene_.lattice.dims;
    std::size_t at = 0;
    for (int z = 0; z < dims.z; ++z)
      for (int y = 0; y < dims.y; ++y)
        for (int x = 0; x < dims.x; ++x, ++at)
          if (extrusion_.marks[at] != 0) others[grid_.at(glm::ivec3(x, y, z) / grid_.factor)] = 1;
    rim_ = with_edge(grid_, others, options_.rim_mm);
  }

  /// For each cell behind the middle, calls `visit` with the cell and the up to 27 cells of the box around
  /// it.
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

  /// Finds foam and cloth: cells whose surroundings are denser than air on average, and most of whose
  /// neighbours are also such cells. The second condition excludes the blurred edge of skin.
  void find_foam() {
    foam_.assign(grid_.count(), 0);
    if (!seeks_foam_) return;
    Cells dense(grid_.count(), 0);
    // Cells of the patient's blurred edge are left out, because they would turn the air beside them into
    // foam.
    for_each_box_behind([&](std::size_t cell, const std::vector<std::size_t>& box) {
      double sum = 0.0, count = 0.0;
      for (const std::size_t i : box) {
        if (edge_[i] != 0) continue;
        sum += std::min(static_cast<double>(mean_[i]), options_.threshold);
        count += 1.0;
      }
      dense[cell] = count > 0.0 && sum > (air_ + above_air) * count ? 1 : 0;
    });
    for_each_box_behind([&](std::size_t cell, const std::vector<std::size_t>& box) {
      std::size_t count = 0, all = 0;
      for (const std::size_t i : box) {
        if (edge_[i] != 0) continue;
        count += dense[i];
        ++all;
      }
      foam_[cell] = dense[cell] != 0 && 2 * count > all ? 1 : 0;
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
  CellGrid grid_;
  double air_ = -1000.0, middle_y_mm_ = 0.0;
  bool seeks_foam_ = false;
  int back_sign_ = 1;
  Extrusion extrusion_;
  /// For each cell: the mean sample; the squared distance in mm^2 to the core; for solid cells, the squared
  /// distance to the nearest cell that is not solid.
  std::vector<float> mean_, away_, depth2_;
  std::vector<std::uint8_t> is_reached_;
  Cells solid_, core_, body_, support_, doubtful_, inside_, edge_, rim_, foam_;
};

void check_options(const PatientOptions& options) {
  const auto is_length = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!std::isfinite(options.threshold) || !is_length(options.detach_mm) || !is_length(options.near_mm) ||
      !is_length(options.rim_mm) || !is_length(options.board_mm) || options.board_mm == 0.0)
    throw InvalidInput(
        "to remove a headrest, the threshold must be finite, and the lengths finite and not negative");
}

}  // namespace

PatientParts patient_parts(const Scene& scene, const PatientOptions& options) {
  check(scene);
  check_options(options);
  const auto* samples = std::get_if<Int16Samples>(&scene.samples);
  if (samples == nullptr)
    throw InvalidInput(scene.source +
                       ": a headrest can be removed from 16-bit integer samples only, and these are "
                       "floats");
  options.progress.at(0.0);
  return Parter(scene, *samples, options).run();
}

}  // namespace octotomy::voxel

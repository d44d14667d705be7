// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Fits a lattice to a stack of slices:
//   1  choose the step from the distances of neighbours
//   2  fit even distances to positions that are rounded or noisy
//   3  distinguish holes from a protocol's second slice distance
//   4  find the source slices of every slice of the lattice
//   5  fit the stack's sideways lean, report slices that deviate from it, widen the lattice by it
#include "voxel/scan/slice_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"

namespace octotomy::voxel {

namespace {

/// A shift of d pixels changes a sample at an edge by d times the edge's height. A tenth of a pixel changes
/// samples less than the partial volume effect of any slice, and is far above the rounding of positions.
constexpr double aside_tolerance_px() {
  return 0.1;
}

/// If positions err by up to a tenth of the slices' distance, the error from treating the slices as evenly
/// spaced is smaller than the blur of linear interpolation, which mixes up to half of the neighbouring slice
/// in.
constexpr double noise_share() {
  return 0.1;
}

/// A sideways shift of up to half a pixel counts as noise of the positions; a larger one as a displacement of
/// the slice.
constexpr double most_noise_px() {
  return 0.5;
}

/// The decimal step, 1 mm or finer, to which one coordinate of all positions is rounded; 0 if the step is
/// finer than a micrometre or the coordinate is equal in all slices.
double rounding_step_mm(const std::vector<DicomSlice>& slices, int axis) {
  const bool changes = std::any_of(slices.begin(), slices.end(), [&](const DicomSlice& slice) {
    return slice.first_mm[axis] != slices.front().first_mm[axis];
  });
  for (const double step_mm : {1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001})
    if (changes && std::all_of(slices.begin(), slices.end(), [&](const DicomSlice& slice) {
          const double steps = slice.first_mm[axis] / step_mm;
          return std::abs(steps - std::round(steps)) * step_mm < 1e-6;
        }))
      return step_mm;
  return 0.0;
}

bool are_equal(double gap_mm, double other_mm) {
  return std::abs(gap_mm - other_mm) <= 2.0 * position_tolerance_mm(std::min(gap_mm, other_mm));
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Layer {
 public:
  Layer(const DicomStack& stack, std::filesystem::path path, std::vector<Finding>& audit)
      : stack_(stack), path_(std::move(path)), audit_(audit) {}

  SlicePlan run() {
    plan_.size_px = stack_.first().size_px;
    plan_.slice_count = stack_.slices.size();
    if (stack_.slices.size() == 1) {
      lay_one();
      return std::move(plan_);
    }
    for (const DicomSlice& slice : stack_.slices) heights_mm_.push_back(stack_.height_mm(slice));
    for (std::size_t i = 1; i < heights_mm_.size(); ++i)
      gaps_mm_.push_back(heights_mm_[i] - heights_mm_[i - 1]);
    for (int axis = 0; axis < 3; ++axis) rounding_mm_[axis] = rounding_step_mm(stack_.slices, axis);
    choose_step();
    even_out();
    find_holes();
    if (even_) {
      take_even_sources();
      report_even();
    } else {
      find_sources();
      report_spacing();
    }
    report_holes();
    lay_across();
    return std::move(plan_);
  }

 private:
  void find(const char* check, Verdict verdict, std::string detail, std::vector<std::string> files = {}) {
    audit_.push_back({check, verdict, std::move(detail), std::move(files)});
  }

  void lay_one() {
    plan_.sources.push_back({});
    plan_.step_mm = stack_.first().thickness_mm.value_or(0.0);
    const bool is_known = plan_.step_mm > 0.0;
    if (!is_known) plan_.step_mm = 1.0;
    find("slice_spacing", Verdict::Warn,
         print("a single slice; its thickness of %g mm is %s", plan_.step_mm,
               is_known ? "the header's" : "assumed, because the header states none"));
  }

  double total_mm() const { return heights_mm_.back(); }
  double least_mm() const { return *std::min_element(gaps_mm_.begin(), gaps_mm_.end()); }
  double most_mm() const { return *std::max_element(gaps_mm_.begin(), gaps_mm_.end()); }

  void choose_step() {
    // Chooses the least distance that occurs often enough, so that a single slice squeezed between two others
    // does not determine the step.
    std::vector<double> sorted = gaps_mm_;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t needed = (gaps_mm_.size() + 4) / 5;
    double usual_mm = sorted.front();
    for (std::size_t i = 0; i + needed <= sorted.size(); ++i)
      if (are_equal(sorted[i], sorted[i + needed - 1])) {
        usual_mm = sorted[i];
        break;
      }
    // The mean of all gaps near this distance is accurate enough to count the slices of a long stack.
    double sum = 0.0;
    int count = 0;
    for (const double gap : gaps_mm_)
      if (gap > 0.75 * usual_mm && gap < 1.5 * usual_mm) {
        sum += gap;
        ++count;
      }
    const double steps = std::round(total_mm() / (sum / count));
    if (steps > 4.0 * static_cast<double>(stack_.slices.size()))
      refuse(path_,
             print("the slices are too scattered for a volume: gaps from %.3g to %.3g mm between %zu slices; "
                   "select the slices of one scan by --series or by --slices FROM:TO",
                   least_mm(), most_mm(), stack_.slices.size()));
    step_count_ = static_cast<std::size_t>(std::max(1.0, steps));
    plan_.step_mm = total_mm() / static_cast<double>(step_count_);
  }

  /// Evenly spaced heights, and for each slice the number of its height: low_mm + number * step_mm.
  struct Even {
    std::vector<long> numbers;
    double low_mm = 0.0, step_mm = 0.0, worst_mm = 0.0;

    double height_mm(std::size_t i) const { return low_mm + step_mm * static_cast<double>(numbers[i]); }
  };

  /// The evenly spaced heights that fit the slices with these numbers best, by least squares.
  Even fitted(std::vector<long> numbers) const {
    const auto count = static_cast<double>(numbers.size());
    double mean_number = 0.0, mean_mm = 0.0, square = 0.0, product = 0.0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      mean_number += static_cast<double>(numbers[i]) / count;
      mean_mm += heights_mm_[i] / count;
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const double number = static_cast<double>(numbers[i]) - mean_number;
      square += number * number;
      product += number * (heights_mm_[i] - mean_mm);
    }
    Even even{std::move(numbers), 0.0, product / square, 0.0};
    even.low_mm = mean_mm - even.step_mm * mean_number;
    for (std::size_t i = 0; i < even.numbers.size(); ++i)
      even.worst_mm = std::max(even.worst_mm, std::abs(heights_mm_[i] - even.height_mm(i)));
    return even;
  }

  /// The largest rounding error of a height, computed from the decimals of the positions.
  double height_rounding_mm() const { return 0.5 * glm::dot(rounding_mm_, glm::abs(stack_.normal)); }

  /// Whether the images' numbers are consecutive, so that no image is missing between them.
  bool numbers_run_on() const {
    const int step = stack_.slices[1].instance_number - stack_.slices[0].instance_number;
    for (std::size_t i = 1; i < stack_.slices.size(); ++i)
      if (stack_.slices[i].instance_number - stack_.slices[i - 1].instance_number != step) return false;
    return std::abs(step) == 1;
  }

  /// Whether rounding or noise of the positions explains the deviations from evenly spaced heights. Rounding
  /// by more than a quarter of a step resembles missing slices. In that case the images' numbers must also be
  /// consecutive, and long gaps must be as frequent as rounding produces them.
  bool is_explained(const Even& even) const {
    if (!(even.step_mm > 0.0)) return false;
    if (even.worst_mm <= noise_share() * even.step_mm) return true;
    // Heights fitted by least squares may deviate by slightly more than half a step of rounding.
    if (even.worst_mm > 1.1 * height_rounding_mm()) return false;
    const double tag_mm = std::abs(stack_.first().spacing_tag_mm.value_or(0.0));
    const bool tag_agrees = tag_mm == 0.0 || std::abs(tag_mm - even.step_mm) <= 0.05 * even.step_mm;
    const auto long_gaps = std::count_if(gaps_mm_.begin(), gaps_mm_.end(),
                                         [&](double gap) { return gap > 1.5 * plan_.step_mm; });
    return even.worst_mm <= 0.25 * even.step_mm || (numbers_run_on() && tag_agrees && long_gaps > 2);
  }

  /// Uses evenly spaced heights if the slices deviate from them only by errors of the stated positions.
  void even_out() {
    const double tolerance_mm = position_tolerance_mm(plan_.step_mm);
    std::vector<long> counted(heights_mm_.size(), 0), spaced(heights_mm_.size(), 0);
    bool is_on_lattice = true;
    for (std::size_t i = 0; i < heights_mm_.size(); ++i) {
      counted[i] = static_cast<long>(i);
      if (i > 0) spaced[i] = spaced[i - 1] + std::max(1L, std::lround(gaps_mm_[i - 1] / plan_.step_mm));
      const double steps = heights_mm_[i] / plan_.step_mm;
      is_on_lattice = is_on_lattice && std::abs(steps - std::round(steps)) * plan_.step_mm <= tolerance_mm;
    }
    const Even even = fitted(std::move(counted));
    if (is_on_lattice && std::abs(even.step_mm - plan_.step_mm) < 0.01 * plan_.step_mm) return;
    if (is_explained(even) && (!is_on_lattice || height_rounding_mm() > tolerance_mm)) {
      even_ = even;
    } else if (!is_on_lattice) {
      const Even with_gaps = fitted(std::move(spaced));
      if (is_explained(with_gaps) && with_gaps.worst_mm <= 0.25 * with_gaps.step_mm) even_ = with_gaps;
    }
    if (!even_) return;
    plan_.step_mm = even_->step_mm;
    plan_.low_mm = even_->low_mm;
  }

  /// Each evenly spaced height is that of a slice of the stack or lies between two slices.
  void take_even_sources() {
    for (std::size_t i = 0; i < even_->numbers.size(); ++i) {
      if (i > 0) {
        const long gap = even_->numbers[i] - even_->numbers[i - 1];
        for (long k = 1; k < gap; ++k)
          plan_.sources.push_back({i - 1, i, static_cast<double>(k) / static_cast<double>(gap)});
      }
      plan_.sources.push_back({i, i, 0.0});
    }
  }

  void report_even() {
    std::vector<std::string> off;
    for (std::size_t i = 0; i < heights_mm_.size(); ++i)
      if (std::abs(heights_mm_[i] - even_->height_mm(i)) > position_tolerance_mm(plan_.step_mm))
        off.push_back(stack_.slices[i].name);
    const double rounding_mm = height_rounding_mm();
    const bool is_rounding = even_->worst_mm <= 1.1 * rounding_mm;
    const bool is_small = even_->worst_mm <= noise_share() * even_->step_mm;
    find(
        "slice_spacing", is_rounding && is_small && hole_gaps_.empty() ? Verdict::Pass : Verdict::Warn,
        print("%zu slices %.6g mm apart; their positions%s lie up to %.3g mm away from that, which is less "
              "than the blur of interpolation: every slice is copied",
              plan_.sources.size(), plan_.step_mm,
              is_rounding ? print(", rounded to %.3g mm,", 2.0 * rounding_mm).c_str() : "", even_->worst_mm) +
            (hole_gaps_.empty() ? "" : ", except at the gaps that missing_slices lists") +
            (is_rounding && is_small ? "" : ": " + listed(off)),
        is_rounding && is_small ? std::vector<std::string>() : off);
  }

  /// Whether two gaps have the same length within the accuracy of the positions.
  bool are_alike(std::size_t a, std::size_t b) const {
    if (!even_) return are_equal(gaps_mm_[a], gaps_mm_[b]);
    return even_->numbers[a + 1] - even_->numbers[a] == even_->numbers[b + 1] - even_->numbers[b];
  }

  /// Whether a gap is one of at least three equal gaps in a row.
  bool is_in_run(std::size_t gap) const {
    std::size_t first = gap, last = gap;
    while (first > 0 && are_alike(first - 1, gap)) --first;
    while (last + 1 < gaps_mm_.size() && are_alike(last + 1, gap)) ++last;
    return last - first >= 2;
  }

  bool is_long(std::size_t gap) const {
    return even_ ? even_->numbers[gap + 1] - even_->numbers[gap] > 1 : gaps_mm_[gap] > 1.5 * plan_.step_mm;
  }

  /// Whether the images' numbers skip as many images as fit into the gap.
  bool skips_numbers(std::size_t gap) const {
    const int skipped = std::abs(stack_.slices[gap + 1].instance_number - stack_.slices[gap].instance_number);
    return skipped > 1 && std::lround(gaps_mm_[gap] / plan_.step_mm) == skipped;
  }

  void find_holes() {
    for (std::size_t i = 0; i < gaps_mm_.size(); ++i)
      if (is_long(i) && (!is_in_run(i) || skips_numbers(i))) hole_gaps_.push_back(i);
    const double origin_mm = glm::dot(stack_.first().first_mm, stack_.normal);
    for (const std::size_t gap : hole_gaps_)
      plan_.holes.push_back({stack_.normal, origin_mm + heights_mm_[gap], origin_mm + heights_mm_[gap + 1]});
  }

  void find_sources() {
    const std::size_t count = heights_mm_.size();
    const double tolerance_mm = position_tolerance_mm(plan_.step_mm);
    std::size_t below = 0;
    for (std::size_t k = 0; k <= step_count_; ++k) {
      const double height_mm = static_cast<double>(k) * plan_.step_mm;
      while (below + 2 < count && heights_mm_[below + 1] <= height_mm) ++below;
      const double above_mm = height_mm - heights_mm_[below];
      if (above_mm <= tolerance_mm) {
        plan_.sources.push_back({below, below, 0.0});
      } else if (gaps_mm_[below] - above_mm <= tolerance_mm) {
        plan_.sources.push_back({below + 1, below + 1, 0.0});
      } else {
        plan_.sources.push_back({below, below + 1, above_mm / gaps_mm_[below]});
      }
    }
  }

  /// "13 of 4.002 mm, 1 of 1.081 mm, 13 of 6.999 mm", in order along the normal.
  std::string runs() const {
    std::string text;
    std::size_t shown = 0;
    for (std::size_t i = 0; i < gaps_mm_.size();) {
      std::size_t end = i + 1;
      while (end < gaps_mm_.size() && are_equal(gaps_mm_[end], gaps_mm_[i])) ++end;
      if (++shown <= 8) text += (text.empty() ? "" : ", ") + print("%zu of %.4g mm", end - i, gaps_mm_[i]);
      i = end;
    }
    return shown > 8 ? text + " and " + std::to_string(shown - 8) + " more" : text;
  }

  void report_spacing() {
    std::vector<bool> used(stack_.slices.size(), false);
    for (const SlicePlan::Source& source : plan_.sources)
      if (source.below == source.above) used[source.below] = true;
    std::vector<std::string> off;
    for (std::size_t i = 0; i < used.size(); ++i)
      if (!used[i]) off.push_back(stack_.slices[i].name);
    const bool has_two_distances = std::any_of(gaps_mm_.begin(), gaps_mm_.end(),
                                               [&](double gap) { return gap > 1.5 * plan_.step_mm; }) &&
                                   hole_gaps_.empty();
    if (!off.empty() || has_two_distances)
      find("slice_spacing", Verdict::Warn,
           print("uneven: gaps from %.4g to %.4g mm (", least_mm(), most_mm()) + runs() + "); " +
               print("%zu slices resampled to %zu, %.6g mm apart, by linear interpolation",
                     heights_mm_.size(), plan_.sources.size(), plan_.step_mm) +
               (off.empty() ? "" : "; off the lattice: " + listed(off)),
           off);
    else if (!hole_gaps_.empty())
      find("slice_spacing", Verdict::Warn,
           print("%.6g mm apart except at the gaps that missing_slices lists", plan_.step_mm));
    else
      find("slice_spacing", Verdict::Pass,
           print("%zu slices %.6g mm apart", plan_.sources.size(), plan_.step_mm));
  }

  void report_holes() {
    if (hole_gaps_.empty()) return find("missing_slices", Verdict::Pass, "none");
    std::size_t missing = 0;
    double longest_mm = 0.0;
    std::string list;
    std::vector<std::string> names;
    for (const std::size_t gap : hole_gaps_) {
      const auto count =
          static_cast<std::size_t>(std::max(1L, std::lround(gaps_mm_[gap] / plan_.step_mm) - 1));
      missing += count;
      longest_mm = std::max(longest_mm, gaps_mm_[gap] - plan_.step_mm);
      const DicomSlice& below = stack_.slices[gap];
      const DicomSlice& above = stack_.slices[gap + 1];
      list += (list.empty() ? "" : "; ") +
              print("%zu in the gap of %.4g mm after slice %zu, between ", count, gaps_mm_[gap], gap + 1) +
              below.name + " and " + above.name;
      for (const DicomSlice* slice : {&below, &above})
        if (names.empty() || names.back() != slice->name) names.push_back(slice->name);
    }
    const bool is_grave = longest_mm > longest_unmeasured_mm();
    find("missing_slices", is_grave ? Verdict::Fail : Verdict::Warn,
         print("%zu of %zu slices are missing and linearly interpolated; up to %.4g mm were not measured (%s "
               "%g mm is a failure): ",
               missing, stack_.slices.size() + missing, longest_mm, is_grave ? "more than" : "above",
               longest_unmeasured_mm()) +
             list,
         names);
  }

  /// The sideways shift in pixels per millimetre of height: the median over pairs of slices half a stack
  /// apart (after Theil and Sen). A single displaced slice or noise of the positions hardly changes it.
  glm::dvec2 lean_px_per_mm() const {
    const std::size_t count = stack_.slices.size(), half = count / 2;
    glm::dvec2 lean;
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<double> slopes;
      for (std::size_t i = half; i < count; ++i)
        slopes.push_back(
            (stack_.aside_px(stack_.slices[i])[axis] - stack_.aside_px(stack_.slices[i - half])[axis]) /
            (heights_mm_[i] - heights_mm_[i - half]));
      lean[axis] = median_of(slopes);
    }
    return lean;
  }

  /// The median of the points along each axis.
  static glm::dvec2 medians_of(const std::vector<glm::dvec2>& points) {
    glm::dvec2 medians;
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<double> values;
      values.reserve(points.size());
      for (const glm::dvec2& point : points) values.push_back(point[axis]);
      medians[axis] = median_of(values);
    }
    return medians;
  }

  /// A line through the stack, and the sideways distances of the slices from it.
  struct Line {
    glm::dvec2 lean_px_per_mm{0.0}, start_px{0.0}, scatter_px{0.0};
    std::vector<glm::dvec2> off_px;
  };
  Line line_along(const glm::dvec2& lean) const {
    Line line;
    line.lean_px_per_mm = lean;
    for (std::size_t i = 0; i < stack_.slices.size(); ++i)
      line.off_px.push_back(stack_.aside_px(stack_.slices[i]) - lean * heights_mm_[i]);
    line.start_px = medians_of(line.off_px);
    std::vector<glm::dvec2> sizes;
    for (glm::dvec2& off : line.off_px) sizes.push_back(glm::abs(off -= line.start_px));
    // Estimates the standard deviation of normally distributed noise from the median.
    line.scatter_px = 1.48 * medians_of(sizes);
    return line;
  }

  /// The line through the stack. It leans only if the lean is larger than scatter of the positions can
  /// produce. The shift over the whole stack is computed from half as many pairs as slices, so its error is
  /// about 5 / sqrt(slices) times the scatter. Six times this error is allowed, because the scatter of a
  /// dozen slices is known only to a factor of two.
  Line line() const {
    Line leaning = line_along(lean_px_per_mm());
    const glm::dvec2 scatter_px = leaning.scatter_px;
    const glm::dvec2 shift_px = glm::abs(leaning.lean_px_per_mm) * total_mm();
    const double feigned = 30.0 / std::sqrt(static_cast<double>(stack_.slices.size()));
    const bool is_lean = (shift_px.x > aside_tolerance_px() && shift_px.x > feigned * scatter_px.x) ||
                         (shift_px.y > aside_tolerance_px() && shift_px.y > feigned * scatter_px.y);
    return is_lean ? leaning : line_along(glm::dvec2(0.0));
  }

  static double size_of(const glm::dvec2& off) { return std::max(std::abs(off.x), std::abs(off.y)); }

  /// Reports the slices that deviate from the line and sets the sideways positions of all slices. Slices
  /// within the noise are put on the line.
  void place_aside(const Line& line, bool is_tilted) {
    std::vector<std::string> names;
    double most_px = 0.0, most_mm = 0.0;
    for (std::size_t i = 0; i < line.off_px.size(); ++i) {
      if (size_of(line.off_px[i]) <= aside_tolerance_px()) continue;
      most_px = std::max(most_px, size_of(line.off_px[i]));
      most_mm = std::max(most_mm, glm::length(line.off_px[i] * stack_.first().spacing_mm));
      names.push_back(stack_.slices[i].name);
    }
    // A single displaced slice is reported. Small displacements of many slices count as noise of the
    // positions.
    const bool is_common =
        5 * names.size() >= line.off_px.size() || most_px <= 5.0 * size_of(line.scatter_px);
    const bool is_noise = !names.empty() && most_px <= most_noise_px() && is_common;
    const bool is_line = is_noise || !is_tilted;
    if (!is_tilted && !names.empty()) plan_.origin_px = line.start_px;
    for (std::size_t i = 0; i < line.off_px.size(); ++i) {
      const bool is_in_line = is_noise || size_of(line.off_px[i]) <= aside_tolerance_px();
      const glm::dvec2 in_line =
          is_tilted ? line.start_px + line.lean_px_per_mm * heights_mm_[i] : glm::dvec2(0.0);
      const glm::dvec2 own = stack_.aside_px(stack_.slices[i]) - plan_.origin_px;
      plan_.aside_px.push_back(is_in_line && is_line ? in_line : own);
    }
    plan_.leans = is_tilted || (!is_noise && !names.empty());
    if (!plan_.leans) plan_.aside_px.clear();
    if (is_noise)
      find("sideways", Verdict::Warn,
           slices(names.size()) +
               print(" scatter up to %.3g mm (%.2g pixels) to the side, as noisy or rounded positions do: "
                     "these slices are put in line: ",
                     most_mm, most_px) +
               listed(names),
           names);
    else if (!names.empty())
      find("sideways", Verdict::Warn,
           slices(names.size()) +
               print(" up to %.3g mm to the side of the others, moved back by linear "
                     "interpolation: ",
                     most_mm) +
               listed(names),
           names);
  }

  void refuse_far_aside() const {
    for (std::size_t i = 1; i < stack_.slices.size(); ++i) {
      const DicomSlice& slice = stack_.slices[i];
      const double aside_mm = glm::length((stack_.aside_px(slice) - stack_.aside_px(stack_.slices[i - 1])) *
                                          stack_.first().spacing_mm);
      // Positions of slices that nearly touch may have more noise than the distance between the slices.
      if (aside_mm > std::max(gaps_mm_[i - 1], most_noise_px() * stack_.first().spacing_mm.x))
        refuse(slice.path,
               print("lies %.4g mm to the side of the slice before it, more than any gantry tilt explains; "
                     "move it to a folder of its own, or leave it out by --slices FROM:TO",
                     aside_mm));
    }
  }

  /// Sets the lattice's extent within the slices' planes, wider than a slice if the stack leans.
  void lay_across() {
    refuse_far_aside();
    const Line line = this->line();
    const glm::dvec2 lean_px = glm::abs(line.lean_px_per_mm) * total_mm();
    const bool is_tilted = size_of(lean_px) > aside_tolerance_px();
    place_aside(line, is_tilted);
    glm::dvec2 low_px(0.0);
    glm::dvec2 high_px(0.0);
    for (const glm::dvec2& aside_px : plan_.aside_px) {
      low_px = glm::min(low_px, aside_px);
      high_px = glm::max(high_px, aside_px);
    }
    const double lean_mm = glm::length(line.lean_px_per_mm * stack_.first().spacing_mm) * total_mm();
    const double tilt_deg = std::atan2(lean_mm, total_mm()) * 180.0 / std::numbers::pi;
    const double tag_deg = std::abs(stack_.first().tilt_deg.value_or(0.0));
    const glm::dvec2 spread_px = high_px - low_px;
    constexpr double widest_px = 1 << 15;
    if (!(std::max(spread_px.x, spread_px.y) <= widest_px))
      refuse(path_, print("its slices are displaced sideways by %.4g pixels in total; check their positions "
                          "and the pixels' spacing",
                          std::max(spread_px.x, spread_px.y)));
    if (plan_.leans) {
      plan_.low_px = glm::ivec2(glm::floor(low_px + aside_tolerance_px()));
      const glm::ivec2 high = glm::ivec2(glm::ceil(high_px - aside_tolerance_px()));
      plan_.size_px += high - plan_.low_px;
    }
    if (is_tilted)
      find("gantry_tilt", Verdict::Warn,
           print("slices lean by %.2f degrees (%.4g mm over the stack); straightened by linear interpolation "
                 "within slices, widened from %d x %d to %d x %d pixels and filled with the padding or the "
                 "lowest value",
                 tilt_deg, lean_mm, stack_.first().size_px.x, stack_.first().size_px.y, plan_.size_px.x,
                 plan_.size_px.y));
    else if (tag_deg > 0.5)  // files state the tag to half a degree or better
      find("gantry_tilt", Verdict::Warn,
           print("the header names a tilt of %.3g degrees, but by their positions the slices lie straight "
                 "above each other: the tilt is ignored",
                 tag_deg));
    else
      find("gantry_tilt", Verdict::Pass, "slices lie straight above each other");
  }

  const DicomStack& stack_;
  std::filesystem::path path_;
  std::vector<Finding>& audit_;
  SlicePlan plan_;
  std::vector<double> heights_mm_;  ///< heights of the slices along the normal, from the first slice
  std::vector<double> gaps_mm_;     ///< gap i lies between slices i and i + 1
  std::vector<std::size_t> hole_gaps_;
  std::size_t step_count_ = 0;
  glm::dvec3 rounding_mm_{0.0};  ///< decimal step of the positions' coordinates
  std::optional<Even> even_;     ///< if set, the slices are treated as evenly spaced at these heights
};

}  // namespace

bool SlicePlan::is_copy() const {
  if (leans || sources.size() != slice_count) return false;
  for (std::size_t k = 0; k < sources.size(); ++k)
    if (sources[k].below != k || sources[k].above != k) return false;
  return true;
}

Lattice lattice_of(const DicomStack& stack, const SlicePlan& plan) {
  const glm::dvec3 row_mm = stack.along_row * stack.first().spacing_mm.x;
  const glm::dvec3 column_mm = stack.along_column * stack.first().spacing_mm.y;
  const glm::dvec2 low_px = glm::dvec2(plan.low_px) + plan.origin_px;
  const glm::dvec3 first_mm =
      stack.first().first_mm + row_mm * low_px.x + column_mm * low_px.y + stack.normal * plan.low_mm;
  return {{plan.size_px, static_cast<int>(plan.sources.size())},
          glm::dmat4(glm::dvec4(row_mm, 0.0), glm::dvec4(column_mm, 0.0),
                     glm::dvec4(stack.normal * plan.step_mm, 0.0), glm::dvec4(first_mm, 1.0))};
}

SlicePlan slice_plan(const DicomStack& stack, const std::filesystem::path& path,
                     std::vector<Finding>& audit) {
  return Layer(stack, path, audit).run();
}

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A lattice through a stack of slices:
//   1  choose the step from the distances of neighbours
//   2  tell holes from a protocol's second distance
//   3  find for every slice of the lattice the slices that it is made from
//   4  fit the stack's lean, name slices off it, widen the lattice by it
#include "voxel/scan/slice_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "voxel/scan/audit.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {

namespace {

/// Some scanners write positions with two decimals, so that the difference of two positions errs by up to
/// 0.01 mm. A shift of a hundredth of the step changes samples by less than interpolation would.
double position_tolerance_mm(double step_mm) {
  return std::max(0.01, 0.01 * step_mm);
}

/// A shift of d pixels changes a sample at a step edge by d times the step; a tenth is below the partial
/// volume effect of any slice, and far above the rounding of positions.
constexpr double aside_tolerance_px() {
  return 0.1;
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
    choose_step();
    find_holes();
    find_sources();
    report_spacing();
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
               is_known ? "the header's" : "assumed, the header has none"));
  }

  double total_mm() const { return heights_mm_.back(); }
  double least_mm() const { return *std::min_element(gaps_mm_.begin(), gaps_mm_.end()); }
  double most_mm() const { return *std::max_element(gaps_mm_.begin(), gaps_mm_.end()); }

  void choose_step() {
    // The finest distance with company; an only slice squeezed between two others sets no step.
    std::vector<double> sorted = gaps_mm_;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t needed = (gaps_mm_.size() + 4) / 5;
    double usual_mm = sorted.front();
    for (std::size_t i = 0; i + needed <= sorted.size(); ++i)
      if (are_equal(sorted[i], sorted[i + needed - 1])) {
        usual_mm = sorted[i];
        break;
      }
    // The mean of all such gaps is exact enough to count through a long stack.
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

  /// Whether a gap is one of at least three equal ones in a row.
  bool is_in_run(std::size_t gap) const {
    std::size_t first = gap, last = gap;
    while (first > 0 && are_equal(gaps_mm_[first - 1], gaps_mm_[gap])) --first;
    while (last + 1 < gaps_mm_.size() && are_equal(gaps_mm_[last + 1], gaps_mm_[gap])) ++last;
    return last - first >= 2;
  }

  /// Whether the scanner's numbers skip as many images as the gap has room for.
  bool skips_numbers(std::size_t gap) const {
    const int skipped = std::abs(stack_.slices[gap + 1].instance_number - stack_.slices[gap].instance_number);
    return skipped > 1 && std::lround(gaps_mm_[gap] / plan_.step_mm) == skipped;
  }

  void find_holes() {
    for (std::size_t i = 0; i < gaps_mm_.size(); ++i)
      if (gaps_mm_[i] > 1.5 * plan_.step_mm && (!is_in_run(i) || skips_numbers(i))) hole_gaps_.push_back(i);
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

  /// Shift aside per millimetre of height, in pixels: the median of all neighbours, so that one slice out of
  /// line does not bend it.
  glm::dvec2 lean_px_per_mm() const {
    glm::dvec2 lean;
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<double> slopes;
      for (std::size_t i = 1; i < stack_.slices.size(); ++i)
        slopes.push_back(
            (stack_.aside_px(stack_.slices[i])[axis] - stack_.aside_px(stack_.slices[i - 1])[axis]) /
            gaps_mm_[i - 1]);
      lean[axis] = median_of(slopes);
    }
    return lean;
  }

  /// Names the slices that stand aside from the line through the others.
  void report_sideways(const glm::dvec2& lean) {
    std::vector<glm::dvec2> off_px;
    for (std::size_t i = 0; i < stack_.slices.size(); ++i)
      off_px.push_back(stack_.aside_px(stack_.slices[i]) - lean * heights_mm_[i]);
    glm::dvec2 usual;
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<double> values;
      values.reserve(off_px.size());
      for (const glm::dvec2& off : off_px) values.push_back(off[axis]);
      usual[axis] = median_of(values);
    }
    std::vector<std::string> names;
    double most_mm = 0.0;
    for (std::size_t i = 0; i < off_px.size(); ++i) {
      const glm::dvec2 off = off_px[i] - usual;
      if (std::max(std::abs(off.x), std::abs(off.y)) <= aside_tolerance_px()) continue;
      most_mm = std::max(most_mm, glm::length(off * stack_.first().spacing_mm));
      names.push_back(stack_.slices[i].name);
    }
    if (names.empty()) return;
    find("sideways", Verdict::Warn,
         slices(names.size()) +
             print(" up to %.3g mm to the side of the others, moved back by linear "
                   "interpolation: ",
                   most_mm) +
             listed(names),
         names);
  }

  /// Sets the lattice's extent across the stack, wider than the slices if they lean.
  void lay_across() {
    glm::dvec2 low_px(0.0);
    glm::dvec2 high_px(0.0);
    for (std::size_t i = 1; i < stack_.slices.size(); ++i) {
      const DicomSlice& slice = stack_.slices[i];
      const glm::dvec2 aside_px = stack_.aside_px(slice);
      low_px = glm::min(low_px, aside_px);
      high_px = glm::max(high_px, aside_px);
      const double aside_mm =
          glm::length((aside_px - stack_.aside_px(stack_.slices[i - 1])) * stack_.first().spacing_mm);
      if (aside_mm > gaps_mm_[i - 1])
        refuse(slice.path,
               print("lies %.4g mm to the side of the slice before it, more than any gantry tilt explains; "
                     "move it to a folder of its own, or leave it out by --slices FROM:TO",
                     aside_mm));
    }
    const glm::dvec2 lean = lean_px_per_mm();
    report_sideways(lean);
    const double lean_mm = glm::length(lean * stack_.first().spacing_mm) * total_mm();
    const double tilt_deg = std::atan2(lean_mm, total_mm()) * 180.0 / std::numbers::pi;
    const double tag_deg = std::abs(stack_.first().tilt_deg.value_or(0.0));
    const glm::dvec2 spread_px = high_px - low_px;
    constexpr double widest_px = 1 << 15;
    if (!(std::max(spread_px.x, spread_px.y) <= widest_px))
      refuse(path_, print("its slices lean over %.4g pixels; check their positions and the pixels' spacing",
                          std::max(spread_px.x, spread_px.y)));
    plan_.leans = std::max(spread_px.x, spread_px.y) > aside_tolerance_px();
    const glm::dvec2 lean_px = glm::abs(lean) * total_mm();
    const bool is_tilted = std::max(lean_px.x, lean_px.y) > aside_tolerance_px();
    if (plan_.leans) {
      plan_.low_px = glm::ivec2(glm::floor(low_px + aside_tolerance_px()));
      const glm::ivec2 high = glm::ivec2(glm::ceil(high_px - aside_tolerance_px()));
      plan_.size_px += high - plan_.low_px;
    }
    if (is_tilted)
      find("gantry_tilt", Verdict::Warn,
           print("slices lean by %.2f degrees (%.4g mm over the stack); straightened by linear interpolation "
                 "within slices, widened from %d x %d to %d x %d pixels and filled with the lowest value",
                 tilt_deg, lean_mm, stack_.first().size_px.x, stack_.first().size_px.y, plan_.size_px.x,
                 plan_.size_px.y));
    else if (tag_deg > 0.5)  // files give the tag to half a degree or better
      find("gantry_tilt", Verdict::Warn,
           print("the header names a tilt of %.3g degrees, but by their positions the slices stand straight "
                 "above each other: the tilt is ignored",
                 tag_deg));
    else
      find("gantry_tilt", Verdict::Pass, "slices stand straight above each other");
  }

  const DicomStack& stack_;
  std::filesystem::path path_;
  std::vector<Finding>& audit_;
  SlicePlan plan_;
  std::vector<double> heights_mm_;  ///< from the first slice, along the normal
  std::vector<double> gaps_mm_;     ///< gap i lies between slices i and i + 1
  std::vector<std::size_t> hole_gaps_;
  std::size_t step_count_ = 0;
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
  const glm::dvec3 first_mm = stack.first().first_mm + row_mm * static_cast<double>(plan.low_px.x) +
                              column_mm * static_cast<double>(plan.low_px.y);
  return {{plan.size_px, static_cast<int>(plan.sources.size())},
          glm::dmat4(glm::dvec4(row_mm, 0.0), glm::dvec4(column_mm, 0.0),
                     glm::dvec4(stack.normal * plan.step_mm, 0.0), glm::dvec4(first_mm, 1.0))};
}

SlicePlan slice_plan(const DicomStack& stack, const std::filesystem::path& path,
                     std::vector<Finding>& audit) {
  return Layer(stack, path, audit).run();
}

}  // namespace octotomy::voxel

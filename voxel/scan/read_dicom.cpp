// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A stack of slices to a lattice:
//   1  lay a lattice through the slices: its step is the smallest gap
//   2  decode the slices, rescaled
//   3  interpolate linearly if slices leave the lattice: gantry tilt, uneven or missing slices
//   4  judge by the air if the values are Hounsfield
// Geometry comes from ImagePositionPatient and ImageOrientationPatient. The scanner's tags for tilt and
// spacing are only compared with them, because vendors disagree on the sign of the tilt and on the meaning of
// the spacing.
#include "voxel/scan/read_dicom.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <tbb/parallel_for.h>

#include "voxel/scan/air_level.h"
#include "voxel/scan/audit.h"
#include "voxel/scan/dicom_series.h"
#include "voxel/space/file_text.h"
#include "voxel/space/memory_need.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;
using Stack = DicomStack;

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

/// The lattice's place in the stack of slices.
struct Plan {
  struct Source {
    std::size_t below = 0;
    std::size_t above = 0;
    double share_above = 0.0;
  };
  std::vector<Source> sources;  ///< of each slice of the lattice
  double step_mm = 1.0;
  bool leans = false;    ///< slices are shifted aside against each other
  glm::ivec2 low_px{0};  ///< first pixel of the lattice, in pixels of the first slice
  glm::ivec2 size_px{0};

  bool is_copy() const {
    return !leans && std::all_of(sources.begin(), sources.end(),
                                 [](const Source& source) { return source.below == source.above; });
  }
};

class SeriesReader {
 public:
  SeriesReader(fs::path path, const ReadOptions& options) : path_(std::move(path)), options_(options) {}

  Scene run() {
    options_.progress.at(0.0);
    const Stack stack = stack_of_series(path_, options_, scene_.audit);
    options_.progress.at(0.1);
    const Plan plan = lay(stack);
    if (!decode_as<std::int16_t>(stack)) decode_as<float>(stack);
    options_.progress.at(0.8);
    audit_rescale(stack);
    audit_padding(stack);
    if (!plan.is_copy())
      std::visit([&](auto& samples) { samples = resample(stack, plan, samples); }, scene_.samples);
    place(stack, plan);
    scene_.modality = stack.first().modality;
    if (scene_.modality == "CT") {
      AirLevel air = air_level_of_ct(scene_);
      // The header declares the unit as unspecified, and no air contradicts it: not Hounsfield.
      if (stack.first().rescale_type == "US" && air.meaning == Meaning::Hounsfield &&
          air.finding.verdict != Verdict::Pass)
        air.meaning = Meaning::Raw;
      scene_.meaning = air.meaning;
      scene_.audit.push_back(air.finding);
    }
    scene_.source = path_.string();
    if (!stack.first().series_description.empty()) scene_.source += ": " + stack.first().series_description;
    return std::move(scene_);
  }

 private:
  void find(const char* check, Verdict verdict, std::string detail) {
    scene_.audit.push_back({check, verdict, std::move(detail)});
  }

  Plan lay(const Stack& stack) {
    Plan plan;
    plan.size_px = stack.first().size_px;
    if (stack.slices.size() == 1) {
      plan.sources.push_back({});
      plan.step_mm = stack.first().thickness_mm.value_or(0.0);
      const bool is_known = plan.step_mm > 0.0;
      if (!is_known) plan.step_mm = 1.0;
      find("slice_spacing", Verdict::Warn,
           print("a single slice; its thickness of %g mm is %s", plan.step_mm,
                 is_known ? "the header's" : "assumed, the header has none"));
      return plan;
    }
    lay_along_normal(stack, plan);
    lay_across(stack, plan);
    return plan;
  }

  /// Sets the lattice's step and the slices that each of its slices is made from.
  void lay_along_normal(const Stack& stack, Plan& plan) {
    const std::size_t count = stack.slices.size();
    std::vector<double> heights_mm;
    for (const DicomSlice& slice : stack.slices) heights_mm.push_back(stack.height_mm(slice));
    double least = std::numeric_limits<double>::infinity();
    double most = 0.0;
    for (std::size_t i = 1; i < count; ++i) {
      least = std::min(least, heights_mm[i] - heights_mm[i - 1]);
      most = std::max(most, heights_mm[i] - heights_mm[i - 1]);
    }
    // The mean of all small gaps is exact enough to count through a long stack.
    double sum = 0.0;
    int fine_count = 0;
    for (std::size_t i = 1; i < count; ++i) {
      if (const double gap = heights_mm[i] - heights_mm[i - 1]; gap < 1.5 * least) {
        sum += gap;
        ++fine_count;
      }
    }
    const double total_mm = heights_mm.back();
    const double steps = std::round(total_mm / (sum / fine_count));
    if (steps > 2.0 * static_cast<double>(count))
      refuse(path_,
             print("the slices are too scattered for a volume: gaps from %.3g to %.3g mm between %zu slices; "
                   "select the slices of one scan",
                   least, most, count));
    plan.step_mm = total_mm / steps;
    const double tolerance_mm = position_tolerance_mm(plan.step_mm);
    std::size_t below = 0;
    for (std::size_t k = 0; k <= static_cast<std::size_t>(steps); ++k) {
      const double height_mm = static_cast<double>(k) * plan.step_mm;
      while (below + 2 < count && heights_mm[below + 1] <= height_mm) ++below;
      const double gap_mm = heights_mm[below + 1] - heights_mm[below];
      const double above_mm = height_mm - heights_mm[below];
      if (above_mm <= tolerance_mm) {
        plan.sources.push_back({below, below, 0.0});
      } else if (gap_mm - above_mm <= tolerance_mm) {
        plan.sources.push_back({below + 1, below + 1, 0.0});
      } else {
        plan.sources.push_back({below, below + 1, above_mm / gap_mm});
      }
    }
    std::vector<bool> used(count, false);
    for (const Plan::Source& source : plan.sources)
      if (source.below == source.above) used[source.below] = true;
    const auto uneven_count = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
    report_spacing(plan, least, most, uneven_count, count, heights_mm);
  }

  void report_spacing(const Plan& plan, double least, double most, std::size_t uneven_count,
                      std::size_t count, const std::vector<double>& heights_mm) {
    if (uneven_count > 0) {
      find("slice_spacing", Verdict::Warn,
           print("uneven: gaps from %.4g to %.4g mm; %zu slices resampled to %zu, %.6g mm apart, by linear "
                 "interpolation",
                 least, most, count, plan.sources.size(), plan.step_mm));
      return;
    }
    find("slice_spacing", Verdict::Pass,
         print("%zu slices %.6g mm apart", plan.sources.size(), plan.step_mm));
    if (plan.sources.size() == count) {
      find("missing_slices", Verdict::Pass, "none");
      return;
    }
    std::size_t widest = 1;
    for (std::size_t i = 1; i < count; ++i)
      if (heights_mm[i] - heights_mm[i - 1] > heights_mm[widest] - heights_mm[widest - 1]) widest = i;
    find("missing_slices", Verdict::Warn,
         print("%zu of %zu slices are missing and linearly interpolated; the widest gap, %.4g mm, follows "
               "slice %zu from the start",
               plan.sources.size() - count, plan.sources.size(), most, widest));
  }

  /// Sets the lattice's extent across the stack, wider than the slices if they lean.
  void lay_across(const Stack& stack, Plan& plan) {
    glm::dvec2 low_px(0.0);
    glm::dvec2 high_px(0.0);
    for (std::size_t i = 1; i < stack.slices.size(); ++i) {
      const DicomSlice& slice = stack.slices[i];
      const glm::dvec2 aside_px = stack.aside_px(slice);
      low_px = glm::min(low_px, aside_px);
      high_px = glm::max(high_px, aside_px);
      const DicomSlice& before = stack.slices[i - 1];
      const double aside_mm = glm::length((aside_px - stack.aside_px(before)) * stack.first().spacing_mm);
      if (aside_mm > stack.height_mm(slice) - stack.height_mm(before))
        refuse(slice.path,
               print("lies %.4g mm to the side of the slice before it, more than any gantry tilt explains; "
                     "move it to a folder of its own",
                     aside_mm));
    }
    const DicomSlice& last = stack.slices.back();
    const double lean_mm = glm::length(stack.aside_px(last) * stack.first().spacing_mm);
    const double tilt_deg = std::atan2(lean_mm, stack.height_mm(last)) * 180.0 / std::numbers::pi;
    const double tag_deg = std::abs(stack.first().tilt_deg.value_or(0.0));
    const glm::dvec2 spread_px = high_px - low_px;
    plan.leans = std::max(spread_px.x, spread_px.y) > aside_tolerance_px();
    if (!plan.leans) {
      // Files give the tag to half a degree or better.
      if (tag_deg > 0.5)
        find(
            "gantry_tilt", Verdict::Warn,
            print("the header names a tilt of %.3g degrees, but by their positions the slices stand straight "
                  "above each other: the tilt is ignored",
                  tag_deg));
      else
        find("gantry_tilt", Verdict::Pass, "slices stand straight above each other");
      return;
    }
    plan.low_px = glm::ivec2(glm::floor(low_px + aside_tolerance_px()));
    const glm::ivec2 high = glm::ivec2(glm::ceil(high_px - aside_tolerance_px()));
    plan.size_px += high - plan.low_px;
    find("gantry_tilt", Verdict::Warn,
         print("slices lean by %.2f degrees (%.4g mm over the stack); straightened by linear interpolation "
               "within slices, widened from %d x %d to %d x %d pixels and filled with the lowest value",
               tilt_deg, lean_mm, stack.first().size_px.x, stack.first().size_px.y, plan.size_px.x,
               plan.size_px.y));
  }

  template <typename Sample>
  bool decode_as(const Stack& stack) {
    const glm::ivec2 size_px = stack.first().size_px;
    const std::size_t area = static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
    need_memory(path_, area * stack.slices.size(), sizeof(Sample));
    Samples<Sample> samples(area * stack.slices.size());
    std::vector<char> fits(stack.slices.size(), 0);
    for_each_index(stack.slices.size(), options_.progress, [&](std::size_t i) {
      fits[i] = read_dicom_samples(stack.slices[i], std::span<Sample>(samples).subspan(i * area, area));
    });
    const bool all_fit = std::all_of(fits.begin(), fits.end(), [](char fit) { return fit != 0; });
    if (all_fit) scene_.samples = std::move(samples);
    return all_fit;
  }

  void audit_rescale(const Stack& stack) {
    const DicomSlice& first = stack.first();
    const bool is_ct = first.modality == "CT";
    const auto differs = [&](const DicomSlice& slice) {
      return slice.slope != first.slope || slice.intercept != first.intercept;
    };
    const auto differing = std::count_if(stack.slices.begin(), stack.slices.end(), differs);
    if (differing > 0)
      find(
          "rescale", Verdict::Warn,
          print("slope and intercept change between slices (%td differ from the first); each slice's own are "
                "applied",
                differing));
    else if (!first.slope && !first.intercept)
      find("rescale", is_ct ? Verdict::Warn : Verdict::Pass,
           is_ct ? "RescaleSlope and RescaleIntercept are absent; stored values are not rescaled"
                 : "none in the header; stored values are not rescaled");
    else if (is_ct && !first.rescale_type.empty() && first.rescale_type != "HU")
      find("rescale", Verdict::Warn,
           print("slope %g, intercept %g applied; their unit is declared '%s', not HU",
                 first.slope.value_or(1.0), first.intercept.value_or(0.0), first.rescale_type.c_str()));
    else if (is_ct && (!first.slope || !first.intercept))
      find("rescale", Verdict::Warn,
           "RescaleSlope or RescaleIntercept is absent; a slope of 1 or an intercept of 0 is assumed");
    else
      find("rescale", Verdict::Pass,
           print("slope %g, intercept %g applied", first.slope.value_or(1.0), first.intercept.value_or(0.0)));
    if (first.inverted)
      find("photometric", Verdict::Warn, "MONOCHROME1: viewers show it inverted; values are read as stored");
  }

  /// Pixels beyond the scanner's field of view hold a padding value, which is no measurement.
  void audit_padding(const Stack& stack) {
    const std::optional<double> padding = stack.first().padding;
    if (!padding) return find("padding", Verdict::Pass, "the header names no padding value");
    const auto count = std::visit(
        [&](const auto& samples) {
          return std::count_if(samples.begin(), samples.end(),
                               [&](auto sample) { return static_cast<double>(sample) == *padding; });
        },
        scene_.samples);
    if (count == 0)
      find("padding", Verdict::Pass, print("no sample has the padding value %g", *padding));
    else
      find("padding", Verdict::Warn,
           print("%td samples have the padding value %g, which is no measurement; they are kept: choose "
                 "windows without that value",
                 count, *padding));
  }

  template <typename Sample>
  static Samples<Sample> resample(const Stack& stack, const Plan& plan, const Samples<Sample>& stored) {
    const glm::ivec2 from_px = stack.first().size_px;
    const std::size_t from_area = static_cast<std::size_t>(from_px.x) * static_cast<std::size_t>(from_px.y);
    const std::size_t width = static_cast<std::size_t>(plan.size_px.x);
    const std::size_t area = width * static_cast<std::size_t>(plan.size_px.y);
    const double fill = static_cast<double>(*std::min_element(stored.begin(), stored.end()));
    const auto in_slice = [&](std::size_t slice, glm::dvec2 p_px) {
      // The slice ends half a pixel beyond the centres of its outer pixels.
      if (p_px.x < -0.5 || p_px.y < -0.5 || p_px.x > from_px.x - 0.5 || p_px.y > from_px.y - 0.5) return fill;
      p_px = glm::clamp(p_px, glm::dvec2(0.0), glm::dvec2(from_px - 1));
      const glm::ivec2 low = glm::min(glm::ivec2(p_px), glm::max(from_px - 2, 0));
      const glm::dvec2 t = p_px - glm::dvec2(low);
      const auto at = [&](int x, int y) {
        const glm::ivec2 i = glm::min(low + glm::ivec2(x, y), from_px - 1);
        return static_cast<double>(
            stored[slice * from_area + static_cast<std::size_t>(i.y) * static_cast<std::size_t>(from_px.x) +
                   static_cast<std::size_t>(i.x)]);
      };
      const double lower = at(0, 0) * (1.0 - t.x) + at(1, 0) * t.x;
      return t.y == 0.0 ? lower : lower * (1.0 - t.y) + (at(0, 1) * (1.0 - t.x) + at(1, 1) * t.x) * t.y;
    };
    std::vector<glm::dvec2> aside_px(stack.slices.size(), glm::dvec2(0.0));
    if (plan.leans)
      for (std::size_t i = 0; i < aside_px.size(); ++i) aside_px[i] = stack.aside_px(stack.slices[i]);
    Samples<Sample> samples(area * plan.sources.size());
    tbb::parallel_for(std::size_t{0}, plan.sources.size(), [&](std::size_t k) {
      const Plan::Source source = plan.sources[k];
      for (std::size_t i = 0; i < area; ++i) {
        const glm::dvec2 p_px = glm::dvec2(plan.low_px) +
                                glm::dvec2(static_cast<double>(i % width), static_cast<double>(i / width));
        double value = in_slice(source.below, p_px - aside_px[source.below]);
        if (source.above != source.below)
          value += source.share_above * (in_slice(source.above, p_px - aside_px[source.above]) - value);
        if constexpr (std::is_integral_v<Sample>)
          samples[k * area + i] = static_cast<Sample>(std::floor(value + 0.5));
        else
          samples[k * area + i] = static_cast<Sample>(value);
      }
    });
    return samples;
  }

  void place(const Stack& stack, const Plan& plan) {
    const glm::dvec3 row_mm = stack.along_row * stack.first().spacing_mm.x;
    const glm::dvec3 column_mm = stack.along_column * stack.first().spacing_mm.y;
    const glm::dvec3 first_mm = stack.first().first_mm + row_mm * static_cast<double>(plan.low_px.x) +
                                column_mm * static_cast<double>(plan.low_px.y);
    scene_.lattice.dims = {plan.size_px, static_cast<int>(plan.sources.size())};
    scene_.lattice.lps_from_voxel =
        glm::dmat4(glm::dvec4(row_mm, 0.0), glm::dvec4(column_mm, 0.0),
                   glm::dvec4(stack.normal * plan.step_mm, 0.0), glm::dvec4(first_mm, 1.0));
  }

  fs::path path_;
  const ReadOptions& options_;
  Scene scene_;
};

}  // namespace

Scene read_dicom(const fs::path& path, const ReadOptions& options) {
  return SeriesReader(path, options).run();
}

}  // namespace octotomy::voxel

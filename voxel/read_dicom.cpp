// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Slices to a lattice:
//   1  read every file's header; what is no slice is counted, not hidden
//   2  choose the series with most slices, and in it the commonest size and orientation
//   3  order the slices by position along their normal and drop repeated ones
//   4  lay a lattice through them: the finest gap that occurs is its step
//   5  decode the slices, rescaled
//   6  where slices do not stand on the lattice - gantry tilt, uneven or missing slices - interpolate
//   linearly 7  judge by the air whether the values are Hounsfield
// ImagePositionPatient and ImageOrientationPatient decide; the scanner's tags for tilt and spacing are only
// compared with them, since vendors disagree about the former's sign and the meaning of the latter.
#include "voxel/read_dicom.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <stdexcept>
#include <tbb/parallel_for.h>

#include "voxel/air_level.h"
#include "voxel/dicom_slice.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

/// Positions are decimal strings that some scanners end after two decimals, so that the difference of two
/// errs by up to 0.01 mm; beyond that a hundredth of the step moves a sample by less than interpolation
/// blurs.
double position_tolerance_mm(double step_mm) {
  return std::max(0.01, 0.01 * step_mm);
}

/// Slices closer than a tenth of the usual gap cannot be two samples of the stack: they repeat one place.
double repeat_tolerance_mm(double usual_gap_mm) {
  return 0.1 * usual_gap_mm;
}

/// A shift of d pixels changes a sample at a step edge by d times the step; a tenth is below the partial
/// volume effect of any slice, and far above the rounding of positions.
constexpr double aside_tolerance_px() {
  return 0.1;
}

/// Direction cosines are printed with six decimals at worst; over the longest side in use, 4096 pixels, a
/// thousandth would already be four pixels, so ten roundings is all that one orientation may spread.
constexpr double cosine_tolerance() {
  return 1e-5;
}

template <typename... Parts>
std::string print(const char* format, Parts... parts) {
  char text[512];
  std::snprintf(text, sizeof text, format, parts...);
  return text;
}

std::string slices(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " slice" : " slices");
}

[[noreturn]] void refuse(const fs::path& path, const std::string& reason) {
  throw std::runtime_error(path.string() + ": " + reason);
}

/// Runs a task an index in parallel; of several exceptions the lowest index's is thrown, on any thread count.
void for_each_index(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::vector<std::exception_ptr> errors(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    try {
      task(i);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

/// The regular files of a folder and its subfolders, sorted.
std::vector<fs::path> files_of(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  std::error_code error;
  fs::recursive_directory_iterator entry(path, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error))
    if (std::error_code ignored; entry->is_regular_file(ignored)) files.push_back(entry->path());
  if (error) refuse(path, "the folder cannot be listed: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

/// A stack of slices with one size and orientation, ordered along the normal.
struct Stack {
  std::vector<DicomSlice> slices;
  glm::dvec3 along_row{1, 0, 0};
  glm::dvec3 along_column{0, 1, 0};
  glm::dvec3 normal{0, 0, 1};

  const DicomSlice& first() const { return slices.front(); }
  double height_mm(const DicomSlice& slice) const {
    return glm::dot(slice.first_mm - first().first_mm, normal);
  }
  /// How far a slice's first pixel lies from the first slice's normal, in pixels.
  glm::dvec2 aside_px(const DicomSlice& slice) const {
    const glm::dvec3 offset_mm = slice.first_mm - first().first_mm;
    return glm::dvec2(glm::dot(offset_mm, along_row), glm::dot(offset_mm, along_column)) / first().spacing_mm;
  }
};

/// Where the lattice's slices lie in the stack.
struct Plan {
  struct Source {
    std::size_t below = 0;
    std::size_t above = 0;
    double share_above = 0.0;
  };
  std::vector<Source> sources;  ///< one a slice of the lattice
  double step_mm = 1.0;
  bool leans = false;    ///< slices are shifted aside against each other
  glm::ivec2 low_px{0};  ///< first pixel of the lattice, in those of the first slice
  glm::ivec2 size_px{0};

  bool is_copy() const {
    return !leans && std::all_of(sources.begin(), sources.end(),
                                 [](const Source& source) { return source.below == source.above; });
  }
};

class SeriesReader {
 public:
  explicit SeriesReader(fs::path path) : path_(std::move(path)) {}

  Scene run() {
    Stack stack = orient(choose(read_headers()));
    order(stack);
    const Plan plan = lay(stack);
    if (!decode_as<std::int16_t>(stack)) decode_as<float>(stack);
    audit_rescale(stack);
    if (!plan.is_copy())
      std::visit([&](auto& samples) { samples = resample(stack, plan, samples); }, scene_.samples);
    place(stack, plan);
    scene_.modality = stack.first().modality;
    if (scene_.modality == "CT") {
      AirLevel air = air_level_of_ct(scene_);
      // Declared as unspecified and without air to the contrary: not Hounsfield.
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

  std::vector<DicomSlice> read_headers() {
    const std::vector<fs::path> files = files_of(path_);
    std::vector<std::variant<DicomSlice, NoSlice>> headers(files.size());
    for_each_index(files.size(), [&](std::size_t i) { headers[i] = read_dicom_slice(files[i]); });
    std::vector<DicomSlice> found;
    std::size_t stray_count = 0;
    std::string first_stray;
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (DicomSlice* slice = std::get_if<DicomSlice>(&headers[i])) {
        found.push_back(std::move(*slice));
      } else if (stray_count++ == 0) {
        first_stray =
            (fs::is_directory(path_) ? fs::relative(files[i], path_) : files[i].filename()).string() + " (" +
            std::get<NoSlice>(headers[i]).reason + ")";
      }
    }
    if (found.empty() && !fs::is_directory(path_))
      refuse(path_, "is no scan that can be read: " + std::get<NoSlice>(headers.front()).reason +
                        "; scans are DICOM, .nii, .nii.gz, .nrrd, .nhdr, .mha and .mhd");
    if (found.empty())
      refuse(path_,
             "no DICOM slice in the folder or below; " +
                 (stray_count == 0 ? "it holds no files"
                                   : std::to_string(stray_count) + " files, the first " + first_stray));
    if (stray_count == 0)
      find("stray_files", Verdict::Pass, "every file is a DICOM slice");
    else
      find("stray_files", Verdict::Warn,
           std::to_string(stray_count) + (stray_count == 1 ? " file" : " files") +
               " skipped that are no DICOM slices, the first " + first_stray);
    return found;
  }

  /// The slices of the series with most of them; of equal ones that with the lowest identifier.
  std::vector<DicomSlice> choose(std::vector<DicomSlice> found) {
    std::map<std::string, std::vector<DicomSlice>> series;
    for (DicomSlice& slice : found) series[slice.series_uid].push_back(std::move(slice));
    const auto named = [](const std::vector<DicomSlice>& members) {
      const DicomSlice& first = members.front();
      return "'" + first.series_description + "' (" + first.modality + ", " + slices(members.size()) + ")";
    };
    auto most = series.begin();
    for (auto it = series.begin(); it != series.end(); ++it)
      if (it->second.size() > most->second.size()) most = it;
    if (series.size() == 1) {
      find("series", Verdict::Pass, "one series: " + named(most->second));
    } else {
      std::string others;
      for (const auto& [uid, members] : series)
        if (uid != most->first) others += (others.empty() ? "" : ", ") + named(members);
      find("series", Verdict::Warn,
           std::to_string(series.size()) + " series: took " + named(most->second) + ", left " + others +
               "; give a folder of one series to choose another");
    }
    return std::move(most->second);
  }

  /// Keeps the slices that share the commonest of something; the others are said in a finding.
  void keep_commonest(const char* check, std::vector<DicomSlice>& members,
                      const std::function<bool(const DicomSlice&, const DicomSlice&)>& alike,
                      const std::function<std::string(const DicomSlice&)>& named) {
    std::vector<std::vector<DicomSlice>> kinds;
    for (DicomSlice& slice : members) {
      const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                     [&](const auto& known) { return alike(known.front(), slice); });
      if (kind == kinds.end())
        kinds.push_back({std::move(slice)});
      else
        kind->push_back(std::move(slice));
    }
    auto& most = *std::max_element(kinds.begin(), kinds.end(),
                                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
    const std::string taken = named(most.front());
    if (const std::size_t left = members.size() - most.size(); left == 0)
      find(check, Verdict::Pass, taken);
    else
      find(check, Verdict::Warn,
           "mixed in one series: kept " + slices(most.size()) + " of " + taken + ", left " + slices(left));
    members = std::vector<DicomSlice>(std::move(most));
  }

  Stack orient(std::vector<DicomSlice> members) {
    keep_commonest(
        "size", members,
        [](const DicomSlice& a, const DicomSlice& b) {
          return a.size_px == b.size_px &&
                 glm::all(glm::lessThan(glm::abs(a.spacing_mm - b.spacing_mm), 1e-5 * a.spacing_mm));
        },
        [](const DicomSlice& slice) {
          return print("%d x %d pixels of %.6g x %.6g mm", slice.size_px.x, slice.size_px.y,
                       slice.spacing_mm.x, slice.spacing_mm.y);
        });
    keep_commonest(
        "orientation", members,
        [](const DicomSlice& a, const DicomSlice& b) {
          return glm::length(a.along_row - b.along_row) < cosine_tolerance() &&
                 glm::length(a.along_column - b.along_column) < cosine_tolerance();
        },
        [](const DicomSlice& slice) {
          const glm::dvec3 normal = glm::abs(glm::cross(slice.along_row, slice.along_column));
          const char* plane = normal.z >= normal.x && normal.z >= normal.y ? "axial"
                              : normal.y >= normal.x                       ? "coronal"
                                                                           : "sagittal";
          return print("%s slices, rows along (%.4g, %.4g, %.4g), columns along (%.4g, %.4g, %.4g) in LPS",
                       plane, slice.along_row.x + 0.0, slice.along_row.y + 0.0, slice.along_row.z + 0.0,
                       slice.along_column.x + 0.0, slice.along_column.y + 0.0, slice.along_column.z + 0.0);
        });
    Stack stack;
    stack.slices = std::move(members);
    make_perpendicular(stack);
    if (stack.first().spacing_at_detector)
      find("pixel_spacing", Verdict::Warn,
           "PixelSpacing is absent; ImagerPixelSpacing, measured at the detector, is taken in its place");
    return stack;
  }

  void make_perpendicular(Stack& stack) {
    const DicomSlice& first = stack.first();
    const double row = glm::length(first.along_row);
    const double column = glm::length(first.along_column);
    const double lean = glm::dot(first.along_row, first.along_column);
    // A thousandth is fifty times the worst rounding seen; more is no rounding but a wrong header.
    if (!(std::abs(row - 1.0) < 1e-3 && std::abs(column - 1.0) < 1e-3 && std::abs(lean) < 1e-3))
      refuse(first.path, "ImageOrientationPatient is not two perpendicular unit vectors");
    stack.along_row = first.along_row / row;
    stack.along_column =
        glm::normalize(first.along_column - glm::dot(first.along_column, stack.along_row) * stack.along_row);
    // Adding zero takes the sign from -0, which headers hold and no reader wants to see.
    stack.along_row += 0.0;
    stack.along_column += 0.0;
    stack.normal = glm::cross(stack.along_row, stack.along_column) + 0.0;
  }

  void order(Stack& stack) {
    // Heights count from the first slice in file order, which sorting must not move under the comparison.
    const glm::dvec3 normal = stack.normal;
    std::stable_sort(stack.slices.begin(), stack.slices.end(), [&](const DicomSlice& a, const DicomSlice& b) {
      const double height_a = glm::dot(a.first_mm, normal);
      const double height_b = glm::dot(b.first_mm, normal);
      return height_a != height_b ? height_a < height_b : a.instance_number < b.instance_number;
    });
    drop_repeated(stack);
  }

  void drop_repeated(Stack& stack) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < stack.slices.size(); ++i)
      gaps.push_back(stack.height_mm(stack.slices[i]) - stack.height_mm(stack.slices[i - 1]));
    std::erase_if(gaps, [](double gap) { return gap < 1e-6; });  // far below any printed position
    double usual_gap_mm = 0.0;
    if (!gaps.empty()) {
      std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
      usual_gap_mm = gaps[gaps.size() / 2];
    }
    std::vector<DicomSlice> kept;
    std::size_t copy_count = 0;
    std::size_t rival_count = 0;
    std::string first_repeat;
    for (DicomSlice& slice : stack.slices) {
      const bool repeats = !kept.empty() && glm::dot(slice.first_mm - kept.back().first_mm, stack.normal) <=
                                                repeat_tolerance_mm(usual_gap_mm);
      if (!repeats) {
        kept.push_back(std::move(slice));
        continue;
      }
      if (copy_count + rival_count == 0) first_repeat = slice.path.filename().string();
      ++(slice.instance_uid == kept.back().instance_uid ? copy_count : rival_count);
    }
    stack.slices = std::move(kept);
    if (copy_count + rival_count == 0)
      find("duplicates", Verdict::Pass, "every slice has a place of its own");
    else if (rival_count == 0)
      find("duplicates", Verdict::Warn,
           slices(copy_count) + " stored twice and left out, the first " + first_repeat);
    else
      find("duplicates", Verdict::Fail,
           slices(rival_count) + " of other images at places already taken, left out, the first " +
               first_repeat + "; the series holds several scans: separate them to choose");
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

  /// The lattice's step and which slices each of its slices comes from.
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
    // Averaged over all gaps of the finest kind, the step is exact enough to count through a long stack.
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
             print("the slices are too scattered for a volume: gaps from %g to %g mm between %zu slices; "
                   "select those of one scan",
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
         print("%zu of %zu slices are missing and linearly interpolated; the widest gap, %.4g mm, is after "
               "slice "
               "%zu from the start",
               plan.sources.size() - count, plan.sources.size(), most, widest));
  }

  /// The lattice's extent across the stack, wider than the slices where they lean.
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
               print("lies %.4g mm aside of the slice before it, more than any gantry tilts; it belongs "
                     "to another scan",
                     aside_mm));
    }
    const DicomSlice& last = stack.slices.back();
    const double lean_mm = glm::length(stack.aside_px(last) * stack.first().spacing_mm);
    const double tilt_deg = std::atan2(lean_mm, stack.height_mm(last)) * 180.0 / std::numbers::pi;
    const double tag_deg = std::abs(stack.first().tilt_deg.value_or(0.0));
    const glm::dvec2 spread_px = high_px - low_px;
    plan.leans = std::max(spread_px.x, spread_px.y) > aside_tolerance_px();
    if (!plan.leans) {
      // The tag is printed to half a degree at worst.
      if (tag_deg > 0.5)
        find("gantry_tilt", Verdict::Warn,
             print("the header names a tilt of %g degrees, yet the slices stand straight above each other: "
                   "positions are believed",
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
               "within "
               "slices, widened from %d x %d to %d x %d pixels and filled with the lowest value",
               tilt_deg, lean_mm, stack.first().size_px.x, stack.first().size_px.y, plan.size_px.x,
               plan.size_px.y));
  }

  template <typename Sample>
  bool decode_as(const Stack& stack) {
    const glm::ivec2 size_px = stack.first().size_px;
    const std::size_t area = static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
    std::vector<Sample> samples(area * stack.slices.size());
    std::vector<char> fits(stack.slices.size(), 0);
    for_each_index(stack.slices.size(), [&](std::size_t i) {
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
          print(
              "slope and intercept change between slices (%td differ from the first); each slice has its own "
              "applied",
              differing));
    else if (!first.slope && !first.intercept)
      find("rescale", is_ct ? Verdict::Warn : Verdict::Pass,
           is_ct ? "RescaleSlope and RescaleIntercept are absent; stored values are taken as they are"
                 : "none in the header; stored values are taken as they are");
    else if (is_ct && !first.rescale_type.empty() && first.rescale_type != "HU")
      find("rescale", Verdict::Warn,
           print("slope %g, intercept %g applied; their unit is declared '%s', not HU",
                 first.slope.value_or(1.0), first.intercept.value_or(0.0), first.rescale_type.c_str()));
    else if (is_ct && (!first.slope || !first.intercept))
      find("rescale", Verdict::Warn,
           "only one of RescaleSlope and RescaleIntercept is there; 1 or 0 is assumed");
    else
      find("rescale", Verdict::Pass,
           print("slope %g, intercept %g applied", first.slope.value_or(1.0), first.intercept.value_or(0.0)));
    if (first.inverted)
      find("photometric", Verdict::Warn, "MONOCHROME1: shown inverted by viewers, read as stored");
  }

  template <typename Sample>
  static std::vector<Sample> resample(const Stack& stack, const Plan& plan,
                                      const std::vector<Sample>& stored) {
    const glm::ivec2 from_px = stack.first().size_px;
    const std::size_t from_area = static_cast<std::size_t>(from_px.x) * static_cast<std::size_t>(from_px.y);
    const std::size_t width = static_cast<std::size_t>(plan.size_px.x);
    const std::size_t area = width * static_cast<std::size_t>(plan.size_px.y);
    const double fill = static_cast<double>(*std::min_element(stored.begin(), stored.end()));
    const auto in_slice = [&](std::size_t slice, glm::dvec2 p_px) {
      // A pixel reaches half its width beyond its centre, and so does the slice.
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
    std::vector<Sample> samples(area * plan.sources.size());
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
  Scene scene_;
};

}  // namespace

Scene read_dicom(const fs::path& path) {
  return SeriesReader(path).run();
}

}  // namespace octotomy::voxel

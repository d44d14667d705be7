// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Files to the stack of one series:
//   1  read every file's header; count the files that hold no slice
//   2  choose the series asked for, else that with most slices; leave out scout views
//   3  keep the commonest size and orientation
//   4  order the slices by position along their normal and drop repeated ones
#include "voxel/scan/dicom_series.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tbb/parallel_for.h>

#include "voxel/scan/audit.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

/// Slices closer than a tenth of the usual gap repeat one position.
double repeat_tolerance_mm(double usual_gap_mm) {
  return 0.1 * usual_gap_mm;
}

/// Files give direction cosines with six decimals or more. Ten roundings are allowed: over the longest side
/// in use, 4096 pixels, they shift a pixel by a twenty-fifth of its width.
constexpr double cosine_tolerance() {
  return 1e-5;
}

std::string slices(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " slice" : " slices");
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

class SeriesAssembler {
 public:
  SeriesAssembler(fs::path path, const ReadOptions& options, std::vector<Finding>& audit)
      : path_(std::move(path)), options_(options), audit_(audit) {}

  std::vector<SeriesEntry> list() {
    std::vector<SeriesEntry> entries;
    for (const std::vector<DicomSlice>& members : by_series(read_headers())) {
      const DicomSlice& first = members.front();
      entries.push_back({first.series_uid, first.series_description, first.modality, first.series_number,
                         members.size(), first.size_px});
    }
    return entries;
  }

  DicomStack run() {
    DicomStack stack = orient(without_localizers(choose(read_headers())));
    order(stack);
    return stack;
  }

 private:
  void find(const char* check, Verdict verdict, std::string detail) {
    audit_.push_back({check, verdict, std::move(detail)});
  }

  std::vector<DicomSlice> read_headers() {
    const std::vector<fs::path> files = files_of(path_);
    std::vector<std::variant<std::vector<DicomSlice>, NoSlice>> headers(files.size());
    for_each_index(files.size(), options_.progress,
                   [&](std::size_t i) { headers[i] = read_dicom_slices(files[i]); });
    std::vector<DicomSlice> found;
    std::size_t stray_count = 0;
    std::string first_stray;
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (auto* slices = std::get_if<std::vector<DicomSlice>>(&headers[i])) {
        std::move(slices->begin(), slices->end(), std::back_inserter(found));
      } else if (stray_count++ == 0) {
        first_stray =
            (fs::is_directory(path_) ? fs::relative(files[i], path_) : files[i].filename()).string() + " (" +
            std::get<NoSlice>(headers[i]).reason + ")";
      }
    }
    if (found.empty() && !fs::is_directory(path_))
      refuse(path_, "is not a readable scan: " + std::get<NoSlice>(headers.front()).reason +
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

  /// Slices by series, most slices first; equal counts in the order of their identifiers.
  static std::vector<std::vector<DicomSlice>> by_series(std::vector<DicomSlice> found) {
    std::map<std::string, std::vector<DicomSlice>> series;
    for (DicomSlice& slice : found) series[slice.series_uid].push_back(std::move(slice));
    std::vector<std::vector<DicomSlice>> sorted;
    for (auto& [uid, members] : series) sorted.push_back(std::move(members));
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    return sorted;
  }

  static std::string named(const std::vector<DicomSlice>& members) {
    const DicomSlice& first = members.front();
    return "'" + first.series_description + "' (" + first.modality + ", " + slices(members.size()) + ")";
  }

  /// The series asked for, else that with most slices.
  std::vector<DicomSlice> choose(std::vector<DicomSlice> found) {
    std::vector<std::vector<DicomSlice>> series = by_series(std::move(found));
    const std::size_t taken = options_.series.empty() ? 0 : asked(series);
    if (series.size() == 1) {
      find("series", Verdict::Pass, "one series: " + named(series.front()));
      return std::move(series.front());
    }
    std::string others;
    for (std::size_t i = 0; i < series.size(); ++i)
      if (i != taken) others += (others.empty() ? "" : ", ") + std::to_string(i + 1) + " " + named(series[i]);
    find("series", options_.series.empty() ? Verdict::Warn : Verdict::Pass,
         std::to_string(series.size()) + " series: took " + std::to_string(taken + 1) + " " +
             named(series[taken]) + ", left " + others +
             (options_.series.empty() ? "; choose another by --series N" : ""));
    return std::move(series[taken]);
  }

  /// The one series that the options' text names by number, identifier or description.
  std::size_t asked(const std::vector<std::vector<DicomSlice>>& series) const {
    const std::string& wanted = options_.series;
    std::vector<std::size_t> described;
    std::string known;
    for (std::size_t i = 0; i < series.size(); ++i) {
      if (wanted == std::to_string(i + 1) || wanted == series[i].front().series_uid) return i;
      if (series[i].front().series_description.find(wanted) != std::string::npos) described.push_back(i);
      known += (known.empty() ? "" : ", ") + std::to_string(i + 1) + " " + named(series[i]);
    }
    if (described.size() == 1) return described.front();
    refuse(path_, (described.empty() ? "no series is '" : "several series are '") + wanted +
                      "'; choose by number: " + known);
  }

  /// Some scanners put scout views into the series of the scan.
  std::vector<DicomSlice> without_localizers(std::vector<DicomSlice> members) {
    const auto localizers = static_cast<std::size_t>(std::count_if(
        members.begin(), members.end(), [](const DicomSlice& slice) { return slice.is_localizer; }));
    if (localizers == 0) {
      find("localizers", Verdict::Pass, "none");
    } else if (localizers == members.size()) {
      find("localizers", Verdict::Fail,
           "every image is a localizer: this series is a scout view; choose another by --series N");
    } else {
      find("localizers", Verdict::Warn, slices(localizers) + " of scout views left out");
      std::erase_if(members, [](const DicomSlice& slice) { return slice.is_localizer; });
    }
    return members;
  }

  /// Keeps the largest group of slices that are alike; a finding states the others.
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

  DicomStack orient(std::vector<DicomSlice> members) {
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
    DicomStack stack;
    stack.slices = std::move(members);
    make_perpendicular(stack);
    if (stack.first().spacing_at_detector)
      find("pixel_spacing", Verdict::Warn,
           "PixelSpacing is absent; ImagerPixelSpacing, measured at the detector, replaces it");
    return stack;
  }

  void make_perpendicular(DicomStack& stack) {
    const DicomSlice& first = stack.first();
    const double row = glm::length(first.along_row);
    const double column = glm::length(first.along_column);
    const double lean = glm::dot(first.along_row, first.along_column);
    // A thousandth is fifty times the worst rounding seen; a larger deviation is a wrong header.
    if (!(std::abs(row - 1.0) < 1e-3 && std::abs(column - 1.0) < 1e-3 && std::abs(lean) < 1e-3))
      refuse(first.path, "ImageOrientationPatient is not two perpendicular unit vectors");
    stack.along_row = first.along_row / row;
    stack.along_column =
        glm::normalize(first.along_column - glm::dot(first.along_column, stack.along_row) * stack.along_row);
    // Adding zero turns -0, which headers hold, into 0.
    stack.along_row += 0.0;
    stack.along_column += 0.0;
    stack.normal = glm::cross(stack.along_row, stack.along_column) + 0.0;
  }

  void order(DicomStack& stack) {
    // height_mm() counts from the first slice, which sorting moves: compare heights from the origin instead.
    const glm::dvec3 normal = stack.normal;
    std::stable_sort(stack.slices.begin(), stack.slices.end(), [&](const DicomSlice& a, const DicomSlice& b) {
      const double height_a = glm::dot(a.first_mm, normal);
      const double height_b = glm::dot(b.first_mm, normal);
      return height_a != height_b ? height_a < height_b : a.instance_number < b.instance_number;
    });
    drop_repeated(stack);
  }

  void drop_repeated(DicomStack& stack) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < stack.slices.size(); ++i)
      gaps.push_back(stack.height_mm(stack.slices[i]) - stack.height_mm(stack.slices[i - 1]));
    std::erase_if(gaps, [](double gap) { return gap < 1e-6; });  // below the rounding of any file's positions
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
      find("duplicates", Verdict::Pass, "every slice has its own position");
    else if (rival_count == 0)
      find("duplicates", Verdict::Warn,
           slices(copy_count) + " stored twice and left out, the first " + first_repeat);
    else
      find("duplicates", Verdict::Fail,
           slices(rival_count) +
               " left out that are different images at positions already taken, the first " + first_repeat +
               "; the series holds several scans: put each into a folder of its own");
  }

  fs::path path_;
  const ReadOptions& options_;
  std::vector<Finding>& audit_;
};

}  // namespace

DicomStack stack_of_series(const fs::path& path, const ReadOptions& options, std::vector<Finding>& audit) {
  return SeriesAssembler(path, options, audit).run();
}

std::vector<SeriesEntry> list_series(const fs::path& path) {
  const ReadOptions options;
  std::vector<Finding> audit;
  return SeriesAssembler(path, options, audit).list();
}

void for_each_index(std::size_t count, const Progress& progress,
                    const std::function<void(std::size_t)>& task) {
  std::vector<std::exception_ptr> errors(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    try {
      if (progress.stop.stop_requested()) throw Stopped("stopped while the scan was read");
      task(i);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace octotomy::voxel

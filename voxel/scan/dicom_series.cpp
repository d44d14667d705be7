// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Turns files into the stack of one series:
//   1 read every file's header; list the files that hold no slice
//   2 choose the requested series or stack, else the series with most slices; leave out scout views
//   3 keep the commonest patient, study, modality and frame of reference, size and orientation
//   4 if several stacks lie at one place, keep the largest
//   5 order the slices by position along their normal and drop repeated ones
//   6 keep the requested slices and check the attributes that they must share
// Longer than most sources because the steps share the list of the folder's contents and of the caller's
// choices.
#include "voxel/scan/dicom_series.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tbb/parallel_for.h>

#include "voxel/dicom/dicom_folder.h"
#include "voxel/dicom/dicom_pixels.h"
#include "voxel/dicom/dicom_stacks.h"
#include "voxel/dicom/identity.h"
#include "voxel/scan/stack_audit.h"
#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

/// Slices closer than this share of the usual gap count as being at one position.
double repeat_tolerance_mm(double usual_gap_mm) {
  return 0.1 * usual_gap_mm;
}

/// A rotation that moves the farthest pixel of an image by at most this many pixels changes samples less than
/// the partial volume effect of a slice.
constexpr double unseen_turn_px() {
  return 0.1;
}

/// A direction whose length differs from 1 by more than this is not a rounded or badly scaled unit vector.
constexpr double most_length_error = 0.1;

/// Rounding to two decimals changes each cosine by up to 0.005. A vector's length is then wrong by up to
/// 0.005 times the root of three, and the scalar product of two vectors by up to twice this value.
double two_decimals_error() {
  return 0.01 * std::sqrt(3.0);
}

/// The mean distance between neighbouring slices along the first slice's normal; none for a single slice.
std::optional<double> mean_distance_mm(const std::vector<DicomSlice>& slices) {
  if (slices.size() < 2) return {};
  const glm::dvec3 normal = glm::cross(slices.front().along_row, slices.front().along_column);
  const auto [low, high] =
      std::minmax_element(slices.begin(), slices.end(), [&](const DicomSlice& a, const DicomSlice& b) {
        return glm::dot(a.first_mm, normal) < glm::dot(b.first_mm, normal);
      });
  return glm::dot(high->first_mm - low->first_mm, normal) / static_cast<double>(slices.size() - 1);
}

class SeriesAssembler {
 public:
  SeriesAssembler(fs::path path, const ReadOptions& options, std::vector<Finding>& audit)
      : path_(std::move(path)), options_(options), audit_(audit) {}

  std::vector<SeriesEntry> list() {
    std::vector<SeriesEntry> entries;
    for (const Series& series : by_series(read_headers()))
      for (std::size_t i = 0; i < series.stacks.size(); ++i) {
        const DicomSlice& first = series.stacks[i].slices.front();
        entries.push_back({first.series_uid, first.series_description, first.modality, first.series_number,
                           series.stacks[i].slices.size(), first.size_px, series.choice(i),
                           series.stacks[i].words, first.spacing_mm,
                           mean_distance_mm(series.stacks[i].slices), first.identity.study_date});
      }
    return entries;
  }

  DicomStack run() {
    DicomStack stack = orient(with_one_identity(without_localizers(chosen_of(read_headers()))));
    order(stack);
    if (options_.join) audit_join(stack, audit_);
    audit_counts(stack, audit_);
    keep_asked(stack);
    audit_stack(stack, audit_);
    return stack;
  }

 private:
  struct Series {
    std::vector<DicomSlice> members;
    std::vector<DicomSubseries> stacks;
    std::size_t number = 0;

    std::string choice(std::size_t stack) const {
      return std::to_string(number) + (stacks.size() == 1 ? "" : "." + std::to_string(stack + 1));
    }
  };

  void find(const char* check, Verdict verdict, std::string detail, std::vector<std::string> files = {}) {
    audit_.push_back({check, verdict, std::move(detail), std::move(files)});
  }

  struct SkippedFiles {
    std::vector<std::string> names, reasons;
    std::vector<std::string> series_uids;
  };
  using Skipped = std::map<NoSlice::Kind, SkippedFiles>;

  std::vector<DicomSlice> read_headers() {
    const FolderFiles folder = files_of(path_);
    const std::vector<fs::path>& files = folder.files;
    std::vector<std::variant<std::vector<DicomSlice>, NoSlice>> headers(files.size());
    for_each_index(files.size(), options_.progress,
                   [&](std::size_t i) { headers[i] = read_dicom_slices(files[i]); });
    std::vector<DicomSlice> found;
    Skipped& skipped = skipped_;
    const auto skip = [&](const std::string& name, const NoSlice& none) {
      skipped[none.kind].names.push_back(name);
      skipped[none.kind].reasons.push_back(name + " (" + none.reason + ")");
      skipped[none.kind].series_uids.push_back(none.series_uid);
    };
    for (std::size_t i = 0; i < files.size(); ++i) {
      const std::string name = name_of(files[i]);
      if (auto* slices = std::get_if<std::vector<DicomSlice>>(&headers[i])) {
        for (DicomSlice& slice : *slices) {
          slice.name = name + (slices->size() == 1 ? "" : " frame " + std::to_string(slice.frame + 1));
          found.push_back(std::move(slice));
        }
      } else {
        skip(name, std::get<NoSlice>(headers[i]));
      }
    }
    for (const fs::path& staged : folder.staged)
      skip(name_of(staged), {"files that another run did not finish or still writes"});
    if (found.empty() && !is_folder(path_) && is_directory_of_dicom(headers.front()))
      refuse(
          path_,
          "is a DICOM directory, which lists images but contains none: choose the folder in which it lies");
    if (found.empty() && !is_folder(path_))
      refuse(path_, "is not a readable scan: " + std::get<NoSlice>(headers.front()).reason +
                        "; scans are DICOM, .nii, .nii.gz, .nrrd, .nhdr, .mha and .mhd");
    if (const auto volume = std::find_if(
            files.begin(), files.end(), [](const fs::path& file) { return volume_format(file).has_value(); });
        found.empty() && volume != files.end())
      refuse(path_, "no DICOM slice in the folder or below; it holds " + name_of(*volume) +
                        ", which is read by its own path: " + volume->string());
    if (found.empty()) refuse_empty(files.size() + folder.staged.size(), skipped);
    return found;
  }

  static bool is_directory_of_dicom(const std::variant<std::vector<DicomSlice>, NoSlice>& header) {
    const auto* none = std::get_if<NoSlice>(&header);
    return none != nullptr && none->is_directory;
  }

  /// A file's name for messages: its path below the scan's folder.
  std::string name_of(const fs::path& file) const {
    return (is_folder(path_) ? file.lexically_relative(path_) : file.filename()).string();
  }

  [[noreturn]] void refuse_empty(std::size_t file_count, const Skipped& skipped) const {
    // Reports damaged and unusable images first, because they explain more than files that are not images.
    for (const auto kind : {NoSlice::Kind::Damaged, NoSlice::Kind::Unusable, NoSlice::Kind::Stray})
      if (const auto some = skipped.find(kind); some != skipped.end())
        refuse(path_, "no DICOM slice in the folder or below; " + std::to_string(file_count) +
                          (file_count == 1 ? " file, " : " files, among them ") +
                          listed(some->second.reasons, 3));
    refuse(path_, "no DICOM slice in the folder or below; it holds no files");
  }

  /// Reports files without a slice. If such a file belongs to the chosen series, the finding states that the
  /// series lacks it.
  void audit_skipped(const std::string& taken_uid) {
    const auto tell = [&](const char* check, NoSlice::Kind kind, Verdict verdict, const char* passed,
                          const char* what) {
      const auto some = skipped_.find(kind);
      if (some == skipped_.end()) return find(check, Verdict::Pass, passed);
      const std::size_t count = some->second.names.size();
      const auto& uids = some->second.series_uids;
      const auto own = kind == NoSlice::Kind::Unusable ? std::count(uids.begin(), uids.end(), taken_uid) : 0;
      find(check, own > 0 ? Verdict::Fail : verdict,
           std::to_string(count) + (count == 1 ? " file" : " files") + what +
               (own > 0 ? "(" + std::to_string(own) + " of the series taken, which lacks them) " : "") +
               listed(some->second.reasons),
           some->second.names);
    };
    tell("stray_files", NoSlice::Kind::Stray, Verdict::Warn, "every file is a DICOM image",
         " skipped that are not DICOM slices: ");
    tell("unusable_images", NoSlice::Kind::Unusable, Verdict::Warn, "none",
         " skipped whose images cannot be part of a volume: ");
    tell("damaged_files", NoSlice::Kind::Damaged, Verdict::Fail, "none",
         " left out that are damaged or cannot be read; copy them again: ");
  }

  /// Returns the slices of the series that choose() selects. The audit begins with lines about files without
  /// slices.
  std::vector<DicomSlice> chosen_of(std::vector<DicomSlice> found) {
    const auto before = static_cast<std::ptrdiff_t>(audit_.size());
    std::vector<DicomSlice> taken = choose(std::move(found));
    const auto middle = static_cast<std::ptrdiff_t>(audit_.size());
    audit_skipped(taken.front().series_uid);
    std::rotate(audit_.begin() + before, audit_.begin() + middle, audit_.end());
    return taken;
  }

  /// Slices by series, most slices first; equal counts in the order of their identifiers.
  std::vector<Series> by_series(std::vector<DicomSlice> found) const {
    std::map<std::string, Series> series;
    for (DicomSlice& slice : found) {
      const std::string uid = options_.join ? std::string() : slice.series_uid;
      series[uid].members.push_back(std::move(slice));
    }
    std::vector<Series> sorted;
    sorted.reserve(series.size());
    for (auto& [uid, one] : series) sorted.push_back(std::move(one));
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Series& a, const Series& b) { return a.members.size() > b.members.size(); });
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      sorted[i].number = i + 1;
      sorted[i].stacks = subseries_of(sorted[i].members, options_.join);
    }
    return sorted;
  }

  static std::string named(const std::vector<DicomSlice>& members) {
    const DicomSlice& first = members.front();
    return "'" + first.series_description + "' (" + first.modality + ", " + slices(members.size()) + ")";
  }

  /// "1 'Head' (CT, 40 slices); 2.1 'Head' (CT, 20 slices) kernel H60s".
  static std::string choices(const std::vector<Series>& all) {
    std::string list;
    for (const Series& series : all)
      for (std::size_t i = 0; i < series.stacks.size(); ++i)
        list += (list.empty() ? "" : "; ") + series.choice(i) + " " + named(series.stacks[i].slices) +
                (series.stacks[i].words.empty() ? "" : " " + series.stacks[i].words);
    return list;
  }

  /// "; choose by --series N of ...", or empty if there is only one series.
  std::string advice() const { return choice_count_ > 1 ? "; choose by --series N of " + choices_ : ""; }

  /// The requested series or stack, else the series with most slices.
  std::vector<DicomSlice> choose(std::vector<DicomSlice> found) {
    std::vector<Series> all = by_series(std::move(found));
    choices_ = choices(all);
    for (const Series& series : all) choice_count_ += series.stacks.size();
    const ChosenSeries wanted = options_.series.empty() ? ChosenSeries{} : asked(all);
    Series& taken = all[wanted.series];
    if (wanted.stack) {
      find("series", Verdict::Pass, "took " + taken.choice(*wanted.stack) + " of " + choices_);
      return std::move(taken.stacks[*wanted.stack].slices);
    }
    if (all.size() == 1) {
      find("series", Verdict::Pass, "one series: " + named(taken.members));
      return std::move(taken.members);
    }
    std::string others;
    std::size_t told = 0;
    for (const Series& series : all)
      if (series.number != taken.number && ++told <= 8)
        others +=
            (others.empty() ? "" : ", ") + std::to_string(series.number) + " " + named(series.members) +
            (is_of_one_patient(series.members.front(), taken.members.front()) ? "" : " of another patient");
    if (told > 8) others += " and " + std::to_string(told - 8) + " more";
    const Scattered scattered = scattered_of(all, taken);
    const bool is_scattered = options_.series.empty() && scattered.images > 0;
    find("series",
         is_scattered && scattered.images > taken.members.size() ? Verdict::Fail
         : options_.series.empty()                               ? Verdict::Warn
                                                                 : Verdict::Pass,
         std::to_string(all.size()) + " series: took " + std::to_string(taken.number) + " " +
             named(taken.members) + ", left " + others +
             (is_scattered ? print("; %zu images of %zu other series lie at other positions of the same "
                                   "stack: --join reads all as one series",
                                   scattered.images, scattered.series)
                           : std::string()) +
             (options_.series.empty() ? "; choose another by --series N" : ""));
    return std::move(taken.members);
  }

  /// Images of other series that may continue a series: of the same kind, at other positions.
  struct Scattered {
    std::size_t series = 0, images = 0;
  };
  Scattered scattered_of(const std::vector<Series>& all, const Series& taken) const {
    const DicomSlice& first = taken.members.front();
    const glm::dvec3 normal = glm::cross(first.along_row, first.along_column);
    double low_mm = glm::dot(first.first_mm, normal), high_mm = low_mm;
    for (const DicomSlice& slice : taken.members) {
      low_mm = std::min(low_mm, glm::dot(slice.first_mm, normal));
      high_mm = std::max(high_mm, glm::dot(slice.first_mm, normal));
    }
    Scattered scattered;
    for (const Series& series : all) {
      if (series.number == taken.number) continue;
      const bool continues =
          std::all_of(series.members.begin(), series.members.end(), [&](const DicomSlice& slice) {
            const double height_mm = glm::dot(slice.first_mm, normal);
            return !slice.is_localizer && same_grid(slice, first) && same_orientation(slice, first) &&
                   slice.modality == first.modality && is_of_one_patient(slice, first) &&
                   (height_mm < low_mm || height_mm > high_mm);
          });
      if (!continues) continue;
      ++scattered.series;
      scattered.images += series.members.size();
    }
    return scattered;
  }

  static bool is_of_one_patient(const DicomSlice& a, const DicomSlice& b) {
    Identity of_a = a.identity, of_b = b.identity;
    for (Identity* each : {&of_a, &of_b}) {
      each->study_uids.clear();
      each->frame_uids.clear();
    }
    return compared(of_a, of_b).differing.empty();
  }

  struct ChosenSeries {
    std::size_t series = 0;
    std::optional<std::size_t> stack = {};
  };

  /// The series or stack that the options name by number, identifier, description or attribute. Throws unless
  /// exactly one fits.
  ChosenSeries asked(const std::vector<Series>& all) const {
    const std::string& wanted = options_.series;
    std::vector<ChosenSeries> described, with_words;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const DicomSlice& first = all[i].members.front();
      if (wanted == std::to_string(i + 1) || wanted == first.series_uid) return {i};
      if (first.series_description.find(wanted) != std::string::npos) described.push_back({i});
      for (std::size_t stack = 0; stack < all[i].stacks.size(); ++stack) {
        if (all[i].stacks.size() > 1 && wanted == all[i].choice(stack)) return {i, stack};
        if (all[i].stacks[stack].words.find(wanted) != std::string::npos) with_words.push_back({i, stack});
      }
    }
    if (described.size() == 1) return described.front();
    if (described.empty() && with_words.size() == 1) return with_words.front();
    refuse(path_,
           (described.empty() && with_words.empty() ? "no series matches '" : "several series match '") +
               wanted + "'; choose by number: " + choices_);
  }

  /// Leaves out scout views, which some scanners put into the series of the scan.
  std::vector<DicomSlice> without_localizers(std::vector<DicomSlice> members) {
    const auto localizers = static_cast<std::size_t>(std::count_if(
        members.begin(), members.end(), [](const DicomSlice& slice) { return slice.is_localizer; }));
    if (localizers == 0) {
      find("localizers", Verdict::Pass, "none");
    } else if (localizers == members.size()) {
      find("localizers", Verdict::Fail, "every image is a localizer: this series is a scout view" + advice());
    } else {
      std::vector<std::string> names;
      for (const DicomSlice& slice : members)
        if (slice.is_localizer) names.push_back(slice.name);
      find("localizers", Verdict::Warn, slices(localizers) + " of scout views left out: " + listed(names),
           names);
      std::erase_if(members, [](const DicomSlice& slice) { return slice.is_localizer; });
    }
    return members;
  }

  /// Groups the slices by `alike` and keeps the largest group. A finding lists the other slices.
  void keep_commonest(const char* check, std::vector<DicomSlice>& members,
                      const std::function<bool(const DicomSlice&, const DicomSlice&)>& alike,
                      const std::function<std::string(const DicomSlice&)>& named) {
    std::vector<std::vector<DicomSlice>> kinds = grouped(std::move(members), alike);
    auto& most = *std::max_element(kinds.begin(), kinds.end(),
                                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
    const std::string taken = named(most.front());
    std::vector<std::string> left;
    for (const auto& kind : kinds)
      if (&kind != &most)
        for (const DicomSlice& slice : kind) left.push_back(slice.name);
    if (left.empty())
      find(check, Verdict::Pass, taken);
    else
      find(check, Verdict::Fail,
           "mixed in one series: kept " + slices(most.size()) + " of " + taken + ", left " +
               slices(left.size()) + ": " + listed(left) + advice(),
           left);
    members = std::vector<DicomSlice>(std::move(most));
  }

  /// Keeps the commonest patient, study, modality and frame of reference. An image without such an attribute
  /// counts as having the commonest value.
  std::vector<DicomSlice> with_one_identity(std::vector<DicomSlice> members) {
    for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait) {
      const bool is_joinable = dicom_traits[trait].role == TraitRole::Origin;
      if (dicom_traits[trait].role != TraitRole::Identity && !is_joinable) continue;
      if (is_joinable && options_.join) continue;
      std::map<std::string, std::size_t> counts;
      for (const DicomSlice& slice : members)
        if (!slice.traits[trait].empty()) ++counts[slice.traits[trait]];
      const bool is_rarely_stated = dicom_traits[trait].check == std::string("patient_issuer");
      if (counts.empty() && is_rarely_stated) continue;
      if (counts.size() < 2) {
        find(dicom_traits[trait].check, Verdict::Pass, "one in all slices");
        continue;
      }
      const std::string commonest =
          std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
            return a.second < b.second;
          })->first;
      const auto is_other = [&](const DicomSlice& slice) {
        return !slice.traits[trait].empty() && slice.traits[trait] != commonest;
      };
      std::vector<std::string> left;
      for (const DicomSlice& slice : members)
        if (is_other(slice)) left.push_back(slice.name);
      std::erase_if(members, is_other);
      find(dicom_traits[trait].check, Verdict::Fail,
           "one series holds " + std::string(dicom_traits[trait].effect) + ": kept " +
               slices(members.size()) + ", left out " + slices(left.size()) + ": " + listed(left) +
               (is_joinable ? "; if an export assigned several of them to the images of one scan, --join "
                              "keeps all images"
                            : ""),
           left);
    }
    return members;
  }

  /// If several stacks lie at the same positions, keeps the largest.
  void keep_one_stack(std::vector<DicomSlice>& members) {
    std::vector<DicomSubseries> stacks = parted_at_one_place(std::move(members));
    members = std::move(stacks.front().slices);
    if (stacks.size() == 1) return find("stacks", Verdict::Pass, "no two stacks at one place");
    std::string list = "took " + slices(members.size()) + ", " + stacks.front().words + "; left ";
    std::vector<std::string> left;
    for (std::size_t i = 1; i < stacks.size(); ++i) {
      list += (i == 1 ? "" : "; ") + slices(stacks[i].slices.size()) + ", " + stacks[i].words;
      for (const DicomSlice& slice : stacks[i].slices) left.push_back(slice.name);
    }
    find("stacks", Verdict::Fail,
         std::to_string(stacks.size()) + " stacks of one series lie at one place: " + list + ": " +
             listed(left) + advice(),
         left);
  }

  /// Keeps the slices that the options select.
  void keep_asked(DicomStack& stack) {
    if (options_.slices.empty()) return;
    const auto count = static_cast<int>(stack.slices.size());
    std::vector<bool> wanted(stack.slices.size(), false);
    for (const SliceRange& range : options_.slices) {
      if (range.first < 1 || range.last > count)
        refuse(path_,
               print("--slices %d:%d: the series has the slices 1:%d", range.first, range.last, count));
      std::fill(wanted.begin() + range.first - 1, wanted.begin() + range.last, true);
    }
    std::vector<DicomSlice> kept;
    for (std::size_t i = 0; i < wanted.size(); ++i)
      if (wanted[i]) kept.push_back(std::move(stack.slices[i]));
    stack.slices = std::move(kept);
    find("chosen_slices", Verdict::Pass,
         "kept " + std::to_string(stack.slices.size()) + " of " + std::to_string(count) +
             " slices, as --slices " + to_string(options_.slices) + " asks");
  }

  /// Places slices whose positions are all the same by SliceLocation, along the normal.
  void place_by_location(std::vector<DicomSlice>& members) {
    std::set<double> locations_mm;
    for (const DicomSlice& slice : members) {
      if (slice.first_mm != members.front().first_mm || !slice.location_mm) return;
      locations_mm.insert(*slice.location_mm);
    }
    if (members.size() < 2 || locations_mm.size() < members.size()) return;
    for (DicomSlice& slice : members) {
      slice.first_mm += *slice.location_mm * glm::normalize(glm::cross(slice.along_row, slice.along_column));
      slice.assumed_place = "SliceLocation along the normal, since every ImagePositionPatient is the same";
    }
  }

  DicomStack orient(std::vector<DicomSlice> members) {
    place_by_location(members);
    keep_commonest("size", members, same_grid, [](const DicomSlice& slice) {
      return print("%d x %d pixels of %.6g x %.6g mm", slice.size_px.x, slice.size_px.y, slice.spacing_mm.x,
                   slice.spacing_mm.y);
    });
    keep_commonest("orientation", members, same_orientation, [](const DicomSlice& slice) {
      const glm::dvec3 normal = glm::abs(glm::cross(slice.along_row, slice.along_column));
      const char* plane = normal.z >= normal.x && normal.z >= normal.y ? "axial"
                          : normal.y >= normal.x                       ? "coronal"
                                                                       : "sagittal";
      return print("%s slices, rows along (%.4g, %.4g, %.4g), columns along (%.4g, %.4g, %.4g) in LPS", plane,
                   slice.along_row.x + 0.0, slice.along_row.y + 0.0, slice.along_row.z + 0.0,
                   slice.along_column.x + 0.0, slice.along_column.y + 0.0, slice.along_column.z + 0.0);
    });
    DicomStack stack;
    keep_one_stack(members);
    stack.slices = std::move(members);
    take_mean_spacing(stack);
    make_perpendicular(stack);
    if (!stack.first().assumed_spacing.empty())
      find("pixel_spacing", Verdict::Warn,
           "PixelSpacing is absent; " + stack.first().assumed_spacing + " replaces it");
    if (!stack.first().pixels.states_sign)
      find("pixel_representation", Verdict::Warn,
           "PixelRepresentation is absent: samples are taken as unsigned. If samples below 0 appear as "
           "values above 32767, set the attribute to 1");
    return stack;
  }

  /// Pixel spacings that count as equal may differ in their last decimals. All slices get the mean.
  static void take_mean_spacing(DicomStack& stack) {
    glm::dvec2 sum(0.0);
    bool is_one = true;
    for (const DicomSlice& slice : stack.slices) {
      sum += slice.spacing_mm;
      is_one = is_one && slice.spacing_mm == stack.first().spacing_mm;
    }
    if (is_one) return;
    for (DicomSlice& slice : stack.slices) slice.spacing_mm = sum / static_cast<double>(stack.slices.size());
  }

  /// Returns the means of the slices' directions along rows and along columns. If all are equal, they have
  /// exactly the bits of the first slice. Warns if a slice is visibly turned from the mean.
  std::pair<glm::dvec3, glm::dvec3> mean_directions(const DicomStack& stack) {
    const DicomSlice& first = stack.first();
    glm::dvec3 along_row(0.0), along_column(0.0);
    bool is_one = true;
    for (const DicomSlice& slice : stack.slices) {
      along_row += slice.along_row / static_cast<double>(stack.slices.size());
      along_column += slice.along_column / static_cast<double>(stack.slices.size());
      is_one = is_one && slice.along_row == first.along_row && slice.along_column == first.along_column;
    }
    if (is_one) return {first.along_row, first.along_column};
    double most_px = 0.0;
    std::vector<std::string> turned;
    for (const DicomSlice& slice : stack.slices) {
      const double px = turned_px(slice, along_row, along_column);
      most_px = std::max(most_px, px);
      if (px > unseen_turn_px()) turned.push_back(slice.name);
    }
    // The audit already has a passing line on the orientation. This adds a line only if there is a doubt.
    if (!turned.empty())
      find("orientation_noise", Verdict::Warn,
           "directions differ from slice to slice, which moves pixels of " + slices(turned.size()) +
               print(" by up to %.2g of their width at the edge; the mean direction is taken: ", most_px) +
               listed(turned),
           turned);
    return {along_row, along_column};
  }

  void make_perpendicular(DicomStack& stack) {
    const auto [along_row, along_column] = mean_directions(stack);
    const double row = glm::length(along_row);
    const double column = glm::length(along_column);
    const double lean = glm::dot(along_row, along_column);
    const double length_error = std::max(std::abs(row - 1.0), std::abs(column - 1.0)),
                 error = std::max(std::abs(lean), std::min(length_error, two_decimals_error()));
    if (!(std::abs(lean) < two_decimals_error() && length_error < most_length_error))
      refuse(
          stack.first().path,
          print("ImageOrientationPatient is not two perpendicular unit vectors: they are %.4g and %.4g long "
                "and lean by %.3g degrees; correct the attribute",
                row, column,
                std::asin(std::clamp(lean / std::max(row * column, 1e-12), -1.0, 1.0)) * 180.0 /
                    3.14159265358979323846));
    if (length_error >= two_decimals_error())
      find("orientation_length", Verdict::Warn,
           print("the vectors of ImageOrientationPatient are %.4g and %.4g long, not 1: only their "
                 "directions are used, and PixelSpacing is unchanged",
                 row, column));
    else if (error >= 1e-3)
      find("orientation_rounded", Verdict::Warn,
           print("ImageOrientationPatient is accurate only to %.2g: directions may be wrong by %.2g degrees",
                 error, error * 180.0 / 3.14159265358979323846));
    stack.along_row = along_row / row;
    stack.along_column =
        glm::normalize(along_column - glm::dot(along_column, stack.along_row) * stack.along_row);
    // Adding zero turns -0, which some headers contain, into 0.
    stack.along_row += 0.0;
    stack.along_column += 0.0;
    stack.normal = glm::cross(stack.along_row, stack.along_column) + 0.0;
  }

  void order(DicomStack& stack) {
    // height_mm() counts from the first slice, but sorting changes the first slice. Therefore heights from
    // the origin are compared.
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
    // Less than the rounding of positions in any file.
    std::erase_if(gaps, [](double gap) { return gap < 1e-6; });
    double usual_gap_mm = 0.0;
    if (!gaps.empty()) {
      std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
      usual_gap_mm = gaps[gaps.size() / 2];
    }
    std::vector<DicomSlice> kept;
    std::vector<std::string> copies, renamed, rivals;
    for (DicomSlice& slice : stack.slices) {
      const bool repeats = !kept.empty() && glm::dot(slice.first_mm - kept.back().first_mm, stack.normal) <=
                                                repeat_tolerance_mm(usual_gap_mm);
      if (!repeats) {
        kept.push_back(std::move(slice));
        continue;
      }
      const bool same_uid = slice.instance_uid == kept.back().instance_uid;
      const bool recoded = slice.pixels.transfer_syntax != kept.back().pixels.transfer_syntax;
      if (same_pixels(slice, kept.back()) || (same_uid && recoded))
        (same_uid ? copies : renamed).push_back(slice.name);
      else
        rivals.push_back(slice.name);
    }
    stack.slices = std::move(kept);
    audit_repeated(copies, renamed, rivals);
    audit_identifiers(stack);
  }

  /// Reports images of different files with the same SOP Instance UID. Frames of one file share one UID.
  void audit_identifiers(const DicomStack& stack) {
    std::map<std::string, std::filesystem::path> file_of;
    std::vector<std::string> shared;
    for (const DicomSlice& slice : stack.slices)
      if (!slice.instance_uid.empty() &&
          file_of.emplace(slice.instance_uid, slice.path).first->second != slice.path)
        shared.push_back(slice.name);
    if (shared.empty()) return;
    find("instance_uids", Verdict::Warn,
         slices(shared.size()) +
             " with the SOP Instance UID of another image, which must be unique: references to it, such as "
             "those of a segmentation, are ambiguous: " +
             listed(shared),
         shared);
  }

  void audit_repeated(const std::vector<std::string>& copies, const std::vector<std::string>& renamed,
                      const std::vector<std::string>& rivals) {
    std::string told;
    std::vector<std::string> all;
    const auto tell = [&](const std::vector<std::string>& names, const char* what,
                          const std::string& advice) {
      if (names.empty()) return;
      told += (told.empty() ? "" : "; ") + slices(names.size()) + what + listed(names) + advice;
      all.insert(all.end(), names.begin(), names.end());
    };
    tell(rivals, " left out that are different images at positions already taken: ",
         "; the series holds several scans" + advice() +
             (choice_count_ > 1 ? ", or put each into a folder of its own"
                                : ": put each into a folder of its own"));
    tell(copies, " stored twice and left out: ", "");
    tell(renamed,
         " left out, because they have the pixels and the position of another image under a new identifier: ",
         "");
    const Verdict verdict = !rivals.empty() ? Verdict::Fail : !all.empty() ? Verdict::Warn : Verdict::Pass;
    find("duplicates", verdict, all.empty() ? "every slice has its own position" : told, all);
  }

  fs::path path_;
  const ReadOptions& options_;
  std::vector<Finding>& audit_;
  Skipped skipped_;
  std::size_t choice_count_ = 0;
  std::string choices_;  ///< list of all series and stacks, for findings and error messages
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

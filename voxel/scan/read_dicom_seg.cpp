// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Turns a segmentation (DICOM PS3.3, A.51) into a label map:
//   1 read the segments' numbers and labels, and each frame's segment and position
//   2 order the positions along the normal and lay a lattice through them
//   3 unpack each frame into its plane; where segments overlap, a further number represents all of them
#include "voxel/scan/read_dicom_seg.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>

#include "voxel/dicom/dicom_codec.h"
#include "voxel/dicom/dicom_file.h"
#include "voxel/dicom/identity.h"
#include "voxel/scan/label_overlaps.h"
#include "voxel/scan/slice_plan.h"
#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

constexpr const char* segmentation_storage = "1.2.840.10008.5.1.4.1.1.66.4";
/// Storage class of segmentations whose pixels are the numbers of segments.
constexpr const char* label_map_storage = "1.2.840.10008.5.1.4.1.1.66.7";

/// Positions may deviate by this share of the planes' distance and still count as even, with a warning. Two
/// planes that deviate towards each other still remain separate.
constexpr double jitter = 0.2;
/// Positions closer than this count as equal, because decimal strings are rounded.
constexpr double same_position_mm = 1e-4;

struct Frame {
  int segment = 0;
  double height_mm = 0.0;
  std::size_t number = 0;  ///< number of the frame in the file
};

class SegReader {
 public:
  SegReader(const fs::path& path, const DicomFile& file, const std::string& bytes)
      : path_(path), file_(file), bytes_(bytes) {}

  Scene run() {
    place();
    fill();
    scene_.meaning = Meaning::Label;
    return finished();
  }

  /// The fractions of one segment, from 0 to 1.
  Scene run_fractions(const std::string& segment) {
    place();
    fill_fractions(chosen(segment));
    scene_.meaning = Meaning::Raw;
    return finished();
  }

 private:
  void place() {
    read_image();
    read_segments();
    read_frames();
    lay();
  }

  Scene finished() {
    scene_.modality = "SEG";
    scene_.source = path_.string();
    scene_.identity = identity_of(file_);
    return std::move(scene_);
  }

  [[noreturn]] void refused(const std::string& reason) const { refuse(path_, "a segmentation " + reason); }

  void read_image() {
    rows_ = file_.unsigned_short(0x00280010).value_or(0);
    columns_ = file_.unsigned_short(0x00280011).value_or(0);
    bits_ = file_.unsigned_short(0x00280100).value_or(1);
    const std::string type = trimmed(file_.text(0x00620001));
    is_label_map_ = type == "LABELMAP";
    const bool fits = is_label_map_ ? bits_ == 8 || bits_ == 16 : bits_ == 1 || bits_ == 8;
    if (rows_ == 0 || columns_ == 0 || !fits)
      refused(is_label_map_ ? "without pixels of 8 or 16 bits" : "without pixels of 1 or 8 bits");
    if (!file_.raw_pixels() && !file_.fragments()) refused("without pixels");
    if (bits_ != 8 || is_label_map_) return;
    if (type == "BINARY") {
      least_ = 1;
      return;
    }
    most_fraction_ = file_.unsigned_short(0x0062000e).value_or(255);
    least_ = std::max(1, (most_fraction_ + 1) / 2);
  }

  void read_segments() {
    std::string list;
    for (const DicomFile& segment : file_.items(0x00620002)) {
      const int number = segment.unsigned_short(0x00620004).value_or(0);
      if (number < 1 && is_label_map_) continue;  // zero is the background of a label map
      if (number < 1) refused("with a segment that has no number");
      names_[number] = trimmed(segment.readable_text(0x00620005));
      list += (list.empty() ? "" : ", ") + std::to_string(number) + " '" + names_[number] + "'";
    }
    if (list.empty()) refused("without segments");
    scene_.audit.push_back({"segments", Verdict::Pass, list});
  }

  /// A decimal attribute from a frame's own functional groups or, if absent there, from the shared groups.
  static std::optional<std::vector<double>> group_decimals(const DicomFile* own, const DicomFile* shared,
                                                           DicomTag group, DicomTag tag) {
    for (const DicomFile* groups : {own, shared}) {
      if (groups == nullptr) continue;
      for (const DicomFile& item : groups->items(group))
        if (auto found = item.decimals(tag)) return found;
    }
    return std::nullopt;
  }

  void read_frames() {
    const std::vector<DicomFile> own = file_.items(0x52009230);
    const std::vector<DicomFile> shared = file_.items(0x52009229);
    const DicomFile* const common = shared.empty() ? nullptr : &shared.front();
    const std::size_t area = static_cast<std::size_t>(rows_) * columns_;
    if (!own.empty() && file_.fragments()) decompress_frames(own.size());
    if (own.empty()) refused("without frames");
    if (file_.raw_pixels())
      pixels_ = std::string_view(bytes_).substr(file_.raw_pixels()->at, file_.raw_pixels()->length);
    if (pixels_.size() * 8 / bits_ / area < own.size())
      refused("that is cut short: its frames hold fewer pixels than they claim");
    const auto measures = [&](DicomTag tag) { return group_decimals(&own[0], common, 0x00289110, tag); };
    const auto spacing = measures(0x00280030);
    if (!spacing || spacing->size() != 2 || !((*spacing)[0] > 0.0) || !((*spacing)[1] > 0.0))
      refused("without PixelSpacing");
    spacing_mm_ = {(*spacing)[1], (*spacing)[0]};
    const auto positive = [&](DicomTag tag) {
      const auto number = measures(tag);
      return number && number->front() > 0.0 ? std::optional(number->front()) : std::nullopt;
    };
    stated_step_mm_ = positive(0x00180088);
    thickness_mm_ = positive(0x00180050);
    for (std::size_t i = 0; i < own.size(); ++i) take_frame(own[i], common, i);
  }

  /// Decodes the frames one after the other. Refuses a header that states more pixels than any codec can pack
  /// into the file's bytes.
  void decompress_frames(std::size_t count) {
    const std::string& syntax = file_.transfer_syntax();
    if (bits_ == 1)
      refused("whose pixels of 1 bit are compressed (transfer syntax " + syntax +
              "): decompress it with another tool, such as gdcmconv --raw");
    const std::uint64_t each =
        std::uint64_t{bits_ / 8} * static_cast<std::uint64_t>(rows_) * static_cast<std::uint64_t>(columns_);
    constexpr std::uint64_t most_packed = 4096;
    if (each > most_packed * bytes_.size() / count)
      refused("that claims " + std::to_string(count) + " frames of " + std::to_string(columns_) + " x " +
              std::to_string(rows_) + " pixels, more than its bytes can hold: it is damaged");
    const auto parts = file_.frame_fragments(count);
    if (!parts)
      refused("whose compressed fragments cannot be assigned to frames: decompress it with another tool");
    for (std::size_t i = 0; i < count; ++i) {
      const auto bits = static_cast<unsigned>(bits_);
      CompressedFrame frame{
          syntax, static_cast<unsigned>(columns_), static_cast<unsigned>(rows_), bits, bits, bits - 1, false,
          {}};
      for (const DicomExtent& part : (*parts)[i]) frame.fragments.push_back(file_.at(part));
      const std::optional<std::string> decoded = decompress(frame);
      if (!decoded)
        refused("whose frame " + std::to_string(i + 1) + " in transfer syntax " + syntax +
                " cannot be decompressed: the file may be damaged; try to decompress it with another tool");
      decompressed_ += *decoded;
    }
    pixels_ = decompressed_;
  }

  void take_frame(const DicomFile& own, const DicomFile* shared, std::size_t number) {
    const auto position = group_decimals(&own, shared, 0x00209113, 0x00200032);
    const auto orientation = group_decimals(&own, shared, 0x00209116, 0x00200037);
    if (!position || position->size() != 3 || !orientation || orientation->size() != 6)
      refused("whose frame " + std::to_string(number + 1) + " has no position or orientation");
    const glm::dvec3 row((*orientation)[0], (*orientation)[1], (*orientation)[2]);
    const glm::dvec3 column((*orientation)[3], (*orientation)[4], (*orientation)[5]);
    const glm::dvec3 first((*position)[0], (*position)[1], (*position)[2]);
    if (frames_.empty()) {
      row_ = row;
      column_ = column;
      normal_ = glm::cross(row, column);
      if (std::abs(glm::length(row) - 1.0) > 1e-3 || std::abs(glm::length(column) - 1.0) > 1e-3 ||
          std::abs(glm::dot(row, column)) > 1e-3)
        refused("whose axes are not two perpendicular unit vectors");
      origin_mm_ = first;
    } else if (glm::distance(row, row_) > 1e-4 || glm::distance(column, column_) > 1e-4) {
      refused("whose frame " + std::to_string(number + 1) + " is turned against the first");
    }
    const glm::dvec3 offset = first - origin_mm_;
    const glm::dvec2 aside(glm::dot(offset, row_), glm::dot(offset, column_));
    if (glm::length(aside) > 0.02 * std::min(spacing_mm_.x, spacing_mm_.y))
      refused("whose frame " + std::to_string(number + 1) + " is shifted within its plane");
    int segment = 0;
    for (const DicomFile* groups : {&own, shared}) {
      if (groups == nullptr || segment != 0) continue;
      for (const DicomFile& item : groups->items(0x0062000a))
        segment = item.unsigned_short(0x0062000b).value_or(0);
    }
    if (segment < 1 && !is_label_map_)
      refused("whose frame " + std::to_string(number + 1) + " names no segment");
    frames_.push_back({segment, glm::dot(offset, normal_), number});
  }

  /// How well the frames fit evenly spaced planes with this distance.
  struct Fit {
    double step_mm = 0.0, low_mm = 0.0;
    double off_mm = 0.0;  ///< distance of `worst`, the frame farthest from its plane, from that plane
    Frame worst = {};
    bool is_distinct = true;  ///< no two planes coincide
    /// A single position errs by at most half as much as the difference of two positions.
    bool is_exact() const { return is_distinct && off_mm <= 0.5 * position_tolerance_mm(step_mm); }
    bool holds() const { return is_distinct && off_mm <= jitter * step_mm; }
  };

  Fit fit_of(double step_mm) const {
    const double first_mm = frames_.front().height_mm;
    const auto off_mm = [&](const Frame& frame) {
      return std::remainder(frame.height_mm - first_mm, step_mm);
    };
    double sum_mm = 0.0;
    for (const Frame& frame : frames_) sum_mm += off_mm(frame);
    const double mean_mm = sum_mm / static_cast<double>(frames_.size());
    Fit fit{step_mm, first_mm + mean_mm};
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (const double off = std::abs(off_mm(frames_[i]) - mean_mm); off > fit.off_mm) {
        fit.off_mm = off;
        fit.worst = frames_[i];
      }
      if (i > 0 && frames_[i].height_mm - frames_[i - 1].height_mm > same_plane_mm_ &&
          plane_of(frames_[i], fit) == plane_of(frames_[i - 1], fit))
        fit.is_distinct = false;
    }
    return fit;
  }

  static long plane_of(const Frame& frame, const Fit& fit) {
    return std::lround((frame.height_mm - fit.low_mm) / fit.step_mm);
  }

  /// The largest distance between frames that count as one plane: a share of the least distance between two
  /// frames of one segment or, if no segment has two, of the stated distance.
  double distance_in_plane_mm() const {
    double least_mm = std::numeric_limits<double>::infinity();
    std::map<int, double> last_mm;
    for (const Frame& frame : frames_) {
      const auto [last, is_first] = last_mm.try_emplace(frame.segment, frame.height_mm);
      if (const double gap_mm = frame.height_mm - last->second; !is_first && gap_mm > same_position_mm)
        least_mm = std::min(least_mm, gap_mm);
      last->second = frame.height_mm;
    }
    if (std::isfinite(least_mm)) return jitter * least_mm;
    return std::max(same_position_mm, jitter * stated_step_mm_.value_or(thickness_mm_.value_or(0.0)));
  }

  /// The distances between neighbouring planes, in ascending order.
  std::vector<double> gaps_mm() const {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < frames_.size(); ++i)
      if (const double gap = frames_[i].height_mm - frames_[i - 1].height_mm; gap > same_plane_mm_)
        gaps.push_back(gap);
    std::sort(gaps.begin(), gaps.end());
    return gaps;
  }

  /// Chooses the distance between planes: the stated one if the frames fit it, else the usual distance of
  /// neighbours, else, if none is stated, the least distance.
  Fit chosen_fit() {
    const std::vector<double> gaps = gaps_mm();
    if (gaps.empty()) {
      if (!stated_step_mm_ && !thickness_mm_)
        warn_spacing("all frames lie in one plane and the file states no thickness: taken as 1 mm");
      return fit_of(stated_step_mm_.value_or(thickness_mm_.value_or(1.0)));
    }
    const std::optional<Fit> stated =
        stated_step_mm_ ? std::optional(fit_of(*stated_step_mm_)) : std::nullopt;
    if (stated && stated->holds()) {
      if (gaps.front() > 1.5 * stated->step_mm)
        warn_spacing(
            print("the file states planes %.6g mm apart, and the nearest lie %.6g mm apart: the planes "
                  "between them are assumed to be empty",
                  stated->step_mm, gaps.front()));
      return *stated;
    }
    const double median_mm = gaps[gaps.size() / 2];
    double steps = 0.0;
    for (const double gap : gaps) steps += std::max(1.0, std::round(gap / median_mm));
    const Fit usual = fit_of((frames_.back().height_mm - frames_.front().height_mm) / steps);
    if (stated && !usual.is_exact()) return *stated;
    if (!usual.holds()) {
      warn_spacing(print("planes are taken as %.6g mm apart, the least distance, as the file states none",
                         gaps.front()));
      return fit_of(gaps.front());
    }
    if (stated)
      warn_spacing(
          print("the file states a distance of %.6g mm and its planes lie %.6g mm apart: the positions are "
                "used",
                *stated_step_mm_, usual.step_mm));
    return usual;
  }

  void warn_spacing(std::string detail) {
    scene_.audit.push_back({"slice_spacing", Verdict::Warn, std::move(detail)});
  }

  std::string place_of(const Frame& frame) const {
    const glm::dvec3 p = origin_mm_ + frame.height_mm * normal_;
    return "frame " + std::to_string(frame.number + 1) + print(" at (%.6g, %.6g, %.6g) mm", p.x, p.y, p.z);
  }

  void lay() {
    std::stable_sort(frames_.begin(), frames_.end(),
                     [](const Frame& a, const Frame& b) { return a.height_mm < b.height_mm; });
    same_plane_mm_ = distance_in_plane_mm();
    fit_ = chosen_fit();
    if (!fit_.holds())
      refused("whose planes are not evenly apart: " + place_of(fit_.worst) +
              print(" lies %.3g mm from the nearest of planes with a spacing of %.6g mm: write the "
                    "segmentation with evenly spaced frames, or as .nrrd on the lattice of its scan",
                    fit_.off_mm, fit_.step_mm));
    if (!fit_.is_exact())
      warn_spacing(print("planes lie up to %.3g mm from planes with a spacing of %.6g mm, most ", fit_.off_mm,
                         fit_.step_mm) +
                   place_of(fit_.worst) + ": they are treated as evenly spaced");
    const double planes = std::round((frames_.back().height_mm - fit_.low_mm) / fit_.step_mm) + 1.0;
    if (planes > 4.0 * static_cast<double>(frames_.size()) + 64.0)
      refused("whose planes are scattered: " + print("%.0f for %zu frames", planes, frames_.size()));
    // Headers state thickness and distance to two decimals or better.
    const double tolerance_mm = 0.02 + 0.01 * fit_.step_mm;
    if (planes > 1.0 && thickness_mm_ && *thickness_mm_ < fit_.step_mm - tolerance_mm)
      warn_spacing(
          print("planes of %.4g mm (SliceThickness) lie %.4g mm apart: the positions are used, so each plane "
                "represents %.4g mm of its segments. Nothing was drawn in %.3g mm of "
                "them; volumes are %.3g times those of the planes alone",
                *thickness_mm_, fit_.step_mm, fit_.step_mm, fit_.step_mm - *thickness_mm_,
                fit_.step_mm / *thickness_mm_));
    const glm::dvec3 first = origin_mm_ + fit_.low_mm * normal_;
    scene_.lattice = {
        {columns_, rows_, static_cast<int>(planes)},
        glm::dmat4(glm::dvec4(row_ * spacing_mm_.x, 0.0), glm::dvec4(column_ * spacing_mm_.y, 0.0),
                   glm::dvec4(normal_ * fit_.step_mm, 0.0), glm::dvec4(first, 1.0))};
  }

  /// The segment of a pixel; 0: none.
  int segment_at(const Frame& frame, std::size_t pixel) const {
    if (!is_label_map_) return is_inside(pixel) ? frame.segment : 0;
    const std::size_t at = pixel * bits_ / 8;
    const auto byte = [&](std::size_t i) { return int{static_cast<unsigned char>(pixels_[at + i])}; };
    if (bits_ == 8) return byte(0);
    return file_.big_endian() && decompressed_.empty() ? byte(0) * 256 + byte(1) : byte(1) * 256 + byte(0);
  }

  bool is_inside(std::size_t pixel) const {
    if (bits_ == 8) return static_cast<unsigned char>(pixels_[pixel]) >= least_;
    return ((pixels_[pixel / 8] >> (pixel % 8)) & 1) != 0;
  }

  /// The number of the segment with this label, or with this number if no label is equal.
  int chosen(const std::string& wanted) const {
    std::vector<int> named;
    std::string all;
    for (const auto& [number, name] : names_) {
      if (name == wanted) named.push_back(number);
      all += (all.empty() ? "" : ", ") + std::to_string(number) + " '" + name + "'";
    }
    if (named.size() == 1) return named.front();
    for (const auto& [number, name] : names_)
      if (std::to_string(number) == wanted) return number;
    refused("that has " + std::string(named.empty() ? "no segment" : "several segments") + " '" + wanted +
            "': choose its label or number, one of " + all);
  }

  /// The fraction of a pixel that belongs to segment `wanted`, from 0 to 1.
  float fraction_at(const Frame& frame, std::size_t pixel, int wanted) const {
    if (most_fraction_ == 0) return segment_at(frame, pixel) == wanted ? 1.0F : 0.0F;
    const int stored = static_cast<unsigned char>(pixels_[pixel]);
    return static_cast<float>(std::min(stored, most_fraction_)) / static_cast<float>(most_fraction_);
  }

  void fill_fractions(int wanted) {
    const std::size_t area = static_cast<std::size_t>(rows_) * columns_;
    FloatSamples samples(scene_.lattice.sample_count(), 0.0F);
    std::size_t partial = 0;
    for (const Frame& frame : frames_) {
      if (!is_label_map_ && frame.segment != wanted) continue;
      float* const plane = samples.data() + static_cast<std::size_t>(plane_of(frame, fit_)) * area;
      for (std::size_t i = 0; i < area; ++i) {
        plane[i] = std::max(plane[i], fraction_at(frame, frame.number * area + i, wanted));
        partial += plane[i] > 0.0F && plane[i] < 1.0F;
      }
    }
    scene_.samples = std::move(samples);
    const std::string what = "samples are the shares of the segment " + std::to_string(wanted) + " '" +
                             names_[wanted] + "', 0 to 1, " + std::to_string(partial) + " of them partial";
    const std::string kind = trimmed(file_.text(0x00620010));
    if (most_fraction_ > 0 && kind != "OCCUPANCY")
      scene_.audit.push_back({"fractions", Verdict::Warn,
                              what + ": the file states " + (kind.empty() ? "no type of fraction" : kind) +
                                  ", so they may not be shares of volume"});
    else
      scene_.audit.push_back({"fractions", Verdict::Pass, what});
  }

  /// Counts the pixels of a frame whose fractions are neither zero nor the maximum.
  void count_fractions(const Frame& frame, std::size_t area) {
    int& largest = largest_fractions_[frame.segment];
    for (const char pixel : pixels_.substr(frame.number * area, area)) {
      const int fraction = static_cast<unsigned char>(pixel);
      largest = std::max(largest, fraction);
      if (fraction > 0 && fraction < most_fraction_) ++(fraction < least_ ? rounded_down_ : rounded_up_);
    }
  }

  void fill() {
    int largest = names_.rbegin()->first;
    for (const Frame& frame : frames_) largest = std::max(largest, frame.segment);
    if (is_label_map_) largest = bits_ == 8 ? 255 : 65535;
    std::stable_sort(frames_.begin(), frames_.end(),
                     [](const Frame& a, const Frame& b) { return a.segment < b.segment; });
    // Labels in int16 use at most half of the positive numbers; the other half is reserved for overlaps.
    constexpr int most_of_int16 = 1 << 14;
    held_.resize(static_cast<std::size_t>(largest) + 1);
    LabelOverlaps overlaps(largest);
    largest <= most_of_int16 ? fill_as<std::int16_t>(overlaps, 2 * most_of_int16 - 1)
                             : fill_as<float>(overlaps, most_number);
    audit_segments();
  }

  /// Reports samples of segments that the file does not describe, and fractional segments that were cut at
  /// one half.
  void audit_segments() {
    std::vector<std::string> undescribed, below;
    for (std::size_t i = 1; i < held_.size(); ++i)
      if (held_[i] > 0 && !names_.contains(static_cast<int>(i)))
        undescribed.push_back(std::to_string(i) + " (" + std::to_string(held_[i]) + " samples)");
    if (!undescribed.empty())
      scene_.audit.push_back({"undescribed", Verdict::Warn,
                              "samples belong to segments that the file does not describe: " +
                                  listed(undescribed) + ": they have a number but no name"});
    if (rounded_down_ + rounded_up_ == 0) return;
    for (const auto& [segment, fraction] : largest_fractions_)
      if (fraction > 0 && fraction < least_)
        below.push_back(std::to_string(segment) + " (at most " + std::to_string(fraction) + ")");
    scene_.audit.push_back(
        {"fractions", Verdict::Warn,
         print(
             "a FRACTIONAL segmentation is cut at one half, %d of %d: %zu samples of less are left out, and "
             "%zu of more are whole",
             least_, most_fraction_, rounded_down_, rounded_up_) +
             (below.empty() ? "" : "; no sample reaches one half of segment " + listed(below)) +
             "; --series with a segment's label or number reads its fractions as samples from 0 to 1"});
  }

  template <typename Sample>
  void fill_as(LabelOverlaps& overlaps, int most) {
    const std::size_t area = static_cast<std::size_t>(rows_) * columns_;
    Samples<Sample> samples(scene_.lattice.sample_count(), Sample{0});
    std::map<int, std::size_t> counts;
    for (const Frame& frame : frames_) {
      const auto plane = static_cast<std::size_t>(plane_of(frame, fit_));
      if (most_fraction_ > 0) count_fractions(frame, area);
      for (std::size_t i = 0; i < area; ++i) {
        const int segment = segment_at(frame, frame.number * area + i);
        if (segment == 0) continue;
        ++held_[static_cast<std::size_t>(segment)];
        Sample& sample = samples[plane * area + i];
        if (sample == Sample{0}) {
          sample = static_cast<Sample>(segment);
          continue;
        }
        const int old = static_cast<int>(sample), number = overlaps.joined(old, segment);
        if (number == old) continue;
        if (overlaps.largest() > most) refused("whose segments overlap in too many combinations");
        sample = static_cast<Sample>(number);
        if (overlaps.all().contains(old)) --counts[old];
        ++counts[number];
      }
    }
    scene_.samples = std::move(samples);
    scene_.overlaps = overlaps.all();
    std::erase_if(scene_.overlaps, [&](const auto& each) { return counts[each.first] == 0; });
    if (!scene_.overlaps.empty())
      scene_.audit.push_back({"overlaps", Verdict::Warn, described(scene_.overlaps, counts, names_)});
  }

  const fs::path& path_;
  const DicomFile& file_;
  const std::string& bytes_;
  Scene scene_;
  std::map<int, std::string> names_;  ///< of the segments
  std::vector<Frame> frames_;
  int rows_ = 0, columns_ = 0;
  std::size_t bits_ = 1;
  bool is_label_map_ = false;
  std::string_view pixels_;        ///< pixels of all frames, one frame after the other
  std::string decompressed_ = {};  ///< memory of `pixels_` if the frames were compressed
  int least_ = 128;
  int most_fraction_ = 0;  ///< maximum of a fractional segmentation; 0 for others
  std::size_t rounded_down_ = 0, rounded_up_ = 0;
  std::map<int, int> largest_fractions_;  ///< by segment
  std::vector<std::size_t> held_;         ///< number of samples of each segment
  std::optional<double> stated_step_mm_, thickness_mm_;
  glm::dvec2 spacing_mm_{1.0};
  double same_plane_mm_ = 0.0;
  Fit fit_;
  glm::dvec3 row_{1, 0, 0}, column_{0, 1, 0}, normal_{0, 0, 1}, origin_mm_{0.0};
};

}  // namespace

bool is_dicom_seg(const fs::path& path) {
  // The storage class is among the first attributes, so the beginning of the file suffices.
  std::string bytes(4096, '\0');
  std::ifstream in = opened(path);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return DicomFile::begins(bytes) && (bytes.find(segmentation_storage) != std::string::npos ||
                                      bytes.find(label_map_storage) != std::string::npos);
}

namespace {

/// Reads the file of a segmentation and returns the scene that `read` makes from it.
template <typename Read>
Scene read_seg(const fs::path& path, const Read& read) {
  std::string stored = file_bytes(path);
  try {
    const std::string bytes = whole_dicom(std::move(stored));
    const DicomFile file(bytes, bytes.size(), true);
    return read(SegReader(path, file, bytes));
  } catch (const DicomFile::NeedsMore&) {
    refuse(path, "changed while it was read");
  } catch (const Error& error) {
    if (std::string(error.what()).find(path.string()) != std::string::npos) throw;
    refuse(path, error.what());
  }
}

}  // namespace

Scene read_dicom_seg(const fs::path& path) {
  return read_seg(path, [](SegReader&& reader) { return reader.run(); });
}

Scene read_dicom_fractions(const fs::path& path, const std::string& segment) {
  return read_seg(path, [&](SegReader&& reader) { return reader.run_fractions(segment); });
}

}  // namespace octotomy::voxel

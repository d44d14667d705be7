// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A segmentation (DICOM PS3.3, A.51) to a label map:
//   1  read the segments' numbers and labels, and each frame's segment and position
//   2  order the positions along the normal and lay a lattice through them
//   3  unpack each frame into its plane; where segments overlap, a number stands for all of them
#include "voxel/scan/read_dicom_seg.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "voxel/scan/audit.h"
#include "voxel/scan/dicom_file.h"
#include "voxel/scan/identity.h"
#include "voxel/scan/label_overlaps.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

constexpr const char* segmentation_storage = "1.2.840.10008.5.1.4.1.1.66.4";
/// Of segmentations whose pixels are the numbers of segments.
constexpr const char* label_map_storage = "1.2.840.10008.5.1.4.1.1.66.7";

struct Frame {
  int segment = 0;
  double height_mm = 0.0;
  std::size_t number = 0;  ///< in the file
};

class SegReader {
 public:
  SegReader(const fs::path& path, const DicomFile& file, const std::string& bytes)
      : path_(path), file_(file), bytes_(bytes) {}

  Scene run() {
    read_image();
    read_segments();
    read_frames();
    lay();
    fill();
    scene_.meaning = Meaning::Label;
    scene_.modality = "SEG";
    scene_.source = path_.string();
    scene_.identity = identity_of(file_);
    return std::move(scene_);
  }

 private:
  [[noreturn]] void refused(const std::string& reason) const { refuse(path_, "a segmentation " + reason); }

  void read_image() {
    rows_ = file_.unsigned_short(0x00280010).value_or(0);
    columns_ = file_.unsigned_short(0x00280011).value_or(0);
    bits_ = file_.unsigned_short(0x00280100).value_or(1);
    is_label_map_ = trimmed(file_.text(0x00620001)) == "LABELMAP";
    const bool fits = is_label_map_ ? bits_ == 8 || bits_ == 16 : bits_ == 1 || bits_ == 8;
    if (rows_ == 0 || columns_ == 0 || !fits)
      refused(is_label_map_ ? "without pixels of 8 or 16 bits" : "without pixels of 1 or 8 bits");
    if (!file_.raw_pixels()) refused("whose pixels are compressed or absent: decompress it first");
    if (bits_ == 8) least_ = (file_.unsigned_short(0x0062000e).value_or(255) + 1) / 2;
  }

  void read_segments() {
    std::string list;
    for (const DicomFile& segment : file_.items(0x00620002)) {
      const int number = segment.unsigned_short(0x00620004).value_or(0);
      if (number < 1 && is_label_map_) continue;  // its background
      if (number < 1) refused("with a segment that has no number");
      names_[number] = trimmed(segment.readable_text(0x00620005));
      list += (list.empty() ? "" : ", ") + std::to_string(number) + " '" + names_[number] + "'";
    }
    if (list.empty()) refused("without segments");
    scene_.audit.push_back({"segments", Verdict::Pass, list});
  }

  /// A decimal attribute of a frame's own or the shared functional groups.
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
    if (own.empty() || (file_.raw_pixels()->length * 8) / bits_ / area < own.size())
      refused("that is cut short: its frames hold fewer pixels than they claim");
    const auto measures = [&](DicomTag tag) { return group_decimals(&own[0], common, 0x00289110, tag); };
    const auto spacing = measures(0x00280030);
    if (!spacing || spacing->size() != 2 || !((*spacing)[0] > 0.0) || !((*spacing)[1] > 0.0))
      refused("without PixelSpacing");
    spacing_mm_ = {(*spacing)[1], (*spacing)[0]};
    for (const DicomTag tag : {DicomTag{0x00180088}, DicomTag{0x00180050}})
      if (const auto step = measures(tag); step_mm_ == 0.0 && step && step->front() > 0.0)
        step_mm_ = step->front();
    for (std::size_t i = 0; i < own.size(); ++i) take_frame(own[i], common, i);
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

  void lay() {
    std::set<double> heights;
    for (const Frame& frame : frames_) heights.insert(frame.height_mm);
    low_mm_ = *heights.begin();
    // The header's distance of planes, if the positions are multiples of it; else their least distance.
    double least_mm = 0.0;
    for (auto height = std::next(heights.begin()); height != heights.end(); ++height)
      if (const double gap = *height - *std::prev(height); gap > 1e-4)
        least_mm = least_mm == 0.0 ? gap : std::min(least_mm, gap);
    const auto fits = [&](double step_mm) {
      return step_mm > 0.0 && std::all_of(heights.begin(), heights.end(), [&](double height) {
               const double planes = (height - low_mm_) / step_mm;
               return std::abs(planes - std::round(planes)) < 0.02;
             });
    };
    if (!fits(step_mm_)) step_mm_ = least_mm;
    if (step_mm_ == 0.0) step_mm_ = 1.0;
    if (!fits(step_mm_)) refused("whose planes lie on no lattice");
    const double planes = std::round((*heights.rbegin() - low_mm_) / step_mm_) + 1.0;
    if (planes > 4.0 * static_cast<double>(frames_.size()) + 64.0)
      refused("whose planes are scattered: " + print("%.0f for %zu frames", planes, frames_.size()));
    const glm::dvec3 first = origin_mm_ + low_mm_ * normal_;
    scene_.lattice = {
        {columns_, rows_, static_cast<int>(planes)},
        glm::dmat4(glm::dvec4(row_ * spacing_mm_.x, 0.0), glm::dvec4(column_ * spacing_mm_.y, 0.0),
                   glm::dvec4(normal_ * step_mm_, 0.0), glm::dvec4(first, 1.0))};
  }

  /// The segment of a pixel; 0 is none.
  int segment_at(const Frame& frame, std::size_t pixel) const {
    if (!is_label_map_) return is_inside(pixel) ? frame.segment : 0;
    const std::size_t at = file_.raw_pixels()->at + pixel * bits_ / 8;
    const auto byte = [&](std::size_t i) { return int{static_cast<unsigned char>(bytes_[at + i])}; };
    if (bits_ == 8) return byte(0);
    return file_.big_endian() ? byte(0) * 256 + byte(1) : byte(1) * 256 + byte(0);
  }

  bool is_inside(std::size_t pixel) const {
    const std::size_t at = file_.raw_pixels()->at;
    if (bits_ == 8) return static_cast<unsigned char>(bytes_[at + pixel]) >= least_;
    return ((bytes_[at + pixel / 8] >> (pixel % 8)) & 1) != 0;
  }

  void fill() {
    int largest = names_.rbegin()->first;
    for (const Frame& frame : frames_) largest = std::max(largest, frame.segment);
    if (is_label_map_) largest = bits_ == 8 ? 255 : 65535;
    std::stable_sort(frames_.begin(), frames_.end(),
                     [](const Frame& a, const Frame& b) { return a.segment < b.segment; });
    // Half of int16's numbers are left for overlaps.
    constexpr int most_of_int16 = 1 << 14;
    LabelOverlaps overlaps(largest);
    largest <= most_of_int16 ? fill_as<std::int16_t>(overlaps, 2 * most_of_int16 - 1)
                             : fill_as<float>(overlaps, 1 << 24);
  }

  template <typename Sample>
  void fill_as(LabelOverlaps& overlaps, int most) {
    const std::size_t area = static_cast<std::size_t>(rows_) * columns_;
    Samples<Sample> samples(scene_.lattice.sample_count(), Sample{0});
    std::map<int, std::size_t> counts;
    for (const Frame& frame : frames_) {
      const auto plane = static_cast<std::size_t>(std::lround((frame.height_mm - low_mm_) / step_mm_));
      for (std::size_t i = 0; i < area; ++i) {
        const int segment = segment_at(frame, frame.number * area + i);
        if (segment == 0) continue;
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
  int least_ = 128;
  glm::dvec2 spacing_mm_{1.0};
  double step_mm_ = 0.0;
  double low_mm_ = 0.0;
  glm::dvec3 row_{1, 0, 0}, column_{0, 1, 0}, normal_{0, 0, 1}, origin_mm_{0.0};
};

}  // namespace

bool is_dicom_seg(const fs::path& path) {
  // The class stands among the first attributes.
  std::string bytes(4096, '\0');
  std::ifstream in = opened(path);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return DicomFile::begins(bytes) && (bytes.find(segmentation_storage) != std::string::npos ||
                                      bytes.find(label_map_storage) != std::string::npos);
}

Scene read_dicom_seg(const fs::path& path) {
  const std::string bytes = file_bytes(path);
  try {
    const DicomFile file(bytes, bytes.size());
    return SegReader(path, file, bytes).run();
  } catch (const DicomFile::Deflated&) {
    refuse(path, "a deflated segmentation: inflate it first");
  } catch (const DicomFile::NeedsMore&) {
    refuse(path, "changed while it was read");
  } catch (const Error& error) {
    if (std::string(error.what()).find(path.string()) != std::string::npos) throw;
    refuse(path, error.what());
  }
}

}  // namespace octotomy::voxel

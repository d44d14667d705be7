// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "voxel/scan/air_level.h"
#include "voxel/scan/label_names.h"
#include "voxel/scan/label_overlaps.h"
#include "voxel/scan/neighbour_audit.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/memory_need.h"
#include "voxel/space/printed.h"
#include "voxel/volume/sample_files.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

/// Whether the file's samples can be copied into the scene unchanged.
bool are_own(const SampleFiles& samples) {
  return samples.stored.type == SampleType::Int16 && !samples.stored.is_rescaled() &&
         samples.stored.big_endian == (std::endian::native == std::endian::big) &&
         (samples.encoding == SampleFiles::Encoding::Raw ||
          samples.encoding == SampleFiles::Encoding::Deflated);
}

bool passes_check(const Scene& scene) {
  try {
    check(scene);
    return true;
  } catch (const InvalidInput&) {
    return false;  // read_scene() reports the flaw after the samples have been checked
  }
}

/// Reads the scene's samples, and calls `slices_final` while doing so. Returns the number of bytes that
/// follow the samples.
std::uintmax_t read_slices(
    const Scene& scene, const SlicesFinal& slices_final,
    const std::function<std::uintmax_t(const std::function<void(std::uintmax_t)>&)>& read) {
  const std::uintmax_t slice_bytes =
      scene.lattice.sample_count() * sizeof(std::int16_t) / static_cast<std::size_t>(scene.lattice.dims.z);
  int told = 0;
  const auto tell = [&](int count) {
    told = count;
    slices_final(scene, count);
  };
  try {
    const std::uintmax_t behind = read([&](std::uintmax_t held) {
      if (const auto count = static_cast<int>(held / slice_bytes); count > told) tell(count);
    });
    tell(scene.lattice.dims.z);
    return behind;
  } catch (...) {
    tell(0);
    throw;
  }
}

SmallNumbers read_samples(const fs::path& path, const SampleFiles& from, const ReadOptions& options,
                          Scene& scene) {
  std::uintmax_t behind = 0;
  StoredSamples stored = from.stored;
  // Numbers in text are parsed to this machine's byte order.
  if (from.encoding == SampleFiles::Encoding::Text)
    stored.big_endian = std::endian::native == std::endian::big;
  const SmallNumbers small = take_stored(stored, scene, [&](char* memory, std::size_t bytes) {
    const auto read = [&](const std::function<void(std::uintmax_t)>& held) {
      return read_sample_files(path, from, memory, bytes, held);
    };
    const bool is_told = options.slices_final && are_own(from) && passes_check(scene);
    behind = is_told ? read_slices(scene, options.slices_final, read) : read({});
  });
  if (behind > 0)
    scene.audit.push_back({"samples", Verdict::Warn,
                           std::to_string(behind) +
                               " bytes follow the samples and were not read: compare the sizes, the type and "
                               "the offset of the samples in the header with the data"});
  return small;
}

/// A mask or label map with a header copied from a CT seems to contain Hounsfield units. Its stored numbers
/// reveal it: they are few and small and include 0.
bool is_mask(const SmallNumbers& small) {
  return small && small->test(0) && small->count() <= 64;
}

std::string listed_numbers(const std::bitset<256>& numbers) {
  std::vector<std::string> names;
  for (std::size_t number = 0; number < numbers.size(); ++number)
    if (numbers[number]) names.push_back(std::to_string(number));
  return listed(names);
}

std::optional<Meaning> meaning_of(const std::string& word) {
  if (word == "HU") return Meaning::Hounsfield;
  if (word == "raw") return Meaning::Raw;
  if (word == "label") return Meaning::Label;
  return std::nullopt;
}

Finding undescribed(const std::vector<std::string>& values) {
  return {"undescribed", Verdict::Warn,
          "samples have values that no segment of the file has: " + listed(values) +
              ": they have a number but no name"};
}

/// Merges the layers of a 3D Slicer segmentation to one label map. Where segments overlap, a further number
/// represents the set of their labels.
class LayerReader {
 public:
  LayerReader(const fs::path& path, const VolumeHeader& header, const std::vector<SlicerSegment>& segments)
      : path_(path), layers_(static_cast<std::size_t>(header.layers)) {
    for (const SlicerSegment& segment : segments) {
      number_of_[{segment.layer, segment.value}] = segment.number;
      names_[segment.number] = segment.name;
      largest_ = std::max(largest_, segment.number);
    }
    wide_.lattice.dims = header.geometry.dims;
    wide_.lattice.dims.x *= header.layers;
    need_room(path, wide_.lattice.sample_count(),
              bytes_of(header.samples.stored.type) + 2 * sizeof(std::int16_t));
    read_samples(path, header.samples, {}, wide_);
  }

  void fill(Scene& scene) {
    scene.audit.insert(scene.audit.end(), wide_.audit.begin(), wide_.audit.end());
    number_unlisted(scene);
    LabelOverlaps overlaps(largest_);
    // Labels in int16 use at most half of the positive numbers; the other half is reserved for overlaps.
    constexpr int most_of_int16 = 1 << 14;
    largest_ <= most_of_int16 ? fill_as<std::int16_t>(overlaps, 2 * most_of_int16 - 1, scene)
                              : fill_as<float>(overlaps, most_number, scene);
  }

 private:
  int value_at(std::size_t index) const {
    return std::visit(
        [&](const auto& samples) {
          const double value = samples[index];
          if (value > most_number)
            refuse(path_, print("has the label %.9g; the largest that can be read is %d: renumber the labels",
                                value, most_number));
          return value >= 0.5 ? static_cast<int>(std::lround(value)) : 0;
        },
        wide_.samples);
  }

  /// Assigns numbers above those of the listed segments to values that no segment has, and reports them.
  void number_unlisted(Scene& scene) {
    std::vector<std::string> unlisted;
    for (std::size_t i = 0; i < wide_.lattice.sample_count(); ++i)
      if (const int value = value_at(i); value != 0) {
        const auto layer = static_cast<int>(i % layers_);
        const auto [entry, is_new] = number_of_.try_emplace({layer, value}, 0);
        if (!is_new) continue;
        entry->second = ++largest_;
        unlisted.push_back(print("%d in layer %d (as number %d)", value, layer, largest_));
      }
    if (!unlisted.empty()) scene.audit.push_back(undescribed(unlisted));
  }

  template <typename Sample>
  void fill_as(LabelOverlaps& overlaps, int most, Scene& scene) {
    Samples<Sample> samples(scene.lattice.sample_count(), Sample{0});
    std::map<int, std::size_t> counts;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      int number = 0;
      for (std::size_t layer = 0; layer < layers_; ++layer)
        if (const int value = value_at(i * layers_ + layer); value != 0)
          number = overlaps.joined(number, number_of_.at({static_cast<int>(layer), value}));
      if (overlaps.largest() > most) refuse(path_, "its segments overlap in too many combinations");
      if (overlaps.all().contains(number)) ++counts[number];
      samples[i] = static_cast<Sample>(number);
    }
    scene.samples = std::move(samples);
    scene.overlaps = overlaps.all();
    std::erase_if(scene.overlaps, [&](const auto& each) { return counts[each.first] == 0; });
    if (!scene.overlaps.empty())
      scene.audit.push_back({"overlaps", Verdict::Warn, described(scene.overlaps, counts, names_)});
  }

  const fs::path& path_;
  std::size_t layers_;
  Scene wide_;
  std::map<std::pair<int, int>, int> number_of_;  ///< the label's number for each pair of layer and value
  std::map<int, std::string> names_;
  int largest_ = 0;
};

/// For a file with one layer, reports sample values that no segment has.
void audit_undescribed(const std::vector<SlicerSegment>& segments, Scene& scene) {
  std::map<double, std::size_t> counts{{0.0, 0}};
  for (const SlicerSegment& segment : segments) counts[segment.number] = 0;
  const std::size_t most = counts.size() + 100;
  std::visit(
      [&](const auto& samples) {
        auto last = counts.begin();
        for (const double value : samples) {
          if (last->first != value) {
            const auto found = counts.find(value);
            if (found == counts.end() && counts.size() == most) continue;
            last = found == counts.end() ? counts.emplace(value, 0).first : found;
          }
          ++last->second;
        }
      },
      scene.samples);
  counts.erase(0.0);
  for (const SlicerSegment& segment : segments) counts.erase(segment.number);
  std::vector<std::string> values;
  for (const auto& [value, count] : counts)
    values.push_back(print("%.9g (%zu %s)", value, count, count == 1 ? "sample" : "samples"));
  if (!values.empty()) scene.audit.push_back(undescribed(values));
}

/// Whether the file lists segments of 3D Slicer, so that its samples are their labels. Lists them in the
/// audit.
bool take_segments(const std::vector<SlicerSegment>& segments, Scene& scene) {
  std::string list;
  for (const SlicerSegment& segment : segments)
    list += (list.empty() ? "" : ", ") + std::to_string(segment.number) + " '" + segment.name + "'";
  if (list.empty()) return false;
  scene.meaning = Meaning::Label;
  scene.audit.push_back({"segments", Verdict::Pass, list});
  std::map<int, std::string> names;
  for (const SlicerSegment& segment : segments) {
    const auto [known, is_new] = names.try_emplace(segment.number, segment.name);
    if (!is_new)
      scene.audit.push_back({"segments", Verdict::Warn,
                             "'" + known->second + "' and '" + segment.name + "' both have the value " +
                                 std::to_string(segment.value) + " in layer " +
                                 std::to_string(segment.layer) +
                                 ": their samples cannot be distinguished, and they are read as one label"});
  }
  return true;
}

void take_meaning(const VolumeHeader& header, const SmallNumbers& small, Scene& scene) {
  scene.modality = header.modality;
  const std::optional<Meaning> stated = meaning_of(header.meaning);
  AirLevel air{stated.value_or(Meaning::Raw),
               {"unit", Verdict::Pass, "the file names its values' unit: " + header.meaning}};
  if (!stated && header.modality.empty()) air = air_level_of_unnamed(scene);
  if (!stated && header.modality == "CT") air = air_level_of_ct(scene);
  if (!stated && !header.modality.empty() && header.modality != "CT")
    air.finding = {"unit", Verdict::Pass,
                   "the file states the modality " + header.modality + ", whose values have no unit"};
  if (is_mask(small) && (air.meaning == Meaning::Hounsfield || (!stated && header.modality == "CT"))) {
    const bool is_rescaled = header.samples.stored.is_rescaled();
    air = {
        is_rescaled ? Meaning::Raw : Meaning::Label,
        {"unit", Verdict::Warn,
         "the stored numbers are few and small (" + listed_numbers(*small) +
             "), as in a mask or label map whose header was copied from a CT: " +
             (is_rescaled ? "the header's slope and intercept are applied, and values have no unit; if they "
                            "are a mask, take slope and intercept out of the header"
                          : "values are taken as labels, not as Hounsfield units")}};
  }
  scene.meaning = air.meaning;
  scene.audit.push_back(air.finding);
  if (air.meaning == Meaning::Label) return;
  const bool is_ct = header.modality == "CT" || air.meaning == Meaning::Hounsfield;
  if (auto sign = lost_sign_finding(scene, is_ct)) scene.audit.push_back(std::move(*sign));
}

/// Accepts the padding that the file states only if no sample is lower, because padding must be below every
/// measured sample.
void take_padding_below_all(std::optional<double> stated, Scene& scene) {
  if (!stated) return;
  // Samples that are not numbers have already become padding, below all others. Samples with the stated value
  // get that padding's value.
  if (scene.padding && range(scene).low == *stated)
    std::visit(
        [&](auto& samples) {
          using Sample = std::decay_t<decltype(samples.front())>;
          std::replace(samples.begin(), samples.end(), static_cast<Sample>(*stated),
                       static_cast<Sample>(*scene.padding));
        },
        scene.samples);
  if (scene.padding) return;
  const double least = std::visit(
      [](const auto& samples) {
        return static_cast<double>(*std::min_element(samples.begin(), samples.end()));
      },
      scene.samples);
  if (least == *stated) {
    scene.padding = stated;
    scene.audit.push_back({"padding", Verdict::Pass,
                           print("samples of %.9g are padding: the scanner measured nothing there", least)});
  } else if (least < *stated) {
    scene.audit.push_back({"padding", Verdict::Warn,
                           "some samples are below the padding that the file states, so it is not padding: "
                           "every sample counts as measured"});
  }
}

/// Compares a CT's slices with their neighbours, as for a DICOM series.
void audit_slices(Scene& scene) {
  const glm::ivec3& dims = scene.lattice.dims;
  std::vector<std::string> names;
  for (int k = 0; k < dims.z; ++k) names.push_back("slice " + std::to_string(k + 1));
  // Padding lies below every measured sample, and air is -1000.
  constexpr double floor = -1100.0;
  audit_neighbours(scene.samples, {dims.x, dims.y}, names, floor, scene.audit);
}

}  // namespace

Scene read_volume(const fs::path& path, VolumeFormat format, const ReadOptions& options) {
  const VolumeHeader header = read_volume_header(path, format);
  Scene scene;
  scene.source = path.string();
  scene.lattice = placed(header.geometry, options.frame, options.unit, scene.audit);
  scene.audit.insert(scene.audit.end(), header.audit.begin(), header.audit.end());
  if (!scene.lattice.right_handed())
    scene.audit.push_back(
        {"handedness", Verdict::Pass, "voxel axes are left-handed; positions allow for it"});
  const std::vector<SlicerSegment> segments =
      format == VolumeFormat::Nrrd ? slicer_segments(path) : std::vector<SlicerSegment>{};
  if (header.layers > 1) {
    LayerReader(path, header, segments).fill(scene);
    take_segments(segments, scene);
    return scene;
  }
  need_room(path, scene.lattice.sample_count(),
            are_own(header.samples) ? sizeof(std::int16_t)
                                    : bytes_of(header.samples.stored.type) + sizeof(std::int16_t));
  const SmallNumbers small = read_samples(path, header.samples, options, scene);
  take_padding_below_all(header.padding, scene);
  if (take_segments(segments, scene))
    audit_undescribed(segments, scene);
  else
    take_meaning(header, small, scene);
  if (scene.meaning != Meaning::Hounsfield) return scene;
  take_unstated_padding(scene);
  audit_slices(scene);
  return scene;
}

}  // namespace octotomy::voxel

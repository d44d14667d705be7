// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_volume.h"

#include <bit>
#include <stdexcept>

#include "voxel/scan/air_level.h"
#include "voxel/scan/audit.h"
#include "voxel/space/file_text.h"
#include "voxel/space/memory_need.h"
#include "voxel/volume/sample_files.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

/// Whether the samples are the scene's as they stand in the file.
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
  } catch (const std::invalid_argument&) {
    return false;  // read_scene() says so when the samples are known to be sound
  }
}

/// Tells of slices while the scene's own samples are read. Returns the bytes behind the samples.
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
  // Numbers of text are parsed into this machine's order.
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
    scene.audit.push_back(
        {"samples", Verdict::Warn,
         std::to_string(behind) +
             " bytes stand behind the samples and were not read: compare the sizes, the type and "
             "the offset of the samples in the header with the data"});
  return small;
}

/// A mask or label map whose header was copied from a CT says, or would be taken to say, that it holds
/// Hounsfield units: of masks the stored numbers are few and small, 0 among them.
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

void take_meaning(const VolumeHeader& header, const SmallNumbers& small, Scene& scene) {
  scene.modality = header.modality;
  const std::optional<Meaning> stated = meaning_of(header.meaning);
  AirLevel air{stated.value_or(Meaning::Raw),
               {"unit", Verdict::Pass, "the file names its values' unit: " + header.meaning}};
  if (!stated) air = header.modality == "CT" ? air_level_of_ct(scene) : air_level_of_unnamed(scene);
  if (is_mask(small) && (air.meaning == Meaning::Hounsfield || (!stated && header.modality == "CT"))) {
    const bool is_rescaled = header.samples.stored.is_rescaled();
    air = {is_rescaled ? Meaning::Raw : Meaning::Label,
           {"unit", Verdict::Warn,
            "the stored numbers are few and small (" + listed_numbers(*small) +
                "), as in a mask or label map whose header was copied from a CT: values are taken as " +
                (is_rescaled ? "raw" : "labels") + ", not as Hounsfield units"}};
  }
  scene.meaning = air.meaning;
  scene.audit.push_back(air.finding);
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
  need_memory(path, scene.lattice.sample_count(),
              are_own(header.samples) ? sizeof(std::int16_t)
                                      : bytes_of(header.samples.stored.type) + sizeof(std::int16_t));
  const SmallNumbers small = read_samples(path, header.samples, options, scene);
  take_meaning(header, small, scene);
  return scene;
}

}  // namespace octotomy::voxel

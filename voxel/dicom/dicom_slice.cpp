// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Turns a header into slices, attribute by attribute. Each attribute that a volume needs may be absent, wrong
// or stored elsewhere, in ways of its own.
#include "voxel/dicom/dicom_slice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "voxel/dicom/character_set.h"
#include "voxel/dicom/dicom_frames.h"
#include "voxel/dicom/dicom_pixel_parts.h"
#include "voxel/dicom/identity.h"
#include "voxel/dicom/inflate.h"
#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"

namespace octotomy::voxel {

namespace {

constexpr DicomTag shared_groups_tag = 0x52009229;
constexpr DicomTag frame_groups_tag = 0x52009230;

/// Attributes of a slice by tag. The attributes of a frame are searched in its own functional groups, then in
/// the shared ones, then in the file (DICOM PS3.3, C.7.6.16).
class Attributes {
 public:
  explicit Attributes(const DicomFile& file) : file_(&file) {}
  Attributes(const DicomFile& file, const DicomFile* shared, const DicomFile* own) : file_(&file) {
    for (const DicomFile* groups : {own, shared}) {
      if (groups == nullptr) continue;
      for (const DicomTag group :
           {DicomTag{0x00209113}, DicomTag{0x00209116}, DicomTag{0x00289110}, DicomTag{0x00289145},
            DicomTag{0x00209111}, DicomTag{0x00189314}, DicomTag{0x00189325}, DicomTag{0x00189341},
            DicomTag{0x00189117}, DicomTag{0x00189118}, DicomTag{0x00209253}})
        for (DicomFile& item : groups->items(group)) groups_.push_back(std::move(item));
    }
  }
  /// Adds an item whose attributes apply to this frame and take precedence over those of the file.
  void add(const DicomFile& item) { groups_.push_back(item); }

  std::string text(DicomTag tag) const {
    return first<std::string>([&](const DicomFile& from) {
             std::string found = from.readable_text(tag);
             return found.empty() ? std::nullopt : std::optional(std::move(found));
           })
        .value_or("");
  }
  /// A trait's value as a text, also for a trait that is stored as a binary number.
  std::string trait(DicomTag tag) const {
    const auto wide = [&] {
      return first<double>([&](const DicomFile& from) { return from.float_double(tag); });
    };
    const auto word = [&] {
      return first<std::uint32_t>([&](const DicomFile& from) { return from.unsigned_long(tag); });
    };
    if (tag == 0x00189087)  // VR FD
      return wide() ? print("%g", *wide()) : std::string();
    if (tag == 0x00209128)  // VR UL
      return word() ? std::to_string(*word()) : std::string();
    const std::string found = text(tag);
    // VR FL is a binary float, which some writers store as a decimal string. The bytes of a binary float,
    // such as 0, are not digits, so both can be distinguished.
    if ((tag == 0x00209241 || tag == 0x00209245) && word() &&
        (found.empty() || found.find_first_not_of("0123456789.+- ") != std::string::npos))
      return print("%g", static_cast<double>(std::bit_cast<float>(*word())));
    return found;
  }
  bool has_decimal_comma(DicomTag tag) const {
    return std::any_of(groups_.begin(), groups_.end(),
                       [&](const DicomFile& group) { return group.has_decimal_comma(tag); }) ||
           file_->has_decimal_comma(tag);
  }
  std::optional<std::vector<double>> decimals(DicomTag tag) const {
    return first<std::vector<double>>([&](const DicomFile& from) { return from.decimals(tag); });
  }
  std::optional<double> decimal(DicomTag tag) const {
    return first<double>([&](const DicomFile& from) { return from.decimal(tag); });
  }

 private:
  template <typename Value, typename Ask>
  std::optional<Value> first(const Ask& ask) const {
    for (const DicomFile& group : groups_)
      if (std::optional<Value> found = ask(group)) return found;
    return ask(*file_);
  }

  const DicomFile* file_;
  std::vector<DicomFile> groups_;
};

/// Whether every value that the pixels can hold is finite in single precision after the rescale.
bool is_rescale_finite(const DicomSlice& slice) {
  const double largest_stored = std::ldexp(1.0, static_cast<int>(slice.pixels.stored));
  return std::abs(slice.slope.value_or(1.0)) * largest_stored + std::abs(slice.intercept.value_or(0.0)) <=
         static_cast<double>(std::numeric_limits<float>::max());
}

struct NamedTag {
  DicomTag tag;
  const char* name;
  bool is_needed;  ///< without this value the position or the samples of an image are unknown
};
constexpr std::array<NamedTag, 10> decimal_tags{{{0x00200032, "ImagePositionPatient", true},
                                                 {0x00200037, "ImageOrientationPatient", true},
                                                 {0x00280030, "PixelSpacing", true},
                                                 {0x00181164, "ImagerPixelSpacing", false},
                                                 {0x00281052, "RescaleIntercept", true},
                                                 {0x00281053, "RescaleSlope", true},
                                                 {0x00180050, "SliceThickness", false},
                                                 {0x00180088, "SpacingBetweenSlices", false},
                                                 {0x00181120, "GantryDetectorTilt", false},
                                                 {0x3004000c, "GridFrameOffsetVector", true}}};

/// The reason if a needed attribute exists but contains no numbers. Such an attribute is not treated as
/// absent, because that would change positions or values.
std::optional<NoSlice> unreadable_number(const Attributes& attributes) {
  for (const NamedTag& named : decimal_tags) {
    const std::string text = attributes.text(named.tag);
    if (named.is_needed && !text.empty() && !attributes.decimals(named.tag))
      return NoSlice{std::string("an image whose ") + named.name + " '" + text.substr(0, 60) +
                         "' is not a number; correct the attribute",
                     NoSlice::Kind::Unusable};
  }
  return std::nullopt;
}

std::string decimal_commas_of(const Attributes& attributes) {
  std::string names;
  for (const NamedTag& named : decimal_tags)
    if (attributes.has_decimal_comma(named.tag) && attributes.decimals(named.tag))
      names += (names.empty() ? "" : ", ") + std::string(named.name);
  return names;
}

/// Sets the slice's geometry. Returns the reason if the header states none or an impossible one.
std::optional<NoSlice> take_geometry(const Attributes& attributes, std::size_t frame_count,
                                     DicomSlice& slice) {
  constexpr auto unusable = NoSlice::Kind::Unusable;
  if (auto flaw = unreadable_number(attributes)) return flaw;
  const auto are_within = [](const std::vector<double>& numbers, double low, double high) {
    return std::all_of(numbers.begin(), numbers.end(), [&](double x) { return x >= low && x <= high; });
  };
  auto position = attributes.decimals(0x00200032);
  auto orientation = attributes.decimals(0x00200037);
  if (!position && !orientation) {
    position = attributes.decimals(0x00200030);
    orientation = attributes.decimals(0x00200035);
    slice.position_of_acr_nema = position && orientation;
  }
  // Some writers store the positions of all frames in one attribute.
  if (position && frame_count > 1 && position->size() == 3 * frame_count) {
    const auto own = position->begin() + 3 * slice.frame;
    position = std::vector<double>(own, own + 3);
  }
  if (!orientation || orientation->size() != 6)
    return NoSlice{
        "an image without ImageOrientationPatient: add it, or read the pixels by --raw with --spacing",
        unusable};
  if (const auto location_mm = attributes.decimal(0x00201041); !position && location_mm && frame_count == 1) {
    const glm::dvec3 row((*orientation)[0], (*orientation)[1], (*orientation)[2]),
        column((*orientation)[3], (*orientation)[4], (*orientation)[5]), normal = glm::cross(row, column);
    const glm::dvec3 p = *location_mm / std::max(glm::length(normal), 1e-3) * normal;
    position = {p.x, p.y, p.z};
    slice.assumed_place = "SliceLocation along the normal, since ImagePositionPatient is absent";
  }
  if (!position || position->size() != 3)
    return NoSlice{
        "an image without ImagePositionPatient: add it, or read the pixels by --raw with --spacing",
        unusable};
  auto spacing = attributes.decimals(0x00280030);
  for (const auto& [tag, name] :
       {std::pair{DicomTag{0x00181164}, "ImagerPixelSpacing, measured at the detector,"},
        std::pair{DicomTag{0x00182010}, "NominalScannedPixelSpacing, of the film that was scanned,"}})
    if (!spacing) {
      spacing = attributes.decimals(tag);
      slice.assumed_spacing = name;
    }
  if (spacing && spacing->size() != 2)
    return NoSlice{"an image whose PixelSpacing has " + std::to_string(spacing->size()) +
                       " values instead of two, the distances between rows and between columns",
                   unusable};
  if (!spacing)
    return NoSlice{"an image without PixelSpacing: add it, or read the pixels by --raw with --spacing",
                   unusable};
  if (!are_within(*spacing, 1e-6, 1e6))  // outside the range of any scanner or microscope
    return NoSlice{"an image whose PixelSpacing is not 1e-6 to 1e6 mm", unusable};
  if (!are_within(*position, -1e9, 1e9))  // up to this distance doubles resolve 1e-7 mm
    return NoSlice{"an image whose ImagePositionPatient is beyond 1e9 mm", unusable};
  if (!are_within(*orientation, -1.1, 1.1))  // the same tolerance as for the directions of a stack
    return NoSlice{"an image whose ImageOrientationPatient is not two unit vectors", unusable};
  slice.first_mm = {(*position)[0], (*position)[1], (*position)[2]};
  slice.along_row = {(*orientation)[0], (*orientation)[1], (*orientation)[2]};
  slice.along_column = {(*orientation)[3], (*orientation)[4], (*orientation)[5]};
  slice.spacing_mm = {(*spacing)[1], (*spacing)[0]};  // the attribute states the distance between rows first
  slice.thickness_mm = attributes.decimal(0x00180050);
  slice.spacing_tag_mm = attributes.decimal(0x00180088);
  slice.tilt_deg = attributes.decimal(0x00181120);
  return std::nullopt;
}

/// The range from PixelPaddingValue to PixelPaddingRangeLimit, or the single value if there is no limit.
std::optional<DicomPadding> padding_of(const DicomFile& file, const DicomPixels& pixels) {
  const auto stored = [&](DicomTag tag) -> std::optional<double> {
    const auto word = file.unsigned_short(tag);
    if (!word) return std::nullopt;
    return pixels.is_signed ? static_cast<double>(static_cast<std::int16_t>(*word))
                            : static_cast<double>(*word);
  };
  const auto value = stored(0x00280120);
  if (!value) return std::nullopt;
  const double limit = stored(0x00280121).value_or(*value);
  return DicomPadding{std::min(*value, limit), std::max(*value, limit)};
}

/// Sets the slice's Modality LUT if the file has one. Returns the reason if the table is damaged.
std::optional<NoSlice> take_lut(const DicomFile& file, DicomSlice& slice) {
  const std::vector<DicomFile> items = file.items(0x00283000);
  if (items.empty()) return std::nullopt;
  const std::vector<std::uint16_t> descriptor = items.front().unsigned_shorts(0x00283002);
  const std::size_t held = items.front().length(0x00283006).value_or(0);
  const NoSlice damaged{
      "an image whose Modality LUT has not the number of entries that its descriptor states",
      NoSlice::Kind::Unusable};
  if (descriptor.size() != 3) return damaged;
  const std::size_t count = descriptor[0] == 0 ? 65536 : descriptor[0];
  auto lut = std::make_shared<ModalityLut>();
  lut->first = slice.pixels.is_signed ? static_cast<std::int16_t>(descriptor[1]) : descriptor[1];
  lut->type = items.front().readable_text(0x00283004);
  std::vector<std::uint16_t> words = items.front().unsigned_shorts(0x00283006);
  const bool is_byte_each = descriptor[2] <= 8 && held >= count && held < 2 * count;
  if (is_byte_each && !file.big_endian())
    for (const std::uint16_t word : words) {
      lut->values.push_back(word & 0xff);
      lut->values.push_back(word >> 8);
    }
  else if (descriptor[2] <= 8)
    for (const std::uint16_t word : words) lut->values.push_back(word & 0xff);
  else
    lut->values = std::move(words);
  if (is_byte_each && held % 2 != 0) lut->values.push_back(lut->values.back());
  if (lut->values.size() < count) return damaged;
  lut->values.resize(count);
  slice.lut = std::move(lut);
  return std::nullopt;
}

/// The real-world mappings of the frame; if the frame has none, the mappings shared by all frames; if there
/// are none either, the mappings of the file.
std::vector<RealWorldMapping> real_world_of(const DicomFile& file, const DicomFile* own,
                                            const DicomFile* shared, bool is_signed) {
  std::vector<RealWorldMapping> found;
  for (const DicomFile* from : {own, shared, &file}) {
    if (from == nullptr || !found.empty()) continue;
    for (const DicomFile& item : from->items(0x00409096)) {
      const auto stored = [&](DicomTag tag, DicomTag wide) -> std::optional<double> {
        if (const auto number = item.float_double(wide)) return number;
        const auto word = item.unsigned_short(tag);
        if (!word) return std::nullopt;
        return is_signed ? static_cast<std::int16_t>(*word) : static_cast<double>(*word);
      };
      RealWorldMapping& mapping = found.emplace_back();
      mapping.slope = item.float_double(0x00409225);
      mapping.intercept = item.float_double(0x00409224);
      mapping.first = stored(0x00409216, 0x00409214);
      mapping.last = stored(0x00409211, 0x00409213);
      for (const DicomFile& unit : item.items(0x004008ea)) mapping.unit = unit.readable_text(0x00080100);
    }
  }
  return found;
}

/// The value of an unsigned two-byte attribute; 0 if the attribute is absent.
int stated_short(const DicomFile& file, DicomTag tag) {
  return file.unsigned_short(tag).value_or(0);
}

/// Statements in the header that cast doubt on the pixels as measurements of a person; empty if there are
/// none.
std::string doubts_of(const DicomFile& file) {
  std::string doubts;
  const auto add = [&](const std::string& doubt) { doubts += (doubts.empty() ? "" : "; ") + doubt; };
  std::string kinds = file.text(0x00080008) + "\\" + file.text(0x00089207);
  for (const DicomTag groups : {shared_groups_tag, frame_groups_tag})
    for (const DicomFile& group : file.items(groups))
      for (const DicomTag type : {DicomTag{0x00189329}, DicomTag{0x00189226}, DicomTag{0x00189341}})
        for (const DicomFile& item : group.items(type))
          kinds += "\\" + item.text(0x00089007) + "\\" + item.text(0x00089207);
  kinds += "\\";
  for (const char* kind : {"MIP", "MAX_IP", "MIN_IP", "MINIP", "PROJECTION IMAGE"})
    if (kinds.find("\\" + std::string(kind) + "\\") != std::string::npos)
      add(std::string("ImageType or FrameType ") + kind +
          ": a projection through several slices, in which bone appears too thick");
  if (const std::string name = file.text(0x00100010), set = file.text(character_set_tag);
      !utf8_of(set, name) && std::any_of(name.begin(), name.end(), [](char c) { return (c & 0x80) != 0; }))
    add("SpecificCharacterSet '" + set + "' cannot represent the patient's name: its letters are shown as ?");
  if (file.text(0x00280301) == "YES") add("BurnedInAnnotation YES: letters in the pixels look like bone");
  if (file.text(0x20500020) == "INVERSE")
    add("PresentationLUTShape INVERSE: the stored values may be inverted");
  if (file.text(0x00102210) == "QUADRUPED")
    add("AnatomicalOrientationType QUADRUPED: left, front and head are those of an animal on four feet");
  return doubts;
}

/// CT Image, Enhanced CT Image and Legacy Converted Enhanced CT Image (DICOM PS3.4, B.5).
bool is_ct_class(const std::string& class_uid) {
  return class_uid == "1.2.840.10008.5.1.4.1.1.2" || class_uid == "1.2.840.10008.5.1.4.1.1.2.1" ||
         class_uid == "1.2.840.10008.5.1.4.1.1.2.2";
}

/// Reads the part of the header that all frames of a file share. Returns the reason if the file contains no
/// slice.
std::variant<DicomSlice, NoSlice> common_of(const DicomFile& file, const std::filesystem::path& path) {
  if (file.text(0x00020002) == "1.2.840.10008.1.3.10")
    return NoSlice{"a DICOM directory", NoSlice::Kind::Stray, true};
  DicomSlice slice;
  slice.path = path;
  const auto rows = file.unsigned_short(0x00280010);
  const auto columns = file.unsigned_short(0x00280011);
  if (!rows || !columns || *rows == 0 || *columns == 0) return NoSlice{"DICOM without an image"};
  slice.size_px = {*columns, *rows};
  constexpr auto unusable = NoSlice::Kind::Unusable;
  if (file.length(0x7fe00008) || file.length(0x7fe00009))
    return NoSlice{
        "pixels of floating point, which octotomy cannot decode: convert the file to NIfTI or NRRD",
        unusable};
  if (file.unsigned_short(0x00280002).value_or(1) != 1) return NoSlice{"a colour image", unusable};
  const std::string photometric = file.readable_text(0x00280004);
  if (!photometric.empty() && !photometric.starts_with("MONOCHROME"))
    return NoSlice{"pixels in " + photometric + ", whose values are not measurements", unusable};
  if (file.text(0x00080008).find("MOSAIC") != std::string::npos)
    return NoSlice{"a mosaic, which shows many slices in one picture; export the slices as single images",
                   unusable};
  slice.pixels = pixels_of(file);
  if (!is_sound(slice.pixels))
    return NoSlice{print("pixels of %u bits, of which %u are stored and bit %u is the highest: these numbers "
                         "contradict each other, or the pixels do not have 8, 12, 16 or 32 bits",
                         slice.pixels.allocated, slice.pixels.stored, slice.pixels.high),
                   unusable};
  slice.inverted = photometric == "MONOCHROME1";
  slice.lossy = lossy_of(file);
  slice.class_uid = file.text(0x00080016);
  slice.instance_uid = file.text(0x00080018);
  slice.series_uid = file.text(0x0020000e);
  slice.series_description = file.readable_text(0x0008103e);
  slice.modality = file.readable_text(0x00080060);
  slice.patient_orientation = file.text(0x00200020);
  slice.doubts = doubts_of(file);
  if (file.contradicts_syntax())
    slice.assumed_coding =
        "the value representations in the attributes, although they contradict the transfer syntax";
  if (!file.unsigned_short(0x00280101))
    slice.assumed_coding += print("%s%u bits, as BitsStored is absent",
                                  slice.assumed_coding.empty() ? "" : "; ", slice.pixels.stored);
  if (is_ct_class(slice.class_uid) && slice.modality != "CT") {
    slice.assumed_modality = slice.modality.empty() ? "absent" : "'" + slice.modality + "'";
    slice.modality = "CT";
  }
  slice.identity = identity_of(file);
  const auto number = [&](DicomTag tag) {
    const double value = file.decimal(tag).value_or(0.0);
    return std::abs(value) < 1e9 ? static_cast<int>(value) : 0;
  };
  slice.padding = padding_of(file, slice.pixels);
  if (auto flaw = take_lut(file, slice)) return std::move(*flaw);
  if (const auto ratio = file.decimals(0x00280034); ratio && ratio->size() == 2 && (*ratio)[1] > 0.0)
    slice.aspect_ratio = (*ratio)[0] / (*ratio)[1];
  if (const int images = number(0x00201002); images > 0) slice.stated_images = images;
  if (const int slices = stated_short(file, 0x00540081); slices > 0) slice.stated_images = slices;
  slice.concatenation = {file.text(0x00209161), stated_short(file, 0x00209162),
                         stated_short(file, 0x00209163)};
  slice.series_number = number(0x00200011);
  slice.instance_number = number(0x00200013);
  return slice;
}

/// Sets the fields that may differ between frames. Returns the reason if the header of the frame is unusable.
std::optional<NoSlice> take_frame(const DicomFile& file, const Attributes& attributes,
                                  std::size_t frame_count, DicomSlice& slice) {
  if (auto flaw = take_geometry(attributes, frame_count, slice)) return flaw;
  slice.decimal_commas = decimal_commas_of(attributes);
  slice.location_mm = attributes.decimal(0x00201041);
  slice.rescale_type = attributes.text(0x00281054);
  slice.intercept = attributes.decimal(0x00281052);
  slice.slope = attributes.decimal(0x00281053);
  // PET and nuclear medicine have a separate attribute for their unit (PS3.3, C.8.9.1).
  if (slice.rescale_type.empty()) slice.rescale_type = file.text(0x00541001);
  // A dose has special attributes for its scaling and for its unit (GY or RELATIVE).
  if (const auto scaling = file.decimal(0x3004000e); scaling && !slice.slope && !slice.intercept) {
    slice.slope = scaling;
    slice.intercept = 0.0;
    slice.rescale_type = file.text(0x30040002);
  }
  if (!is_rescale_finite(slice))
    return NoSlice{"values that exceed single precision after RescaleSlope", NoSlice::Kind::Unusable};
  for (std::size_t i = 0; i < dicom_traits.size(); ++i)
    for (const DicomTag tag : dicom_traits[i].tags)
      if (tag != 0 && slice.traits[i].empty()) slice.traits[i] = attributes.trait(tag);
  slice.is_localizer = file.text(0x00080008).find("LOCALIZER") != std::string::npos;
  return std::nullopt;
}

std::variant<std::vector<DicomSlice>, NoSlice> slices_of(const DicomFile& file,
                                                         const std::filesystem::path& path) {
  std::variant<DicomSlice, NoSlice> common = common_of(file, path);
  if (NoSlice* flaw = std::get_if<NoSlice>(&common)) return std::move(*flaw);
  const double claimed = std::max(file.decimal(0x00280008).value_or(1.0), 1.0);
  // NumberOfFrames may be damaged. Items bound the number of frames, because each item takes at least eight
  // bytes of the file.
  const std::vector<DicomFile> own = file.items(frame_groups_tag);
  const std::vector<DicomFile> shared = file.items(shared_groups_tag);
  if (!own.empty() && static_cast<double>(own.size()) != claimed)
    return NoSlice{print("NumberOfFrames is %.0f, but %zu frames have attributes of their own; export the "
                         "image again, or as single frames",
                         claimed, own.size()),
                   NoSlice::Kind::Unusable};
  const std::size_t frames = own.empty() ? static_cast<std::size_t>(std::min(claimed, 1e6)) : own.size();
  const DicomSlice& first = std::get<DicomSlice>(common);
  if (own.empty() && frames > 1 && frames > most_frames(file, first))
    return NoSlice{
        print("cut short: the header counts %.0f frames, but the file has pixels of fewer", claimed),
        NoSlice::Kind::Damaged};
  const bool is_nuclear_medicine = own.empty() && is_nuclear(first.class_uid);
  if (is_nuclear_medicine && frames > 1)
    if (auto flaw = not_reconstructed(file, frames)) return std::move(*flaw);
  const std::vector<DicomFile> detectors =
      is_nuclear_medicine ? detectors_of_frames(file, frames) : std::vector<DicomFile>();
  std::vector<DicomSlice> slices(frames, first);
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const DicomFile* own_groups = own.empty() ? nullptr : &own[i];
    const DicomFile* shared_groups = shared.empty() ? nullptr : &shared.front();
    Attributes attributes(file, shared_groups, own_groups);
    if (!detectors.empty()) attributes.add(detectors[i]);
    slices[i].frame = static_cast<int>(i);
    if (slices.size() > 1) slices[i].instance_uid.append("#").append(std::to_string(i + 1));
    if (own.empty() && frames > 1 && attributes.text(0x00200032).empty())
      return NoSlice{
          is_nuclear_medicine
              ? "a nuclear medicine image without the position of its first slice: state "
                "ImagePositionPatient "
                "and ImageOrientationPatient in DetectorInformationSequence, or read the pixels by --raw "
                "with "
                "--spacing"
              : "a multi-frame image without the positions of its frames; export it as single frames",
          NoSlice::Kind::Unusable};
    if (auto flaw = take_frame(file, attributes, frames, slices[i])) return std::move(*flaw);
    slices[i].real_world = real_world_of(file, own_groups, shared_groups, slices[i].pixels.is_signed);
  }
  if (own.empty() && frames > 1)
    if (auto flaw = place_frames(file, slices)) return std::move(*flaw);
  if (is_nuclear_medicine) take_frame_vectors(file, slices);
  if (auto flaw = take_pixels(file, slices)) return std::move(*flaw);
  return slices;
}

/// The slices of a file. If it has none, the reason, with the UID of the file's series.
std::variant<std::vector<DicomSlice>, NoSlice> slices_or_reason(const DicomFile& file,
                                                                const std::filesystem::path& path) {
  auto found = slices_of(file, path);
  if (NoSlice* flaw = std::get_if<NoSlice>(&found)) flaw->series_uid = file.text(0x0020000e);
  return found;
}

/// The slices of a file. `bytes` is the file's beginning; if it ends within the attributes, the whole file is
/// read.
std::variant<std::vector<DicomSlice>, NoSlice> slices_of(std::string bytes, std::size_t file_bytes,
                                                         const std::filesystem::path& path) {
  try {
    return slices_or_reason(DicomFile(bytes, file_bytes), path);
  } catch (const DicomFile::NeedsMore&) {
    bytes = beginning_of(path, file_bytes);
    return slices_or_reason(DicomFile(bytes, bytes.size()), path);
  }
}

}  // namespace

std::size_t frame_bytes(const DicomSlice& slice) {
  return (static_cast<std::size_t>(slice.size_px.x) * static_cast<std::size_t>(slice.size_px.y) *
              slice.pixels.allocated +
          7) /
         8;
}

std::string beginning_of(const std::filesystem::path& path, std::size_t count) {
  errno = 0;
  std::ifstream in = opened(path);
  std::string bytes(count, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in.is_open() || in.bad())
    throw Error(ErrorCode::Input,
                std::string("cannot be read: ") + (errno != 0 ? std::strerror(errno) : "unknown reason"));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

std::string inflated(const std::string& bytes, std::size_t at) {
  return bytes.substr(0, at) + inflate_raw(std::string_view(bytes).substr(at));
}

std::variant<std::vector<DicomSlice>, NoSlice> read_dicom_slices(const std::filesystem::path& path) {
  // A header takes some kilobytes. The pixels after it are not needed yet.
  constexpr std::size_t most_attributes = std::size_t{1} << 15;
  std::string bytes;
  try {
    bytes = beginning_of(path, most_attributes);
  } catch (const Error& error) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return NoSlice{"a broken link"};
    return NoSlice{error.what(), NoSlice::Kind::Damaged};
  }
  if (!DicomFile::begins(bytes)) return NoSlice{"not DICOM"};
  try {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    const std::size_t file_bytes = error ? bytes.size() : std::max<std::size_t>(size, bytes.size());
    try {
      return slices_of(bytes, file_bytes, path);
    } catch (const DicomFile::Deflated& from) {
      const std::string whole = inflated(beginning_of(path, file_bytes), from.at);
      auto slices = slices_or_reason(DicomFile(whole, whole.size(), true), path);
      if (auto* found = std::get_if<std::vector<DicomSlice>>(&slices))
        for (DicomSlice& slice : *found) slice.pixels.is_deflated = true;
      return slices;
    }
  } catch (const DicomFile::NeedsMore&) {
    return NoSlice{"changed while it was read"};
  } catch (const Error& error) {
    // A file that cannot be parsed and lacks DICOM's prefix may be of any kind, so it counts as stray.
    const bool has_prefix = bytes.size() >= 132 && bytes.compare(128, 4, "DICM") == 0;
    return NoSlice{error.what(), has_prefix ? NoSlice::Kind::Damaged : NoSlice::Kind::Stray};
  }
}

}  // namespace octotomy::voxel

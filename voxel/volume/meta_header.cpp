// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Reads headers of MetaImage in the same way as MetaIO, ITK and VTK: TransformMatrix lists the directions of
// the axes one after the other, Offset is the position of the first sample, both in LPS; MET_LONG has 32
// bits. Departures: DistanceUnits apply to spacing and Offset; the intensity function is applied.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"
#include "voxel/volume/text_header.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, SampleType> meta_types{
    {"met_char", SampleType::Int8},       {"met_uchar", SampleType::UInt8},
    {"met_short", SampleType::Int16},     {"met_ushort", SampleType::UInt16},
    {"met_int", SampleType::Int32},       {"met_uint", SampleType::UInt32},
    {"met_long", SampleType::Int32},      {"met_ulong", SampleType::UInt32},
    {"met_long_long", SampleType::Int64}, {"met_ulong_long", SampleType::UInt64},
    {"met_float", SampleType::Float},     {"met_double", SampleType::Double}};

class MetaReader {
 public:
  explicit MetaReader(const fs::path& path)
      : path_(path), text_(read_text_header(path, VolumeFormat::Meta)) {}

  VolumeHeader read() {
    header_.fields = text_.fields;
    if (!text_.field("elementdatafile"))
      refuse(path_, "its MetaImage header does not end with ElementDataFile");
    const double axes = text_.number(path_, "ndims").value_or(0.0);
    if (axes != 2.0 && axes != 3.0 && axes != 4.0)
      refuse(path_, "its MetaImage header is damaged: NDims is not 2, 3 or 4");
    axes_ = static_cast<std::size_t>(axes);
    const std::vector<double> sizes = text_.numbers(path_, "dimsize", axes_);
    if (sizes.empty()) refuse(path_, "its MetaImage header is damaged: DimSize is missing");
    header_.geometry.dims = dims_of(path_, sizes);
    take_unit();
    take_geometry();
    take_samples();
    take_scaling();
    take_meaning();
    return std::move(header_);
  }

 private:
  /// The numbers of the first field that exists among several names. Adds a warning if another of these
  /// fields has different numbers.
  std::vector<double> first_of(const std::vector<const char*>& names, std::size_t count) {
    std::vector<double> taken;
    std::string taken_name;
    for (const char* name : names) {
      const std::vector<double> numbers = text_.numbers(path_, lower_case(name), count);
      if (numbers.empty()) continue;
      if (taken.empty()) {
        taken = numbers;
        taken_name = name;
      } else if (numbers != taken) {
        header_.audit.push_back(
            {"geometry", Verdict::Warn,
             "the header's " + taken_name + " and " + name + " disagree: " + taken_name + " was taken"});
      }
    }
    return taken;
  }

  void take_unit() {
    const std::optional<std::string> words = text_.field("distanceunits");
    if (!words || *words == "?" || words->empty() || lower_case(*words) == "unknown") return;
    const std::optional<LengthUnit> unit = length_unit(*words);
    if (!unit) {
      header_.audit.push_back(
          {"length_unit", Verdict::Warn,
           "the file states the unit '" + *words + "', which is not a known unit of length"});
      return;
    }
    header_.geometry.unit_says = unit->name + " (DistanceUnits)";
    header_.geometry.mm_per_unit = glm::dvec3(unit->mm);
  }

  void take_geometry() {
    StatedGeometry& geometry = header_.geometry;
    std::vector<double> spacing = text_.numbers(path_, "elementspacing", axes_);
    if (spacing.empty()) {
      spacing = text_.numbers(path_, "elementsize", axes_);
      header_.audit.push_back(
          {"spacing", Verdict::Warn,
           spacing.empty()
               ? "the file states no ElementSpacing: 1 in its unit of length is assumed"
               : "the file states no ElementSpacing: its ElementSize is assumed to be the spacing"});
      if (spacing.empty()) spacing.assign(axes_, 1.0);
    }
    const std::vector<double> matrix =
        first_of({"TransformMatrix", "Orientation", "Rotation"}, axes_ * axes_);
    if (!matrix.empty()) geometry.frame = PatientFrame();
    geometry.frame_says =
        matrix.empty() ? "MetaImage without TransformMatrix" : "MetaImage's TransformMatrix";
    const std::size_t used = std::min<std::size_t>(axes_, 3);
    bool is_unit = true;
    for (std::size_t axis = 0; axis < used; ++axis) {
      glm::dvec3 direction(0.0);
      direction[static_cast<int>(axis)] = 1.0;
      for (std::size_t i = 0; i < used && !matrix.empty(); ++i)
        direction[static_cast<int>(i)] = matrix[axis * axes_ + i];
      is_unit = is_unit && std::abs(glm::length(direction) - 1.0) <= 1e-3;
      geometry.file_from_voxel[static_cast<int>(axis)] = glm::dvec4(direction * spacing[axis], 0.0);
    }
    if (!is_unit)
      header_.audit.push_back(
          {"geometry", Verdict::Warn,
           "an axis in TransformMatrix is not of length 1: its length was multiplied with the "
           "spacing"});
    warn_of_minus_signs("ElementSpacing", spacing, header_);
    take_origin(used);
    check_anatomy(matrix.empty());
    if (axes_ == 2) add_third_axis(header_);
  }

  void take_origin(std::size_t used) {
    const std::vector<double> origin = first_of({"Offset", "Position", "Origin"}, axes_);
    for (std::size_t i = 0; i < used && !origin.empty(); ++i)
      header_.geometry.file_from_voxel[3][static_cast<int>(i)] = origin[i];
    if (origin.empty())
      header_.audit.push_back({"origin", Verdict::Warn,
                               "the file states no Offset: its first sample is assumed to lie at 0, 0, 0"});
    const std::vector<double> centre = text_.numbers(path_, "centerofrotation", axes_);
    if (std::any_of(centre.begin(), centre.end(), [](double number) { return number != 0.0; }))
      header_.audit.push_back(
          {"geometry", Verdict::Warn,
           "the file states a CenterOfRotation, which ITK and VTK do not apply: it is not used"});
  }

  /// AnatomicalOrientation repeats the matrix in letters, the sides at which the axes start: RAI means axes
  /// along LPS. It is compared with the matrix and otherwise not used.
  void check_anatomy(bool is_assumed) {
    const std::string letters = text_.field("anatomicalorientation").value_or("???");
    if (letters.find('?') != std::string::npos || axes_ != 3) return;
    const std::string from = sides_of_origin(glm::dmat3(header_.geometry.file_from_voxel));
    const bool agrees = letters == from;
    header_.audit.push_back({"anatomical_orientation", agrees ? Verdict::Pass : Verdict::Warn,
                             "AnatomicalOrientation is " + letters +
                                 (agrees ? ", which agrees with" : ", but " + from + " follows from") +
                                 (is_assumed ? " the assumed axes" : " TransformMatrix") +
                                 "; it is not used"});
  }

  /// Reads only the first letter, as MetaIO does.
  std::optional<bool> flag(const char* name) const {
    const std::optional<std::string> word = text_.field(name);
    if (!word || word->empty()) return std::nullopt;
    return std::string_view("tT1yY").find(word->front()) != std::string_view::npos;
  }

  void take_samples() {
    SampleFiles& samples = header_.samples;
    const std::string type = text_.field("elementtype").value_or("");
    const auto known = meta_types.find(lower_case(type));
    if (known == meta_types.end())
      refuse(path_, "its MetaImage header is damaged: ElementType is '" + type +
                        "', which is not a type of numbers");
    samples.stored.type = known->second;
    const double channels = text_.number(path_, "elementnumberofchannels").value_or(1.0);
    if (channels != 1.0) refuse(path_, print("has %g values per sample; a scan has one", channels));
    const bool is_text = flag("binarydata") == false;
    const bool is_packed = flag("compresseddata") == true;
    if (is_text && is_packed)
      refuse(path_, "states samples that are both text and compressed: correct one of these statements");
    samples.encoding = is_text     ? SampleFiles::Encoding::Text
                       : is_packed ? SampleFiles::Encoding::Deflated
                                   : SampleFiles::Encoding::Raw;
    std::optional<bool> msb = flag("binarydatabyteordermsb");
    const std::optional<bool> element_msb = flag("elementbyteordermsb");
    if (msb && element_msb && *msb != *element_msb)
      refuse(path_,
             "BinaryDataByteOrderMSB and ElementByteOrderMSB contradict each other: remove the wrong line");
    if (!msb) msb = element_msb;
    samples.stored.big_endian = msb.value_or(false);
    if (!msb && !is_text && bytes_of(samples.stored.type) > 1)
      header_.audit.push_back(
          {"byte_order", Verdict::Warn,
           "the file does not state the order of its bytes (BinaryDataByteOrderMSB): the low "
           "ones first are assumed"});
    const std::string data = *text_.field("elementdatafile");
    const bool is_local = lower_case(data) == "local";
    samples.files = is_local ? std::vector{path_} : data_files(path_, data, text_.listed);
    if (is_local) samples.file_at = text_.end;
    take_header_size();
  }

  void take_header_size() {
    SampleFiles& samples = header_.samples;
    const std::optional<double> bytes = text_.number(path_, "headersize");
    if (!bytes || *bytes == 0.0) return;
    constexpr double most = 1e15;
    if (!(*bytes >= -1.0 && *bytes <= most) || *bytes != std::trunc(*bytes) ||
        (*bytes < 0.0 && *bytes != -1.0))
      refuse(path_, "its MetaImage header is damaged: HeaderSize is not a number of bytes");
    samples.at_end = *bytes < 0.0;
    if (samples.at_end && samples.encoding != SampleFiles::Encoding::Raw)
      refuse(path_, "has HeaderSize -1 and samples that are not raw: where they begin is unknown");
    if (!samples.at_end) samples.file_at = static_cast<std::uintmax_t>(*bytes);
  }

  void take_scaling() {
    StoredSamples& stored = header_.samples.stored;
    const std::optional<double> slope = text_.number(path_, "elementtointensityfunctionslope");
    const std::optional<double> offset = text_.number(path_, "elementtointensityfunctionoffset");
    if ((slope && (*slope == 0.0 || !std::isfinite(*slope))) || (offset && !std::isfinite(*offset))) {
      header_.audit.push_back(
          {"rescale", Verdict::Warn,
           "the file's ElementToIntensityFunction would map all values to one: it is not applied"});
      return;
    }
    stored.slope = slope.value_or(1.0);
    stored.intercept = offset.value_or(0.0);
    header_.audit.push_back(rescale_finding(stored, slope || offset
                                                        ? "ElementToIntensityFunction"
                                                        : "the file states no ElementToIntensityFunction"));
  }

  void take_meaning() {
    header_.meaning = text_.field(meaning_key).value_or("");
    header_.modality = text_.field(modality_key).value_or("");
    take_padding(text_.field(padding_key), header_);
    // MetaIO's names of modalities are MET_MOD_CT, _MR, _NM, _US, _OTHER and _UNKNOWN.
    const std::string modality = text_.field("modality").value_or("");
    if (header_.modality.empty() && (modality == "MET_MOD_CT" || modality == "MET_MOD_MR" ||
                                     modality == "MET_MOD_NM" || modality == "MET_MOD_US"))
      header_.modality = modality.substr(8);
  }

  const fs::path& path_;
  TextHeader text_;
  std::size_t axes_ = 3;
  VolumeHeader header_;
};

}  // namespace

VolumeHeader read_meta_header(const fs::path& path) {
  return MetaReader(path).read();
}

}  // namespace octotomy::voxel

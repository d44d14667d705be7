// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Reads headers of NIfTI-1 and NIfTI-2, whose fields nifti1.h and nifti2.h of the NIfTI library define. Does
// not call the library's own reader: it prints to standard error, trusts the dims and the length of
// extensions in damaged headers, silently changes negative spacings, forms and slopes, and hangs on some
// headers. A check that refuses such headers beforehand would have to parse every field itself.
//
// Geometry: the sform if its code is positive, else the qform if its code is positive, else the spacing
// alone. The spacing states no frame. The axes are then assumed to run to the left, front and head, as in
// Analyze files, and the volume to be centred on the origin, as in nibabel, SPM and FSL. xyzt_units apply to
// spacing and positions.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <nifti/nifti1.h>
#include <nifti/nifti2.h>

#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"
#include "voxel/volume/sample_stream.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

template <typename Number>
Number swapped(Number value) {
  std::array<char, sizeof(Number)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(Number));
  std::reverse(bytes.begin(), bytes.end());
  std::memcpy(&value, bytes.data(), sizeof(Number));
  return value;
}

/// The header fields that this reader uses, for both versions of the format.
struct Fields {
  int version = 1;
  bool is_swapped = false;
  std::array<double, 8> dim{}, pixdim{};
  int datatype = 0, bitpix = 0, intent_code = 0, xyzt_units = 0, qform_code = 0, sform_code = 0;
  double vox_offset = 0.0, slope = 0.0, intercept = 0.0;
  glm::dvec3 quaternion{0.0}, qoffset{0.0};
  glm::dmat4 sform{1.0};
  std::string description, magic;
};

template <typename Header>
Fields fields_of(const char* bytes, bool is_swapped) {
  Header header;
  std::memcpy(&header, bytes, sizeof header);
  const auto number = [&](auto value) { return is_swapped ? swapped(value) : value; };
  const auto real = [&](auto value) { return static_cast<double>(number(value)); };
  const auto whole = [&](auto value) { return static_cast<int>(number(value)); };
  const auto text = [](const auto& letters) {
    return shown({letters, std::find(std::begin(letters), std::end(letters), '\0')});
  };
  Fields fields;
  fields.is_swapped = is_swapped;
  for (std::size_t i = 0; i < 8; ++i) {
    fields.dim[i] = real(header.dim[i]);
    fields.pixdim[i] = real(header.pixdim[i]);
  }
  fields.datatype = whole(header.datatype);
  fields.bitpix = whole(header.bitpix);
  fields.intent_code = whole(header.intent_code);
  fields.xyzt_units = whole(header.xyzt_units);
  fields.qform_code = whole(header.qform_code);
  fields.sform_code = whole(header.sform_code);
  fields.vox_offset = real(header.vox_offset);
  fields.slope = real(header.scl_slope);
  fields.intercept = real(header.scl_inter);
  fields.quaternion = {real(header.quatern_b), real(header.quatern_c), real(header.quatern_d)};
  fields.qoffset = {real(header.qoffset_x), real(header.qoffset_y), real(header.qoffset_z)};
  for (int column = 0; column < 4; ++column) {
    const auto i = static_cast<std::size_t>(column);
    fields.sform[column] = {real(header.srow_x[i]), real(header.srow_y[i]), real(header.srow_z[i]),
                            column == 3 ? 1.0 : 0.0};
  }
  fields.description = text(header.descrip);
  fields.magic = text(header.magic);
  return fields;
}

/// An upper bound of the shift of a lattice's corner by single precision. It covers eight roundings: of the
/// steps, the origin and the operations between quaternion and matrix.
double single_precision(const glm::dmat4& file_from_voxel, const glm::ivec3& dims) {
  double extent = glm::length(glm::dvec3(file_from_voxel[3]));
  for (int axis = 0; axis < 3; ++axis) extent += dims[axis] * glm::length(glm::dvec3(file_from_voxel[axis]));
  return 8.0 * static_cast<double>(std::numeric_limits<float>::epsilon()) * extent;
}

double worst_shift(const glm::dmat4& a, const glm::dmat4& b, const glm::ivec3& dims) {
  double worst = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec4 p_voxel(glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2) * glm::dvec3(dims - 1),
                             1.0);
    worst = std::max(worst, glm::length(a * p_voxel - b * p_voxel));
  }
  return worst;
}

/// The name of the coordinates that a form's code denotes.
std::string name_of_code(int code) {
  switch (code) {
    case NIFTI_XFORM_SCANNER_ANAT:
      return "the scanner's coordinates";
    case NIFTI_XFORM_ALIGNED_ANAT:
      return "coordinates aligned to another image";
    case NIFTI_XFORM_TALAIRACH:
      return "Talairach's coordinates";
    case NIFTI_XFORM_MNI_152:
      return "the coordinates of the template MNI 152";
    case NIFTI_XFORM_TEMPLATE_OTHER:
      return "the coordinates of a template";
    default:
      return print("code %d", code);
  }
}

class NiftiReader {
 public:
  explicit NiftiReader(const fs::path& named)
      : pair_(nifti_pair(named)), path_(pair_ ? pair_->header : named) {
    if (!pair_ && !volume_format(named))
      refuse(named, "is one of NIfTI's two files, the .hdr and the .img, and the other one is missing");
    read_fields();
    const bool is_single = fields_.magic.starts_with("n+");
    if (is_single == pair_.has_value() || (!is_single && !fields_.magic.starts_with("ni")))
      refuse(path_, pair_ && fields_.magic.empty()
                        ? "is Analyze 7.5, which does not state left and right: save it as NIfTI"
                        : "its NIfTI header is damaged: magic '" + fields_.magic + "' (" +
                              (pair_ ? "ni1 or ni2" : "n+1 or n+2") + " is expected)");
  }

  VolumeHeader read() {
    const auto axes = static_cast<std::size_t>(std::clamp(fields_.dim[0], 0.0, 8.0));
    require(axes >= 2 && axes <= 7,
            print("dim[0] is %g, which is not a number of axes from 2 to 7", fields_.dim[0]));
    for (std::size_t axis = 1; axis <= axes; ++axis)
      require(fields_.dim[axis] >= 1.0,
              print("dim[%zu] is %g, but an axis has at least one sample", axis, fields_.dim[axis]));
    header_.geometry.dims = dims_of(
        path_, {fields_.dim.begin() + 1, fields_.dim.begin() + 1 + static_cast<std::ptrdiff_t>(axes)});
    take_unit();
    take_geometry(axes);
    take_exact_geometry();
    take_samples();
    take_meaning();
    return std::move(header_);
  }

 private:
  static constexpr int most_code = NIFTI_XFORM_TEMPLATE_OTHER;
  /// Size of the header and this program's own extension behind it.
  static constexpr std::size_t most_read = 4096;

  void read_fields() {
    bytes_.resize(most_read);
    std::size_t held = 0;
    try {
      held = SampleStream(path_, 0, is_gzip(path_)).read(bytes_.data(), bytes_.size());
    } catch (const Error&) {
      refuse(path_, "is cut short or damaged within its header");
    }
    bytes_.resize(held);
    std::int32_t size = 0;
    if (held >= sizeof size) std::memcpy(&size, bytes_.data(), sizeof size);
    constexpr auto first = static_cast<std::int32_t>(sizeof(nifti_1_header));
    constexpr auto second = static_cast<std::int32_t>(sizeof(nifti_2_header));
    const bool is_swapped = swapped(size) == first || swapped(size) == second;
    if (is_swapped) size = swapped(size);
    if (size != first && size != second)
      refuse(path_, "is not a NIfTI file, though its extension says so; rename it to its real format");
    if (held < static_cast<std::size_t>(size)) refuse(path_, "is cut short or damaged within its header");
    fields_ = size == first ? fields_of<nifti_1_header>(bytes_.data(), is_swapped)
                            : fields_of<nifti_2_header>(bytes_.data(), is_swapped);
    fields_.version = size == first ? 1 : 2;
    header_bytes_ = static_cast<std::size_t>(size);
  }

  void take_unit() {
    StatedGeometry& geometry = header_.geometry;
    const int code = fields_.xyzt_units & 7;
    const std::map<int, std::pair<const char*, double>> units{{NIFTI_UNITS_METER, {"metres", 1e3}},
                                                              {NIFTI_UNITS_MM, {"mm", 1.0}},
                                                              {NIFTI_UNITS_MICRON, {"micrometres", 1e-3}}};
    if (const auto unit = units.find(code); unit != units.end()) {
      geometry.unit_says = std::string(unit->second.first) + print(" (xyzt_units %d)", code);
      geometry.mm_per_unit = glm::dvec3(unit->second.second);
    } else if (code != NIFTI_UNITS_UNKNOWN) {
      header_.audit.push_back(
          {"length_unit", Verdict::Warn, print("xyzt_units has the code %d, which is not a unit", code)});
    }
  }

  /// Whether numbers are finite and below a kilometre, beyond which no scanner reaches.
  bool are_lengths(std::initializer_list<glm::dvec3> lengths) const {
    const double most = 1e6 / header_.geometry.mm_per_unit.x;
    return std::all_of(lengths.begin(), lengths.end(), [&](const glm::dvec3& length) {
      return std::abs(length.x) <= most && std::abs(length.y) <= most && std::abs(length.z) <= most;
    });
  }

  /// The spacing along three axes. For a single slice the header may omit that of the third axis.
  glm::dvec3 spacing(std::size_t axes) {
    glm::dvec3 spacing(fields_.pixdim[1], fields_.pixdim[2], fields_.pixdim[3]);
    const bool has_third = axes >= 3 || std::abs(spacing.z) > 0.0;
    if (!has_third) spacing.z = 1.0;
    const glm::dvec3 length = glm::abs(spacing);
    const double least = 1e-6 / header_.geometry.mm_per_unit.x;  // no voxel is smaller than a nanometre
    require(are_lengths({length}) && length.x >= least && length.y >= least && length.z >= least,
            print("pixdim %g %g %g is not a valid spacing: set it, or save the volume again", spacing.x,
                  spacing.y, spacing.z));
    if (spacing != length)
      header_.audit.push_back(
          {"spacing", Verdict::Warn,
           print("the header's spacing %g %g %g has a minus sign, which pixdim cannot have: "
                 "its size was taken",
                 spacing.x, spacing.y, spacing.z)});
    third_is_missing_ = !has_third;
    return length;
  }

  glm::dmat4 qform(std::size_t axes) {
    const glm::dvec3 length = spacing(axes);
    require(are_lengths({fields_.quaternion, fields_.qoffset}),
            "its qform has a number that is not finite or larger than any length in a scan");
    const double squared = glm::dot(fields_.quaternion, fields_.quaternion);
    constexpr double rounding = 8.0 * static_cast<double>(std::numeric_limits<float>::epsilon());
    if (squared > 1.0 + rounding)
      header_.audit.push_back(
          {"quaternion", Verdict::Warn,
           print("the qform's quaternion has the length %.4g instead of at most 1: it was "
                 "shortened",
                 std::sqrt(squared))});
    const double real = std::sqrt(std::max(0.0, 1.0 - squared));
    const glm::dmat3 turn = glm::mat3_cast(
        glm::normalize(glm::dquat(real, fields_.quaternion.x, fields_.quaternion.y, fields_.quaternion.z)));
    const double qfac = fields_.pixdim[0];
    if (qfac != 1.0 && qfac != -1.0 && qfac != 0.0)
      header_.audit.push_back({"qfac", Verdict::Warn,
                               print("qfac is %g instead of 1 or -1: the third axis was taken as for %d",
                                     qfac, qfac < 0.0 ? -1 : 1)});
    glm::dmat4 ras(1.0);
    for (int axis = 0; axis < 3; ++axis)
      ras[axis] = glm::dvec4(turn[axis] * length[axis] * (axis == 2 && qfac < 0.0 ? -1.0 : 1.0), 0.0);
    ras[3] = glm::dvec4(fields_.qoffset, 1.0);
    return ras;
  }

  /// Whether the sform is valid: its numbers are finite and its columns span a volume. For a single slice the
  /// third column may be absent.
  bool is_sound_sform(std::size_t axes) {
    const glm::dmat4& s = fields_.sform;
    const auto is_finite = [](const glm::dvec4& column) {
      return std::isfinite(column.x) && std::isfinite(column.y) && std::isfinite(column.z);
    };
    if (!is_finite(s[0]) || !is_finite(s[1]) || !is_finite(s[2]) || !is_finite(s[3])) return false;
    require(are_lengths({s[0], s[1], s[2], s[3]}), "its sform has a number larger than any length in a scan");
    third_is_missing_ = axes < 3 && glm::dvec3(s[2]) == glm::dvec3(0.0);
    const glm::dvec3 third =
        third_is_missing_ ? glm::cross(glm::dvec3(s[0]), glm::dvec3(s[1])) : glm::dvec3(s[2]);
    return glm::determinant(glm::dmat3(glm::dvec3(s[0]), glm::dvec3(s[1]), third)) != 0.0;
  }

  void take_geometry(std::size_t axes) {
    StatedGeometry& geometry = header_.geometry;
    const PatientFrame ras = *patient_frame("RAS");
    for (const auto& [name, code] : {std::pair("sform", fields_.sform_code), {"qform", fields_.qform_code}})
      if (code < 0 || code > most_code)
        header_.audit.push_back({"form_code", Verdict::Warn,
                                 print("the %s has the code %d, which NIfTI does not define: it is %s", name,
                                       code, code < 0 ? "taken as none" : "taken as of the patient")});
    const bool has_sform = fields_.sform_code > 0 && is_sound_sform(axes);
    if (fields_.sform_code > 0 && !has_sform) {
      if (fields_.qform_code <= 0)
        refuse(path_, "its NIfTI header is damaged: its sform spans no volume, and it has no qform");
      header_.audit.push_back(
          {"forms", Verdict::Warn,
           "the header's sform spans no volume or has invalid numbers: its qform was taken"});
    }
    if (has_sform) {
      geometry.frame = ras;
      geometry.frame_says = "NIfTI's sform, " + name_of_code(fields_.sform_code);
      geometry.file_from_voxel = fields_.sform;
      if (third_is_missing_)
        add_third_axis(header_);
      else if (fields_.qform_code > 0)
        compare_forms(axes);
      else
        compare_spacing(axes);
    } else if (fields_.qform_code > 0) {
      geometry.frame = ras;
      geometry.frame_says = "NIfTI's qform, " + name_of_code(fields_.qform_code);
      geometry.file_from_voxel = qform(axes);
      if (third_is_missing_) add_third_axis(header_);
    } else {
      geometry.frame_says =
          "NIfTI with neither sform nor qform; the origin is assumed in the volume's centre";
      geometry.assumed_frame = *patient_frame("LAS");
      const glm::dvec3 length = spacing(axes);
      for (int axis = 0; axis < 3; ++axis) geometry.file_from_voxel[axis][axis] = length[axis];
      if (third_is_missing_) add_third_axis(header_);
      const glm::dvec3 centre = 0.5 * glm::dvec3(geometry.dims - 1) * length;
      geometry.file_from_voxel[3] = glm::dvec4(-centre, 1.0);
    }
    const int code = has_sform ? fields_.sform_code : fields_.qform_code;
    if (code == NIFTI_XFORM_TALAIRACH || code == NIFTI_XFORM_MNI_152 || code == NIFTI_XFORM_TEMPLATE_OTHER)
      header_.audit.push_back({"form_code", Verdict::Warn,
                               "places are " + name_of_code(code) +
                                   ": lengths and volumes are the template's, not the patient's"});
    if (!has_sform && fields_.qform_code > 0 && fields_.pixdim[0] == 0.0)
      header_.audit.push_back(
          {"qfac", Verdict::Warn, "pixdim[0] is 0 and does not state the third axis' side: 1 is assumed"});
    if (axes < 3 && !third_is_missing_)
      header_.audit.push_back(
          {"slice_spacing", Verdict::Pass, "a single slice, whose thickness the header states"});
  }

  /// Warns if pixdim, which the sform does not use, differs from the sform by more than a hundredth.
  void compare_spacing(std::size_t axes) {
    bool agrees = true;
    glm::dvec3 spacing(0.0);
    for (int axis = 0; axis < static_cast<int>(std::min<std::size_t>(axes, 3)); ++axis) {
      spacing[axis] = glm::length(glm::dvec3(fields_.sform[axis]));
      const double stated = std::abs(fields_.pixdim[static_cast<std::size_t>(axis) + 1]);
      agrees = agrees && std::abs(stated - spacing[axis]) <= 0.01 * spacing[axis];
    }
    if (!agrees)
      header_.audit.push_back(
          {"spacing", Verdict::Warn,
           print("the header's pixdim %g %g %g and its sform, whose columns are %g %g %g "
                 "long, disagree: the sform was taken",
                 fields_.pixdim[1], fields_.pixdim[2], fields_.pixdim[3], spacing.x, spacing.y, spacing.z)});
  }

  /// Warns if the positions of a corner by sform and by qform differ by more than the rounding of their
  /// numbers.
  void compare_forms(std::size_t axes) {
    const std::size_t lines = header_.audit.size();
    glm::dmat4 q(1.0);
    try {
      q = qform(axes);
    } catch (const Error&) {
      header_.audit.push_back(
          {"forms", Verdict::Warn, "the header's qform is damaged: its sform, which is valid, was taken"});
      return;
    }
    header_.audit.resize(lines);  // the qform is not used, so its own flaws are not reported
    third_is_missing_ = false;
    const glm::dmat4& s = fields_.sform;
    const glm::ivec3& dims = header_.geometry.dims;
    // The quaternion's first number is the square root of 1 minus the sum of the other numbers' squares. The
    // rounding of the squares adds up to `slack`, so near half a turn the root is uncertain by up to the root
    // of `slack`.
    constexpr double slack = 4.0 * static_cast<double>(std::numeric_limits<float>::epsilon());
    const double real = std::sqrt(std::max(0.0, 1.0 - glm::dot(fields_.quaternion, fields_.quaternion)));
    const double turn = 2.0 * slack / std::max(real, std::sqrt(slack));
    double extent = 0.0;
    for (int axis = 0; axis < 3; ++axis) extent += dims[axis] * glm::length(glm::dvec3(s[axis]));
    const double shift = worst_shift(s, q, dims);
    if (shift <= single_precision(s, dims) + single_precision(q, dims) + turn * extent) return;
    double cosine = 1.0;
    for (int axis = 0; axis < 3; ++axis)
      cosine = std::min(cosine,
                        glm::dot(glm::normalize(glm::dvec3(s[axis])), glm::normalize(glm::dvec3(q[axis]))));
    header_.audit.push_back({"forms", Verdict::Warn,
                             print("the header's sform and qform disagree: axes by up to %.3g degrees, "
                                   "corners by up to %.3g mm; the "
                                   "sform was taken",
                                   glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0))),
                                   shift * header_.geometry.mm_per_unit.x)});
  }

  /// Uses the double-precision geometry that this program stores in its own files, if the header still agrees
  /// with it.
  void take_exact_geometry() {
    const std::optional<glm::dmat4> lps = own_geometry();
    if (!lps) return;
    StatedGeometry& geometry = header_.geometry;
    glm::dmat4 ras = *lps;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 2; ++row) ras[column][row] = -ras[column][row];
    const bool agrees =
        geometry.frame && geometry.mm_per_unit == glm::dvec3(1.0) &&
        worst_shift(ras, geometry.file_from_voxel, geometry.dims) <= single_precision(ras, geometry.dims);
    if (agrees)
      geometry.file_from_voxel = ras;
    else
      header_.audit.push_back(
          {"geometry", Verdict::Warn,
           "the header was changed since it was written: its positions are used, not the older "
           "ones in double precision"});
  }

  /// The geometry in this program's own extension, which is the first extension; none if it is absent or
  /// damaged.
  std::optional<glm::dmat4> own_geometry() const {
    // Extensions begin after the flags that state whether there are any.
    const std::size_t at = header_bytes_ + 4;
    if (bytes_.size() < at + 8 || bytes_[header_bytes_] == 0) return std::nullopt;
    const auto length = static_cast<std::size_t>(std::max(8, whole_at(at)));
    if (length > bytes_.size() - at || whole_at(at + 4) != nifti_text_extension) return std::nullopt;
    std::string_view text = std::string_view(bytes_).substr(at + 8, length - 8);
    if (!text.starts_with(nifti_geometry_mark)) return std::nullopt;
    text.remove_prefix(nifti_geometry_mark.size());
    glm::dmat4 matrix(1.0);
    for (int i = 0; i < 12; ++i) {
      while (text.starts_with(' ')) text.remove_prefix(1);
      double number = 0.0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
      if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
      text.remove_prefix(static_cast<std::size_t>(end - text.data()));
      matrix[i % 4][i / 4] = number;
    }
    return matrix;
  }

  std::int32_t whole_at(std::size_t at) const {
    std::int32_t number = 0;
    std::memcpy(&number, bytes_.data() + at, sizeof number);
    return fields_.is_swapped ? swapped(number) : number;
  }

  void take_samples() {
    static const std::map<int, SampleType> types{
        {DT_UINT8, SampleType::UInt8},   {DT_INT16, SampleType::Int16},    {DT_INT32, SampleType::Int32},
        {DT_FLOAT32, SampleType::Float}, {DT_FLOAT64, SampleType::Double}, {DT_INT8, SampleType::Int8},
        {DT_UINT16, SampleType::UInt16}, {DT_UINT32, SampleType::UInt32},  {DT_INT64, SampleType::Int64},
        {DT_UINT64, SampleType::UInt64}};
    const auto type = types.find(fields_.datatype);
    if (type == types.end()) refuse_type();
    require(static_cast<std::size_t>(std::max(0, fields_.bitpix)) == 8 * bytes_of(type->second),
            print("bitpix is %d, but samples of its datatype %d have %zu bits", fields_.bitpix,
                  fields_.datatype, 8 * bytes_of(type->second)));
    SampleFiles& samples = header_.samples;
    samples.stored.type = type->second;
    samples.stored.big_endian = fields_.is_swapped == (std::endian::native == std::endian::little);
    samples.files = {pair_ ? pair_->image : path_};
    const double least = pair_ ? 0.0 : static_cast<double>(header_bytes_) + 4.0;
    double offset = std::trunc(fields_.vox_offset);
    if (!pair_ && offset == 0.0) {
      header_.audit.push_back(
          {"offset", Verdict::Warn,
           print("the header states no offset of the samples (vox_offset): byte %g is assumed", least)});
      offset = least;
    }
    require(offset >= (pair_ ? 0.0 : static_cast<double>(header_bytes_)) && offset <= 1e9,
            print("vox_offset is %g, which is not a valid position of its samples", offset));
    const bool is_packed = is_gzip(samples.files.front());
    samples.encoding = is_packed ? SampleFiles::Encoding::Deflated : SampleFiles::Encoding::Raw;
    samples.byte_skip = static_cast<std::uintmax_t>(offset);
    take_scaling();
  }

  void take_scaling() {
    StoredSamples& stored = header_.samples.stored;
    const double slope = fields_.slope, intercept = fields_.intercept;
    if (slope == 0.0 || !std::isfinite(slope)) {
      const bool is_ignored = std::isfinite(intercept) && intercept != 0.0;
      header_.audit.push_back(
          {"rescale", is_ignored ? Verdict::Warn : Verdict::Pass,
           print("values are the stored numbers: a slope of %g means no scaling", slope) +
               (is_ignored ? print(", so that the intercept %g is not applied", intercept) : std::string())});
      return;
    }
    if (!std::isfinite(intercept))
      refuse(path_,
             print("its slope is %g, but its intercept is not a finite number: the values are therefore "
                   "unknown; save the volume again",
                   slope));
    stored.slope = slope;
    stored.intercept = intercept;
    header_.audit.push_back(rescale_finding(stored, "scl_slope and scl_inter"));
  }

  [[noreturn]] void refuse_type() const {
    static const std::map<int, const char*> names{{DT_BINARY, "single bits"},
                                                  {DT_COMPLEX64, "complex numbers"},
                                                  {DT_COMPLEX128, "complex numbers"},
                                                  {DT_COMPLEX256, "complex numbers"},
                                                  {DT_RGB24, "colours"},
                                                  {DT_RGBA32, "colours"},
                                                  {DT_FLOAT128, "numbers of 128 bits"}};
    const auto name = names.find(fields_.datatype);
    if (name == names.end()) require(false, print("datatype %d is not a type of samples", fields_.datatype));
    refuse(path_, std::string("its samples are ") + name->second +
                      "; a scan has one number of at most 64 bits a sample: convert it first");
  }

  void take_meaning() {
    if (fields_.description.starts_with(nifti_mark)) {
      std::string rest = fields_.description.substr(nifti_mark.size());
      if (const std::size_t at = rest.find(nifti_padding_mark); at != std::string::npos) {
        take_padding(trimmed(rest.substr(at + nifti_padding_mark.size())), header_);
        rest.erase(at);
      }
      rest = trimmed(rest);
      const std::size_t gap = rest.find(' ');
      header_.meaning = rest.substr(0, gap);
      if (gap != std::string::npos) header_.modality = trimmed(rest.substr(gap));
    } else if (fields_.intent_code == NIFTI_INTENT_LABEL) {
      header_.meaning = "label";
    } else if (fields_.intent_code >= NIFTI_FIRST_STATCODE && fields_.intent_code <= NIFTI_LAST_STATCODE) {
      header_.meaning = "raw";
      header_.audit.push_back({"intent", Verdict::Warn,
                               print("the file states that its values are a statistic (intent %d): they are "
                                     "taken as raw, not as Hounsfield units",
                                     fields_.intent_code)});
    }
  }

  void require(bool holds, const std::string& otherwise) const {
    if (!holds) refuse(path_, "its NIfTI header is damaged: " + otherwise);
  }

  std::optional<NiftiPair> pair_;
  fs::path path_;  ///< of the header
  std::string bytes_;
  std::size_t header_bytes_ = 0;
  Fields fields_;
  bool third_is_missing_ = false;
  VolumeHeader header_;
};

}  // namespace

std::optional<NiftiPair> nifti_pair(const fs::path& path) {
  const std::string name = path.filename().string(), lower = lower_case(name);
  const auto is_pair = [&](const char* ending) { return lower.ends_with(ending); };
  const bool is_header = is_pair(".hdr") || is_pair(".hdr.gz");
  if (!is_header && !is_pair(".img") && !is_pair(".img.gz")) return std::nullopt;
  const std::string stem = name.substr(0, lower.rfind(is_header ? ".hdr" : ".img"));
  for (const char* ending : {".hdr", ".hdr.gz", ".HDR", ".img", ".img.gz", ".IMG"}) {
    if ((lower_case(ending).starts_with(".hdr")) == is_header) continue;
    const fs::path other = path.parent_path() / (stem + ending);
    if (std::error_code error; fs::is_regular_file(other, error))
      return is_header ? NiftiPair{path, other} : NiftiPair{other, path};
  }
  return std::nullopt;
}

VolumeHeader read_nifti_header(const fs::path& path) {
  return NiftiReader(path).read();
}

}  // namespace octotomy::voxel

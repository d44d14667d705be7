// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Reads headers of NRRD by its definition (teem.sourceforge.net/nrrd/format.html, Teem 1.9). Departures: only
// one value per sample and one volume, except for the layers of 3D Slicer's segmentations; bzip2 and blocks
// are refused. Axes that are not spatial are skipped if their length is 1. Without `centers` a sample is in
// the middle of its cell, as Teem assumes.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>

#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"
#include "voxel/volume/text_header.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, SampleType>& nrrd_types() {
  static const std::map<std::string, SampleType> all = [] {
    std::map<std::string, SampleType> named{{"signed char", SampleType::Int8},
                                            {"uchar", SampleType::UInt8},
                                            {"unsigned char", SampleType::UInt8},
                                            {"float", SampleType::Float},
                                            {"double", SampleType::Double}};
    const auto add = [&](const char* signs, const char* short_name, std::initializer_list<const char*> names,
                         SampleType type) {
      named.emplace(short_name, type);
      for (const char* name : names) named.emplace(std::string(signs) + name, type);
    };
    for (const char* sign : {"", "signed "}) {
      add(sign, "short", {"short", "short int"}, SampleType::Int16);
      add(sign, "int", {"int"}, SampleType::Int32);
      add(sign, "longlong", {"long long", "long long int"}, SampleType::Int64);
    }
    add("unsigned ", "ushort", {"short", "short int"}, SampleType::UInt16);
    add("unsigned ", "uint", {"int"}, SampleType::UInt32);
    add("unsigned ", "ulonglong", {"long long", "long long int"}, SampleType::UInt64);
    for (const SampleType type :
         {SampleType::Int8, SampleType::UInt8, SampleType::Int16, SampleType::UInt16, SampleType::Int32,
          SampleType::UInt32, SampleType::Int64, SampleType::UInt64}) {
      named.emplace(name_of(type), type);
      named.emplace(name_of(type) + "_t", type);
    }
    return named;
  }();
  return all;
}

/// Splits a text at blanks, but not within quotes or brackets. Quotes are removed.
std::vector<std::string> words_in(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = text.find_first_not_of(" \t"); at != std::string::npos;
       at = text.find_first_not_of(" \t", at)) {
    const char closing = text[at] == '"' ? '"' : text[at] == '(' ? ')' : ' ';
    std::size_t end = closing == ' ' ? text.find_first_of(" \t", at) : text.find(closing, at + 1);
    end = std::min(end, text.size());
    if (closing == '"')
      words.push_back(text.substr(at + 1, end - at - 1));
    else
      words.push_back(text.substr(at, end - at));
    at = std::min(closing == ' ' ? end : end + 1, text.size());
  }
  return words;
}

class NrrdReader {
 public:
  explicit NrrdReader(const fs::path& path)
      : path_(path), text_(read_text_header(path, VolumeFormat::Nrrd)) {}

  VolumeHeader read() {
    header_.fields = text_.fields;
    header_.fields.insert(text_.keys.begin(), text_.keys.end());
    take_axes();
    take_frame();
    take_units();
    if (has_directions_)
      take_directions();
    else
      take_spacings();
    if (space_axes_.size() < 3) add_third_axis(header_);
    take_samples();
    take_meaning();
    return std::move(header_);
  }

 private:
  [[noreturn]] void refuse_field(const char* name, const std::string& reason) const {
    refuse(path_, std::string("its NRRD header is damaged: '") + name + "' " + reason);
  }

  std::string need(const char* name) const {
    const std::optional<std::string> text = text_.field(name);
    if (!text) refuse_field(name, "is missing");
    return *text;
  }

  /// The words of a field that has one word for each axis; empty if the field is absent.
  std::vector<std::string> words_an_axis(const char* name) const {
    const std::optional<std::string> text = text_.field(name);
    if (!text) return {};
    std::vector<std::string> words = words_in(*text);
    if (words.size() != axis_count_)
      refuse_field(name, "must have " + std::to_string(axis_count_) + " parts, one for each axis");
    return words;
  }

  /// Finds the spatial axes: the axes with a direction or, if no axis has one, the axes whose kind may be
  /// spatial.
  void take_axes() {
    const double axes = text_.number(path_, "dimension").value_or(0.0);
    if (!(axes >= 2.0 && axes <= 16.0) || axes != std::trunc(axes))
      refuse_field("dimension", "is not 2 to 16");
    axis_count_ = static_cast<std::size_t>(axes);
    need("sizes");
    const std::vector<double> sizes = text_.numbers(path_, "sizes", axis_count_);
    const std::vector<std::string> directions = words_an_axis("spacedirections");
    const std::vector<std::string> kinds = words_an_axis("kinds");
    has_directions_ = !directions.empty();
    std::vector<double> lengths;
    for (std::size_t axis = 0; axis < axis_count_; ++axis) {
      const std::string kind = kinds.empty() ? "" : lower_case(kinds[axis]);
      const bool is_of_space =
          has_directions_ ? lower_case(directions[axis]) != "none" && kind != "time" : is_kind_of_space(kind);
      if (!is_of_space && axis == 0 && sizes[axis] > 1.0 && lists_segments()) {
        take_layers(sizes[axis]);
      } else if (is_of_space && (sizes[axis] != 1.0 || lengths.size() < 3)) {
        lengths.push_back(sizes[axis]);
        space_axes_.push_back(axis);
      } else if (sizes[axis] != 1.0) {
        refuse(path_,
               print("its axis %d of %g numbers is not spatial (%s); a scan has one value a sample: "
                     "extract one volume from it",
                     static_cast<int>(axis + 1), sizes[axis], kind.empty() ? "no direction" : kind.c_str()));
      }
    }
    if (lengths.size() < 2) refuse_field("sizes", "has fewer than two spatial axes");
    header_.geometry.dims = dims_of(path_, lengths);
    if (header_.geometry.dims.x > std::numeric_limits<int>::max() / header_.layers)
      refuse_field("sizes", "are too large");
    space_axes_.resize(std::min<std::size_t>(space_axes_.size(), 3));
    directions_ = directions;
  }

  /// Whether 3D Slicer wrote its segments into the header.
  bool lists_segments() const {
    return std::any_of(text_.keys.begin(), text_.keys.end(), [](const auto& key) {
      return key.first.starts_with("segment") && key.first.ends_with("_name");
    });
  }

  void take_layers(double count) {
    constexpr double most_layers = 4096.0;
    if (!(count <= most_layers) || count != std::trunc(count))
      refuse_field("sizes", "has no number of layers");
    header_.layers = static_cast<int>(count);
  }

  static bool is_kind_of_space(const std::string& kind) {
    return kind.empty() || kind == "domain" || kind == "space" || kind == "???" || kind == "none";
  }

  void take_frame() {
    StatedGeometry& geometry = header_.geometry;
    const std::optional<std::string> space = text_.field("space");
    const std::optional<double> dimension = text_.number(path_, "spacedimension");
    space_dimension_ = static_cast<std::size_t>(std::clamp(dimension.value_or(3.0), 0.0, 16.0));
    if (!space) {
      geometry.frame_says = has_directions_ ? "NRRD without 'space'" : "NRRD without 'space' and directions";
      return;
    }
    std::string name = lower_case(*space);
    const bool has_time = name.ends_with("-time") || (name.size() == 4 && name.back() == 't');
    if (has_time) name.resize(name.size() - (name.ends_with("-time") ? 5 : 1));
    if (!dimension) space_dimension_ = has_time ? 4 : 3;
    geometry.frame = patient_frame(name);
    geometry.frame_says = "space " + *space;
    const bool is_known =
        geometry.frame || name == "scanner-xyz" || name == "3d-right-handed" || name == "3d-left-handed";
    if (!is_known) geometry.frame_says += ", which is none of NRRD's";
  }

  void take_units() {
    const char* const name = has_directions_ ? "spaceunits" : "units";
    const std::optional<std::string> text = text_.field(name),
                                     unused = text_.field(has_directions_ ? "units" : "spaceunits");
    const auto millimetres = [](const std::optional<std::string>& units) {
      const std::vector<std::string> words = units ? words_in(*units) : std::vector<std::string>{};
      const std::optional<LengthUnit> unit = words.empty() ? std::nullopt : length_unit(words.front());
      return unit ? unit->mm : 0.0;
    };
    if (millimetres(unused) > 0.0 && millimetres(unused) != (text ? millimetres(text) : 1.0))
      header_.audit.push_back({"length_unit", Verdict::Warn,
                               std::string("the file states ") +
                                   (has_directions_ ? "units " : "space units ") + *unused + ", which its " +
                                   (has_directions_ ? "directions do" : "spacings do") +
                                   " not use, and they contradict the unit that is taken"});
    if (!text) return;
    std::vector<std::string> words = has_directions_ ? words_in(*text) : words_an_axis(name);
    if (!has_directions_) {
      std::vector<std::string> of_space;
      for (const std::size_t axis : space_axes_) of_space.push_back(words[axis]);
      words = of_space;
    }
    glm::dvec3 mm(1.0);
    for (std::size_t axis = 0; axis < std::min<std::size_t>(words.size(), 3); ++axis) {
      const std::optional<LengthUnit> unit = length_unit(words[axis]);
      if (!unit) {
        header_.audit.push_back(
            {"length_unit", Verdict::Warn,
             "the file states the unit '" + words[axis] + "', which is not a known unit of length"});
        return;
      }
      mm[static_cast<int>(axis)] = unit->mm;
    }
    if (words.size() < std::min<std::size_t>(space_axes_.size(), 3)) refuse_field(name, "has too few parts");
    if (words.size() == 2) mm.z = mm.x;
    header_.geometry.mm_per_unit = mm;
    const std::string first = length_unit(words[0])->name;
    const bool is_one = mm == glm::dvec3(mm.x);
    header_.geometry.unit_says =
        (is_one ? first : "units of " + print("%g, %g and %g mm", mm.x, mm.y, mm.z)) +
        (has_directions_ ? " (space units)" : " (units)");
  }

  /// The numbers of "(1,2,3)". Numbers after the third belong to time and are ignored.
  glm::dvec3 vector_of(const char* name, const std::string& text) const {
    const bool has_brackets = text.size() >= 2 && text.front() == '(';
    const std::optional<std::vector<double>> numbers =
        has_brackets ? numbers_in(text.substr(
                           1, text.find(')') == std::string::npos ? text.size() : text.find(')') - 1))
                     : std::nullopt;
    if (!numbers || numbers->size() != space_dimension_)
      refuse_field(name, "has '" + text.substr(0, 100) + "' instead of a vector of " +
                             std::to_string(space_dimension_) + " numbers, as (1,0,0)");
    glm::dvec3 vector(0.0);
    for (std::size_t i = 0; i < std::min<std::size_t>(numbers->size(), 3); ++i)
      vector[static_cast<int>(i)] = (*numbers)[i];
    return vector;
  }

  void take_directions() {
    StatedGeometry& geometry = header_.geometry;
    for (std::size_t i = 0; i < space_axes_.size(); ++i)
      geometry.file_from_voxel[static_cast<int>(i)] =
          glm::dvec4(vector_of("space directions", directions_[space_axes_[i]]), 0.0);
    if (const std::optional<std::string> origin = text_.field("spaceorigin"))
      geometry.file_from_voxel[3] =
          glm::dvec4(vector_of("space origin", words_in(*origin).empty() ? "" : words_in(*origin)[0]), 1.0);
    else
      warn_of_origin();
    warn_of_other_spacings();
    warn_of_ends();
    if (text_.field("measurementframe"))
      header_.audit.push_back({"measurement_frame", Verdict::Pass,
                               "the file's measurement frame is ignored: it applies only to vectors and "
                               "tensors, and a scan holds neither"});
  }

  /// NRRD defines no meaning for axis mins and axis maxs if there are directions. They are not used, and the
  /// audit has a warning.
  void warn_of_ends() {
    for (const char* name : {"axismins", "axismaxs"}) {
      const std::vector<double> ends = numbers_an_axis(name);
      if (std::none_of(ends.begin(), ends.end(), [](double end) { return std::isfinite(end); })) continue;
      header_.audit.push_back({"origin", Verdict::Warn,
                               "the file states both where its axes begin or end (axis mins, axis maxs) and "
                               "space origin and directions: the latter are used"});
      return;
    }
  }

  /// NRRD defines no meaning for spacings if there are directions. Warns if spacings and directions differ,
  /// because one of them is wrong.
  void warn_of_other_spacings() {
    const std::vector<double> spacings = numbers_an_axis("spacings");
    for (std::size_t i = 0; i < space_axes_.size(); ++i) {
      const double stated = std::abs(spacings[space_axes_[i]]),
                   taken = glm::length(glm::dvec3(header_.geometry.file_from_voxel[static_cast<int>(i)]));
      if (!std::isfinite(stated) || std::abs(stated - taken) <= 1e-3 * taken) continue;
      header_.audit.push_back(
          {"spacing", Verdict::Warn,
           print(
               "the file states spacings of %.6g along axis %zu and directions %.6g long: the directions are "
               "taken",
               stated, i + 1, taken)});
      return;
    }
  }

  void warn_of_origin() {
    header_.audit.push_back({"origin", Verdict::Warn,
                             "the file states no origin: its first sample is assumed to lie at 0, 0, 0"});
  }

  /// The numbers of a field with one number for each axis. Numbers may be nan; all are nan if the field is
  /// absent.
  std::vector<double> numbers_an_axis(const char* name) const {
    const std::vector<double> numbers = text_.numbers(path_, name, axis_count_);
    return numbers.empty() ? std::vector<double>(axis_count_, std::numeric_limits<double>::quiet_NaN())
                           : numbers;
  }

  /// Reads the older fields, which state the spacings or the ends of single axes.
  void take_spacings() {
    StatedGeometry& geometry = header_.geometry;
    const std::vector<double> spacings = numbers_an_axis("spacings");
    const std::vector<double> lows = numbers_an_axis("axismins"), highs = numbers_an_axis("axismaxs");
    std::vector<std::string> centers = words_an_axis("centers");
    if (centers.empty()) centers = words_an_axis("centerings");
    bool has_origin = false, guesses_spacing = false, guesses_center = false;
    for (std::size_t i = 0; i < space_axes_.size(); ++i) {
      const std::size_t axis = space_axes_[i];
      const std::string center = centers.empty() ? "" : lower_case(centers[axis]);
      const bool is_node = center == "node";
      double spacing = spacings[axis];
      if (const double stretch = highs[axis] - lows[axis],
          cells = geometry.dims[static_cast<int>(i)] - (is_node ? 1 : 0);
          std::isfinite(spacing) && std::isfinite(stretch) && cells > 0.0 &&
          std::abs(stretch / cells - spacing) > 1e-3 * std::abs(spacing) &&
          std::abs(stretch / (cells + (is_node ? 1 : -1)) - spacing) > 1e-3 * std::abs(spacing))
        header_.audit.push_back(
            {"spacing", Verdict::Warn,
             print("axis %zu has a spacing of %.6g, but its ends imply %.6g: the spacing is taken", axis + 1,
                   spacing, stretch / cells)});
      if (!std::isfinite(spacing)) {
        const double cells = geometry.dims[static_cast<int>(i)] - (is_node ? 1 : 0);
        spacing = cells > 0.0 ? (highs[axis] - lows[axis]) / cells : std::numeric_limits<double>::quiet_NaN();
      }
      if (!std::isfinite(spacing)) {
        spacing = 1.0;
        guesses_spacing = true;
      }
      geometry.file_from_voxel[static_cast<int>(i)][static_cast<int>(i)] = spacing;
      if (!std::isfinite(lows[axis])) continue;
      has_origin = true;
      guesses_center = guesses_center || (!is_node && center != "cell");
      geometry.file_from_voxel[3][static_cast<int>(i)] = lows[axis] + (is_node ? 0.0 : 0.5 * spacing);
    }
    warn_of_minus_signs("spacings", spacings, header_);
    if (guesses_spacing)
      header_.audit.push_back(
          {"spacing", Verdict::Warn,
           "the file states no spacing along some axis: 1 in its unit of length is assumed"});
    if (guesses_center)
      header_.audit.push_back(
          {"origin", Verdict::Warn,
           "the file states where its axes begin, but not whether a sample lies there or half a "
           "voxel further (centers): the latter is assumed"});
    if (!has_origin) warn_of_origin();
  }

  void take_samples() {
    SampleFiles& samples = header_.samples;
    const std::string type = lower_case(need("type"));
    const auto known = nrrd_types().find(type);
    if (known == nrrd_types().end())
      refuse_field("type", "is '" + type + "', which is not a type of numbers");
    samples.stored.type = known->second;
    take_encoding();
    take_endian();
    const std::string data = text_.field("datafile").value_or("");
    if (data.empty()) {
      samples.files = {path_};
      samples.file_at = text_.end;
    } else {
      samples.files = data_files(path_, data, text_.listed);
    }
    take_skips();
    header_.audit.push_back(rescale_finding(samples.stored, "NRRD states no scaling"));
    const std::optional<std::string> low = text_.field("oldmin"), high = text_.field("oldmax");
    if (low || high)
      header_.audit.push_back({"old_range", Verdict::Warn,
                               "the file's numbers represent values from " + low.value_or("?") + " to " +
                                   high.value_or("?") +
                                   " before they were quantised (old min, old max): the numbers "
                                   "were taken as they are"});
  }

  void take_encoding() {
    SampleFiles& samples = header_.samples;
    using Encoding = SampleFiles::Encoding;
    static const std::map<std::string, Encoding> encodings{
        {"raw", Encoding::Raw},    {"gzip", Encoding::Deflated}, {"gz", Encoding::Deflated},
        {"ascii", Encoding::Text}, {"text", Encoding::Text},     {"txt", Encoding::Text},
        {"hex", Encoding::Hex}};
    const std::string encoding = lower_case(need("encoding"));
    if (encoding == "bzip2" || encoding == "bz2")
      refuse(
          path_,
          "its samples are packed by bzip2, which is not read here: save it with the encoding gzip or raw");
    const auto known = encodings.find(encoding);
    if (known == encodings.end()) refuse_field("encoding", "is '" + encoding + "', which is none of NRRD's");
    samples.encoding = known->second;
  }

  void take_endian() {
    SampleFiles& samples = header_.samples;
    const std::optional<std::string> endian = text_.field("endian");
    if (endian && lower_case(*endian) != "little" && lower_case(*endian) != "big")
      refuse_field("endian", "is neither little nor big");
    samples.stored.big_endian = endian && lower_case(*endian) == "big";
    const bool matters = samples.encoding != SampleFiles::Encoding::Text && bytes_of(samples.stored.type) > 1;
    if (!endian && matters)
      header_.audit.push_back(
          {"byte_order", Verdict::Warn,
           "the file does not state the order of its bytes (endian): little-endian is assumed"});
  }

  void take_skips() {
    SampleFiles& samples = header_.samples;
    const double lines = text_.number(path_, "lineskip").value_or(0.0);
    const double bytes = text_.number(path_, "byteskip").value_or(0.0);
    constexpr double most = 1e15;
    if (!(lines >= 0.0 && lines <= most) || lines != std::trunc(lines))
      refuse_field("line skip", "is not a number of lines");
    if (!(bytes >= -1.0 && bytes <= most) || bytes != std::trunc(bytes))
      refuse_field("byte skip", "is not a number of bytes");
    samples.line_skip = static_cast<std::uintmax_t>(lines);
    samples.at_end = bytes < 0.0;
    if (samples.at_end && samples.encoding != SampleFiles::Encoding::Raw)
      refuse_field("byte skip", "is -1, which only raw samples can have");
    if (!samples.at_end) samples.byte_skip = static_cast<std::uintmax_t>(bytes);
  }

  void take_meaning() {
    const auto key = [&](const char* name) {
      const auto found = text_.keys.find(name);
      return found == text_.keys.end() ? std::string() : found->second;
    };
    header_.meaning = key(meaning_key);
    header_.modality = key(modality_key);
    if (header_.modality.empty()) header_.modality = key("DICOM_0008_0060");
    if (text_.keys.contains(padding_key)) take_padding(key(padding_key), header_);
    const std::optional<std::string> unit = text_.field("sampleunits");
    if (!unit) return;
    std::string name = lower_case(*unit);
    std::erase(name, '"');
    const bool is_hounsfield = name == "hu" || name.starts_with("hounsfield");
    if (header_.meaning.empty() && is_hounsfield) header_.meaning = "HU";
    if (!is_hounsfield)
      header_.audit.push_back({"sample_units", Verdict::Warn,
                               "the file states the unit '" + *unit + "' for its values, which is not used"});
  }

  const fs::path& path_;
  TextHeader text_;
  std::size_t axis_count_ = 0, space_dimension_ = 3;
  bool has_directions_ = false;
  std::vector<std::size_t> space_axes_;  ///< at most three
  std::vector<std::string> directions_;
  VolumeHeader header_;
};

}  // namespace

VolumeHeader read_nrrd_header(const fs::path& path) {
  return NrrdReader(path).read();
}

}  // namespace octotomy::voxel

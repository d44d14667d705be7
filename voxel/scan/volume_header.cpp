// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/volume_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "voxel/scan/fill_ahead.h"
#include "voxel/scan/sample_stream.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

/// Refuses a NIfTI-1 header with impossible values, on some of which the library behind ITK hangs. Reads the
/// first kilobyte, unpacked, and passes over the extensions between header and samples.
class NiftiGate {
 public:
  explicit NiftiGate(const fs::path& path) : path_(path) {
    try {
      held_ = SampleStream(path, 0, is_gzip(path)).read(bytes_.data(), bytes_.size());
    } catch (const Error&) {
      // Refused below, as what is too short is.
    }
    if (held_ < header_bytes) refuse(path_, "is cut short or damaged within its header");
    constexpr auto size = static_cast<std::int32_t>(header_bytes);
    swapped_ = number<std::int32_t>(0) != size;
    if (number<std::int32_t>(0) == 540)
      refuse(path_, "is NIfTI-2; its header is not read here: save it as NIfTI-1");
    require(number<std::int32_t>(0) == size, "size");
    require(bytes_[344] == 'n' && bytes_[345] == '+' && bytes_[346] == '1', "magic (n+1 is expected)");
    check_dims();
    check_places();
    if (has_extensions()) check_extensions();
  }

  std::uintmax_t sample_bytes() const { return static_cast<std::uintmax_t>(number<std::int16_t>(72)) / 8; }
  std::uintmax_t samples_at() const { return static_cast<std::uintmax_t>(number<float>(108)); }

  /// A slope of zero is none.
  bool is_plain() const {
    const auto slope = number<float>(112);
    return !swapped_ && (slope == 0.0f || slope == 1.0f) && number<float>(116) == 0.0f;
  }

  /// The geometry in our own extension; none if that is absent or damaged.
  std::optional<glm::dmat4> exact_geometry() const {
    const auto samples_at = static_cast<std::size_t>(number<float>(108));
    if (!has_extensions()) return std::nullopt;
    for (std::size_t at = extensions_at; at + 8 <= std::min(held_, samples_at);) {
      const auto length = static_cast<std::size_t>(std::max(0, number<std::int32_t>(at)));
      if (length < shortest_extension || length > std::min(held_, samples_at) - at) break;
      const std::string_view text(bytes_.data() + at + 8, length - 8);
      if (number<std::int32_t>(at + 4) == nifti_text_extension && text.starts_with(nifti_geometry_mark))
        return rows_of(text.substr(nifti_geometry_mark.size()));
      at += length;
    }
    return std::nullopt;
  }

 private:
  static std::optional<glm::dmat4> rows_of(std::string_view text) {
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

  bool has_extensions() const { return held_ > header_bytes && bytes_[header_bytes] != 0; }

  /// The library behind ITK copies its list of extensions for each one more.
  void check_extensions() const {
    constexpr int most = 1024;  // programs write a handful
    SampleStream stream(path_, 0, is_gzip(path_));
    if (!skip(stream, extensions_at)) return;
    std::uintmax_t at = extensions_at;
    std::array<char, 8> head{};
    for (int count = 1; at + head.size() <= samples_at(); ++count) {
      if (stream.read(head.data(), head.size()) < head.size()) return;
      const auto length = static_cast<std::uintmax_t>(std::max(0, number_in<std::int32_t>(head.data())));
      if (length < shortest_extension || length > samples_at() - at) return;
      if (count > most)
        refuse(path_, "its NIfTI header has more than " + std::to_string(most) +
                          " extensions: save the volume without them");
      if (!skip(stream, length - head.size())) return;
      at += length;
    }
  }

  /// False where fewer bytes follow.
  static bool skip(SampleStream& stream, std::uintmax_t bytes) {
    std::array<char, 4096> part{};
    while (bytes > 0) {
      const auto wanted = static_cast<std::size_t>(std::min<std::uintmax_t>(bytes, part.size()));
      if (stream.read(part.data(), wanted) < wanted) return false;
      bytes -= wanted;
    }
    return true;
  }

  void check_dims() const {
    const int axis_count = number<std::int16_t>(40);
    require(axis_count >= 2 && axis_count <= 7, "number of axes");
    for (int axis = 1; axis <= axis_count; ++axis)
      require(number<std::int16_t>(40 + 2 * static_cast<std::size_t>(axis)) >= 1, "dims");
    // From 8-bit to 64-bit integers and floats, by NIfTI-1's codes.
    const std::map<int, int> bits_of = {{2, 8},   {4, 16},   {8, 32},   {16, 32},   {64, 64},
                                        {256, 8}, {512, 16}, {768, 32}, {1024, 64}, {1280, 64}};
    const auto type = bits_of.find(number<std::int16_t>(70));
    require(type != bits_of.end(), "type of samples");
    require(type->second == number<std::int16_t>(72), "bits of a sample");
  }

  void check_places() const {
    // No scanner reaches a kilometre, and no voxel is smaller than a nanometre.
    const auto check_range = [&](std::size_t first, std::size_t count, const char* what) {
      for (std::size_t i = 0; i < count; ++i) require(std::abs(number<float>(first + 4 * i)) <= 1e6f, what);
    };
    const float data_at = number<float>(108);
    require(data_at >= 348.0f && data_at <= 1e9f, "offset of the samples");
    check_range(76, 8, "spacing");
    for (std::size_t axis = 1; axis <= 3; ++axis)
      require(axis > static_cast<std::size_t>(number<std::int16_t>(40)) ||
                  std::abs(number<float>(76 + 4 * axis)) >= 1e-6f,
              "spacing");
    require(std::isfinite(number<float>(112)) && std::isfinite(number<float>(116)), "slope and intercept");
    if (number<std::int16_t>(252) > 0) check_range(256, 6, "quaternion");
    if (number<std::int16_t>(254) > 0) check_range(280, 12, "affine");
  }

  template <typename Number>
  Number number(std::size_t at) const {
    return number_in<Number>(bytes_.data() + at);
  }
  template <typename Number>
  Number number_in(const char* bytes) const {
    std::array<char, sizeof(Number)> raw{};
    std::copy_n(bytes, raw.size(), raw.begin());
    if (swapped_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
  }

  void require(bool holds, const char* what) const {
    if (!holds) refuse(path_, std::string("its NIfTI header is damaged: ") + what);
  }

  static constexpr std::size_t header_bytes = 348;
  static constexpr std::size_t extensions_at = header_bytes + 4;  // behind the flags that say there are any
  static constexpr std::size_t shortest_extension = 16;
  fs::path path_;
  std::array<char, 1024> bytes_{};
  std::size_t held_ = 0;
  bool swapped_ = false;
};

/// The text header of a NRRD or MetaImage, keys in lower case; empty for NIfTI.
class TextHeader {
 public:
  TextHeader(const fs::path& path, VolumeFormat format) : path_(path) {
    std::ifstream in = opened(path);
    if (!in) refuse(path, "cannot be opened; check that it is a file and that you may read it");
    std::string head(most_bytes, '\0');
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(in.gcount()));
    if (head.empty()) refuse(path, "the file is empty");
    check_magic(head, format);
    if (format != VolumeFormat::Nifti) parse(head, format);
    if (format == VolumeFormat::Meta) check_meta();
  }

  std::optional<std::string> value(const std::string& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? std::nullopt : std::optional<std::string>(found->second);
  }
  const std::map<std::string, std::string>& values() const { return values_; }
  /// The offset after MetaImage's last line, or after the empty line that ends NRRD's header.
  std::size_t end() const { return end_; }

 private:
  void check_magic(const std::string& head, VolumeFormat format) const {
    const auto at = [&](std::size_t i) {
      return i < head.size() ? static_cast<unsigned>(static_cast<unsigned char>(head[i])) : 0u;
    };
    bool held = false;
    if (format == VolumeFormat::Nrrd) {
      held = head.starts_with("NRRD00");
    } else if (format == VolumeFormat::Meta) {
      held = head.find("ElementDataFile") != std::string::npos;
    } else {
      const bool packed = extension_of(path_) == ".gz";
      const auto size = [&](unsigned low, unsigned high) {
        return (at(0) == low && at(1) == high) || (at(3) == low && at(2) == high);  // either byte order
      };
      held = packed ? at(0) == 0x1f && at(1) == 0x8b : size(0x5c, 0x01) || size(0x1c, 0x02);
    }
    if (!held)
      refuse(path_, std::string("is not a ") + name_of(format) +
                        " file, though its extension says so; rename it to its real format");
  }

  void parse(const std::string& head, VolumeFormat format) {
    std::size_t lines = 0;
    for (std::size_t at = 0; at < head.size();) {
      if (++lines > most_lines) refuse_length(format);
      const std::size_t end = std::min(head.find('\n', at), head.size());
      const std::string line = trimmed(head.substr(at, end - at));
      at = end + 1;
      if (format == VolumeFormat::Nrrd && line.empty()) {
        end_ = at;
        break;
      }
      const std::size_t mark = line.find(format == VolumeFormat::Nrrd ? ':' : '=');
      if (format == VolumeFormat::Meta) check_meta_line(line, mark);
      if (mark == std::string::npos || line.front() == '#') continue;
      const std::string key = lower_case(trimmed(line.substr(0, mark)));
      std::string value = line.substr(mark + 1);
      if (value.starts_with('=')) value.erase(0, 1);  // NRRD's key:=value
      values_[key] = trimmed(value);
      if (key == "elementdatafile") {
        end_ = at;
        break;
      }
    }
    if (end_ == 0 && head.size() == most_bytes) refuse_length(format);
  }

  [[noreturn]] void refuse_length(VolumeFormat format) const {
    refuse(path_, std::string("its ") + name_of(format) + " header is longer than " +
                      std::to_string(most_lines) + " lines or " + std::to_string(most_bytes >> 20) +
                      " MB: save the volume without its additional fields");
  }

  /// MetaIO writes beyond its buffers on a line that it cannot parse.
  void check_meta_line(const std::string& line, std::size_t mark) const {
    constexpr std::size_t longest = 250;  // MetaIO's words have 255 bytes
    const bool is_plain = std::all_of(line.begin(), line.end(), [](char letter) {
      return letter == '\t' || (letter >= 32 && letter < 127);
    });
    if (mark == std::string::npos || mark == 0 || mark > longest || !is_plain || line.size() - mark > longest)
      refuse(path_, "its MetaImage header is damaged: a line is not a short 'Key = Value'");
  }

  /// MetaIO takes missing numbers from the next lines.
  void check_meta() const {
    if (!value("elementdatafile")) refuse(path_, "its MetaImage header does not end with ElementDataFile");
    const std::vector<double> axes = numbers("ndims", 1);
    if (axes.empty() || !(axes[0] >= 2.0 && axes[0] <= 4.0))
      refuse(path_, "its MetaImage header is damaged: NDims is not 2, 3 or 4");
    const auto axis_count = static_cast<std::size_t>(axes[0]);
    for (const char* key :
         {"dimsize", "elementspacing", "elementsize", "offset", "position", "origin", "centerofrotation"})
      numbers(key, axis_count);
    for (const char* key : {"transformmatrix", "orientation", "rotation"})
      numbers(key, axis_count * axis_count);
    for (const char* key : {"compresseddatasize", "headersize", "elementnumberofchannels"}) numbers(key, 1);
    if (!value("dimsize")) refuse(path_, "its MetaImage header is damaged: DimSize is missing");
    for (const double length : numbers("dimsize", axis_count))
      if (!(length >= 1.0 && length <= std::numeric_limits<int>::max()) || length != std::trunc(length))
        refuse(path_, "its MetaImage header is damaged: DimSize");
    for (const double step : numbers("elementspacing", axis_count))
      if (step == 0.0) refuse(path_, "its MetaImage header is damaged: ElementSpacing");
  }

  /// The numbers of a key: none if it is absent, else `count` finite ones.
  std::vector<double> numbers(const std::string& key, std::size_t count) const {
    std::vector<double> found;
    const std::optional<std::string> text = value(key);
    if (!text) return found;
    std::istringstream words(*text);
    for (std::string word; words >> word;) {
      double number = 0.0;
      if (word.starts_with('+')) word.erase(0, 1);
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
      const bool held = error == std::errc() && end == word.data() + word.size() && std::isfinite(number);
      if (held) found.push_back(number);
      if (!held || found.size() > count) break;
    }
    if (found.size() != count || !words.eof())
      refuse(path_,
             "its MetaImage header is damaged: " + key + " needs " + std::to_string(count) + " numbers");
    return found;
  }

  /// The library behind ITK looks through all lines for each one more. Segmentations have the longest
  /// headers: some ten lines a segment.
  static constexpr std::size_t most_lines = 8192;
  static constexpr std::size_t most_bytes = std::size_t{4} << 20;
  fs::path path_;
  std::map<std::string, std::string> values_;
  std::size_t end_ = 0;
};

/// A field that says yes or no in a word.
bool says(const VolumeHeader& header, const char* key, const char* word, const char* otherwise) {
  return lower_case(header.field(key).value_or(otherwise)) == word;
}

bool is_in_several_files(const std::string& data_file) {
  return data_file.starts_with("LIST") || data_file.find('%') != std::string::npos;
}

fs::path beside(const fs::path& header_file, const std::string& name) {
  return fs::absolute(header_file).parent_path() / name;  // an absolute name stays itself
}

constexpr bool is_little = std::endian::native == std::endian::little;

void place_nrrd_samples(const fs::path& path, std::size_t header_end, VolumeHeader& header) {
  const std::string data = header.field("data file").value_or(header.field("datafile").value_or(""));
  const std::string encoding = lower_case(header.field("encoding").value_or("raw"));
  header.is_packed = encoding == "gzip" || encoding == "gz";
  // The library itself checks skipped bytes and samples in several files.
  const auto absent = [&](const char* key) { return !header.field(key); };
  if (is_in_several_files(data) || !absent("byte skip") || !absent("byteskip") || !absent("line skip") ||
      !absent("lineskip"))
    return;
  header.data_file = data.empty() ? path : beside(path, data);
  if (data.empty()) header.data_at = header_end;
  header.is_plain = (header.is_packed || encoding == "raw") &&
                    says(header, "endian", is_little ? "little" : "big", is_little ? "little" : "big");
}

void place_meta_samples(const fs::path& path, std::size_t header_end, VolumeHeader& header) {
  const std::string data = header.field("elementdatafile").value_or("");
  header.is_packed = says(header, "compresseddata", "true", "false");
  if (is_in_several_files(data)) return;
  const bool is_local = lower_case(data) == "local";
  header.data_file = is_local ? path : beside(path, data);
  if (is_local) header.data_at = header_end;
  header.is_plain = says(header, "binarydata", "true", "true") &&
                    (header.is_packed || says(header, "compresseddata", "false", "false")) &&
                    says(header, "binarydatabyteordermsb", is_little ? "false" : "true", "false") &&
                    says(header, "elementbyteordermsb", is_little ? "false" : "true", "false") &&
                    !header.field("headersize") && !header.field("elementtointensityfunctionslope") &&
                    !header.field("elementtointensityfunctionoffset");
}

/// A packed NIfTI file is packed as a whole, header included; of others the samples are.
bool is_packed_whole(VolumeFormat format, const VolumeHeader& header) {
  return header.is_packed && format == VolumeFormat::Nifti;
}
SampleStream stream_of(VolumeFormat format, const VolumeHeader& header) {
  return {header.data_file, is_packed_whole(format, header) ? 0 : header.data_at, header.is_packed};
}
/// The bytes of the stream that are no samples yet.
std::uintmax_t before_samples(VolumeFormat format, const VolumeHeader& header) {
  return is_packed_whole(format, header) ? header.data_at : 0;
}

[[noreturn]] void refuse_short(const fs::path& path, std::uintmax_t held, std::uintmax_t bytes) {
  refuse(path, "its samples are cut short: " + std::to_string(held) + " bytes of " + std::to_string(bytes));
}

/// Upper bound on the bytes of samples in the file.
std::uintmax_t most_bytes(const fs::path& path, VolumeFormat format, const VolumeHeader& header) {
  // Deflate packs at most 1032 bytes into one; a text encoding at most 8 into two characters.
  constexpr std::uintmax_t densest = 1100;
  bool packed = false;
  std::string data_file;
  if (format == VolumeFormat::Nifti) {
    packed = extension_of(path) == ".gz";
  } else if (format == VolumeFormat::Nrrd) {
    packed = lower_case(header.field("encoding").value_or("raw")) != "raw";
    data_file = header.field("data file").value_or(header.field("datafile").value_or(""));
  } else {
    packed = lower_case(header.field("compresseddata").value_or("false")) == "true" ||
             lower_case(header.field("binarydata").value_or("true")) == "false";
    data_file = header.field("elementdatafile").value_or("LOCAL");
    if (lower_case(data_file) == "local") data_file.clear();
  }
  std::uintmax_t bytes = 0;
  std::error_code error;
  if (data_file.empty()) {
    bytes = fs::file_size(path);
  } else if (is_in_several_files(data_file)) {
    fs::directory_iterator entry(fs::absolute(path).parent_path(), error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error))
      if (std::error_code ignored; entry->is_regular_file(ignored)) bytes += fs::file_size(entry->path());
  } else {
    const fs::path data = beside(path, data_file);
    if (!fs::is_regular_file(data, error))
      refuse(path, "its data file '" + data_file + "' is missing; keep header and data together");
    bytes = fs::file_size(data);
  }
  return packed ? bytes * densest : bytes;
}

}  // namespace

std::optional<std::string> VolumeHeader::field(const std::string& key) const {
  const auto found = fields.find(key);
  return found == fields.end() ? std::nullopt : std::optional<std::string>(found->second);
}

const char* name_of(VolumeFormat format) {
  switch (format) {
    case VolumeFormat::Nifti:
      return "NIfTI";
    case VolumeFormat::Nrrd:
      return "NRRD";
    case VolumeFormat::Meta:
      return "MetaImage";
  }
  return "";
}

std::optional<VolumeFormat> volume_format(const fs::path& path) {
  const std::string name = lower_case(path.filename().string());
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return VolumeFormat::Nifti;
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return VolumeFormat::Nrrd;
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return VolumeFormat::Meta;
  return std::nullopt;
}

VolumeHeader read_volume_header(const fs::path& path, VolumeFormat format) {
  const TextHeader text(path, format);
  VolumeHeader header;
  header.fields = text.values();
  if (format == VolumeFormat::Nifti) {
    const NiftiGate gate(path);
    header.lps_from_voxel = gate.exact_geometry();
    header.data_file = path;
    header.data_at = gate.samples_at();
    header.sample_bytes = gate.sample_bytes();
    header.is_packed = is_gzip(path);
    header.is_plain = gate.is_plain();
  } else if (format == VolumeFormat::Nrrd) {
    place_nrrd_samples(path, text.end(), header);
  } else {
    place_meta_samples(path, text.end(), header);
  }
  header.most_bytes = most_bytes(path, format, header);
  return header;
}

void read_plain_samples(const fs::path& path, VolumeFormat format, const VolumeHeader& header, char* samples,
                        std::uintmax_t bytes, const std::function<void(std::uintmax_t held)>& held) {
  SampleStream stream = stream_of(format, header);
  std::vector<char> before(before_samples(format, header));
  if (stream.read(before.data(), before.size()) < before.size()) refuse_short(path, 0, bytes);
  const std::uintmax_t count = fill_ahead(samples, bytes, [&](char* part, std::size_t wanted) {
    if (held) held(static_cast<std::uintmax_t>(part - samples));
    return stream.read(part, wanted);
  });
  if (count < bytes) refuse_short(path, count, bytes);
  if (header.is_packed) stream.skip_rest();
}

void require_samples(const fs::path& path, VolumeFormat format, const VolumeHeader& header,
                     std::uintmax_t bytes) {
  if (header.data_file.empty()) return;
  const bool is_text = says(header, "binarydata", "false", "true") ||
                       (!header.is_packed && !says(header, "encoding", "raw", "raw"));
  if (is_text) return;  // the library counts the numbers that it parses
  const std::uintmax_t before = header.is_packed ? before_samples(format, header) : header.data_at;
  const std::uintmax_t held =
      header.is_packed ? stream_of(format, header).skip_rest() : fs::file_size(header.data_file);
  if (held < before + bytes) refuse_short(path, held - std::min(held, before), bytes);
}

}  // namespace octotomy::voxel

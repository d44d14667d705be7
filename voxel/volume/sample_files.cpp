// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/sample_files.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"
#include "voxel/volume/fill_ahead.h"
#include "voxel/volume/sample_stream.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using Encoding = SampleFiles::Encoding;

[[noreturn]] void refuse_short(const fs::path& path, std::uintmax_t held, std::uintmax_t bytes) {
  refuse(path, "its samples are cut short: " + std::to_string(held) + " bytes of " + std::to_string(bytes));
}

/// The offset at which the stored samples begin in a file. `bytes` is the samples' size; it is used only if
/// they are raw and at the end of the file.
std::uintmax_t begin_of(const fs::path& path, const SampleFiles& from, const fs::path& file,
                        std::uintmax_t bytes) {
  if (from.at_end) {
    const std::uintmax_t size = fs::file_size(file);
    if (size < bytes) refuse_short(path, size, bytes);
    return size - bytes;
  }
  std::uintmax_t at = from.file_at;
  if (from.line_skip > 0) {
    std::ifstream in = opened(file);
    in.seekg(static_cast<std::streamoff>(at));
    for (std::uintmax_t line = 0; line < from.line_skip; ++line)
      if (!in.ignore(std::numeric_limits<std::streamsize>::max(), '\n') || in.eof())
        refuse(path, "has fewer than the " + std::to_string(from.line_skip) + " lines that its header skips");
    at = static_cast<std::uintmax_t>(in.tellg());
  }
  return from.encoding == Encoding::Raw ? at + from.byte_skip : at;
}

/// Reads the bytes of raw or compressed samples, file by file.
class SampleBytes {
 public:
  SampleBytes(const fs::path& path, const SampleFiles& from, std::uintmax_t bytes)
      : path_(path), from_(from), bytes_a_file_(bytes / from.files.size()) {}

  std::size_t read(char* to, std::size_t wanted) {
    std::size_t held = 0;
    while (held < wanted) {
      if (left_ == 0 && !open_next()) break;
      const auto part = static_cast<std::size_t>(std::min<std::uintmax_t>(left_, wanted - held));
      const std::size_t count = stream_->read(to + held, part);
      held += count;
      left_ -= count;
      if (count < part) break;
      if (left_ == 0) close();
    }
    return held;
  }
  std::uintmax_t behind() const { return behind_; }

 private:
  bool open_next() {
    if (next_ == from_.files.size()) return false;
    const fs::path& file = from_.files[next_++];
    const bool is_packed = from_.encoding == Encoding::Deflated;
    const std::uintmax_t begin = begin_of(path_, from_, file, bytes_a_file_);
    stream_.emplace(file, begin, is_packed);
    left_ = bytes_a_file_;
    if (is_packed)
      skip(from_.byte_skip);
    else
      raw_end_ = begin + bytes_a_file_;
    return true;
  }

  void skip(std::uintmax_t bytes) {
    std::vector<char> part(std::size_t{1} << 16);
    while (bytes > 0) {
      const auto wanted = static_cast<std::size_t>(std::min<std::uintmax_t>(bytes, part.size()));
      if (stream_->read(part.data(), wanted) < wanted) refuse_short(path_, 0, bytes_a_file_);
      bytes -= wanted;
    }
  }

  /// Reads compressed samples to their end, so that their checksum is verified.
  void close() {
    if (from_.encoding == Encoding::Deflated) {
      behind_ += stream_->skip_rest();
    } else {
      const std::uintmax_t size = fs::file_size(from_.files[next_ - 1]);
      behind_ += size - std::min(size, raw_end_);
    }
    stream_.reset();
  }

  const fs::path& path_;
  const SampleFiles& from_;
  std::uintmax_t bytes_a_file_, left_ = 0, behind_ = 0, raw_end_ = 0;
  std::size_t next_ = 0;
  std::optional<SampleStream> stream_;
};

std::string text_of(const fs::path& path, const SampleFiles& from, const fs::path& file) {
  std::ifstream in = opened(file);
  in.seekg(static_cast<std::streamoff>(begin_of(path, from, file, 0) + from.byte_skip));
  return {std::istreambuf_iterator<char>(in), {}};
}

bool is_blank(char letter) {
  return letter == ' ' || letter == ',' || (letter >= '\t' && letter <= '\r');
}

/// Parses a real number as std::from_chars() does. It is an error if the value is not an integer.
std::pair<const char*, std::errc> whole_number(const char* begin, const char* end, double& real) {
  const auto [rest, error] = std::from_chars(begin, end, real);
  return {rest, error == std::errc() && real != std::trunc(real) ? std::errc::invalid_argument : error};
}

/// Parses numbers of a type from text. Returns the text that follows the last number.
template <typename Number>
std::string_view parse(const fs::path& path, std::string_view text, char* to, std::uintmax_t count) {
  for (std::uintmax_t i = 0; i < count; ++i) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    if (text.empty())
      refuse(path,
             "its samples are cut short: " + std::to_string(i) + " numbers of " + std::to_string(count));
    const std::size_t sign = text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0;
    Number number{};
    const char* const begin = text.data() + sign;
    const auto is_end = [&](const char* at) { return at == text.data() + text.size() || is_blank(*at); };
    auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
    if (std::is_integral_v<Number> && error == std::errc() && !is_end(end)) {
      // The number may be an integer that is written as a real number: 3.0 or 1e3.
      double real = 0.0;
      std::tie(end, error) = whole_number(begin, text.data() + text.size(), real);
      if (real >= static_cast<double>(std::numeric_limits<Number>::min()) &&
          real <= static_cast<double>(std::numeric_limits<std::int32_t>::max()) &&
          real <= static_cast<double>(std::numeric_limits<Number>::max()))
        number = static_cast<Number>(real);
      else
        error = std::errc::result_out_of_range;
    }
    const auto used = static_cast<std::size_t>(end - text.data());
    if (error != std::errc() || !is_end(end))
      refuse(path, "sample " + std::to_string(i + 1) + " of its text is not a number of its type: '" +
                       shown(std::string(text.substr(0, 20))) + "'");
    std::memcpy(to + i * sizeof(Number), &number, sizeof(Number));
    text.remove_prefix(used);
  }
  return text;
}

std::string_view parse_text(const fs::path& path, std::string_view text, SampleType type, char* to,
                            std::uintmax_t count) {
  switch (type) {
    case SampleType::Int8:
      return parse<std::int8_t>(path, text, to, count);
    case SampleType::UInt8:
      return parse<std::uint8_t>(path, text, to, count);
    case SampleType::Int16:
      return parse<std::int16_t>(path, text, to, count);
    case SampleType::UInt16:
      return parse<std::uint16_t>(path, text, to, count);
    case SampleType::Int32:
      return parse<std::int32_t>(path, text, to, count);
    case SampleType::UInt32:
      return parse<std::uint32_t>(path, text, to, count);
    case SampleType::Int64:
      return parse<std::int64_t>(path, text, to, count);
    case SampleType::UInt64:
      return parse<std::uint64_t>(path, text, to, count);
    case SampleType::Float:
      return parse<float>(path, text, to, count);
    case SampleType::Double:
      return parse<double>(path, text, to, count);
  }
  return text;
}

std::string_view parse_hex(const fs::path& path, std::string_view text, char* to, std::uintmax_t count) {
  const auto digit = [&]() -> unsigned {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    unsigned value = 16;
    if (!text.empty()) std::from_chars(text.data(), text.data() + 1, value, 16);
    if (value > 15) refuse(path, "its hexadecimal samples are cut short or damaged");
    text.remove_prefix(1);
    return value;
  };
  for (std::uintmax_t i = 0; i < count; ++i) {
    const unsigned high = digit();
    to[i] = static_cast<char>(high * 16 + digit());
  }
  return text;
}

}  // namespace

std::uintmax_t read_sample_files(const fs::path& path, const SampleFiles& from, char* samples,
                                 std::uintmax_t bytes, const std::function<void(std::uintmax_t held)>& held) {
  if (from.encoding == Encoding::Raw || from.encoding == Encoding::Deflated) {
    SampleBytes source(path, from, bytes);
    const std::uintmax_t count = fill_ahead(samples, bytes, [&](char* part, std::size_t wanted) {
      if (held) held(static_cast<std::uintmax_t>(part - samples));
      return source.read(part, wanted);
    });
    if (count < bytes) refuse_short(path, count, bytes);
    return source.behind();
  }
  std::uintmax_t behind = 0;
  const std::uintmax_t part = bytes / from.files.size();
  for (std::size_t i = 0; i < from.files.size(); ++i) {
    const std::string text = text_of(path, from, from.files[i]);
    char* const to = samples + i * part;
    const std::string_view rest =
        from.encoding == Encoding::Hex
            ? parse_hex(path, text, to, part)
            : parse_text(path, text, from.stored.type, to, part / bytes_of(from.stored.type));
    behind += static_cast<std::uintmax_t>(
        std::count_if(rest.begin(), rest.end(), [](char letter) { return !is_blank(letter); }));
  }
  return behind;
}

}  // namespace octotomy::voxel

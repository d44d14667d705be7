// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/portable_map.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

bool is_between(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

/// Skips blanks and comments, then reads the number at `at` and moves `at` past it.
std::uint32_t number_at(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size() && (is_between(bytes[at]) || bytes[at] == '#'))
    at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), number);
  if (error != std::errc()) throw InvalidInput("is a PNM picture whose samples end early");
  at = static_cast<std::size_t>(end - bytes.data());
  return number;
}

}  // namespace

StoredImage read_portable_map(std::string_view bytes, std::size_t most_bytes) {
  const char kind = bytes.at(1);
  const bool is_text = kind == '2' || kind == '3';
  const std::size_t channels = kind == '3' || kind == '6' ? 3 : 1;
  std::size_t at = 2;
  const std::uint32_t width = number_at(bytes, at), height = number_at(bytes, at),
                      largest = number_at(bytes, at);
  ++at;  // one blank before the samples
  // As text, a sample takes at least a digit and a blank; the last sample needs no blank.
  const double samples = static_cast<double>(width) * height * static_cast<double>(channels);
  const double left = at < bytes.size() ? static_cast<double>(bytes.size() - at) : 0.0;
  if (width < 1 || height < 1 || 2.0 * samples > static_cast<double>(most_bytes))
    throw InvalidInput("is a PNM picture of a size that its file cannot hold");
  if (2.0 * samples > left + (is_text ? 1.0 : 0.0))
    throw InvalidInput("is a PNM picture whose samples end early");
  StoredImage image;
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.type = StoredImage::Type::UInt16;
  image.bytes.resize(std::size_t{2} * width * height);
  for (std::size_t i = 0; i < image.bytes.size(); i += 2) {
    std::array<std::uint32_t, 3> pixel{};
    for (std::size_t channel = 0; channel < channels; ++channel) {
      if (is_text) {
        pixel[channel] = number_at(bytes, at);
      } else {
        pixel[channel] = static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[at]) << 8 |
                                                    static_cast<std::uint8_t>(bytes[at + 1]));
        at += 2;
      }
      if (pixel[channel] > largest)
        throw InvalidInput("is a PNM picture with a sample of " + std::to_string(pixel[channel]) +
                           ", above the largest that its header states, " + std::to_string(largest) +
                           ": the file may be damaged");
      if (pixel[channel] != pixel[0]) throw InvalidInput("is a colour image; a scan is grey");
    }
    const auto sample = static_cast<std::uint16_t>(pixel[0]);
    std::memcpy(&image.bytes[i], &sample, sizeof sample);
  }
  return image;
}

}  // namespace octotomy::voxel

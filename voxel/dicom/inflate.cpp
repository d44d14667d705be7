// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/inflate.h"

#include <algorithm>
#include <zlib.h>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

class Stream {
 public:
  explicit Stream(std::string_view input) : input_(input) {
    if (inflateInit2(&stream_, -MAX_WBITS) != Z_OK)
      throw Error(ErrorCode::Resource, "no memory is left to inflate");
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() { inflateEnd(&stream_); }

  std::string run() {
    std::string output;
    std::string part(std::size_t{1} << 18, '\0');
    for (;;) {
      feed();
      stream_.next_out = reinterpret_cast<Bytef*>(part.data());
      stream_.avail_out = static_cast<uInt>(part.size());
      const int state = inflate(&stream_, Z_NO_FLUSH);
      output.append(part, 0, part.size() - stream_.avail_out);
      if (state == Z_STREAM_END) return output;
      if (state == Z_BUF_ERROR && at_ == input_.size())
        throw Error(ErrorCode::Input, "the deflated part is cut short");
      if (state != Z_OK)
        throw Error(ErrorCode::Input,
                    std::string("the deflated part is damaged: ") +
                        (stream_.msg != nullptr ? stream_.msg : "it does not follow the format"));
    }
  }

 private:
  void feed() {
    if (stream_.avail_in > 0 || at_ == input_.size()) return;
    const std::size_t count = std::min(input_.size() - at_, std::size_t{1} << 30);
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(input_.data() + at_));  // zlib only reads it
    stream_.avail_in = static_cast<uInt>(count);
    at_ += count;
  }

  std::string_view input_;
  std::size_t at_ = 0;
  z_stream stream_{};
};

}  // namespace

std::string inflate_raw(std::string_view deflated) {
  return Stream(deflated).run();
}

}  // namespace octotomy::voxel

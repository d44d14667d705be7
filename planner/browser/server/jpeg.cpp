// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/jpeg.h"

#include <cstdio>
#include <cstdlib>
#include <jpeglib.h>

#include "voxel/space/error.h"

namespace octotomy::planner::serve {

std::string jpeg_of(const glm::ivec2& size_px, const std::vector<std::uint8_t>& rgb) {
  constexpr int quality = 85;
  jpeg_compress_struct writer{};
  jpeg_error_mgr errors{};
  writer.err = jpeg_std_error(&errors);
  // libjpeg requires a handler that does not return, so it throws.
  errors.error_exit = [](j_common_ptr) {
    throw voxel::Error(voxel::ErrorCode::Resource, "a picture could not be compressed as JPEG");
  };
  jpeg_create_compress(&writer);
  unsigned char* bytes = nullptr;
  unsigned long count = 0;
  jpeg_mem_dest(&writer, &bytes, &count);
  writer.image_width = static_cast<JDIMENSION>(size_px.x);
  writer.image_height = static_cast<JDIMENSION>(size_px.y);
  writer.input_components = 3;
  writer.in_color_space = JCS_RGB;
  jpeg_set_defaults(&writer);
  jpeg_set_quality(&writer, quality, TRUE);
  writer.dct_method = JDCT_FASTEST;
  jpeg_start_compress(&writer, TRUE);
  while (writer.next_scanline < writer.image_height) {
    JSAMPROW row =
        const_cast<JSAMPROW>(rgb.data() + 3 * static_cast<std::size_t>(size_px.x) * writer.next_scanline);
    jpeg_write_scanlines(&writer, &row, 1);
  }
  jpeg_finish_compress(&writer);
  std::string made(reinterpret_cast<const char*>(bytes), count);
  jpeg_destroy_compress(&writer);
  std::free(bytes);  // NOLINT(cppcoreguidelines-no-malloc): jpeg_mem_dest allocates it
  return made;
}

}  // namespace octotomy::planner::serve

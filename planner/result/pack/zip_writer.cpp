// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/zip_writer.h"

#include <algorithm>
#include <minizip/zip.h>
#include <utility>
#include <zlib.h>

#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

/// 1980-01-01 in the encoding of MS-DOS: the earliest date of an entry in a zip archive.
constexpr unsigned long earliest_date = 0x00210000;
/// Compression level. Higher ones take three times as long and save only 2 %, because coordinates hardly
/// compress.
constexpr int level = 3;
/// minizip's functions take lengths of at most 32 bits.
constexpr std::size_t most_at_once = std::size_t{1} << 30;

}  // namespace

ZipWriter::ZipWriter(const std::filesystem::path& path)
    : path_(path), zip_(zipOpen64(path.c_str(), APPEND_STATUS_CREATE)) {
  if (zip_ == nullptr) refuse();
}

ZipWriter::~ZipWriter() {
  if (zip_ != nullptr) zipClose(zip_, nullptr);
}

void ZipWriter::refuse() const {
  throw voxel::Error(
      voxel::ErrorCode::Resource,
      path_.string() + ": cannot be written: free some space on the disk, or choose another path by -o");
}

void ZipWriter::add(const std::string& name, std::string_view bytes) {
  zip_fileinfo info{};
  info.dosDate = earliest_date;
  const int needs_64_bits = bytes.size() >= 0xffffffffU ? 1 : 0;
  if (zipOpenNewFileInZip64(zip_, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, level,
                            needs_64_bits) != ZIP_OK)
    refuse();
  for (std::size_t begin = 0; begin < bytes.size(); begin += most_at_once) {
    const std::size_t length = std::min(most_at_once, bytes.size() - begin);
    if (zipWriteInFileInZip(zip_, bytes.data() + begin, static_cast<unsigned>(length)) != ZIP_OK) refuse();
  }
  if (zipCloseFileInZip(zip_) != ZIP_OK) refuse();
}

void ZipWriter::close() {
  if (zipClose(std::exchange(zip_, nullptr), nullptr) != ZIP_OK) refuse();
}

}  // namespace octotomy::planner

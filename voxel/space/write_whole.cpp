// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/write_whole.h"

#include <cerrno>
#include <cstdio>

#include "voxel/space/staged_files.h"
#include "voxel/space/write_failure.h"

namespace octotomy::voxel {
namespace {

/// Writes the bytes to `path`. Error messages refer to the file as `named`.
void write_as(const std::filesystem::path& path, const std::filesystem::path& named,
              const std::string& bytes) {
  errno = 0;
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) refuse_unwritten(named, errno);
  const bool is_written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const int number = errno;
  const bool is_closed = std::fclose(file) == 0;
  if (!is_written) refuse_unwritten(named, number);
  if (!is_closed) refuse_unwritten(named, errno);
}

}  // namespace

void write_file(const std::filesystem::path& path, const std::string& bytes) {
  write_as(path, path, bytes);
}

void write_whole(const std::filesystem::path& path, const std::string& bytes) {
  StagedFiles staged(std::filesystem::absolute(path).parent_path());
  write_as(staged.folder() / path.filename(), path, bytes);
  staged.commit();
}

}  // namespace octotomy::voxel

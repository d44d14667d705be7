// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/disk_need.h"

#include <algorithm>
#include <array>
#include <string>
#include <sys/statvfs.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "voxel/space/file_text.h"
#include "voxel/space/rounded.h"
#include "voxel/space/staged_files.h"

namespace octotomy::voxel {
namespace {

/// `f_type` of the file systems on which a file takes at least its size: ext2 to ext4, XFS, tmpfs, FAT,
/// exFAT.
constexpr std::array<std::int64_t, 5> plain_kinds{0xef53, 0x58465342, 0x01021994, 0x4d44, 0x2011bab0};

std::string bytes_text(std::uint64_t bytes) {
  const auto count = static_cast<double>(bytes);
  if (bytes < 1000) return std::to_string(bytes) + " bytes";
  if (count < 1e6) return rounded(count / 1e3) + " kB";
  return count < 1e9 ? rounded(count / 1e6) + " MB" : rounded(count / 1e9) + " GB";
}

}  // namespace

std::optional<std::uint64_t> free_disk(const std::filesystem::path& folder) {
  struct statfs kind {};
  struct statvfs disk {};
  if (::statfs(folder.c_str(), &kind) != 0 || ::statvfs(folder.c_str(), &disk) != 0) return std::nullopt;
  const auto type = static_cast<std::int64_t>(kind.f_type) & 0xffffffff;
  if (std::find(plain_kinds.begin(), plain_kinds.end(), type) == plain_kinds.end() || disk.f_blocks == 0)
    return std::nullopt;
  // Blocks that are reserved for the superuser count as free only for the superuser.
  return std::uint64_t{::geteuid() == 0 ? disk.f_bfree : disk.f_bavail} * disk.f_frsize;
}

void need_disk(const std::filesystem::path& out, std::uint64_t least_bytes) {
  std::filesystem::path folder = place_of(out);
  std::error_code ignored;
  while (!std::filesystem::is_directory(folder, ignored) && folder.has_relative_path())
    folder = folder.parent_path();
  const std::optional<std::uint64_t> free = free_disk(folder);
  if (!free || least_bytes <= *free) return;
  refuse(out,
         "writing it takes at least " + bytes_text(least_bytes) + " of disk, " + bytes_text(*free) +
             " are free: make room, or choose another -o",
         ErrorCode::Resource);
}

}  // namespace octotomy::voxel

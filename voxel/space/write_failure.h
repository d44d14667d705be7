// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include "voxel/space/error.h"

namespace octotomy::voxel {

/// Advice for the error number of a failed write, which is appended to a message; empty unless the cause is a
/// full disk or a limit.
inline std::string way_out_of(int number) {
  if (number == EFBIG) return "; raise the limit on the size of files (ulimit -f)";
  return number == ENOSPC || number == EDQUOT ? "; make room on the disk" : "";
}

/// Throws Error with the file, the reason by the error number of the failed call, and advice. The code is
/// Input or Resource. If the number is 0, a stream failed for an unknown reason, most likely a full disk.
[[noreturn]] inline void refuse_unwritten(const std::filesystem::path& path, int number) {
  throw Error(number == 0 ? ErrorCode::Resource : code_of_errno(number),
              path.string() + ": cannot be written" +
                  (number == 0 ? "; the disk may be full, or a limit on the size of files reached (ulimit -f)"
                               : ": " + std::generic_category().message(number) + way_out_of(number)));
}

}  // namespace octotomy::voxel

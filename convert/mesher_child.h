// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "convert/mesher_process.h"

namespace octotomy::convert {

// The other side of mesher_process.h: what every mesher's own executable begins and ends with.

/// The request that this process was started with.
struct MesherTask {
  MesherRequest request;
  int answer_file = -1;
};
/// Reads the request from the standard input and sets its limits on this process, which from here on dies
/// with its parent. The standard output becomes the log, as libraries talk on it: the answer has a file of
/// its own. Ends the process where there is no request of this build.
MesherTask begin_mesher();

/// The next bytes of the request; false where there are not so many.
bool read_all(void* target, std::size_t bytes);
/// False where they cannot be written.
bool write_all(int file, const void* source, std::size_t bytes);

/// Ends the process without destroying anything.
[[noreturn]] void end_mesher(int status);

}  // namespace octotomy::convert

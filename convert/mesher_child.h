// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "convert/mesher_process.h"

namespace octotomy::convert {

// The other side of mesher_process.h: what every mesher's own executable has around its library.

/// The request that this process was started with.
struct MesherTask {
  MesherRequest request;
  int answer_file = -1;
};
/// A mesher's main(). Reads the request from the standard input and sets its limits on this process, which
/// from there on dies with its parent. The standard output becomes the log, as libraries talk on it: the
/// answer has a file of its own. Then `answer` reads what follows the request, works and writes; it returns
/// false where it could not read or write, and throws what the mesher ended with: TetGen its number. The
/// process ends without destroying anything, by the status that mesher_process.h has for it.
[[noreturn]] void run_mesher(bool (*answer)(const MesherTask& task));

/// The next bytes of the request; false where there are not so many.
bool read_all(void* target, std::size_t bytes);
/// False where they cannot be written.
bool write_all(int file, const void* source, std::size_t bytes);

}  // namespace octotomy::convert

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "convert/tet/mesher_process.h"

namespace octotomy::convert {

// The child's side of mesher_process.h, shared by the meshers' executables.

/// The request to this process.
struct MesherTask {
  MesherRequest request;
  int answer_file = -1;
};
/// A mesher's main(). Reads the request from the standard input and sets its limits on this process, which
/// from then on ends when its parent ends. Libraries print to the standard output, so the standard output
/// becomes the log and the answer gets its own file. `answer` reads the rest of the request, works and
/// writes; it returns false if it cannot read or write, and throws the mesher's own error, for TetGen a
/// number. The process exits at once, without destructors, with a status of mesher_process.h.
[[noreturn]] void run_mesher(bool (*answer)(const MesherTask& task));

/// Reads the next bytes of the request; false if there are fewer.
bool read_all(void* target, std::size_t bytes);
/// False if the bytes cannot be written.
bool write_all(int file, const void* source, std::size_t bytes);

}  // namespace octotomy::convert

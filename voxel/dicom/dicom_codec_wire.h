// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <sys/socket.h>
#include <sys/types.h>

// The messages between decompress() and the decompressing process over a socket. A request is a FrameHead,
// the transfer syntax, and for each fragment its length as std::uint64_t and its bytes. The answer is the
// length of the pixels as std::uint64_t, zero on failure, and the pixels. A head with zero columns requests
// facts about the process. The answer is then the length of a text and the text: "confined" or "not
// confined", then for each library a line of its name, a space and its version. The only argument of the
// process is an empty folder for its temporary files. The program removes this folder, or the process does if
// the program has ended. Both ends are built together, so the format has no version.

namespace octotomy::voxel {

struct FrameHead {
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  std::uint32_t allocated_bits = 0;
  std::uint32_t stored_bits = 0;
  std::uint32_t high_bit = 0;
  std::uint32_t is_signed = 0;
  std::uint32_t syntax_length = 0;
  std::uint32_t fragment_count = 0;
};

/// Sends or receives all bytes. Returns false if the connection is closed or the socket's time limit has
/// passed.
inline bool send_all(int socket, const void* bytes, std::size_t count) {
  for (const auto* at = static_cast<const char*>(bytes); count > 0;) {
    const ssize_t sent = send(socket, at, count, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent;
    count -= static_cast<std::size_t>(sent);
  }
  return true;
}

inline bool receive_all(int socket, void* bytes, std::size_t count) {
  for (auto* at = static_cast<char*>(bytes); count > 0;) {
    const ssize_t received = recv(socket, at, count, 0);
    if (received < 0 && errno == EINTR) continue;
    if (received <= 0) return false;
    at += received;
    count -= static_cast<std::size_t>(received);
  }
  return true;
}

}  // namespace octotomy::voxel

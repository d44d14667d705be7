// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "planner/network/received_files.h"

namespace octotomy::planner {

/// Splits a multipart body (RFC 2046, 5.1) into its parts while it arrives, and writes each part into a
/// folder. Stores at most 64 KB of the body, the header of a part and a boundary in memory.
class Multipart {
 public:
  /// `type` is the Content-Type of the answer. Throws PeerError if it is not multipart/related or names no
  /// boundary.
  Multipart(const std::string& type, ReceivedFiles& folder);
  /// Adds the next bytes of the body. Throws PeerError if the body is damaged or a part is no DICOM object.
  void add(std::string_view bytes);
  /// To be called after the last bytes. Throws PeerError if the body is not complete.
  void finish() const;

 private:
  enum class Place { Before, Header, Part, After };
  /// Processes the next piece of `held_`. Returns false if it needs more bytes.
  bool step();
  /// Counts `more` bytes outside of parts. Throws PeerError if there are too many.
  void need_end(std::size_t more);

  ReceivedFiles& folder_;
  std::string boundary_, held_;
  Place place_ = Place::Before;
  std::size_t beside_ = 0;  ///< bytes before the first and after the last part
  std::optional<ReceivedFiles::Part> part_;
};

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "planner/network/received_files.h"

namespace octotomy::planner {

/// Splits a multipart body (RFC 2046, 5.1) into its parts as it arrives and writes each part into a folder.
/// Holds at most 64 KB of the body, a part's header and a boundary in memory.
class Multipart {
 public:
  /// `type`: the answer's Content-Type. Throws PeerError if it names no boundary.
  Multipart(const std::string& type, ReceivedFiles& folder);
  /// Throws PeerError if the body is damaged or a part is no DICOM object.
  void add(std::string_view bytes);
  /// Throws PeerError unless the body has ended.
  void finish() const;

 private:
  enum class Place { Before, Header, Part, After };
  /// Consumes the next piece of `held_`; false if more bytes are needed.
  bool step();
  /// Throws PeerError if too many bytes belong to no part.
  void need_end(std::size_t more);

  ReceivedFiles& folder_;
  std::string boundary_, held_;
  Place place_ = Place::Before;
  std::size_t beside_ = 0;  ///< bytes before the first and after the last part
  std::optional<ReceivedFiles::Part> part_;
};

}  // namespace octotomy::planner

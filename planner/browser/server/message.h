// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "planner/operation/table/json.h"

// What goes over a page's WebSocket.
namespace octotomy::planner::serve {

/// A message to a page: JSON as text, or a packed frame.
struct Message {
  std::string bytes;
  bool is_binary = false;
};

/// What a page asks.
struct Request {
  std::int64_t id = 0;  ///< none: 0
  std::string what;     ///< the value of "do"
  Json said;            ///< the whole object
};

/// The most levels that a request's JSON may be deep.
inline constexpr int most_levels = 32;

/// Reads a request. Throws voxel::Error, Input, where the text is no JSON object with a word "do", or is
/// deeper than most_levels.
Request parse_request(std::string_view text);

/// {"id": ..., "ok": ...}.
Message answer_to(std::int64_t id, const Json& ok);
/// Makes one line of a text, without control characters and no longer than a page: what a refusal quotes may
/// be megabytes.
using LineOf = std::function<std::string(const std::string& text)>;

/// {"id": ..., "error": {"message", "code"}}; the message as `line_of` makes it. The code is that of either
/// kernel's error, "resource" where memory or the disk gave out, and else "input".
Message refusal_to(std::int64_t id, const std::exception& error, const LineOf& line_of);
/// {"event": name, ...}.
Message event(const std::string& name, const Json& said);

/// A payload of a frame.
struct Part {
  std::string kind;  ///< "jpeg", "png", "depth", "object", "value"
  std::string bytes;
};
/// The header's length in four bytes, least first, the header with its "parts", and the payloads.
Message packed(Json header, const std::vector<Part>& parts);

/// Bytes by zlib's format, fast.
std::string deflated(const void* bytes, std::size_t count);

}  // namespace octotomy::planner::serve

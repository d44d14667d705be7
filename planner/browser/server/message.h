// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "planner/browser/server/access_control.h"
#include "planner/operation/table/json.h"

// Messages over a page's WebSocket.
namespace octotomy::planner::serve {

/// A message to a page: JSON as text, or a packed frame.
struct Message {
  std::string bytes;
  bool is_binary = false;
};

/// A request of a page.
struct Request {
  std::int64_t id = 0;           ///< 0 if absent
  std::string what;              ///< the value of "do"
  Json said;                     ///< the whole object
  Access access = Access::Edit;  ///< of the window that sent it
};

/// The largest depth of a request's JSON.
inline constexpr int most_levels = 32;

/// Reads a request. Throws voxel::Error, Input, if the text is not a JSON object with a word "do", or is
/// deeper than most_levels.
Request parse_request(std::string_view text);

/// {"id": ..., "ok": ...}.
Message answer_to(std::int64_t id, const Json& ok);
/// Formats a text as one line without control characters and at most a page long, because quotations in an
/// error may be megabytes.
using LineOf = std::function<std::string(const std::string& text)>;

/// {"id": ..., "error": {"message", "code"}}; the message formatted by `line_of`. The code is "changed" if
/// another program has changed the plan's file, else the name of fault_of(error).
Message refusal_to(std::int64_t id, const std::exception& error, const LineOf& line_of);
/// {"event": name, ...}.
Message event(const std::string& name, const Json& said);

/// One payload of a frame.
struct Part {
  std::string kind;  ///< "jpeg", "png", "depth", "object", "value"
  std::string bytes;
};
/// The header's length in four bytes, least first, the header with its "parts", and the payloads.
Message packed(Json header, const std::vector<Part>& parts);

/// Compresses bytes in zlib's format at a fast level.
std::string deflated(const void* bytes, std::size_t count);

}  // namespace octotomy::planner::serve

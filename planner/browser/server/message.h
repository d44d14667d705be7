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

// Messages between the server and a page, over the page's WebSocket.
namespace octotomy::planner::serve {

/// A message to a page: JSON text, or a binary frame of packed().
struct Message {
  std::string bytes;
  bool is_binary = false;
};

/// A request that a page has sent.
struct Request {
  std::int64_t id = 0;           ///< 0 if absent
  std::string what;              ///< the value of "do"
  Json said;                     ///< the whole object
  Access access = Access::Edit;  ///< of the window that sent it
};

/// The largest nesting depth of a request's JSON.
inline constexpr int most_levels = 32;

/// Parses a request. Throws voxel::Error, Input, if the text is not a JSON object with a string "do", or is
/// nested deeper than most_levels.
Request parse_request(std::string_view text);

/// {"id": ..., "ok": ...}.
Message answer_to(std::int64_t id, const Json& ok);
/// Formats a text as one line of limited length without control characters. A message may quote megabytes of
/// a file.
using LineOf = std::function<std::string(const std::string& text)>;

/// {"id", "error": {"message", "code"}}, with the message formatted by `line_of`. The code is "changed" if
/// another program has changed the plan's file, otherwise the name of fault_of(error).
Message refusal_to(std::int64_t id, const std::exception& error, const LineOf& line_of);
/// {"event": name, ...}.
Message event(const std::string& name, const Json& said);

/// One payload of a binary frame, and its kind.
struct Part {
  std::string kind;  ///< "jpeg", "png", "depth", "object", "value"
  std::string bytes;
};
/// A binary frame: the length of the header in four bytes, least significant first; the header as JSON, to
/// which "parts" with kind and size of each payload is added; then the payloads.
Message packed(Json header, const std::vector<Part>& parts);

/// Compresses bytes in zlib's format, at a level chosen for speed.
std::string deflated(const void* bytes, std::size_t count);

}  // namespace octotomy::planner::serve

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/message.h"

#include <new>
#include <stdexcept>
#include <zlib.h>

#include "planner/operation/table/fault.h"
#include "planner/operation/table/json_file.h"
#include "planner/plan/history.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

[[noreturn]] void refuse_request(const std::string& why) {
  throw voxel::Error(voxel::ErrorCode::Input, "the request " + why);
}

Message text_of(const Json& json) {
  return {json_text(json), false};
}

}  // namespace

Request parse_request(std::string_view text) {
  if (json_levels(text) > most_levels) refuse_request("is nested too deeply");
  Request request;
  request.said = Json::parse(text, nullptr, false);
  if (!request.said.is_object()) refuse_request("is no JSON object");
  if (const auto id = request.said.find("id"); id != request.said.end() && id->is_number_integer())
    request.id = *id;
  const auto what = request.said.find("do");
  if (what == request.said.end() || !what->is_string()) refuse_request("has no word 'do'");
  request.what = *what;
  return request;
}

Message answer_to(std::int64_t id, const Json& ok) {
  return text_of({{"id", id}, {"ok", ok}});
}

Message refusal_to(std::int64_t id, const std::exception& error, const LineOf& line_of) {
  std::string said = message_of(error);
  Fault fault = fault_of(error);
  // JSON members are missing or have the wrong type. The library's message begins with its own name and an
  // error number, which are removed.
  if (dynamic_cast<const Json::exception*>(&error) != nullptr) {
    said = error.what();
    said = "a value of the request is missing or has the wrong type: " + said.substr(said.find(']') + 1);
    fault = Fault::Input;
  }
  // The code "changed" makes the page offer to reload the file.
  const bool is_other_writer = dynamic_cast<const OtherWriter*>(&error) != nullptr;
  const std::string code = is_other_writer ? "changed" : to_string(fault);
  return text_of({{"id", id}, {"error", {{"message", line_of(said)}, {"code", code}}}});
}

Message event(const std::string& name, const Json& said) {
  Json json{{"event", name}};
  json.update(said);
  return text_of(json);
}

Message packed(Json header, const std::vector<Part>& parts) {
  header["parts"] = Json::array();
  for (const Part& part : parts)
    header["parts"].push_back({{"kind", part.kind}, {"bytes", part.bytes.size()}});
  const std::string text = json_text(header);
  Message message{{}, true};
  for (int byte = 0; byte < 4; ++byte)
    message.bytes += static_cast<char>((text.size() >> (8 * byte)) & 0xffu);
  message.bytes += text;
  for (const Part& part : parts) message.bytes += part.bytes;
  return message;
}

std::string deflated(const void* bytes, std::size_t count) {
  uLongf size = compressBound(static_cast<uLong>(count));
  std::string packed_bytes(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed_bytes.data()), &size, static_cast<const Bytef*>(bytes),
                static_cast<uLong>(count), Z_BEST_SPEED) != Z_OK)
    throw std::bad_alloc();
  packed_bytes.resize(size);
  return packed_bytes;
}

}  // namespace octotomy::planner::serve

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/network/multipart.h"

#include <algorithm>
#include <cctype>

#include "planner/network/connection.h"

namespace octotomy::planner {
namespace {

constexpr std::size_t most_header = 1 << 13, most_boundary = 70, most_beside = 1 << 17;

std::string boundary_of(const std::string& type) {
  std::string lower = type;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::size_t at = lower.find("boundary=");
  if (!lower.starts_with("multipart/related") || at == std::string::npos)
    throw PeerError("the archive answers with '" + type.substr(0, 80) + "', which is not multipart/related");
  std::string text = type.substr(at + 9);
  if (text.starts_with('"'))
    text = text.substr(1, text.find('"', 1) - 1);
  else
    text = text.substr(0, text.find_first_of("; \t"));
  if (text.empty() || text.size() > most_boundary)
    throw PeerError("the archive's answer names no valid boundary");
  return "\r\n--" + text;
}

}  // namespace

Multipart::Multipart(const std::string& type, ReceivedFiles& folder)
    : folder_(folder), boundary_(boundary_of(type)), held_("\r\n") {}

void Multipart::add(std::string_view bytes) {
  // The body is processed in blocks, so that `held_` stays small.
  constexpr std::size_t block = 1 << 16;
  while (!bytes.empty()) {
    const std::string_view now = bytes.substr(0, block);
    bytes.remove_prefix(now.size());
    held_.append(now);
    while (step()) {
    }
  }
}

bool Multipart::step() {
  const std::size_t at = place_ == Place::Header || place_ == Place::After ? 0 : held_.find(boundary_);
  switch (place_) {
    case Place::Before:
    case Place::Part: {
      const std::size_t tail = boundary_.size() - 1;
      const std::size_t before = at != std::string::npos ? at : held_.size() - std::min(held_.size(), tail);
      if (part_)
        part_->write(std::string_view(held_).substr(0, before));
      else
        need_end(before);
      held_.erase(0, before);
      if (at == std::string::npos) return false;
      // The two bytes after a boundary show whether another part follows.
      if (held_.size() < boundary_.size() + 2) return false;
      if (part_) part_->finish("", "");
      part_.reset();
      const std::string_view next = std::string_view(held_).substr(boundary_.size(), 2);
      if (next != "\r\n" && next != "--") throw PeerError("the archive's answer has a damaged boundary");
      place_ = next == "--" ? Place::After : Place::Header;
      held_.erase(0, boundary_.size());
      return true;
    }
    case Place::Header: {
      const std::size_t end = held_.find("\r\n\r\n");
      if (std::min(end, held_.size()) > most_header)
        throw PeerError("the archive's answer has a part whose header is longer than 8 KB");
      if (end == std::string::npos) return false;
      held_.erase(0, end + 4);
      place_ = Place::Part;
      part_.emplace(folder_);
      return true;
    }
    case Place::After:
      need_end(held_.size());
      held_.clear();
      return false;
  }
  return false;
}

void Multipart::need_end(std::size_t more) {
  beside_ += more;
  if (beside_ > most_beside)
    throw PeerError("the archive's answer has more bytes outside of its parts than is allowed");
}

void Multipart::finish() const {
  if (place_ != Place::After) throw PeerError("the archive's answer ends within an object");
}

}  // namespace octotomy::planner

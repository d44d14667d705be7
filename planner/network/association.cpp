// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/network/association.h"

#include <algorithm>
#include <array>
#include <utility>

namespace octotomy::planner {
namespace {

constexpr std::size_t most_data_unit = 1 << 17;    ///< largest data unit that this side accepts
constexpr std::size_t most_negotiation = 1 << 16;  ///< largest request for an association, or answer to one
constexpr std::size_t most_command = 1 << 14;      ///< largest command set; a usual one has about 300 bytes
constexpr const char* application_context = "1.2.840.10008.3.1.1.1";

enum Unit { asks = 1, accepts_it = 2, rejects = 3, data = 4, releases = 5, is_released = 6, aborts = 7 };

std::string big(std::uint64_t number, int bytes) {
  std::string text;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) text += static_cast<char>(number >> shift & 0xff);
  return text;
}

std::string little(std::uint64_t number, int bytes) {
  std::string text = big(number, bytes);
  std::reverse(text.begin(), text.end());
  return text;
}

std::size_t big_at(std::string_view bytes, std::size_t at, int count) {
  std::size_t number = 0;
  for (int i = 0; i < count; ++i)
    number = number << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
  return number;
}

std::size_t little_at(std::string_view bytes, std::size_t at, int count) {
  std::size_t number = 0;
  for (int i = count - 1; i >= 0; --i)
    number = number << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
  return number;
}

std::string item(int kind, const std::string& value) {
  return std::string(1, static_cast<char>(kind)) + '\0' + big(value.size(), 2) + value;
}

std::string unit(int kind, const std::string& value) {
  return std::string(1, static_cast<char>(kind)) + '\0' + big(value.size(), 4) + value;
}

std::string padded_title(const std::string& title) {
  std::string text = title.substr(0, 16);
  text.resize(16, ' ');
  return text;
}

std::string title_of(std::string_view field) {
  const std::size_t last = field.find_last_not_of(std::string_view(" \0", 2));
  const std::size_t first = field.find_first_not_of(' ');
  return last == std::string_view::npos ? "" : std::string(field.substr(first, last + 1 - first));
}

/// A unique identifier without its padding. Empty if the bytes are no identifier (PS3.5, 9.1).
std::string uid_of(std::string_view bytes) {
  while (!bytes.empty() && (bytes.back() == '\0' || bytes.back() == ' ')) bytes.remove_suffix(1);
  if (bytes.size() > 64 || bytes.find_first_not_of("0123456789.") != std::string_view::npos) return "";
  return std::string(bytes);
}

/// A peer's name as messages show it: at most 16 characters, all printable.
std::string printable(std::string text) {
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text.substr(0, 16);
}

/// Passes each item of a unit to `take`. Returns false if an item is damaged or `take` returns false.
bool each_item(std::string_view bytes, const std::function<bool(int kind, std::string_view value)>& take) {
  while (!bytes.empty()) {
    if (bytes.size() < 4) return false;
    const std::size_t length = big_at(bytes, 2, 2);
    if (length > bytes.size() - 4) return false;
    if (!take(static_cast<unsigned char>(bytes[0]), bytes.substr(4, length))) return false;
    bytes.remove_prefix(4 + length);
  }
  return true;
}

std::string user_information() {
  return item(0x50, item(0x51, big(most_data_unit, 4)) +
                        item(0x52, "2.25.107031158870021870421842158015462014722") + item(0x55, "OCTOTOMY"));
}

/// The largest data unit that the other side accepts, from its user information; 16 KB if that states none.
std::size_t most_of(std::string_view information) {
  std::size_t most = 16384;
  each_item(information, [&](int kind, std::string_view value) {
    if (kind == 0x51 && value.size() == 4) most = big_at(value, 0, 4);
    return true;
  });
  if (most == 0) most = most_data_unit;
  return std::clamp<std::size_t>(most, 256, most_data_unit);
}

std::string element(int number, const std::string& value) {
  return little(0, 2) + little(static_cast<std::uint64_t>(number), 2) + little(value.size(), 4) + value;
}

std::string uid_value(std::string uid) {
  if (uid.size() % 2 == 1) uid += '\0';
  return uid;
}

/// Encodes a command set (PS3.7, annex E), which always has implicit VR.
std::string text_of(const DicomCommand& command) {
  const bool is_answer = (command.kind & 0x8000) != 0;
  std::string text;
  if (!command.class_uid.empty()) text += element(0x0002, uid_value(command.class_uid));
  text += element(0x0100, little(command.kind, 2));
  text +=
      is_answer ? element(0x0120, little(command.answered, 2)) : element(0x0110, little(command.message, 2));
  if (command.kind == 0x0001) text += element(0x0700, little(0, 2));
  text += element(0x0800, little(command.has_data ? 1 : 0x0101, 2));
  if (is_answer) text += element(0x0900, little(command.status, 2));
  if (!command.instance_uid.empty()) text += element(0x1000, uid_value(command.instance_uid));
  return element(0x0000, little(text.size(), 4)) + text;
}

/// Decodes a command set. Returns false if the bytes are none.
bool read_command(std::string_view bytes, DicomCommand& command) {
  command = {};
  while (!bytes.empty()) {
    if (bytes.size() < 8 || little_at(bytes, 0, 2) != 0) return false;
    const std::size_t number = little_at(bytes, 2, 2), length = little_at(bytes, 4, 4);
    if (length > bytes.size() - 8) return false;
    const std::string_view value = bytes.substr(8, length);
    const auto short_number = [&](std::uint16_t& to) {
      if (length == 2) to = static_cast<std::uint16_t>(little_at(value, 0, 2));
      return length == 2;
    };
    std::uint16_t data_kind = 0;
    bool is_whole = true;
    switch (number) {
      case 0x0002:
        command.class_uid = uid_of(value);
        break;
      case 0x0100:
        is_whole = short_number(command.kind);
        break;
      case 0x0110:
        is_whole = short_number(command.message);
        break;
      case 0x0120:
        is_whole = short_number(command.answered);
        break;
      case 0x0800:
        is_whole = short_number(data_kind);
        command.has_data = data_kind != 0x0101;
        break;
      case 0x0900:
        is_whole = short_number(command.status);
        break;
      case 0x1000:
        command.instance_uid = uid_of(value);
        break;
      default:
        break;
    }
    if (!is_whole) return false;
    bytes.remove_prefix(8 + length);
  }
  return command.kind != 0;
}

}  // namespace

int Association::read_unit(std::size_t most) {
  connection_.set_deadline(patience_);
  std::array<char, 6> head{};
  connection_.read(head.data(), head.size());
  const int kind = head[0];
  const std::size_t length = big_at({head.data(), head.size()}, 2, 4);
  if (kind < asks || kind > aborts) break_off("sends data that are not DICOM");
  if (length > most)
    break_off("announces a unit of " + std::to_string(length) + " bytes, more than the " +
              std::to_string(most) + " allowed");
  unit_.resize(length);
  connection_.read(unit_.data(), length);
  at_ = length;
  return kind;
}

void Association::break_off(const std::string& reason) {
  abort();
  throw PeerError(peer() + ": " + reason);
}

void Association::abort() {
  try {
    connection_.set_deadline(std::chrono::seconds(1));
    connection_.write(unit(aborts, std::string(4, '\0')));
  } catch (const PeerError&) {
    // Aborting is not necessary: the other side has already closed the connection.
  }
}

Association Association::request(Connection connection, const AssociationTitles& titles,
                                 const std::vector<PresentationContext>& contexts,
                                 std::chrono::milliseconds patience) {
  Association made(std::move(connection), patience);
  std::string text = big(1, 2) + big(0, 2) + padded_title(titles.called) + padded_title(titles.calling) +
                     std::string(32, '\0') + item(0x10, application_context);
  int number = 1;
  for (const PresentationContext& each : contexts) {
    std::string inside =
        std::string(1, static_cast<char>(number)) + std::string(3, '\0') + item(0x30, each.class_uid);
    for (const std::string& syntax : each.syntaxes) inside += item(0x40, syntax);
    text += item(0x20, inside);
    number += 2;
  }
  made.connection_.set_deadline(made.patience_);
  made.connection_.write(unit(asks, text + user_information()));
  const int kind = made.read_unit(most_negotiation);
  if (kind == rejects)
    throw PeerError(made.peer() + ": refuses the association: check that '" + titles.called +
                    "' is its title and that it accepts '" + titles.calling + "'");
  if (kind != accepts_it || made.unit_.size() < 68)
    made.break_off("does not answer the request for an association");
  const bool is_whole = each_item(std::string_view(made.unit_).substr(68), [&](int of,
                                                                               std::string_view value) {
    if (of == 0x50) made.most_sent_ = most_of(value);
    if (of != 0x21) return true;
    if (value.size() < 4) return false;
    const std::size_t index = static_cast<unsigned char>(value[0]) / 2;
    if (value[2] != 0 || index >= contexts.size()) return true;
    return each_item(value.substr(4), [&](int kind_of, std::string_view syntax) {
      if (kind_of == 0x40)
        made.accepted_[static_cast<unsigned char>(value[0])] = {contexts[index].class_uid, {uid_of(syntax)}};
      return true;
    });
  });
  if (!is_whole) made.break_off("answers the request with damaged items");
  return made;
}

Association Association::answer(
    Connection connection, const std::string& title,
    const std::function<bool(const std::string& class_uid, const std::string& syntax)>& accepts,
    std::chrono::milliseconds patience) {
  Association made(std::move(connection), patience);
  if (made.read_unit(most_negotiation) != asks || made.unit_.size() < 68)
    made.break_off("did not begin with a request for an association");
  const std::string_view asked = made.unit_;
  const std::string called = title_of(asked.substr(4, 16)), calling = title_of(asked.substr(20, 16));
  if (!title.empty() && called != title) {
    made.connection_.write(unit(rejects, std::string("\0\1\1\7", 4)));
    throw PeerError(made.peer() + ": calls '" + printable(called) + "', which is not this side's title");
  }
  std::string answers;
  int count = 0;
  const bool is_whole = each_item(asked.substr(68), [&](int kind, std::string_view value) {
    if (kind == 0x50) made.most_sent_ = most_of(value);
    if (kind != 0x20) return true;
    if (value.size() < 4 || ++count > 128) return false;
    const int number = static_cast<unsigned char>(value[0]);
    std::string class_uid, chosen;
    const bool items = each_item(value.substr(4), [&](int of, std::string_view uid) {
      if (of == 0x30) class_uid = uid_of(uid);
      if (of == 0x40 && chosen.empty())
        if (const std::string syntax = uid_of(uid); accepts(class_uid, syntax)) chosen = syntax;
      return true;
    });
    if (!items) return false;
    const int result = !chosen.empty() ? 0 : 4;
    if (result == 0) made.accepted_[number] = {class_uid, {chosen}};
    answers += item(0x21, std::string(1, static_cast<char>(number)) + '\0' + static_cast<char>(result) +
                              '\0' + item(0x40, chosen.empty() ? implicit_little_endian : chosen));
    return true;
  });
  if (!is_whole) made.break_off("sent a request for an association with damaged items");
  made.connection_.write(unit(accepts_it, big(1, 2) + big(0, 2) + padded_title(called) +
                                              padded_title(calling) + std::string(32, '\0') +
                                              item(0x10, application_context) + answers +
                                              user_information()));
  return made;
}

void Association::refuse_for_now(Connection connection) {
  Association made(std::move(connection), std::chrono::milliseconds(200));
  try {
    made.connection_.set_deadline(std::chrono::milliseconds(200));
    made.connection_.write(unit(rejects, std::string("\0\2\3\2", 4)));
  } catch (const PeerError&) {
    // The other side has already closed the connection, so there is nothing to refuse.
  }
}

int Association::context_of(const std::string& class_uid, const std::string& syntax) const {
  for (const auto& [number, each] : accepted_)
    if (each.class_uid == class_uid && each.syntaxes.front() == syntax) return number;
  return 0;
}

void Association::send_fragment(int context, bool is_command, bool is_last, std::string_view bytes) {
  const int flags = (is_command ? 1 : 0) | (is_last ? 2 : 0);
  connection_.set_deadline(patience_);
  std::string whole = big(data, 1) + '\0' + big(bytes.size() + 6, 4) + big(bytes.size() + 2, 4) +
                      static_cast<char>(context) + static_cast<char>(flags);
  whole.append(bytes);
  connection_.write(whole);
}

void Association::send(int context, const DicomCommand& command) {
  send_fragment(context, true, true, text_of(command));
}

void Association::send_data(int context, std::string_view bytes, bool is_last) {
  const std::size_t most = (most_sent_ - 6) & ~std::size_t{1};
  while (bytes.size() > most) {
    send_fragment(context, false, false, bytes.substr(0, most));
    bytes.remove_prefix(most);
  }
  send_fragment(context, false, is_last, bytes);
}

bool Association::next_fragment(Fragment& fragment) {
  if (at_ >= unit_.size()) {
    const int kind = read_unit(most_data_unit);
    if (kind == releases) {
      connection_.write(unit(is_released, std::string(4, '\0')));
      return false;
    }
    if (kind == aborts) throw PeerError(peer() + ": aborted the association");
    if (kind != data) break_off("sends a unit out of order");
    at_ = 0;
  }
  const std::string_view left = std::string_view(unit_).substr(at_);
  if (left.size() < 6) break_off("sends a damaged fragment");
  const std::size_t length = big_at(left, 0, 4);
  if (length < 2 || length > left.size() - 4) break_off("states a wrong length of a fragment");
  const int flags = left[5];
  fragment = {static_cast<unsigned char>(left[4]), (flags & 1) != 0, (flags & 2) != 0,
              left.substr(6, length - 2)};
  at_ += 4 + length;
  return true;
}

bool Association::receive(DicomCommand& command, int& context) {
  std::string bytes;
  for (Fragment fragment;;) {
    if (!next_fragment(fragment)) return false;
    if (!fragment.is_command) break_off("sends data without a command");
    if (!accepted_.contains(fragment.context)) break_off("uses a context that was not agreed on");
    context = fragment.context;
    if (bytes.size() + fragment.bytes.size() > most_command) break_off("sends a command that is too long");
    bytes.append(fragment.bytes);
    if (fragment.is_last) break;
  }
  if (!read_command(bytes, command)) break_off("sends a damaged command");
  return true;
}

void Association::receive_data(int context, const std::function<void(std::string_view)>& part) {
  for (Fragment fragment;;) {
    if (!next_fragment(fragment)) throw PeerError(peer() + ": ends the association within an object");
    if (fragment.is_command || fragment.context != context) break_off("mixes messages");
    part(fragment.bytes);
    if (fragment.is_last) return;
  }
}

void Association::release() {
  connection_.set_deadline(patience_);
  connection_.write(unit(releases, std::string(4, '\0')));
  if (read_unit(most_negotiation) != is_released) abort();
}

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/network/store.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <list>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "voxel/dicom/dicom_attributes.h"
#include "voxel/space/progress.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_contexts = 128;
constexpr std::size_t block_bytes = 1 << 16;

std::uint32_t number_at(const std::string& bytes, std::size_t at, int count) {
  std::uint32_t number = 0;
  for (int i = count - 1; i >= 0; --i)
    number = number << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
  return number;
}

[[noreturn]] void refuse_file(const fs::path& path) {
  throw std::runtime_error(path.string() +
                           ": is no DICOM file with a meta header: octotomy convert writes them");
}

Connection connected(const StorePeer& peer) {
  return {peer.host, peer.port, peer.tls, peer.timeout};
}

DicomCommand answer_to(Association& association, int message) {
  DicomCommand answer;
  int context = 0;
  if (!association.receive(answer, context))
    throw PeerError(association.peer() + ": releases the association without an answer");
  if ((answer.kind & 0x8000) == 0 || answer.answered != message)
    throw PeerError(association.peer() + ": answers a message other than the last one");
  return answer;
}

void send_file(Association& association, const OutgoingFile& file, std::uint16_t message,
               std::vector<std::string>& warnings) {
  const int context = association.context_of(file.class_uid, file.syntax);
  if (context == 0)
    throw PeerError(file.path.string() + ": the other side does not accept objects of class " +
                    file.class_uid + " in transfer syntax " + file.syntax);
  DicomCommand command;
  command.kind = 0x0001;
  command.message = message;
  command.has_data = true;
  command.class_uid = file.class_uid;
  command.instance_uid = file.instance_uid;
  association.send(context, command);
  std::ifstream in(file.path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(file.data_at));
  std::string block(block_bytes, '\0');
  for (std::uint64_t left = file.bytes - file.data_at; left > 0;) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left, block_bytes));
    if (!in.read(block.data(), static_cast<std::streamsize>(count)))
      throw std::runtime_error(file.path.string() + ": cannot be read to its end");
    left -= count;
    association.send_data(context, {block.data(), count}, left == 0);
  }
  const DicomCommand answer = answer_to(association, message);
  const auto stated = [&] {
    std::array<char, 8> text{};
    std::snprintf(text.data(), text.size(), "%04X", answer.status);
    return file.path.string() + ": the other side answers status " + text.data();
  };
  if ((answer.status & 0xf000) == 0xb000)
    warnings.push_back(stated() + ", a warning");
  else if (answer.status != 0)
    throw PeerError(stated() + " and did not store it");
}

/// Whether the receiver accepts a transfer syntax: little endian, or encapsulated pixels (PS3.5, annex A). It
/// refuses deflated data sets, and big endian ones, which are retired.
bool is_taken(const std::string& syntax) {
  return syntax == implicit_little_endian || syntax == explicit_little_endian ||
         syntax == "1.2.840.10008.1.2.5" || syntax.starts_with("1.2.840.10008.1.2.4.");
}

bool is_stored(const std::string& class_uid) {
  return class_uid.starts_with("1.2.840.10008.5.1.4.");
}

/// The beginning of a received object's file, before its data set. The peer does not send it, so it states
/// what the association has agreed on.
std::string file_head(const std::string& class_uid, const std::string& instance_uid,
                      const std::string& syntax) {
  voxel::DicomAttributes meta;
  meta.put(0x00020001, "OB", std::string("\0\1", 2));
  meta.put(0x00020002, "UI", class_uid);
  meta.put(0x00020003, "UI", instance_uid);
  meta.put(0x00020010, "UI", syntax);
  meta.put(0x00020012, "UI", voxel::DicomDigest().uid("octotomy"));
  meta.put(0x00020013, "SH", "OCTOTOMY");
  std::ostringstream text, length;
  meta.write(text);
  voxel::DicomAttributes first;
  first.put_longs(0x00020000, {static_cast<std::uint32_t>(text.str().size())});
  first.write(length);
  return std::string(128, '\0') + "DICM" + length.str() + text.str();
}

/// Serves one association of the receiver.
class Receiver {
 public:
  Receiver(ReceivedFiles& folder, const ReceiveOptions& options, std::atomic<std::size_t>& count)
      : folder_(folder), options_(options), count_(count) {}

  void serve(Association association) const {
    DicomCommand command;
    for (int context = 0; association.receive(command, context);) {
      DicomCommand answer;
      answer.kind = command.kind | 0x8000;
      answer.answered = command.message;
      answer.class_uid = command.class_uid;
      answer.instance_uid = command.instance_uid;
      if (command.kind == 0x0030) {
        association.send(context, answer);
        continue;
      }
      const PresentationContext& agreed = association.context(context);
      if (command.kind != 0x0001 || !command.has_data || command.instance_uid.empty() ||
          command.class_uid != agreed.class_uid || !is_stored(agreed.class_uid)) {
        association.abort();
        throw PeerError(association.peer() + ": sends a request that is neither C-STORE nor C-ECHO");
      }
      take(association, context, agreed.syntaxes.front(), command);
      association.send(context, answer);
      ++count_;
    }
  }

 private:
  void take(Association& association, int context, const std::string& syntax,
            const DicomCommand& command) const {
    try {
      ReceivedFiles::Part part(folder_);
      part.write(file_head(command.class_uid, command.instance_uid, syntax));
      association.receive_data(context, [&](std::string_view bytes) { part.write(bytes); });
      part.finish(command.class_uid, command.instance_uid);
    } catch (const std::exception&) {
      association.abort();
      throw;
    }
  }

  ReceivedFiles& folder_;
  const ReceiveOptions& options_;
  std::atomic<std::size_t>& count_;
};

struct Served {
  std::atomic<bool> is_done = false;
  std::thread thread = {};
};

}  // namespace

OutgoingFile outgoing_file(const fs::path& path) {
  OutgoingFile made{path, {}, {}, {}, 0, 0};
  std::ifstream in(path, std::ios::binary);
  std::string head(144, '\0');
  if (!in.read(head.data(), 144) || head.compare(128, 4, "DICM") != 0 ||
      number_at(head, 132, 4) != 0x00000002)
    refuse_file(path);
  constexpr std::uint32_t most_meta = 1 << 16;
  const std::uint32_t length = number_at(head, 140, 4);
  std::string meta(std::min(length, most_meta), '\0');
  if (length > most_meta || !in.read(meta.data(), length)) refuse_file(path);
  for (std::size_t at = 0; at + 8 <= meta.size();) {
    const bool is_wide = meta.compare(at + 4, 2, "OB") == 0 || meta.compare(at + 4, 2, "UN") == 0;
    if (is_wide && at + 12 > meta.size()) refuse_file(path);
    const std::size_t begin = at + (is_wide ? 12 : 8);
    const std::size_t count = is_wide ? number_at(meta, at + 8, 4) : number_at(meta, at + 6, 2);
    if (count > meta.size() - begin) refuse_file(path);
    std::string value = meta.substr(begin, count);
    while (!value.empty() && (value.back() == '\0' || value.back() == ' ')) value.pop_back();
    const std::uint32_t element = number_at(meta, at + 2, 2);
    if (element == 0x0002) made.class_uid = value;
    if (element == 0x0003) made.instance_uid = value;
    if (element == 0x0010) made.syntax = value;
    at = begin + count;
  }
  made.data_at = 144 + length;
  made.bytes = fs::file_size(path);
  if (made.class_uid.empty() || made.instance_uid.empty() || made.syntax.empty() ||
      made.bytes <= made.data_at)
    refuse_file(path);
  return made;
}

void echo(const StorePeer& peer) {
  Association association = Association::request(
      connected(peer), peer.titles, {{verification_class, {implicit_little_endian}}}, peer.timeout);
  const int context = association.context_of(verification_class, implicit_little_endian);
  if (context == 0) throw PeerError(association.peer() + ": does not accept echoes (C-ECHO)");
  DicomCommand command;
  command.kind = 0x0030;
  command.message = 1;
  command.class_uid = verification_class;
  association.send(context, command);
  if (answer_to(association, 1).status != 0)
    throw PeerError(association.peer() + ": answers an echo with an error");
  association.release();
}

std::vector<std::string> store(const StorePeer& peer, const std::vector<OutgoingFile>& files,
                               const std::stop_token& stop) {
  std::vector<std::string> warnings;
  for (std::size_t first = 0; first < files.size();) {
    // Adds files as long as one association has enough contexts for their kinds.
    std::set<std::pair<std::string, std::string>> kinds;
    std::size_t last = first;
    while (last < files.size() &&
           (kinds.size() < most_contexts || kinds.contains({files[last].class_uid, files[last].syntax}))) {
      kinds.emplace(files[last].class_uid, files[last].syntax);
      ++last;
    }
    std::vector<PresentationContext> contexts;
    for (const auto& [class_uid, syntax] : kinds) contexts.push_back({class_uid, {syntax}});
    Association association = Association::request(connected(peer), peer.titles, contexts, peer.timeout);
    for (std::uint16_t message = 1; first < last; ++first, ++message) {
      if (stop.stop_requested()) {
        association.abort();
        throw voxel::Stopped("stopped before " + files[first].path.string() + " was sent");
      }
      send_file(association, files[first], message, warnings);
    }
    association.release();
  }
  return warnings;
}

void receive_by_store(ReceivedFiles& folder, const ReceiveOptions& options, const std::stop_token& stop) {
  Listener listener(options.address, options.port, options.tls);
  if (options.listening) options.listening(listener.port());
  std::atomic<std::size_t> count = 0;
  const Receiver receiver(folder, options, count);
  std::mutex saying;
  const auto refused = [&](const std::string& what) {
    const std::lock_guard lock(saying);
    if (options.refused) options.refused(what);
  };
  std::list<Served> served;
  const auto accepts = [](const std::string& class_uid, const std::string& syntax) {
    return class_uid == verification_class ? is_taken(syntax) : is_stored(class_uid) && is_taken(syntax);
  };
  while (!stop.stop_requested() && (!options.objects || count < *options.objects)) {
    std::optional<Connection> next = listener.accept(std::chrono::milliseconds(100));
    for (auto each = served.begin(); each != served.end();)
      if (each->is_done) {
        each->thread.join();
        each = served.erase(each);
      } else {
        ++each;
      }
    if (!next) continue;
    if (served.size() >= static_cast<std::size_t>(options.associations)) {
      refused(next->peer() + ": refused for now, because " + std::to_string(served.size()) +
              " associations are open");
      // With TLS, a rejection could be sent only after the handshake, so the connection is just closed.
      if (!options.tls) Association::refuse_for_now(std::move(*next));
      continue;
    }
    Served& mine = served.emplace_back();
    mine.thread = std::thread([&, connection = std::make_shared<Connection>(std::move(*next))] {
      const std::string peer = connection->peer();
      try {
        connection->set_deadline(options.patience);
        listener.handshake(*connection);
        receiver.serve(Association::answer(std::move(*connection), options.title, accepts, options.patience));
      } catch (const std::exception& error) {
        const std::string what = error.what();
        refused(what.starts_with(peer) ? what : peer + ": " + what);
      }
      mine.is_done = true;
    });
  }
  for (Served& each : served) each.thread.join();
}

}  // namespace octotomy::planner

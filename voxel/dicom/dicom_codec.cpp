// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/dicom_codec.h"

#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <sstream>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include "voxel/dicom/dicom_codec_wire.h"
#include "voxel/space/error.h"
#include "voxel/space/helper_file.h"
#include "voxel/space/spawn.h"
#include "voxel/space/unfinished_folder.h"

namespace octotomy::voxel {

namespace {

/// The decoding process, connected by a socket. The process ends when this object is destroyed or the program
/// ends.
class CodecProcess {
 public:
  CodecProcess() {
    const std::string path = helper_file("octotomy_dicom_codec").string();
    int sockets[2] = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0)
      throw Error(ErrorCode::Resource,
                  "compressed DICOM cannot be read: no socket: " + std::string(std::strerror(errno)));
    socket_ = sockets[0];
    // The slowest codec takes a second for the largest slice. A process without an answer after a minute
    // counts as hung.
    const timeval limit{60, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    try {
      // The process's output goes to /dev/null, because one of GDCM's codecs prints while it decodes.
      process_ = spawn({.words = {path, folder_.path().string()}, .in = sockets[1]});
    } catch (const std::system_error& error) {
      close(sockets[0]);
      close(sockets[1]);
      throw Error(ErrorCode::Resource, path + ": compressed DICOM cannot be read: " + error.code().message() +
                                           "; install this helper program and GDCM again");
    }
    close(sockets[1]);
  }
  ~CodecProcess() {
    close(socket_);
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  CodecProcess(const CodecProcess&) = delete;
  CodecProcess& operator=(const CodecProcess&) = delete;

  bool send_request(const CompressedFrame& frame) const {
    const FrameHead head{frame.columns,
                         frame.rows,
                         frame.allocated_bits,
                         frame.stored_bits,
                         frame.high_bit,
                         frame.is_signed ? 1u : 0u,
                         static_cast<std::uint32_t>(frame.transfer_syntax.size()),
                         static_cast<std::uint32_t>(frame.fragments.size())};
    bool sent = send_all(socket_, &head, sizeof head) &&
                send_all(socket_, frame.transfer_syntax.data(), frame.transfer_syntax.size());
    for (const std::string_view fragment : frame.fragments) {
      const std::uint64_t length = fragment.size();
      sent = sent && send_all(socket_, &length, sizeof length) &&
             send_all(socket_, fragment.data(), fragment.size());
    }
    return sent;
  }

  /// The facts that the process reports, as text; empty if it does not answer.
  std::string facts() const {
    constexpr std::uint64_t most_bytes = 4096;
    const FrameHead head{};
    std::uint64_t length = 0;
    if (!send_all(socket_, &head, sizeof head) || !receive_all(socket_, &length, sizeof length) ||
        length > most_bytes)
      return {};
    std::string text(static_cast<std::size_t>(length), '\0');
    return receive_all(socket_, text.data(), text.size()) ? text : std::string();
  }

  /// False if the process crashed or hung on the frame.
  bool receive_answer(const CompressedFrame& frame, std::string& pixels) const {
    std::uint64_t length = 0;
    const std::uint64_t expected = std::uint64_t{frame.columns} * frame.rows * (frame.allocated_bits / 8);
    if (!receive_all(socket_, &length, sizeof length) || (length != 0 && length != expected)) return false;
    pixels.resize(static_cast<std::size_t>(length));
    return receive_all(socket_, pixels.data(), pixels.size());
  }

 private:
  UnfinishedFolder folder_{std::filesystem::temp_directory_path(), "octotomy-codec-"};
  int socket_ = -1;
  pid_t process_ = -1;
};

/// The calling thread's decoding process; null before the first request and after a crash.
std::unique_ptr<CodecProcess>& process_of_thread() {
  thread_local std::unique_ptr<CodecProcess> process;
  return process;
}

}  // namespace

std::optional<std::string> decompress(const CompressedFrame& frame) {
  if (frame.columns == 0 || frame.rows == 0) return std::nullopt;
  std::unique_ptr<CodecProcess>& process = process_of_thread();
  if (!process) process = std::make_unique<CodecProcess>();
  std::string pixels;
  if (!process->send_request(frame) || !process->receive_answer(frame, pixels)) {
    process.reset();  // the next frame starts a new process
    return std::nullopt;
  }
  if (pixels.empty()) return std::nullopt;
  return pixels;
}

CodecFacts codec_facts() {
  std::unique_ptr<CodecProcess>& process = process_of_thread();
  if (!process) process = std::make_unique<CodecProcess>();
  std::istringstream text(process->facts());
  std::string line;
  if (!std::getline(text, line)) {
    process.reset();
    throw Error(ErrorCode::Resource, helper_file("octotomy_dicom_codec").string() +
                                         ": does not answer: install the program and its helpers again");
  }
  CodecFacts facts{line == "confined"};
  while (std::getline(text, line)) {
    const std::size_t space = line.find(' ');
    if (space != std::string::npos)
      facts.libraries.emplace_back(line.substr(0, space), line.substr(space + 1));
  }
  return facts;
}

}  // namespace octotomy::voxel

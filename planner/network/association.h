// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "planner/network/connection.h"

// DICOM's upper layer and messages (PS3.8, 9.3; PS3.7, 6.3 and 9.1), for both sides, reduced to what echo and
// storage need. Every length that a peer states is compared with a bound before it is used.
namespace octotomy::planner {

inline constexpr const char* verification_class = "1.2.840.10008.1.1";
inline constexpr const char* implicit_little_endian = "1.2.840.10008.1.2";
inline constexpr const char* explicit_little_endian = "1.2.840.10008.1.2.1";

/// A class and its transfer syntaxes: several when it is proposed, one when it is accepted.
struct PresentationContext {
  std::string class_uid;
  std::vector<std::string> syntaxes;
};

/// Names of the two programs, at most 16 characters.
struct AssociationTitles {
  std::string called, calling;
};

/// The fields of a message's command set that echo and storage use.
struct DicomCommand {
  std::uint16_t kind = 0;  ///< 0x0001 store, 0x0030 echo; with 0x8000 the answer
  std::uint16_t message = 0;
  std::uint16_t answered = 0;
  std::uint16_t status = 0;
  bool has_data = false;
  std::string class_uid, instance_uid;
};

/// An association over a connection, which it owns.
class Association {
 public:
  /// Requests an association. `patience` is the time limit for each message or part of a message. Throws
  /// PeerError, with the reason that the other side states. Precondition: at most 128 contexts.
  static Association request(Connection connection, const AssociationTitles& titles,
                             const std::vector<PresentationContext>& contexts,
                             std::chrono::milliseconds patience);
  /// Answers a request: accepts contexts that `accepts` allows. A request for another title than `title` is refused
  /// unless that is empty. Throws PeerError if the other side breaks the protocol, after an abort.
  static Association answer(
      Connection connection, const std::string& title,
      const std::function<bool(const std::string& class_uid, const std::string& syntax)>& accepts,
      std::chrono::milliseconds patience);
  /// Rejects the next request as temporarily impossible, because too many associations are open.
  static void refuse_for_now(Connection connection);

  /// The number of an accepted context; 0 if there is none.
  int context_of(const std::string& class_uid, const std::string& syntax) const;
  const PresentationContext& context(int number) const { return accepted_.at(number); }
  const std::string& peer() const { return connection_.peer(); }

  void send(int context, const DicomCommand& command);
  /// Sends a part of a message's data.
  void send_data(int context, std::string_view bytes, bool is_last);

  /// The next command and its context; false after the other side has released the association; the release
  /// is answered.
  bool receive(DicomCommand& command, int& context);
  /// Receives the data of the last command in parts.
  void receive_data(int context, const std::function<void(std::string_view)>& part);

  void release();
  void abort();

 private:
  Association(Connection connection, std::chrono::milliseconds patience)
      : connection_(std::move(connection)), patience_(patience) {}

  struct Fragment {
    int context = 0;
    bool is_command = false, is_last = false;
    std::string_view bytes;
  };
  /// Reads a unit into `unit_`; returns its kind.
  int read_unit(std::size_t most);
  /// The next fragment of a message; false after a release.
  bool next_fragment(Fragment& fragment);
  void send_fragment(int context, bool is_command, bool is_last, std::string_view bytes);
  [[noreturn]] void break_off(const std::string& reason);

  Connection connection_;
  std::map<int, PresentationContext> accepted_;
  std::size_t most_sent_ = 16384;
  std::chrono::milliseconds patience_;
  std::string unit_;
  std::size_t at_ = 0;  ///< of the next fragment in `unit_`
};

}  // namespace octotomy::planner

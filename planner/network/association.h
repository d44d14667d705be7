// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "planner/network/connection.h"

// DICOM's upper layer and messages (PS3.8, 9.3; PS3.7, 6.3 and 9.1), for both sides of an association, as far
// as echo and storage need them. A length that a peer states is compared with a bound before it is used.
namespace octotomy::planner {

inline constexpr const char* verification_class = "1.2.840.10008.1.1";
inline constexpr const char* implicit_little_endian = "1.2.840.10008.1.2";
inline constexpr const char* explicit_little_endian = "1.2.840.10008.1.2.1";

/// A SOP class with transfer syntaxes: those that are proposed, or the one that is accepted.
struct PresentationContext {
  std::string class_uid;
  std::vector<std::string> syntaxes;
};

/// Application entity titles of the receiver and the sender, each of at most 16 characters.
struct AssociationTitles {
  std::string called, calling;
};

/// Those elements of a command set that echo and storage use.
struct DicomCommand {
  std::uint16_t kind = 0;  ///< 0x0001 store, 0x0030 echo; the answers have 0x8000 added
  std::uint16_t message = 0;
  std::uint16_t answered = 0;
  std::uint16_t status = 0;
  bool has_data = false;
  std::string class_uid, instance_uid;
};

/// An association, which owns its connection.
class Association {
 public:
  /// Opens an association. `patience` limits the time for each message or part of one. Throws PeerError, with
  /// the other side's reason, if it is refused. Precondition: at most 128 contexts.
  static Association request(Connection connection, const AssociationTitles& titles,
                             const std::vector<PresentationContext>& contexts,
                             std::chrono::milliseconds patience);
  /// Waits for a request for an association and accepts those of its contexts for which `accepts` is true.
  /// Refuses a request for another title than `title`, unless `title` is empty. If the other side breaks the
  /// protocol, aborts the association and throws PeerError.
  static Association answer(
      Connection connection, const std::string& title,
      const std::function<bool(const std::string& class_uid, const std::string& syntax)>& accepts,
      std::chrono::milliseconds patience);
  /// Rejects the request on a connection as temporary, because too many associations are open.
  static void refuse_for_now(Connection connection);

  /// The number of the accepted context for this class and transfer syntax; 0 if there is none.
  int context_of(const std::string& class_uid, const std::string& syntax) const;
  const PresentationContext& context(int number) const { return accepted_.at(number); }
  const std::string& peer() const { return connection_.peer(); }

  void send(int context, const DicomCommand& command);
  /// Sends a part of the data of the last command sent; `is_last` ends the data.
  void send_data(int context, std::string_view bytes, bool is_last);

  /// Receives the next command and the number of its context. Returns false if the other side has released
  /// the association; the release has then been answered.
  bool receive(DicomCommand& command, int& context);
  /// Receives the data of the command received last. Passes them to `part`, piece by piece.
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
  /// Reads a data unit of at most `most` bytes into `unit_`. Returns its type.
  int read_unit(std::size_t most);
  /// Reads the next fragment of a message. Returns false if the other side releases the association.
  bool next_fragment(Fragment& fragment);
  void send_fragment(int context, bool is_command, bool is_last, std::string_view bytes);
  [[noreturn]] void break_off(const std::string& reason);

  Connection connection_;
  std::map<int, PresentationContext> accepted_;
  std::size_t most_sent_ = 16384;
  std::chrono::milliseconds patience_;
  std::string unit_;
  std::size_t at_ = 0;  ///< offset of the next fragment in `unit_`
};

}  // namespace octotomy::planner

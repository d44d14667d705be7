// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "planner/network/association.h"
#include "planner/network/received_files.h"

namespace octotomy::planner {

/// The host, port and titles of an archive, for C-ECHO and C-STORE.
struct StorePeer {
  std::string host;
  int port = 104;
  AssociationTitles titles{"ANY-SCP", "OCTOTOMY"};
  std::optional<TlsFiles> tls = std::nullopt;
  std::chrono::seconds timeout{30};
};

/// A DICOM file to be sent, with the identifiers of its meta header (PS3.10, 7.1).
struct OutgoingFile {
  std::filesystem::path path;
  std::string class_uid, instance_uid, syntax;
  std::uint64_t data_at = 0, bytes = 0;  ///< offset of the data set, and size of the file
};
/// Reads a file's meta header. Throws std::runtime_error with the path.
OutgoingFile outgoing_file(const std::filesystem::path& path);

/// Checks that an archive answers (C-ECHO). Throws PeerError if it does not.
void echo(const StorePeer& peer);

/// Sends files by C-STORE; data sets are not changed. Returns the warnings of the other side. Throws
/// PeerError, with the file, if the other side refuses it, and voxel::Stopped.
std::vector<std::string> store(const StorePeer& peer, const std::vector<OutgoingFile>& files,
                               const std::stop_token& stop = {});

struct ReceiveOptions {
  std::string address = "127.0.0.1";
  int port = 11112;
  std::string title = "OCTOTOMY";  ///< only associations with this title are accepted; empty: any title
  std::optional<TlsFiles> tls = std::nullopt;
  std::chrono::milliseconds patience{30000};  ///< time limit for each data unit
  int associations = 8;                       ///< largest number at a time; others are rejected
  /// Number of objects after which receive_by_store() returns. None: it runs until it is stopped.
  std::optional<std::size_t> objects = std::nullopt;
  std::function<void(int port)> listening = {};
  /// called with a description when a peer makes an error; calls do not overlap
  std::function<void(const std::string&)> refused = {};
};

/// Receives objects by C-STORE and answers C-ECHO until it is stopped. Acknowledges an object when its file
/// is in the folder. Memory: two data units for each association, whatever peers send. Throws as Listener
/// does.
void receive_by_store(ReceivedFiles& folder, const ReceiveOptions& options, const std::stop_token& stop);

}  // namespace octotomy::planner

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

/// The archive's address and names, for C-ECHO and C-STORE.
struct StorePeer {
  std::string host;
  int port = 104;
  AssociationTitles titles{"ANY-SCP", "OCTOTOMY"};
  std::optional<TlsFiles> tls = std::nullopt;
  std::chrono::seconds timeout{30};
};

/// A DICOM file to send: identified by its meta header (PS3.10, 7.1).
struct OutgoingFile {
  std::filesystem::path path;
  std::string class_uid, instance_uid, syntax;
  std::uint64_t data_at = 0, bytes = 0;  ///< where its data set begins, and the file's size
};
/// Reads a file's meta header. Throws std::runtime_error with the path.
OutgoingFile outgoing_file(const std::filesystem::path& path);

/// Checks that the other side answers (C-ECHO). Throws PeerError.
void echo(const StorePeer& peer);

/// Sends files by C-STORE, with their data sets unchanged. Returns warnings that the other side stated.
/// Throws PeerError with the file if it is refused, and voxel::Stopped.
std::vector<std::string> store(const StorePeer& peer, const std::vector<OutgoingFile>& files,
                               const std::stop_token& stop = {});

struct ReceiveOptions {
  std::string address = "127.0.0.1";
  int port = 11112;
  std::string title = "OCTOTOMY";  ///< only associations with this title are accepted; empty: any title
  std::optional<TlsFiles> tls = std::nullopt;
  std::chrono::milliseconds patience{30000};  ///< for each unit of an association
  int associations = 8;                       ///< largest number at a time; others are rejected as temporary
  /// Ends after this number of objects. None: runs until it is stopped.
  std::optional<std::size_t> objects = std::nullopt;
  std::function<void(int port)> listening = {};
  /// called with a description of a peer's fault; one call at a time
  std::function<void(const std::string&)> refused = {};
};

/// Receives objects by C-STORE, and answers C-ECHO, until it is stopped. An object is acknowledged when it is in the
/// folder. Memory: two units for each association, which peers cannot increase. Throws as Listener does.
void receive_by_store(ReceivedFiles& folder, const ReceiveOptions& options, const std::stop_token& stop);

}  // namespace octotomy::planner

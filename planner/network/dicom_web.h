// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "planner/network/connection.h"
#include "planner/network/received_files.h"

// DICOMweb (PS3.18) by libcurl: STOW-RS, QIDO-RS and WADO-RS. Uses http and https only and follows no
// redirection. The size of every answer is limited.
namespace octotomy::planner {

struct WebArchive {
  std::string url;                             ///< URL of the service, such as http://host:8042/dicom-web
  std::optional<TlsFiles> tls = std::nullopt;  ///< files beside the system's
  std::string user = {};                       ///< NAME:PASSWORD; empty: none
  long timeout_s = 30;                         ///< without any progress
};

/// Stores a file in an archive (STOW-RS), byte for byte. Throws PeerError with the file and the status if the
/// archive refuses it.
void store_by_web(const WebArchive& archive, const std::filesystem::path& path,
                  const std::stop_token& stop = {});

/// Searches an archive (QIDO-RS). `query` is a path with parameters, such as "studies?PatientID=17". Returns
/// the answer, JSON of at most 16 MB. Throws PeerError.
std::string search_by_web(const WebArchive& archive, const std::string& query,
                          const std::stop_token& stop = {});

/// Fetches a study, a series or an instance (WADO-RS) into a folder. `resource` is its path, such as
/// "studies/1.2.3/series/1.2.4". Throws PeerError; the folder then contains the objects that had arrived
/// completely.
void retrieve_by_web(const WebArchive& archive, const std::string& resource, ReceivedFiles& folder,
                     const std::stop_token& stop = {});

/// Percent-encodes a text as a value in a URL. The wildcards * and ? stay as they are, because some archives
/// require that.
std::string web_text(const std::string& text);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "planner/network/connection.h"
#include "planner/network/received_files.h"

// DICOMweb (PS3.18): STOW-RS, QIDO-RS and WADO-RS by libcurl. Only http and https, no redirection, every answer bounded.
namespace octotomy::planner {

struct WebArchive {
  std::string url;                             ///< of the service, as http://host:8042/dicom-web
  std::optional<TlsFiles> tls = std::nullopt;  ///< files beside the system's
  std::string user = {};                       ///< NAME:PASSWORD; empty: none
  long timeout_s = 30;                         ///< without any progress
};

/// Stores a file (STOW-RS), byte for byte. Throws PeerError with the file and the status if it is refused.
void store_by_web(const WebArchive& archive, const std::filesystem::path& path,
                  const std::stop_token& stop = {});

/// The answer to a search (QIDO-RS), JSON of at most 16 MB: `query` is a path with its parameters, such as
/// "studies?PatientID=17". Throws PeerError.
std::string search_by_web(const WebArchive& archive, const std::string& query,
                          const std::stop_token& stop = {});

/// Retrieves a study, a series or an instance (WADO-RS) into a folder: `resource` is its path, such as
/// "studies/1.2.3/series/1.2.4". Throws PeerError; objects that have arrived completely before stay in the
/// folder.
void retrieve_by_web(const WebArchive& archive, const std::string& resource, ReceivedFiles& folder,
                     const std::stop_token& stop = {});

/// A text as a value in an address, with percent encoding. The wildcards * and ? stay unencoded, because some
/// archives expect that.
std::string web_text(const std::string& text);

}  // namespace octotomy::planner

// SPDX-License-Identifier: AGPL-3.0-or-later
// The verbs that exchange objects with an archive.
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <set>

#include "planner/cli/program/verbs.h"
#include "planner/network/dicom_web.h"
#include "planner/network/store.h"
#include "planner/operation/table/number_format.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 1000000;

/// Options of both verbs.
struct ArchiveText {
  std::string address;             ///< of the archive
  std::string title = "OCTOTOMY";  ///< this side's
  TlsFiles tls;
  long timeout_s = 30;
};

struct SendText : ArchiveText {
  std::vector<fs::path> files;
  bool echo = false;
};

struct ReceiveText : ArchiveText {
  fs::path out;
  std::string study, series, instance;
  std::vector<std::string> find;
  std::optional<int> port;
  std::string on = "127.0.0.1";
  bool any_title = false;
  bool with_tls = false;
  std::optional<std::size_t> objects;
  std::uint64_t object_mb = 4096, total_mb = 65536;
  int associations = 8;
};

bool is_web(const std::string& address) {
  return address.starts_with("http://") || address.starts_with("https://");
}

[[noreturn]] void refuse_address(const std::string& address) {
  throw std::runtime_error(address +
                           ": is not the address of an archive: give http://HOST:PORT/PATH or https:// for "
                           "DICOMweb, or dicom://TITLE@HOST:PORT or dicoms:// (TLS) for C-STORE");
}

StorePeer store_peer(const ArchiveText& text) {
  StorePeer peer;
  const bool is_safe = text.address.starts_with("dicoms://");
  if (!is_safe && !text.address.starts_with("dicom://")) refuse_address(text.address);
  std::string rest = text.address.substr(is_safe ? 9 : 8);
  if (const std::size_t at = rest.find('@'); at != std::string::npos) {
    peer.titles.called = rest.substr(0, at);
    rest.erase(0, at + 1);
  }
  const std::size_t colon = rest.rfind(':');
  int port = 0;
  if (colon != std::string::npos && rest.size() - colon <= 6 &&
      rest.find_first_not_of("0123456789", colon + 1) == std::string::npos && colon + 1 < rest.size())
    port = std::stoi(rest.substr(colon + 1));
  peer.host = rest.substr(0, colon);
  if (peer.host.starts_with('[') && peer.host.ends_with(']'))
    peer.host = peer.host.substr(1, peer.host.size() - 2);
  if (port < 1 || port > 65535 || peer.host.empty() || peer.titles.called.empty() ||
      peer.titles.called.size() > 16)
    refuse_address(text.address);
  peer.port = port;
  peer.titles.calling = text.title;
  peer.timeout = std::chrono::seconds(text.timeout_s);
  if (is_safe) peer.tls = text.tls;
  return peer;
}

WebArchive web_archive(const ArchiveText& text) {
  const char* user = std::getenv("OCTOTOMY_ARCHIVE_USER");
  return {text.address, text.tls, user == nullptr ? "" : user, text.timeout_s};
}

/// The DICOM files among the paths and below folders among them. Refuses a path that is a file but not DICOM.
/// A file below a folder that is not DICOM is left out, with a finding.
std::vector<OutgoingFile> files_to_send(const std::vector<fs::path>& paths,
                                        std::vector<std::string>& findings) {
  std::vector<OutgoingFile> files;
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(outgoing_file(path));
      continue;
    }
    std::set<fs::path> inside;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path))
      if (entry.is_regular_file()) inside.insert(entry.path());
    for (const fs::path& each : inside) {
      try {
        files.push_back(outgoing_file(each));
      } catch (const std::runtime_error&) {
        findings.push_back(each.string() + ": not sent, because it is not a DICOM file with a meta header");
      }
    }
  }
  if (files.empty())
    throw std::runtime_error("no DICOM file is named: give DICOM files or folders that contain them");
  if (files.size() > most_files)
    throw std::runtime_error("there are more than 1 000 000 files: send them in parts");
  return files;
}

int send(const Program& program, const SendText& text) {
  Timings timings;
  std::vector<std::string> findings;
  Json json = answer(timings);
  json["to"] = text.address;
  if (text.echo) {
    if (is_web(text.address)) throw std::runtime_error("--echo needs a dicom:// or dicoms:// address");
    echo(store_peer(text));
    json["echo"] = true;
    program.say(json, text.address + " answers\n");
    return done;
  }
  const std::vector<OutgoingFile> files = files_to_send(text.files, findings);
  {
    const Stopwatch watch(timings, "send");
    if (is_web(text.address)) {
      const WebArchive archive = web_archive(text);
      for (const OutgoingFile& file : files) store_by_web(archive, file.path, program.stop.get_token());
    } else {
      for (std::string& warning : store(store_peer(text), files, program.stop.get_token()))
        findings.push_back(std::move(warning));
    }
  }
  std::uint64_t bytes = 0;
  for (const OutgoingFile& file : files) bytes += file.bytes;
  json = answer(timings);
  json.update({{"to", text.address}, {"objects", files.size()}, {"bytes", bytes}, {"findings", findings}});
  for (const std::string& finding : findings) warn_finding(finding);
  program.say(json, lines({{"sent", std::to_string(files.size()) + " objects"},
                           {"size", grouped(static_cast<double>(bytes) / 1e6, 1) + " MB"},
                           {"to", text.address}}));
  return done;
}

/// Refuses an option's text if it is no unique identifier (PS3.5, 9.1).
void need_uid(const std::string& uid, const char* option) {
  if (uid.empty() || uid.size() > 64 || uid.find_first_not_of("0123456789.") != std::string::npos)
    throw std::runtime_error(std::string(option) + " '" + uid +
                             "': is no unique identifier, such as 1.2.840.3");
}

std::string resource_of(const ReceiveText& text) {
  need_uid(text.study, "--study");
  std::string resource = "studies/" + text.study;
  if (!text.series.empty()) need_uid(text.series, "--series"), resource += "/series/" + text.series;
  if (text.instance.empty()) return resource;
  if (text.series.empty()) throw std::runtime_error("--instance needs --series: add --series UID");
  need_uid(text.instance, "--instance");
  return resource + "/instances/" + text.instance;
}

/// First value of an attribute in DICOM's JSON form (PS3.18, F.2); null if the attribute is absent, empty or
/// no text or number. Of a person's name, its alphabetic group.
Json first_value(const Json& found, const char* tag) {
  if (!found.contains(tag) || !found[tag].is_object() || !found[tag].contains("Value")) return nullptr;
  const Json& values = found[tag]["Value"];
  if (!values.is_array() || values.empty()) return nullptr;
  if (values[0].is_object()) return values[0].value("Alphabetic", "");
  return values[0].is_string() || values[0].is_number() ? values[0] : Json(nullptr);
}

int find_studies(const Program& program, const ReceiveText& text) {
  std::string query = "studies";
  for (const std::string& word : text.find) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos)
      throw std::runtime_error("--find '" + word +
                               "': give KEY=VALUE, for example PatientID=17 or PatientName=Doe*");
    query += (query.find('?') == std::string::npos ? "?" : "&") + web_text(word.substr(0, equals)) + "=" +
             web_text(word.substr(equals + 1));
  }
  const Json found =
      Json::parse(search_by_web(web_archive(text), query, program.stop.get_token()), nullptr, false);
  if (!found.is_array())
    throw PeerError(
        text.address +
        ": the answer to the search is not a list in JSON; check the path of the DICOMweb service");
  Json json = answer({});
  json["studies"] = Json::array();
  std::vector<std::pair<std::string, std::string>> rows;
  for (const Json& each : found) {
    json["studies"].push_back({{"study_uid", first_value(each, "0020000D")},
                               {"patient_id", first_value(each, "00100020")},
                               {"patient_name", first_value(each, "00100010")},
                               {"study_date", first_value(each, "00080020")}});
    const Json& made = json["studies"].back();
    const auto text_of = [&](const char* key) { return made[key].is_string() ? line_of(made[key]) : "-"; };
    rows.emplace_back(text_of("study_uid"),
                      text_of("study_date") + "  " + text_of("patient_id") + "  " + text_of("patient_name"));
  }
  program.say(json, rows.empty() ? "no study is found\n" : lines(rows));
  return done;
}

void listen(Program& program, const ReceiveText& text, ReceivedFiles& folder) {
  ReceiveOptions options;
  options.address = text.on;
  options.port = *text.port;
  options.title = text.any_title ? "" : text.title;
  if (text.with_tls) {
    if (text.tls.certificate.empty() || text.tls.key.empty())
      throw std::runtime_error("--tls: the receiver needs a certificate: give --certificate and --key");
    options.tls = text.tls;
  }
  if (!text.with_tls && text.on != "127.0.0.1" && text.on != "::1" && text.on != "localhost")
    warn("--listen " + text.on +
         ": everybody on this network can send objects and can read the objects that others send; --tls "
         "prevents reading "
         "and, with --authorities, sending");
  options.patience = std::chrono::seconds(text.timeout_s);
  options.associations = text.associations;
  options.objects = text.objects;
  options.listening = [&](int port) { warn("listening on " + text.on + ":" + std::to_string(port)); };
  options.refused = [](const std::string& what) { warn_finding(what); };
  receive_by_store(folder, options, program.stop.get_token());
}

int receive(Program& program, const ReceiveText& text) {
  if (!text.port && text.address.empty())
    throw std::runtime_error("give --port N to wait for objects, or --from URL to fetch them");
  if (text.port && !text.address.empty()) throw std::runtime_error("give only one of --port and --from");
  if (!text.address.empty() && !is_web(text.address))
    throw std::runtime_error(text.address + ": objects are fetched by DICOMweb: give http:// or https://");
  if (!text.find.empty()) {
    if (text.address.empty()) throw std::runtime_error("--find searches an archive: give --from URL");
    return find_studies(program, text);
  }
  if (text.out.empty()) throw std::runtime_error("--out: give the folder for the objects");
  Timings timings;
  ReceivedFiles folder(text.out, {text.object_mb << 20, text.total_mb << 20});
  {
    const Stopwatch watch(timings, "receive");
    if (text.port)
      listen(program, text, folder);
    else
      retrieve_by_web(web_archive(text), resource_of(text), folder, program.stop.get_token());
  }
  Json json = answer(timings);
  json["folder"] = text.out.string();
  json["objects"] = Json::array();
  std::uint64_t bytes = 0;
  for (const ReceivedFile& file : folder.files()) {
    json["objects"].push_back({{"file", file.name},
                               {"bytes", file.bytes},
                               {"class_uid", file.class_uid},
                               {"instance_uid", file.instance_uid}});
    bytes += file.bytes;
  }
  program.say(json, lines({{"received", std::to_string(json["objects"].size()) + " objects"},
                           {"size", grouped(static_cast<double>(bytes) / 1e6, 1) + " MB"},
                           {"folder", text.out.string()}}));
  return done;
}

void add_archive_options(CLI::App& verb, ArchiveText& text) {
  verb.add_option("--title", text.title, "This side's application entity title. Default: OCTOTOMY")
      ->check(CLI::Validator(
          [](const std::string& word) {
            return word.empty() || word.size() > 16 ? std::string("a title has 1 to 16 characters")
                                                    : std::string();
          },
          "", "title"));
  verb.add_option("--certificate", text.tls.certificate, "This side's TLS certificate, PEM")
      ->check(CLI::ExistingFile);
  verb.add_option("--key", text.tls.key, "The certificate's private key, PEM")->check(CLI::ExistingFile);
  verb.add_option(
          "--authorities", text.tls.authorities,
          "A PEM file of certificates, one of which must have signed the other side's certificate. Default: "
          "the system's; a receiver without this option accepts every client")
      ->check(CLI::ExistingFile);
  verb.add_option("--timeout", text.timeout_s, "Seconds to wait for the other side at each step. Default: 30")
      ->check(CLI::Range(1L, 3600L));
}

}  // namespace

void add_archive_verbs(Program& program) {
  const auto sent = std::make_shared<SendText>();
  CLI::App& sends = program.verb(
      "send",
      "Sends DICOM files to an archive, by DICOMweb (STOW-RS) or C-STORE. For a password of DICOMweb, set "
      "the environment variable OCTOTOMY_ARCHIVE_USER to NAME:PASSWORD",
      "octotomy send skull.dcm --to http://localhost:8042/dicom-web\n"
      "  octotomy send dicom_folder --to dicom://ORTHANC@localhost:4242\n"
      "  octotomy send --echo --to dicoms://ARCHIVE@pacs.example:2762 --authorities hospital.pem",
      [&program, sent] { return send(program, *sent); });
  sends.add_option("files", sent->files, "DICOM files, or folders that contain DICOM files")
      ->check(CLI::ExistingPath);
  sends
      .add_option("--to", sent->address,
                  "http:// or https:// of a DICOMweb service; dicom://TITLE@HOST:PORT, or dicoms:// for TLS")
      ->required();
  sends.add_flag("--echo", sent->echo, "Sends nothing; checks that the archive answers (C-ECHO)");
  add_archive_options(sends, *sent);

  const auto got = std::make_shared<ReceiveText>();
  CLI::App& receives = program.verb(
      "receive",
      "Receives DICOM objects into a folder, under names that are computed from their bytes: waits for "
      "C-STORE, or "
      "fetches by DICOMweb (QIDO-RS, WADO-RS)",
      "octotomy receive -o inbox --port 11112\n"
      "  octotomy receive --from http://localhost:8042/dicom-web --find PatientID=17\n"
      "  octotomy receive -o study --from http://localhost:8042/dicom-web --study 1.2.840.113619.2.1",
      [&program, got] { return receive(program, *got); });
  receives.add_option("-o,--out", got->out, "The folder");
  receives.add_option("--from", got->address, "http:// or https:// of a DICOMweb service");
  receives.add_option("--study", got->study, "Unique identifier of the study to fetch");
  receives.add_option("--series", got->series, "Only this series of the study");
  receives.add_option("--instance", got->instance, "Only this instance of the series");
  receives.add_option("--find", got->find,
                      "Lists studies: KEY=VALUE, for example PatientID=17; may be repeated");
  receives.add_option("--port", got->port, "Waits for C-STORE on this port; 0: any free one")
      ->check(CLI::Range(0, 65535));
  receives.add_option("--listen", got->on,
                      "The address to wait on. Default: 127.0.0.1, for senders on this computer only");
  receives.add_flag("--tls", got->with_tls, "Accepts only TLS; needs --certificate and --key");
  receives.add_flag("--any-title", got->any_title, "Accepts associations for any title, not only --title");
  receives
      .add_option("--objects", got->objects,
                  "Number of objects after which the program ends. Default: it runs until it is stopped")
      ->check(CLI::PositiveNumber);
  receives.add_option("--object-mb", got->object_mb, "Largest size of an object, MB. Default: 4096")
      ->check(CLI::Range(1, 1000000));
  receives
      .add_option("--total-mb", got->total_mb, "Largest size of all objects together, MB. Default: 65536")
      ->check(CLI::Range(1, 100000000));
  receives
      .add_option("--associations", got->associations, "Largest number of associations at a time. Default: 8")
      ->check(CLI::Range(1, 256));
  add_archive_options(receives, *got);
}

}  // namespace octotomy::planner::cli

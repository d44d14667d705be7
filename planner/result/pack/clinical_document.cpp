// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/clinical_document.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "brep/io/base64.h"
#include "planner/plan/sha256.h"
#include "planner/result/report/drawn_page.h"
#include "voxel/dicom/character_set.h"
#include "voxel/dicom/dicom_attributes.h"

namespace octotomy::planner {
namespace {

constexpr std::string_view
    body_begin = "<text mediaType=\"application/json\" representation=\"B64\" integrityCheck=\"",
    body_middle = "\" integrityCheckAlgorithm=\"SHA-256\">", body_end = "</text>";

std::string in_base64(std::string_view bytes) {
  return base64({bytes.begin(), bytes.end()});
}

/// Decodes a text of hexadecimal digits.
std::string bytes_of_hex(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

/// An attribute of the source, escaped as XML text in UTF-8. Empty if it is absent or has an unknown
/// character set.
std::string text_of(const voxel::DicomSource& source, voxel::DicomTag tag) {
  const auto found = source.attributes.find(tag);
  if (found == source.attributes.end()) return "";
  const auto set = source.attributes.find(voxel::character_set_tag);
  std::string text =
      voxel::utf8_of(set == source.attributes.end() ? "" : set->second.value, found->second.value)
          .value_or("");
  std::erase_if(text, [](char c) { return static_cast<unsigned char>(c) < ' '; });
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return escaped(text);
}

/// The XML elements <family> and <given> of a DICOM name's alphabetic group.
std::string names_in_cda(const std::string& name) {
  const std::string group = name.substr(0, name.find('='));
  const std::size_t caret = group.find('^');
  const std::string family = group.substr(0, caret);
  std::string given = caret == std::string::npos ? "" : group.substr(caret + 1);
  given = given.substr(0, given.find('^'));
  return "<name>" + (family.empty() ? "" : "<family>" + family + "</family>") +
         (given.empty() ? "" : "<given>" + given + "</given>") + "</name>";
}

std::string patient_of(const std::optional<voxel::DicomSource>& source) {
  const std::string id = source ? text_of(*source, 0x00100020) : "",
                    name = source ? text_of(*source, 0x00100010) : "",
                    sex = source ? text_of(*source, 0x00100040) : "",
                    birth = source ? text_of(*source, 0x00100030) : "";
  std::string text =
      id.empty() ? "<id nullFlavor=\"MSK\"/>" : "<id nullFlavor=\"UNK\" extension=\"" + id + "\"/>";
  text += "<patient>" + (name.empty() ? std::string("<name nullFlavor=\"MSK\"/>") : names_in_cda(name));
  text += sex == "M" || sex == "F"
              ? "<administrativeGenderCode code=\"" + sex + "\" codeSystem=\"2.16.840.1.113883.5.1\"/>"
              : "<administrativeGenderCode nullFlavor=\"MSK\"/>";
  return text + (birth.empty() ? "<birthTime nullFlavor=\"MSK\"/>" : "<birthTime value=\"" + birth + "\"/>") +
         "</patient>";
}

}  // namespace

ClinicalDocument clinical_document(const std::string& plan, const std::string& title,
                                   const std::optional<voxel::DicomSource>& source) {
  const std::string patient = patient_of(source);
  voxel::DicomDigest digest;
  for (const std::string* part : {&plan, &title, &patient}) digest.add(*part);
  ClinicalDocument made{{}, digest.uid("clinical document")};
  const std::string author = "<id nullFlavor=\"NA\"/>";
  made.text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<ClinicalDocument xmlns=\"urn:hl7-org:v3\">\n"
      "<typeId root=\"2.16.840.1.113883.1.3\" extension=\"POCD_HD000040\"/>\n<id root=\"" +
      made.identifier +
      "\"/>\n"
      "<code code=\"18776-5\" codeSystem=\"2.16.840.1.113883.6.1\" codeSystemName=\"LOINC\" "
      "displayName=\"Plan of care note\"/>\n<title>" +
      escaped(title) +
      "</title>\n"
      "<effectiveTime nullFlavor=\"NA\"/>\n"
      "<confidentialityCode code=\"N\" codeSystem=\"2.16.840.1.113883.5.25\"/>\n"
      "<recordTarget><patientRole>" +
      patient +
      "</patientRole></recordTarget>\n"
      "<author><time nullFlavor=\"NA\"/><assignedAuthor>" +
      author +
      "<assignedAuthoringDevice>"
      "<manufacturerModelName>Octotomy</manufacturerModelName><softwareName>octotomy " OCTOTOMY_VERSION
      "</softwareName></assignedAuthoringDevice></assignedAuthor></author>\n"
      "<custodian><assignedCustodian><representedCustodianOrganization>" +
      author + "</representedCustodianOrganization></assignedCustodian></custodian>\n<component><nonXMLBody>";
  made.text += std::string(body_begin) + in_base64(bytes_of_hex(sha256_of(plan))) + std::string(body_middle) +
               in_base64(plan) + std::string(body_end) + "</nonXMLBody></component>\n</ClinicalDocument>\n";
  return made;
}

std::string plan_in_document(std::string_view document) {
  const std::size_t begin = document.find(body_begin);
  if (begin == std::string_view::npos)
    throw std::runtime_error("contains no plan of Octotomy: it is another program's document");
  const std::string_view rest = document.substr(begin + body_begin.size());
  const std::size_t sum_end = rest.find(body_middle);
  const std::size_t end = rest.find(body_end);
  if (sum_end == std::string_view::npos || end == std::string_view::npos ||
      end < sum_end + body_middle.size())
    throw std::runtime_error("its body is damaged: export the document again");
  const std::string_view body = rest.substr(sum_end + body_middle.size(), end - sum_end - body_middle.size());
  std::string plan = brep::from_base64(body, body.size());
  // from_base64() ignores everything after the first symbol that is not base64. So the decoded plan is
  // encoded again and compared with the whole body.
  if (in_base64(plan) != body || rest.substr(0, sum_end) != in_base64(bytes_of_hex(sha256_of(plan))))
    throw std::runtime_error(
        "its plan differs from the SHA-256 that the document states: it was damaged or changed");
  return plan;
}

}  // namespace octotomy::planner

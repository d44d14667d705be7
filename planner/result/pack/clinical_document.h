// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "voxel/scan/dicom_source.h"

namespace octotomy::planner {

/// A document of HL7's Clinical Document Architecture.
struct ClinicalDocument {
  std::string text;        ///< XML
  std::string identifier;  ///< a UID in its <id>, computed from the content
};

/// A plan as a document in HL7's Clinical Document Architecture (CDA): a header that names the patient of
/// `source`, and the plan's bytes in base64 with their SHA-256, so that any reader of XML can extract and
/// check them. If there is no source or its identity was removed, the header states that the patient is
/// masked. Times are "not applicable" (NA), so that equal plans make equal documents. Source: HL7 CDA Release
/// 2, nonXMLBody; LOINC 18776-5, plan of care note.
ClinicalDocument clinical_document(const std::string& plan, const std::string& title,
                                   const std::optional<voxel::DicomSource>& source);

/// The bytes of the plan in such a document. Throws std::runtime_error if the document contains no plan, or
/// if the plan does not have the SHA-256 that the document states. The message does not contain the path.
/// Memory: a few times the size of the document.
std::string plan_in_document(std::string_view document);

}  // namespace octotomy::planner

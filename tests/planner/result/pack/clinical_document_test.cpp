// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/clinical_document.h"

#include <gtest/gtest.h>
#include <stdexcept>

namespace octotomy::planner {
namespace {

std::string refusal(const std::string& document) {
  try {
    plan_in_document(document);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(ClinicalDocument, APlanComesBackByteForByte) {
  // Each length modulo three, and bytes that XML would need to escape.
  for (const std::string& plan : {std::string("{\"a\": \"<&>\"}\n"), std::string("{}"), std::string("{ }"),
                                  std::string("\0\xff\n\r", 4)})
    EXPECT_EQ(plan_in_document(clinical_document(plan, "Plan", std::nullopt).text), plan);
}

TEST(ClinicalDocument, TheHeaderNamesThePatientOfTheSourceOrMasksIt) {
  voxel::DicomSource source;
  source.attributes[0x00100010] = {"PN", "Doe^Jane & Co"};
  source.attributes[0x00100020] = {"LO", "A<17"};
  const ClinicalDocument named = clinical_document("{}", "T & U", source);
  EXPECT_NE(named.text.find("<family>Doe</family><given>Jane &amp; Co</given>"), std::string::npos)
      << named.text;
  EXPECT_NE(named.text.find("extension=\"A&lt;17\""), std::string::npos);
  EXPECT_NE(named.text.find("<title>T &amp; U</title>"), std::string::npos);
  EXPECT_NE(named.text.find("<id root=\"" + named.identifier + "\"/>"), std::string::npos);
  const ClinicalDocument masked = clinical_document("{}", "T & U", std::nullopt);
  EXPECT_NE(masked.text.find("<id nullFlavor=\"MSK\"/><patient><name nullFlavor=\"MSK\"/>"),
            std::string::npos);
  EXPECT_NE(masked.identifier, named.identifier);
  EXPECT_EQ(clinical_document("{}", "T & U", source).text, named.text);
}

TEST(ClinicalDocument, AChangedPlanIsRefused) {
  const std::string document = clinical_document("{\"octotomy_plan\": 1}", "Plan", std::nullopt).text;
  const std::size_t body = document.find("SHA-256\">") + 9;
  for (std::size_t i = body; document[i] != '<'; ++i) {
    std::string spoiled = document;
    spoiled[i] = spoiled[i] == 'A' ? 'B' : 'A';
    EXPECT_NE(refusal(spoiled), "") << i;
    spoiled[i] = '!';
    EXPECT_NE(refusal(spoiled), "") << i;
  }
  EXPECT_NE(refusal(document.substr(0, body + 10)).find("damaged"), std::string::npos);
  EXPECT_NE(refusal("<ClinicalDocument/>").find("another program's document"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner

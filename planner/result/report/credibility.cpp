// SPDX-License-Identifier: AGPL-3.0-or-later
// Source: ASME V&V 40-2018, Assessing Credibility of Computational Modeling through Verification and
// Validation: Application to Medical Devices: its terms and its credibility factors (section 5). Factors are
// not graded, because the grade depends on a model risk that only the user can state.
#include "planner/result/report/credibility.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/html.h"

namespace octotomy::planner {
namespace {

constexpr const char* to_state = "to be stated by the user of the numbers: the run has no such information";

/// The certificates by their objects.
std::map<std::string, Json> certificates_of(const Json& result) {
  std::map<std::string, Json> found;
  for (const Json& one : result.at("certificates")) found.emplace(one.at("object").get<std::string>(), one);
  return found;
}

Json evidence_of(const Json& certificate) {
  Json evidence{{"check", "certificate"},
                {"object", certificate.at("object")},
                {"tier", certificate.at("tier")},
                {"verdict", certificate.at("verdict")},
                {"resolved", certificate.at("resolved")},
                {"factor", "calculation verification: discretization error"}};
  evidence["detection_limit"] = certificate.value("detection_limit", Json());
  return evidence;
}

/// A number of the result, with the run's evidence for it.
class Number {
 public:
  Number(std::string step, std::string quantity, Json value, std::string unit)
      : json_{{"step", std::move(step)},       {"quantity", std::move(quantity)},
              {"value", std::move(value)},     {"unit", std::move(unit)},
              {"supported_by", Json::array()}, {"contradicted_by", Json::array()},
              {"gaps", Json::array()}} {}

  void by_certificate(const std::map<std::string, Json>& certificates, const std::string& object) {
    const auto found = certificates.find(object);
    if (found == certificates.end())
      return gap("'" + object +
                 "' has no certificate in this run: only one kernel has an answer, or none was requested");
    const bool agrees = found->second.at("verdict") != "FAIL";
    json_[agrees ? "supported_by" : "contradicted_by"].push_back(evidence_of(found->second));
    if (!found->second.at("resolved").get<bool>())
      gap("'" + object + "' is not resolved by its voxels: its certificate proves little");
  }
  /// Adds the interval, if the run reports one.
  void by_half_width(const Json& half_width, const Json& sources, const Json& coverage = {}) {
    if (!half_width.is_number()) return gap("no half-width was told");
    Json names = Json::array();
    if (sources.is_array())
      for (const Json& source : sources) names.push_back(source.value("name", Json("unnamed")));
    json_["supported_by"].push_back({{"check", "interval"},
                                     {"half_width", half_width},
                                     {"coverage", coverage},
                                     {"sources", names},
                                     {"factor", "calculation verification: discretization error"}});
  }
  /// Adds the other kernel's answer, which either agrees within the half-width or contradicts.
  void by_other_kernel(const Json& answer, const Json& half_width) {
    const Json& value = json_.at("value");
    if (!answer.is_number() || !value.is_number() || !half_width.is_number())
      return gap("one kernel alone answered");
    const double difference = std::abs(value.get<double>() - answer.get<double>());
    const bool agrees = difference <= half_width.get<double>();
    json_[agrees ? "supported_by" : "contradicted_by"].push_back(
        {{"check", "the other kernel's answer"},
         {"value", answer},
         {"difference", difference},
         {"factor", "calculation verification: discretization error"}});
  }
  /// Adds the effect of the stated errors on the number, from trials.
  void by_trials(const Json& trials, const Json& doubt) {
    Json names = Json::array();
    for (const Json& source : doubt.at("sources")) names.push_back(source.at("name"));
    json_["supported_by"].push_back({{"check", "trials"},
                                     {"trials", trials.at("trials")},
                                     {"seed", trials.at("seed")},
                                     {"half_width", doubt.at("half_width")},
                                     {"coverage", doubt.at("coverage")},
                                     {"sources", names},
                                     {"factor", "validation: model inputs"}});
  }
  void gap(const std::string& text) { json_["gaps"].push_back(text); }
  Json json() && { return std::move(json_); }

 private:
  Json json_;
};

void add_interval(const Json& one, const char* key, const std::map<std::string, Json>& certificates,
                  Json& numbers) {
  const Json& interval = one.at(key);
  const std::string object = one.at("object").get<std::string>();
  Number number(one.at("id").get<std::string>(), std::string(key) + " of " + object, interval.at("value"),
                interval.at("unit").get<std::string>());
  number.by_half_width(interval.at("half_width"), interval.at("sources"), interval.at("coverage"));
  number.by_certificate(certificates, object);
  numbers.push_back(std::move(number).json());
}

void add_contacts(const Json& flap, const std::map<std::string, Json>& certificates, Json& numbers) {
  for (const Json& contact : flap.at("osteotomies")) {
    const std::string object = contact.at("object").get<std::string>();
    Number number(flap.at("id").get<std::string>(), "contact area of " + object, contact.at("contact_mm2"),
                  "mm2");
    number.by_certificate(certificates, object);
    if (!contact.at("slab_lacks_at_most_mm2").is_number())
      number.gap(
          "the mean over the slab may differ from the area in the cut, by an amount that was not computed");
    numbers.push_back(std::move(number).json());
  }
}

/// Adds the numbers of a contact: both kernels compute the distance, only one the area.
void add_contact_map(const Json& map, const std::map<std::string, Json>& certificates, Json& numbers) {
  const std::string id = map.at("id").get<std::string>();
  const std::string pair =
      map.at("object").get<std::string>() + " and " + map.at("against").get<std::string>();
  const auto add = [&](Number number) {
    for (const char* key : {"object", "against"})
      number.by_certificate(certificates, map.at(key).get<std::string>());
    numbers.push_back(std::move(number).json());
  };
  std::size_t place = 0;
  for (const Json& contact : map.at("contacts")) {
    Number number(id, "nearest at contact " + std::to_string(++place) + " of " + pair,
                  contact.at("nearest_mm"), "mm");
    number.by_half_width(contact.at("half_width_mm"), Json());
    // Areas come from meshes only. Without a mesh the voxel kernel's distance is the number itself and no
    // evidence for it.
    number.by_other_kernel(map.at("area_mm2").is_number() ? contact.at("voxel_nearest_mm") : Json(),
                           contact.at("half_width_mm"));
    add(std::move(number));
  }
  if (map.at("certain_count").is_number()) {
    Number number(id, "contacts of " + pair + " that are certain", map.at("certain_count"), "");
    number.gap(
        "a count of contacts whose distance plus half-width is within the limit; no other number checks it");
    add(std::move(number));
  }
  for (const auto& [key, what, unit] : {std::tuple("area_mm2", "area in contact of ", "mm2"),
                                        std::tuple("overlap_mm3", "overlap of ", "mm3")})
    if (map.contains(key) && map.at(key).is_number()) {
      Number number(id, what + pair, map.at(key), unit);
      number.gap("only one kernel computes it, without a half-width");
      add(std::move(number));
    }
}

void add_airway(const Json& one, const std::map<std::string, Json>& certificates, Json& numbers) {
  const Json &airway = one.at("airway"), &least = airway.at("narrowest");
  const std::string object = one.at("object").get<std::string>();
  const auto add = [&](const std::string& what, const Json& value, const char* unit, const Json& half_width,
                       const Json& terms, const Json& other) {
    Number number(one.at("id").get<std::string>(), what + " of " + object, value, unit);
    number.by_half_width(half_width, terms);
    number.by_other_kernel(other, half_width);
    number.by_certificate(certificates, object);
    numbers.push_back(std::move(number).json());
  };
  add("airway volume", airway.at("volume_mm3"), "mm3", airway.at("volume_half_width_mm3"), Json(),
      airway.at("volume_mesh_mm3"));
  // The reported area is that of the mesh if there is one; it must not count as evidence for itself.
  add("narrowest section", least.at("area_mm2"), "mm2", least.at("half_width_mm2"),
      least.value("half_width_terms", Json()),
      least.at("mesh_mm2").is_number() ? least.at("voxel_mm2") : Json());
  add("centre line's length", airway.at("length_mm"), "mm", Json(), Json(), Json());
}

void add_trials(const Json& trials, Json& numbers) {
  for (const Json& doubt : trials.at("doubts")) {
    Number number(trials.at("id").get<std::string>(),
                  doubt.at("what").get<std::string>() + " of " + doubt.at("of").get<std::string>(),
                  doubt.at("value"), doubt.at("unit").get<std::string>());
    number.by_trials(trials, doubt);
    number.gap("the sizes of the errors were typed, and trials do not compute objects");
    numbers.push_back(std::move(number).json());
  }
}

/// Adds the pieces' movements. They are the plan's own motions, which both kernels applied in the pieces'
/// certificates.
void add_movements(const Json& result, const std::map<std::string, Json>& certificates, Json& numbers) {
  for (const Json& moved : result.value("movements", Json::array())) {
    const std::string object = moved.at("object").get<std::string>();
    const auto add = [&](const std::string& what, const Json& value, const char* unit) {
      Number number(object, what, value, unit);
      number.by_certificate(certificates, object);
      number.gap("it is the plan's own value: octotomy outcome measures what the operation achieved");
      numbers.push_back(std::move(number).json());
    };
    const auto add_all = [&](const Json& from, const char* unit, const std::vector<std::string>& names) {
      for (const std::string& name : names) add(name, from.at(name + "_" + unit), unit);
    };
    if (!moved.at("centroid").is_null()) add_all(moved.at("centroid"), "mm", {"forward", "left", "up"});
    add_all(moved, "deg", {"pitch", "yaw", "roll"});
  }
}

/// Adds values computed from landmarks; the only evidence for them is the placement of the landmarks.
void add_cephalometry(const Json& result, Json& numbers) {
  if (!result.contains("cephalometry") || !result.at("cephalometry").is_object()) return;
  for (const Json& measure : result.at("cephalometry").at("measures"))
    for (const char* when : {"before", "after"}) {
      const Json& told = measure.at(when);
      if (told.is_null()) continue;
      Number number("cephalometry", measure.at("name").get<std::string>() + " " + when, told.at("value"),
                    measure.at("unit").get<std::string>());
      number.by_half_width(told.value("half_width", Json()), Json::array({{{"name", "landmarks"}}}),
                           result.at("cephalometry").at("coverage"));
      number.gap("the landmarks were placed by people; their accuracy is an assumption of this run");
      numbers.push_back(std::move(number).json());
    }
}

Json numbers_of(const Json& result) {
  const std::map<std::string, Json> certificates = certificates_of(result);
  Json numbers = Json::array();
  for (const Json& one : result.at("measurements")) {
    for (const char* key : {"volume", "area"})
      if (one.contains(key) && one.at(key).is_object()) add_interval(one, key, certificates, numbers);
    const std::string id = one.at("id").get<std::string>();
    if (one.contains("gap_mm") && one.at("gap_mm").is_number()) {
      Number number(id, "gap", one.at("gap_mm"), "mm");
      number.by_half_width(one.at("gap_half_width_mm"), one.value("gap_half_width_terms", Json()));
      for (const char* key : {"object", "to"})
        number.by_certificate(certificates, one.at(key).get<std::string>());
      numbers.push_back(std::move(number).json());
    }
    for (const auto& [key, unit] : {std::pair<std::string, std::string>{"distance", "mm"}, {"angle", "deg"}})
      if (one.contains(key + "_" + unit)) {
        Number number(id, key, one.at(key + "_" + unit), unit);
        number.by_half_width(one.value(key + "_half_width_" + unit, Json()),
                             one.value(key + "_half_width_terms", Json()));
        number.gap("the points were placed by people; their accuracy was not stated for this run");
        numbers.push_back(std::move(number).json());
      }
    if (one.contains("osteotomies")) add_contacts(one, certificates, numbers);
    if (one.contains("contacts")) add_contact_map(one, certificates, numbers);
    if (one.contains("airway")) add_airway(one, certificates, numbers);
    if (one.contains("doubts")) add_trials(one, numbers);
  }
  add_movements(result, certificates, numbers);
  add_cephalometry(result, numbers);
  return numbers;
}

Json factor(const char* group, const char* name, Json evidence, const std::string& gap) {
  Json made{{"group", group}, {"factor", name}, {"evidence", std::move(evidence)}, {"gap", nullptr}};
  if (made["evidence"].empty() || gap.starts_with("also: ")) made["gap"] = gap;
  return made;
}

Json certificate_evidence(const Json& result) {
  Json evidence = Json::array();
  if (result.at("certificates").empty()) return evidence;
  std::size_t limits = 0;
  for (const Json& one : result.at("certificates"))
    limits += one.contains("detection_limit") && !one.at("detection_limit").is_null();
  evidence.push_back({{"check", "certificates"}, {"counts", result.at("counts")}});
  if (limits > 0)
    evidence.push_back(
        {{"check", "errors made in the objects themselves, to find the smallest that is detected"},
         {"certificates_with_detection_limit", limits}});
  return evidence;
}

Json scan_evidence(const Json& result) {
  Json evidence = Json::array();
  for (const Json& scan : result.at("scans"))
    for (const Json& check : scan.at("audit"))
      evidence.push_back({{"check", "scan audit"},
                          {"scan", scan.at("name")},
                          {"of", check.at("check")},
                          {"verdict", check.at("verdict")}});
  return evidence;
}

/// The audit of the scans, and the errors of other inputs as stated for trials.
Json input_evidence(const Json& result) {
  Json evidence = scan_evidence(result);
  for (const Json& one : result.at("measurements"))
    if (one.contains("doubts"))
      evidence.push_back({{"check", "trials"},
                          {"step", one.at("id")},
                          {"trials", one.at("trials")},
                          {"seed", one.at("seed")},
                          {"errors", one.at("errors")}});
  return evidence;
}

bool has_trials(const Json& result) {
  for (const Json& one : result.at("measurements"))
    if (one.contains("doubts")) return true;
  return false;
}

Json reader_evidence(const Json& result) {
  Json evidence = Json::array();
  for (const Json& signature : result.at("signatures"))
    if (signature.value("changed_since", Json::array()).empty())
      evidence.push_back({{"check", "signature"}, {"by", signature.value("by", Json())}});
  return evidence;
}

Json identity_evidence(const Json& result) {
  Json evidence = Json::array();
  for (const Json& scan : result.at("scans"))
    if (const Json sum = scan.value("sha256", Json()); sum.is_string() && !sum.get<std::string>().empty())
      evidence.push_back({{"check", "scan's SHA-256"}, {"scan", scan.at("name")}, {"sha256", sum}});
  if (!evidence.empty())
    evidence.push_back({{"check", "program's version"}, {"version", result.at("octotomy")}});
  return evidence;
}

Json factors_of(const Json& result) {
  const char *code = "code verification", *calculation = "calculation verification",
             *model = "validation: computational model", *comparator = "validation: comparator",
             *assessment = "validation: assessment", *applicability = "applicability";
  const char* no_comparison =
      "this run compared nothing with the patient after the operation: octotomy outcome does, where a later "
      "scan exists";
  const Json none = Json::array();
  return {
      factor(code, "software quality assurance", identity_evidence(result),
             "also: a plan does not run the program's tests; this states which version ran on which system"),
      factor(code, "numerical code verification", none,
             "no closed form was computed in this run: octotomy verify --phantoms and --faults do that for "
             "this version"),
      factor(calculation, "discretization error", certificate_evidence(result),
             "no certificate was requested, or no object has one"),
      factor(calculation, "numerical solver error", none,
             "no solver was checked by itself: residuals of Booleans stand with the objects"),
      factor(calculation, "use error", reader_evidence(result), "no reader has signed the current plan"),
      factor(model, "model form", none,
             "bone is what lies in a window of samples: this run did not test that"),
      factor(model, "model inputs", input_evidence(result),
             has_trials(result) ? "also: the sizes of the errors of landmarks, saw, segmentation and seating "
                                  "were typed, not measured"
                                : "also: errors of landmarks, typed numbers and segmentation were not stated "
                                  "for this run: a trials step computes their effect"),
      factor(comparator, "test samples", none, no_comparison),
      factor(comparator, "test conditions", none, no_comparison),
      factor(assessment, "equivalency of input parameters", none, no_comparison),
      factor(assessment, "output comparison", none, no_comparison),
      factor(applicability, "relevance of the quantities of interest", none, to_state),
      factor(applicability, "relevance of the validation activities to the context of use", none, to_state)};
}

Json context_of(const Json& result) {
  Json scans = Json::array();
  for (const Json& scan : result.at("scans"))
    scans.push_back({{"name", scan.at("name")},
                     {"modality", scan.value("modality", Json())},
                     {"spacing_mm", scan.value("spacing_mm", Json())}});
  return {{"statement", nullptr},
          {"statement_is", to_state},
          {"plan", result.at("plan").value("name", Json())},
          {"scans", scans},
          {"voxel_mm", result.at("universe").at("voxel_mm")}};
}

}  // namespace

Json credibility_json(const Json& result) {
  Json json{
      {"octotomy", result.at("octotomy")},
      {"terms", "ASME V&V 40-2018"},
      {"claim",
       "What this run checked, arranged in the standard's terms. It claims no conformity and no adequacy."},
      {"context_of_use", context_of(result)},
      {"question_of_interest", {{"statement", nullptr}, {"statement_is", to_state}}},
      {"model_risk",
       {{"model_influence", nullptr}, {"decision_consequence", nullptr}, {"statement_is", to_state}}},
      {"credibility_factors", factors_of(result)},
      {"numbers", numbers_of(result)}};
  std::size_t unsupported = 0;
  for (const Json& number : json["numbers"])
    unsupported += number["supported_by"].empty() || !number["contradicted_by"].empty();
  json["unsupported"] = unsupported;
  return json;
}

namespace {

std::string words(const Json& json) {
  if (json.is_null()) return "\u2013";
  if (json.is_number_float()) return three_figures(json.get<double>());
  return escaped(json.is_string() ? json.get<std::string>() : json.dump());
}

std::string spaced(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

/// A value formatted for a sentence.
std::string in_line(const Json& value) {
  if (value.is_number_float()) return three_figures(value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_structured()) return value.dump();
  std::string line;
  for (const auto& [key, one] : value.items())
    line += (line.empty() ? "" : ", ") + (value.is_object() ? spaced(key) + " " : "") + in_line(one);
  return line;
}

/// "certificate, object skull, verdict PASS" in a list.
std::string lines_of(const Json& evidence) {
  std::vector<std::string> lines;
  for (const Json& one : evidence) {
    std::string line;
    for (const auto& [key, value] : one.items()) {
      if (key == "factor" || value.is_null() || (value.is_structured() && value.empty())) continue;
      line += (line.empty() ? "" : ", ") + (key == "check" ? "" : spaced(key) + " ") + in_line(value);
    }
    lines.push_back(line);
  }
  return list(lines);
}

std::string factor_rows(const Json& factors) {
  std::string rows = "<tr><th>Credibility factor</th><th>This run</th><th>Not in this run</th></tr>";
  for (const Json& one : factors)
    rows += "<tr>" + cell(words(one.at("group")) + ": " + element("b", words(one.at("factor")))) +
            cell(one.at("evidence").empty() ? "nothing" : lines_of(one.at("evidence"))) +
            cell(words(one.at("gap"))) + "</tr>";
  return element("table", rows);
}

std::string number_rows(const Json& numbers) {
  std::string rows =
      "<tr><th>Number</th><th class=\"n\">value</th><th>supported by</th><th>contradicted "
      "by</th><th>gaps</th></tr>";
  for (const Json& one : numbers) {
    std::vector<std::string> gaps;
    for (const Json& gap : one.at("gaps")) gaps.push_back(gap.get<std::string>());
    rows += "<tr>" + cell(element("b", words(one.at("step"))) + ", " + words(one.at("quantity"))) +
            figure_cell(words(one.at("value")) + " " + words(one.at("unit"))) +
            cell(one.at("supported_by").empty() ? "nothing" : lines_of(one.at("supported_by"))) +
            cell(lines_of(one.at("contradicted_by"))) + cell(list(gaps)) + "</tr>";
  }
  return element("table", rows);
}

}  // namespace

std::string credibility_html(const Json& json) {
  const Json& context = json.at("context_of_use");
  const auto asked = [](const char* name) {
    return element("p", element("b", name) + ": " + to_state + ".");
  };
  return html_page(
      "Credibility",
      element("header", element("div", element("h1", "Credibility: " + words(context.at("plan"))) +
                                           element("p class=\"soft\"", words(json.at("claim")) + " Terms: " +
                                                                           words(json.at("terms")) + "."))) +
          asked("Context of use") + asked("Question of interest") +
          asked("Model risk, of model influence and decision consequence") +
          element("h2", "Numbers and what supports them") + number_rows(json.at("numbers")) +
          element("h2", "Credibility factors") + factor_rows(json.at("credibility_factors")) +
          element("footer",
                  "Octotomy " + words(json.at("octotomy")) + ". The same as data: credibility.json."));
}

}  // namespace octotomy::planner

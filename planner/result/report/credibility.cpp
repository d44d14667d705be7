// SPDX-License-Identifier: AGPL-3.0-or-later
// Source: ASME V&V 40-2018, Assessing Credibility of Computational Modeling through Verification and
// Validation: Application to Medical Devices: its terms and its credibility factors (section 5). Factors are
// not graded, because the grade depends on a model risk that only the user can state.
#include "planner/result/report/credibility.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "planner/result/report/drawn_page.h"
#include "planner/result/report/result_record.h"

namespace octotomy::planner {
namespace {

constexpr const char* to_state = "to be stated by the user of the numbers: the run has no such information";

using CertificatesByObject = std::map<std::string, CertificateRecord>;

/// A number of the result, with the evidence that the run has for it. The keys of a piece of evidence depend
/// on its `check`.
struct SupportedNumber {
  std::string step, quantity;
  Json value;
  std::string unit;
  std::vector<Json> supported_by, contradicted_by;
  std::vector<std::string> gaps;

  void by_certificate(const CertificatesByObject& certificates, const std::string& object) {
    const auto found = certificates.find(object);
    if (found == certificates.end())
      return gap("'" + object +
                 "' has no certificate in this run: only one kernel has an answer, or none was requested");
    const CertificateRecord& certificate = found->second;
    add(certificate.verdict != "FAIL", {{"check", "certificate"},
                                        {"object", certificate.object},
                                        {"tier", certificate.tier},
                                        {"verdict", certificate.verdict},
                                        {"resolved", certificate.resolved},
                                        {"factor", "calculation verification: discretization error"},
                                        {"detection_limit", certificate.detection_limit}});
    if (!certificate.resolved)
      gap("'" + object + "' is not resolved by its voxels: its certificate proves little");
  }
  /// Adds the number's interval as evidence, or a gap if the run reports none.
  void by_half_width(const std::optional<double>& half_width,
                     const std::optional<std::vector<Doubt>>& sources = {},
                     const std::optional<double>& coverage = {}) {
    if (!half_width) return gap("no half-width was reported");
    std::vector<std::string> names;
    for (const Doubt& source : sources.value_or(std::vector<Doubt>{}))
      names.push_back(source.name.empty() ? "unnamed" : source.name);
    add(true, {{"check", "interval"},
               {"half_width", *half_width},
               {"coverage", print_value(coverage)},
               {"sources", names},
               {"factor", "calculation verification: discretization error"}});
  }
  /// Adds the other kernel's answer. It supports the number if both differ by at most the half-width;
  /// otherwise it contradicts it.
  void by_other_kernel(const std::optional<double>& answer, const std::optional<double>& half_width) {
    if (!answer || !half_width) return gap("one kernel alone answered");
    const double difference = std::abs(value.get<double>() - *answer);
    add(difference <= *half_width, {{"check", "the other kernel's answer"},
                                    {"value", *answer},
                                    {"difference", difference},
                                    {"factor", "calculation verification: discretization error"}});
  }
  /// Adds the half-width from trials with the stated errors.
  void by_trials(const MeasuredTrials& trials, const DoubtfulNumber& doubt) {
    std::vector<std::string> names;
    for (const TrialSource& source : doubt.sources) names.push_back(source.name);
    add(true, {{"check", "trials"},
               {"trials", trials.trials},
               {"seed", trials.seed},
               {"half_width", doubt.half_width},
               {"coverage", doubt.coverage},
               {"sources", names},
               {"factor", "validation: model inputs"}});
  }
  void gap(const std::string& text) { gaps.push_back(text); }

 private:
  void add(bool agrees, Json evidence) {
    (agrees ? supported_by : contradicted_by).push_back(std::move(evidence));
  }
};
constexpr auto members_of(const SupportedNumber&) {
  using N = SupportedNumber;
  return std::tuple(member("step", &N::step), member("quantity", &N::quantity), member("value", &N::value),
                    member("unit", &N::unit), member("supported_by", &N::supported_by),
                    member("contradicted_by", &N::contradicted_by), member("gaps", &N::gaps));
}

struct CredibilityFactor {
  std::string group, factor;
  std::vector<Json> evidence;
  std::optional<std::string> gap;
};
constexpr auto members_of(const CredibilityFactor&) {
  using F = CredibilityFactor;
  return std::tuple(member("group", &F::group), member("factor", &F::factor),
                    member("evidence", &F::evidence), member("gap", &F::gap));
}

struct ScanInContext {
  std::string name;
  std::optional<std::string> modality;
  std::optional<glm::dvec3> spacing_mm;
};
constexpr auto members_of(const ScanInContext&) {
  using S = ScanInContext;
  return std::tuple(member("name", &S::name), member("modality", &S::modality),
                    member("spacing_mm", &S::spacing_mm));
}

struct ContextOfUse {
  std::optional<std::string> statement;
  std::string statement_is = to_state;
  std::optional<std::string> plan;
  std::vector<ScanInContext> scans;
  glm::dvec3 voxel_mm{0.0};
};
constexpr auto members_of(const ContextOfUse&) {
  using C = ContextOfUse;
  return std::tuple(member("statement", &C::statement), member("statement_is", &C::statement_is),
                    member("plan", &C::plan), member("scans", &C::scans), member("voxel_mm", &C::voxel_mm));
}

struct QuestionOfInterest {
  std::optional<std::string> statement;
  std::string statement_is = to_state;
};
constexpr auto members_of(const QuestionOfInterest&) {
  using Q = QuestionOfInterest;
  return std::tuple(member("statement", &Q::statement), member("statement_is", &Q::statement_is));
}

struct ModelRisk {
  std::optional<std::string> model_influence, decision_consequence;
  std::string statement_is = to_state;
};
constexpr auto members_of(const ModelRisk&) {
  using M = ModelRisk;
  return std::tuple(member("model_influence", &M::model_influence),
                    member("decision_consequence", &M::decision_consequence),
                    member("statement_is", &M::statement_is));
}

struct Credibility {
  std::string octotomy, terms, claim;
  ContextOfUse context_of_use;
  QuestionOfInterest question_of_interest;
  ModelRisk model_risk;
  std::vector<CredibilityFactor> credibility_factors;
  std::vector<SupportedNumber> numbers;
  std::size_t unsupported = 0;
};
constexpr auto members_of(const Credibility&) {
  using C = Credibility;
  return std::tuple(
      member("octotomy", &C::octotomy), member("terms", &C::terms), member("claim", &C::claim),
      member("context_of_use", &C::context_of_use), member("question_of_interest", &C::question_of_interest),
      member("model_risk", &C::model_risk), member("credibility_factors", &C::credibility_factors),
      member("numbers", &C::numbers), member("unsupported", &C::unsupported));
}

/// Collects the numbers of a result, with their evidence.
class Numbers {
 public:
  explicit Numbers(const ResultRecord& result) : result_(result) {
    for (const CertificateRecord& one : result.certificates) certificates_.emplace(one.object, one);
    for (const Measurement& one : result.measurements) add(one);
    add_movements();
    if (result.cephalometry) add(*result.cephalometry);
  }
  std::vector<SupportedNumber> numbers() && { return std::move(numbers_); }

 private:
  /// Adds a number. The reference is valid until the next number is added.
  SupportedNumber& number(const std::string& step, const std::string& quantity, Json value,
                          const std::string& unit) {
    SupportedNumber& made = numbers_.emplace_back();
    made.step = step;
    made.quantity = quantity;
    made.value = std::move(value);
    made.unit = unit;
    return made;
  }

  void add(const Measurement& one) {
    if (one.size) {
      add_interval(one.id, one.size->object, "volume", one.size->volume);
      add_interval(one.id, one.size->object, "area", one.size->area);
    }
    if (one.gap && one.gap->gap_mm) {
      SupportedNumber& gap = number(one.id, "gap", *one.gap->gap_mm, "mm");
      gap.by_half_width(one.gap->gap_half_width_mm, one.gap->gap_half_width_terms);
      gap.by_certificate(certificates_, one.gap->object);
      gap.by_certificate(certificates_, one.gap->to);
    }
    const auto of_points = [&](const char* quantity, double value, const char* unit,
                               const std::optional<double>& half_width,
                               const std::optional<std::vector<Doubt>>& terms) {
      SupportedNumber& made = number(one.id, quantity, value, unit);
      made.by_half_width(half_width, terms);
      made.gap("the points were placed by people; their accuracy was not stated for this run");
    };
    if (one.distance)
      of_points("distance", one.distance->distance_mm, "mm", one.distance->distance_half_width_mm,
                one.distance->distance_half_width_terms);
    if (one.angle)
      of_points("angle", one.angle->angle_deg, "deg", one.angle->angle_half_width_deg,
                one.angle->angle_half_width_terms);
    if (one.flap) add(one.id, *one.flap);
    if (one.contacts) add(one.id, *one.contacts);
    if (one.airway) add(one.id, *one.airway);
    if (one.trials) add(one.id, *one.trials);
  }

  void add_interval(const std::string& id, const std::string& object, const char* quantity,
                    const std::optional<MeasuredInterval>& interval) {
    if (!interval) return;
    SupportedNumber& made =
        number(id, std::string(quantity) + " of " + object, interval->value, interval->unit);
    made.by_half_width(interval->half_width, interval->sources, interval->coverage);
    made.by_certificate(certificates_, object);
  }

  void add(const std::string& id, const MeasuredFlap& flap) {
    for (const MeasuredOsteotomy& contact : flap.osteotomies) {
      SupportedNumber& made = number(id, "contact area of " + contact.object, contact.contact_mm2, "mm2");
      made.by_certificate(certificates_, contact.object);
      if (!contact.slab_lacks_at_most_mm2)
        made.gap(
            "the mean over the slab may differ from the area in the cut, by an amount that was not computed");
    }
  }

  /// Adds the numbers of a contact map. Both kernels compute distances; only the mesh kernel computes areas.
  void add(const std::string& id, const MeasuredContacts& map) {
    const std::string pair = map.object + " and " + map.against;
    const auto by_certificates = [&](SupportedNumber& made) {
      made.by_certificate(certificates_, map.object);
      made.by_certificate(certificates_, map.against);
    };
    std::size_t place = 0;
    for (const MeasuredContact& contact : map.contacts) {
      SupportedNumber& made = number(id, "nearest at contact " + std::to_string(++place) + " of " + pair,
                                     contact.nearest_mm, "mm");
      made.by_half_width(contact.half_width_mm);
      // Without an area there is no mesh. The number is then the voxel kernel's distance, which is no
      // evidence for itself.
      made.by_other_kernel(map.area_mm2 ? contact.voxel_nearest_mm : std::nullopt, contact.half_width_mm);
      by_certificates(made);
    }
    const auto unchecked = [&](const std::string& what, const auto& value, const char* unit,
                               const char* gap) {
      if (!value) return;
      SupportedNumber& made = number(id, what, *value, unit);
      made.gap(gap);
      by_certificates(made);
    };
    const char* one_kernel = "only one kernel computes it, without a half-width";
    unchecked("contacts of " + pair + " that are certain", map.certain_count, "",
              "a count of contacts whose distance plus half-width is within the limit; no other number "
              "checks it");
    unchecked("area in contact of " + pair, map.area_mm2, "mm2", one_kernel);
    unchecked("overlap of " + pair, map.overlap_mm3, "mm3", one_kernel);
  }

  void add(const std::string& id, const MeasuredAirway& one) {
    const AirwaySize& airway = one.airway;
    const MeasuredSection& least = airway.narrowest;
    SupportedNumber& volume = number(id, "airway volume of " + one.object, airway.volume_mm3, "mm3");
    volume.by_half_width(airway.volume_half_width_mm3);
    volume.by_other_kernel(airway.volume_mesh_mm3, airway.volume_half_width_mm3);
    volume.by_certificate(certificates_, one.object);
    SupportedNumber& narrowest = number(id, "narrowest section of " + one.object, least.area_mm2, "mm2");
    narrowest.by_half_width(least.half_width_mm2, least.half_width_terms);
    // If there is an area by the mesh, it is the number itself, so the other kernel's area is that of the
    // voxels.
    narrowest.by_other_kernel(least.mesh_mm2 ? std::optional(least.voxel_mm2) : std::nullopt,
                              least.half_width_mm2);
    narrowest.by_certificate(certificates_, one.object);
    SupportedNumber& length = number(id, "centre line's length of " + one.object, airway.length_mm, "mm");
    length.by_half_width({});
    length.by_other_kernel({}, {});
    length.by_certificate(certificates_, one.object);
  }

  void add(const std::string& id, const MeasuredTrials& trials) {
    for (const DoubtfulNumber& doubt : trials.doubts) {
      SupportedNumber& made = number(id, doubt.what + " of " + doubt.of, doubt.value, doubt.unit);
      made.by_trials(trials, doubt);
      made.gap("the sizes of the errors were typed, and trials do not compute objects");
    }
  }

  /// Adds the movements of pieces. They are motions of the plan, which both kernels applied in the
  /// certificates.
  void add_movements() {
    for (const ObjectMovement& moved : result_.movements) {
      const auto add = [&](const char* what, double value, const char* unit) {
        SupportedNumber& made = number(moved.object, what, value, unit);
        made.by_certificate(certificates_, moved.object);
        made.gap("it is the plan's own value: octotomy outcome measures what the operation achieved");
      };
      if (moved.centroid) {
        add("forward", moved.centroid->forward_mm, "mm");
        add("left", moved.centroid->left_mm, "mm");
        add("up", moved.centroid->up_mm, "mm");
      }
      add("pitch", moved.pitch_deg, "deg");
      add("yaw", moved.yaw_deg, "deg");
      add("roll", moved.roll_deg, "deg");
    }
  }

  /// Adds cephalometric values. Their only evidence is how accurately landmarks are placed.
  void add(const CephalometryTable& table) {
    for (const CephalometryRow& row : table.measures)
      for (const auto& [when, value] : {std::pair("before", &row.before), std::pair("after", &row.after)}) {
        if (!*value) continue;
        SupportedNumber& made = number("cephalometry", row.name + " " + when, (*value)->value, row.unit);
        made.by_half_width((*value)->half_width, std::vector<Doubt>{{"landmarks", "", 0.0}}, table.coverage);
        made.gap("the landmarks were placed by people; their accuracy is an assumption of this run");
      }
  }

  const ResultRecord& result_;
  CertificatesByObject certificates_;
  std::vector<SupportedNumber> numbers_;
};

CredibilityFactor factor(const char* group, const char* name, std::vector<Json> evidence,
                         const std::string& gap) {
  CredibilityFactor made{group, name, std::move(evidence), {}};
  if (made.evidence.empty() || gap.starts_with("also: ")) made.gap = gap;
  return made;
}

std::vector<Json> certificate_evidence(const ResultRecord& result) {
  if (result.certificates.empty()) return {};
  std::vector<Json> evidence{{{"check", "certificates"}, {"counts", result.counts}}};
  const auto limits =
      std::count_if(result.certificates.begin(), result.certificates.end(),
                    [](const CertificateRecord& one) { return !one.detection_limit.is_null(); });
  if (limits > 0)
    evidence.push_back({{"check", "errors injected into the objects, to find the smallest that is detected"},
                        {"certificates_with_detection_limit", limits}});
  return evidence;
}

/// Evidence for the inputs: the audits of the scans, and the errors of other inputs that trials state.
std::vector<Json> input_evidence(const ResultRecord& result) {
  std::vector<Json> evidence;
  for (const ScanOfResult& scan : result.scans)
    for (const AuditLine& line : scan.audit)
      evidence.push_back(
          {{"check", "scan audit"}, {"scan", scan.name}, {"of", line.check}, {"verdict", line.verdict}});
  for (const Measurement& one : result.measurements)
    if (one.trials)
      evidence.push_back({{"check", "trials"},
                          {"step", one.id},
                          {"trials", one.trials->trials},
                          {"seed", one.trials->seed},
                          {"errors", print_record(one.trials->errors)}});
  return evidence;
}

bool has_trials(const ResultRecord& result) {
  return std::any_of(result.measurements.begin(), result.measurements.end(),
                     [](const Measurement& one) { return one.trials.has_value(); });
}

std::vector<Json> reader_evidence(const ResultRecord& result) {
  std::vector<Json> evidence;
  for (const SignatureOfResult& signature : result.signatures)
    if (signature.changed_since.empty())
      evidence.push_back({{"check", "signature"}, {"by", print_value(signature.by)}});
  return evidence;
}

std::vector<Json> identity_evidence(const ResultRecord& result) {
  std::vector<Json> evidence;
  for (const ScanOfResult& scan : result.scans)
    if (const std::string sum = scan.sha256.value_or(""); !sum.empty())
      evidence.push_back({{"check", "scan's SHA-256"}, {"scan", scan.name}, {"sha256", sum}});
  if (!evidence.empty()) evidence.push_back({{"check", "program's version"}, {"version", result.octotomy}});
  return evidence;
}

std::vector<CredibilityFactor> factors_of(const ResultRecord& result) {
  const char *code = "code verification", *calculation = "calculation verification",
             *model = "validation: computational model", *comparator = "validation: comparator",
             *assessment = "validation: assessment", *applicability = "applicability";
  const char* no_comparison =
      "this run compared nothing with the patient after the operation: octotomy outcome does, where a later "
      "scan exists";
  const std::vector<Json> none;
  return {
      factor(code, "software quality assurance", identity_evidence(result),
             "also: a plan does not run the program's tests; this states which version ran on which system"),
      factor(code, "numerical code verification", none,
             "no closed form was computed in this run: octotomy verify --phantoms and --faults do that for "
             "this version"),
      factor(calculation, "discretization error", certificate_evidence(result),
             "no certificate was requested, or no object has one"),
      factor(calculation, "numerical solver error", none,
             "no solver was checked by itself: the objects have the residuals of their Booleans"),
      factor(calculation, "use error", reader_evidence(result), "no reader has signed the current plan"),
      factor(model, "model form", none,
             "bone is assumed to be a window of samples: this run did not test that"),
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

ContextOfUse context_of(const ResultRecord& result) {
  ContextOfUse context;
  context.plan = result.plan.name;
  for (const ScanOfResult& scan : result.scans)
    context.scans.push_back({scan.name, scan.modality, scan.spacing_mm});
  context.voxel_mm = result.universe.voxel_mm;
  return context;
}

}  // namespace

Json credibility_json(const Json& json) {
  const auto result = record_of<ResultRecord>(json);
  Credibility made;
  made.octotomy = result.octotomy;
  made.terms = "ASME V&V 40-2018";
  made.claim =
      "What this run checked, arranged in the standard's terms. It claims no conformity and no adequacy.";
  made.context_of_use = context_of(result);
  made.credibility_factors = factors_of(result);
  made.numbers = Numbers(result).numbers();
  for (const SupportedNumber& number : made.numbers)
    made.unsupported += number.supported_by.empty() || !number.contradicted_by.empty() ? 1 : 0;
  return print_record(made);
}

std::string credibility_html(const Json& credibility) {
  const Json& plan = credibility.at("context_of_use").at("plan");
  return drawn_page("Credibility: " + (plan.is_string() ? plan.get<std::string>() : "\u2013"),
                    {{"kind", "credibility"}, {"credibility", credibility}},
                    "Without scripts, read credibility.json beside it.");
}

}  // namespace octotomy::planner

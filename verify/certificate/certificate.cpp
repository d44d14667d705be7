// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/certificate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

#include "voxel/space/rounded.h"

namespace octotomy::verify {
namespace {

/// A difference up to this multiple of the tolerance is a WARN, a larger one a FAIL. The tolerance allows
/// three standard deviations; a normal error does not reach six by chance.
constexpr double doubt = 2.0;

std::string with_unit(double value, const std::string& unit) {
  return voxel::rounded(value) + (unit.empty() ? "" : " " + unit);
}

/// Returns a sentence, for example: "The volume is 768 mm3 in the voxel kernel and 808 mm3 in the mesh
/// kernel, 39.6 mm3 apart; theory allows 12 mm3."
std::string disagreement(const Certificate& certificate, const Comparison& comparison) {
  const std::string difference = with_unit(comparison.difference, comparison.unit);
  std::string text = comparison.statement;
  if (const std::size_t place = text.find('%'); place != std::string::npos) {
    text.replace(place, 1, difference);
  } else {
    text = "The " + comparison.quantity;
    const bool against_truth = certificate.tier == Tier::ClosedForm;
    if (comparison.voxel && comparison.mesh)
      text += " is " + with_unit(*comparison.voxel, comparison.unit) +
              (against_truth ? "" : " in the voxel kernel") + " and " +
              with_unit(*comparison.mesh, comparison.unit) +
              (against_truth ? " in truth, " : " in the mesh kernel, ") + difference + " apart";
    else
      text += " differs by " + difference;
  }
  return text + "; theory allows " + with_unit(*comparison.tolerance, comparison.unit) + ".";
}

}  // namespace

void lower(Certificate& certificate, Verdict verdict, const std::string& reason) {
  certificate.verdict = std::max(certificate.verdict, verdict);
  certificate.reasons.push_back(reason);
}

void add_comparison(Certificate& certificate, Comparison comparison, Verdict worst_verdict) {
  // A difference that is not a number is not within any tolerance, so it fails.
  const auto within = [&](double allowed) { return comparison.difference <= allowed; };
  if (comparison.tolerance && !within(*comparison.tolerance)) {
    comparison.verdict =
        std::min(within(doubt * *comparison.tolerance) ? Verdict::Warn : Verdict::Fail, worst_verdict);
    lower(certificate, comparison.verdict, disagreement(certificate, comparison));
  }
  certificate.comparisons.push_back(std::move(comparison));
}

double Certificate::larger_mm3() const {
  return std::max(std::abs(voxel.volume_mm3), std::abs(mesh.volume_mm3));
}

bool is_evident(const Certificate& certificate) {
  return certificate.resolved() ||
         (certificate.limit && certificate.unseen_mm3() <= evident_share * certificate.larger_mm3());
}

void judge_evidence(Certificate& certificate) {
  const double object_mm3 = certificate.larger_mm3();
  const double unseen_mm3 = std::max(certificate.unseen_mm3(), certificate.tolerance_mm3);
  if (certificate.unresolved || !(object_mm3 > 0.0) || unseen_mm3 <= evident_share * object_mm3) return;
  const std::string share = voxel::rounded(100.0 * unseen_mm3 / object_mm3);
  const std::string allowed = voxel::rounded(100.0 * evident_share);
  certificate.unresolved = {
      std::nullopt, "a wrong part of " + voxel::rounded(unseen_mm3) + " mm3 could pass, " +
                        (share == allowed ? "slightly more than the " + allowed + " % of the object that are"
                                          : share + " % of the object; " + allowed + " % are") +
                        " allowed: take smaller voxels"};
}

void judge_emptiness(Certificate& certificate, double missed_mm3) {
  if (certificate.larger_mm3() > 0.0 || certificate.mesh.area_mm2 > 0.0) return;
  lower(certificate, Verdict::Warn,
        "Both answers are empty, so that nothing was compared. A part of up to " +
            voxel::rounded(missed_mm3) + " mm3 could have been missed.");
  if (!certificate.unresolved) certificate.unresolved = {std::nullopt, "both answers are empty"};
}

std::vector<std::string> shared_makers(const Answer& a, const Answer& b) {
  std::vector<std::string> shared;
  std::set_intersection(a.makers.begin(), a.makers.end(), b.makers.begin(), b.makers.end(),
                        std::back_inserter(shared));
  return shared;
}

void judge_independence(Certificate& certificate) {
  const std::vector<std::string> shared = shared_makers(certificate.voxel, certificate.mesh);
  if (shared.empty()) return;
  std::string names;
  for (const std::string& maker : shared) names += (names.empty() ? "" : "; ") + maker;
  lower(certificate, Verdict::Warn,
        "The answers are not independent, as the same code made both: " + names +
            ". Their agreement does not test that code.");
}

std::string text_of(const WorstPlace& worst) {
  return "The two surfaces differ by up to " + voxel::rounded(worst.size_mm) + " mm near " +
         voxel::rounded(worst.at_mm) + ": " + worst.what + ".";
}

double worst_share(const Certificate& certificate) {
  double worst = 0.0;
  for (const Comparison& comparison : certificate.comparisons) {
    if (!comparison.tolerance || comparison.difference == 0.0) continue;
    assert(*comparison.tolerance >= 0.0);
    worst = std::max(worst, *comparison.tolerance > 0.0 ? comparison.difference / *comparison.tolerance
                                                        : std::numeric_limits<double>::infinity());
  }
  return worst;
}

bool is_worse(const Certificate& a, const Certificate& b) {
  const auto rank = [](const Certificate& c) { return std::tuple(c.verdict, c.resolved(), worst_share(c)); };
  return rank(a) > rank(b);
}

void keep_worse(std::optional<Contested>& kept, const Contested& found) {
  if (!kept || is_worse(found.certificate, kept->certificate)) kept = found;
}

std::string to_string(Tier tier) {
  switch (tier) {
    case Tier::Exact:
      return "exact";
    case Tier::Bounded:
      return "bounded";
    case Tier::ClosedForm:
      return "closed_form";
  }
  return {};
}

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::Pass:
      return "PASS";
    case Verdict::Warn:
      return "WARN";
    case Verdict::Fail:
      return "FAIL";
  }
  return {};
}

std::string verdict_text(const Certificate& certificate) {
  const std::string verdict = to_string(certificate.verdict);
  return certificate.resolved() ? verdict : verdict + ", not resolved: " + certificate.unresolved->reason;
}

}  // namespace octotomy::verify

// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The page from top to bottom, a function a section: heading with the overall verdict, shares of tolerance by
// quantity, pictures of the worst certificate, certificates, the suite's tables, what was not covered.
#include "planner/result/report/verification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "planner/operation/measure/certificate_record.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/difference_pictures.h"
#include "planner/result/report/html.h"
#include "planner/result/report/result_folder.h"
#include "voxel/space/write_whole.h"
#include "voxel/view/surface_scalar.h"

namespace octotomy::planner {
namespace {

verify::Verdict verdict_named(const std::string& name) {
  for (const auto verdict : {verify::Verdict::Pass, verify::Verdict::Warn})
    if (name == verify::to_string(verdict)) return verdict;
  return verify::Verdict::Fail;
}

/// An entry of a suite that was not computed again.
struct NotRecomputed {
  std::string where, why;
};
constexpr auto members_of(const NotRecomputed&) {
  return std::tuple(member("where", &NotRecomputed::where), member("why", &NotRecomputed::why));
}
/// The parts of an answer that the page reads by name.
struct VerificationAnswer {
  std::vector<CertificateRecord> certificates;
  std::vector<NotRecomputed> not_recomputed;
};
constexpr auto members_of(const VerificationAnswer&) {
  return std::tuple(member("certificates", &VerificationAnswer::certificates),
                    member("not_recomputed", &VerificationAnswer::not_recomputed));
}

/// A quantity's difference as a share of its tolerance; infinite if there is a difference but the tolerance
/// is zero.
struct Share {
  double value = 0.0;
  verify::Verdict verdict = verify::Verdict::Pass;
};

std::optional<Share> share_of(const ComparedQuantity& comparison) {
  if (!comparison.tolerance || !comparison.difference) return std::nullopt;
  const double difference = *comparison.difference, tolerance = *comparison.tolerance;
  const double share = difference == 0.0 ? 0.0
                       : tolerance > 0.0 ? difference / tolerance
                                         : std::numeric_limits<double>::infinity();
  return Share{share, verdict_named(comparison.verdict.value_or(""))};
}

using CertificateList = std::vector<CertificateRecord>;

/// Shares by quantity, over all certificates of objects that voxels resolve; the exact tier is a quantity of
/// its own.
using Shares = std::map<std::string, std::vector<Share>>;

Shares shares_of(const CertificateList& certificates) {
  Shares shares;
  for (const CertificateRecord& certificate : certificates) {
    if (!certificate.resolved) continue;
    if (certificate.tier == verify::to_string(verify::Tier::Exact)) {
      const verify::Verdict verdict = verdict_named(certificate.verdict);
      shares["exact tier"].push_back(
          {verdict == verify::Verdict::Pass ? 0.0 : std::numeric_limits<double>::infinity(), verdict});
      continue;
    }
    for (const ComparedQuantity& comparison : certificate.comparisons)
      if (const auto share = share_of(comparison)) shares[comparison.quantity].push_back(*share);
  }
  for (auto& [quantity, all] : shares)
    std::sort(all.begin(), all.end(), [](const Share& a, const Share& b) { return a.value < b.value; });
  return shares;
}

double worst_of(const CertificateRecord& certificate) {
  double worst = 0.0;
  for (const ComparedQuantity& comparison : certificate.comparisons)
    if (const auto share = share_of(comparison)) worst = std::max(worst, share->value);
  return worst;
}

std::string share_text(double share) {
  return std::isfinite(share) ? three_figures(share) : "\u221e";
}

/// A histogram of differences by their share of the tolerance, on a logarithmic scale from a thousandth to
/// ten; smaller and larger ones are counted at the ends.
std::string histogram(const std::vector<Share>& shares) {
  constexpr int bins = 64;
  constexpr double low = -3.0, high = 1.0, width = 640.0, height = 34.0;
  std::array<int, bins> count{};
  for (const Share& share : shares) {
    const double at = share.value > 0.0 ? (std::log10(share.value) - low) / (high - low) : 0.0;
    ++count[static_cast<std::size_t>(std::clamp(at, 0.0, 1.0) * (bins - 1))];
  }
  const int most = *std::max_element(count.begin(), count.end());
  std::string svg = "<svg viewBox=\"0 0 " + fixed(width) + " " + fixed(height) + "\" width=\"100%\">";
  const auto line = [&](double share, const char* colour) {
    const std::string x = fixed(width * (std::log10(share) - low) / (high - low));
    return "<path d=\"M" + x + " 0V" + fixed(height) + "\" stroke=\"" + colour + "\"/>";
  };
  for (const double decade : {0.01, 0.1}) svg += line(decade, "#d9dfe2");
  for (std::size_t bin = 0; bin < count.size(); ++bin) {
    if (count[bin] == 0) continue;
    const double tall = std::max(1.5, (height - 2.0) * std::sqrt(static_cast<double>(count[bin]) / most));
    const double share = std::pow(10.0, low + (high - low) * (static_cast<double>(bin) + 0.5) / bins);
    const char* colour = share <= 1.0 ? "#1f5f7a" : share <= 2.0 ? "#a56a00" : "#b3261e";
    svg += "<rect x=\"" + fixed(width * static_cast<double>(bin) / bins) + "\" y=\"" + fixed(height - tall) +
           "\" width=\"" + fixed(width / bins - 1.0) + "\" height=\"" + fixed(tall) + "\" fill=\"" + colour +
           "\"><title>" + std::to_string(count[bin]) + "</title></rect>";
  }
  return svg + line(1.0, "#1d7a4c") + line(2.0, "#b3261e") + "</svg>";
}

std::string quantities(const Shares& shares) {
  if (shares.empty()) return "";
  std::string rows =
      "<tr><th>Quantity</th><th style=\"width:52%\">difference / allowed, from 0.001 to 10; green: all that "
      "is allowed, red: a failure</th><th class=\"n\">compared</th><th class=\"n\">median</th><th "
      "class=\"n\">99 %</th><th class=\"n\">largest</th><th></th></tr>";
  for (const auto& [quantity, all] : shares) {
    const auto at = [&sorted = all](double part) {
      return share_text(
          sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))].value);
    };
    const verify::Verdict worst =
        std::max_element(all.begin(), all.end(), [](const Share& a, const Share& b) {
          return a.verdict < b.verdict;
        })->verdict;
    rows += "<tr>" + cell(escaped(quantity)) + cell(histogram(all)) +
            figure_cell(grouped(static_cast<double>(all.size()), 0)) + figure_cell(at(0.5)) +
            figure_cell(at(0.99)) + figure_cell(at(1.0)) + cell(pill(worst)) + "</tr>";
  }
  return element("h2", "Observed against allowed") + element("table", rows) +
         element("p class=\"soft small\"",
                 "Bars are as tall as the root of their number. Objects that voxels do not resolve are left "
                 "out.");
}

std::string worst_pictures(const Verification& verification) {
  const auto& worst = verification.worst;
  if (!worst || worst->octree.is_empty() || !worst->solid || worst->solid->empty()) return "";
  const DifferencePictures pictures = difference_pictures(*worst);
  std::string figures;
  for (const ScenePicture& picture : pictures.group.pictures)
    figures += element("figure", "<img style=\"width:100%\" alt=\"" + escaped(picture.view) +
                                     "\" src=\"data:image/png;base64," + base64(picture.png) + "\">" +
                                     element("figcaption", escaped(picture.view)));
  return element("h2", "Worst certificate") +
         element("p",
                 pill(worst->certificate.verdict, worst->certificate.resolved()) + " " +
                     element("code", escaped(worst->certificate.operation)) + ", " +
                     share_text(verify::worst_share(worst->certificate)) +
                     " of what is allowed. The voxel kernel's surface, coloured by its signed distance to "
                     "the mesh kernel's.") +
         list(worst->certificate.reasons) + colour_scale(pictures.most_mm) +
         element("div class=\"pictures four\"", figures);
}

std::string certificate_row(const CertificateRecord& certificate) {
  const verify::Verdict verdict = verdict_named(certificate.verdict);
  const auto volume = [](const KernelAnswer& answer) {
    return figure_cell(answer.volume_mm3 ? grouped(*answer.volume_mm3, 1) : "\u2013");
  };
  const auto &difference = certificate.difference_mm3, &tolerance = certificate.tolerance_mm3;
  std::vector<std::string> reasons = certificate.reasons;
  if (!certificate.resolved)
    reasons.push_back("not resolved: " + certificate.not_resolved_because.value_or(""));
  reasons.insert(reasons.end(), certificate.findings.begin(), certificate.findings.end());
  return "<tr>" + cell(element("code", escaped(certificate.operation)) + list(reasons)) +
         cell(escaped(certificate.tier)) + cell(pill(verdict, certificate.resolved)) +
         volume(certificate.voxel) + volume(certificate.mesh) +
         (difference && tolerance ? figure_cell(grouped(*difference, 1) + " / " + grouped(*tolerance, 1) +
                                                gauge(*difference, *tolerance, verdict))
                                  : figure_cell("\u2013")) +
         figure_cell(share_text(worst_of(certificate))) + "</tr>";
}

/// All certificates if there are few, else those with the largest shares of their tolerances.
std::string certificates(const CertificateList& all) {
  constexpr std::size_t most_shown = 30;
  std::vector<const CertificateRecord*> shown;
  for (const CertificateRecord& certificate : all) shown.push_back(&certificate);
  const bool few = shown.size() <= most_shown;
  if (!few) {
    std::stable_sort(shown.begin(), shown.end(), [](const CertificateRecord* a, const CertificateRecord* b) {
      const auto rank = [](const CertificateRecord& c) {
        return std::tuple(verdict_named(c.verdict), c.resolved, worst_of(c));
      };
      return rank(*a) > rank(*b);
    });
    shown.resize(most_shown);
  }
  if (shown.empty()) return "";
  std::string rows =
      "<tr><th>Question</th><th>Tier</th><th></th><th class=\"n\">voxel, mm\u00b3</th><th class=\"n\">mesh, "
      "mm\u00b3</th><th class=\"n\">difference / allowed, mm\u00b3</th><th class=\"n\">largest "
      "share</th></tr>";
  for (const CertificateRecord* certificate : shown) rows += certificate_row(*certificate);
  return element("h2", few ? "Certificates"
                           : "The " + std::to_string(most_shown) + " worst of " + std::to_string(all.size()) +
                                 " certificates") +
         element("table", rows);
}

std::string value_text(const Json& value) {
  if (value.is_null()) return "\u2013";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_integer()) return grouped(value.get<double>(), 0);
  if (value.is_number()) return three_figures(value.get<double>());
  if (value.is_string()) return escaped(value.get<std::string>());
  std::string all;
  for (const Json& one : value) all += (all.empty() ? "" : ", ") + value_text(one);
  return all;
}

/// A table of JSON objects with the same keys, one row each.
std::string table_of(const std::string& title, const Json& entries) {
  if (!entries.is_array() || entries.empty() || !entries.front().is_object()) return "";
  std::string head, rows;
  for (const auto& [key, value] : entries.front().items()) {
    std::string words = key;
    std::replace(words.begin(), words.end(), '_', ' ');
    head += element(value.is_number() ? "th class=\"n\"" : "th", escaped(words));
  }
  for (const Json& entry : entries) {
    std::string row;
    for (const auto& [key, value] : entry.items())
      row += value.is_number() ? figure_cell(value_text(value)) : cell(value_text(value));
    rows += element("tr", row);
  }
  return element("h2", title) + element("table", element("tr", head) + rows);
}

std::string suite_tables(const Json& answer) {
  constexpr std::array<std::pair<const char*, const char*>, 10> titles{
      {{"checks", "Checks"},
       {"intervals", "Coverage of intervals"},
       {"calibration", "Calibration"},
       {"tightness", "Tightness"},
       {"convergence", "Convergence"},
       {"faults", "Seeded faults"},
       {"power", "Detection power"},
       {"missed", "Missed faults"},
       {"disagreements", "Disagreements"},
       {"tables", "Recomputed entries"}}};
  std::string html;
  for (const auto& [key, title] : titles)
    if (answer.contains(key)) html += table_of(title, answer.at(key));
  return html;
}

std::string not_covered(const Verification& verification, const VerificationAnswer& answer) {
  std::vector<std::string> lines = verification.not_covered;
  if (verification.counts.not_resolved > 0)
    lines.push_back(plural(verification.counts.not_resolved, "object") +
                    " not resolved: a PASS on fewer than six voxels, or on a sheet thinner than one, proves "
                    "little");
  for (const NotRecomputed& gap : answer.not_recomputed) lines.push_back(gap.where + ": " + gap.why);
  // The code that made both answers and their shared inputs, from the certificates.
  std::map<std::string, int> shared;
  for (const CertificateRecord& certificate : answer.certificates)
    for (const auto* list : {&certificate.shared_makers, &certificate.shared_values})
      for (const std::string& entry : *list) ++shared[entry];
  for (const auto& [entry, count] : shared)
    lines.push_back("both answers of " + plural(count, "certificate") + " share " + entry);
  lines.emplace_back(
      "what every certificate takes from one place: how scans are read, which whole samples a window holds, "
      "plans' "
      "names and motions' matrices, convert::voxelise, which says what lies inside of a mesh, and whether a "
      "window is "
      "the tissue that it is meant for");
  return element("h2", "Not covered") + list(lines);
}

std::string heading(const Verification& verification) {
  return element("header",
                 element("div", element("h1", "Verification") +
                                    element("p class=\"soft\"", escaped(verification.subject) +
                                                                    " \u00b7 Octotomy " OCTOTOMY_VERSION)) +
                     overall_verdict(verification.counts));
}

std::string times(const Json& answer) {
  std::string text;
  for (const auto& [stage, milliseconds] : answer.at("timings_ms").items())
    text += (text.empty() ? "" : " \u00b7 ") + escaped(stage) + " " + grouped(milliseconds.get<double>(), 0) +
            " ms";
  return element("footer", "Octotomy " OCTOTOMY_VERSION
                           ". A planning and research tool, not a medical device. Times: " +
                               text + ".");
}

}  // namespace

std::string verification_html(const Verification& verification) {
  const auto answer = record_of<VerificationAnswer>(verification.answer);
  return html_page("Verification: " + verification.subject,
                   heading(verification) + quantities(shares_of(answer.certificates)) +
                       worst_pictures(verification) + certificates(answer.certificates) +
                       suite_tables(verification.answer) + not_covered(verification, answer) +
                       times(verification.answer));
}

void write_verification(const Verification& verification, const std::filesystem::path& folder) {
  ResultFolder result(folder);
  voxel::write_file(result.path() / "report.html", verification_html(verification));
  voxel::write_file(result.path() / "result.json", json_text(verification.answer, 2) + "\n");
  result.publish();
}

}  // namespace octotomy::planner

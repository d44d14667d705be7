// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/group_page.h"

#include <map>

#include "planner/operation/table/number_format.h"
#include "planner/result/report/html.h"

namespace octotomy::planner {
namespace {

std::string figure(const nlohmann::ordered_json& summary, const char* key) {
  return figure_cell(three_figures(summary[key].get<double>()));
}

std::string numbers_table(const GroupPage& page) {
  std::string rows =
      "<tr><th>Number</th><th>Unit</th><th class='n'>Subjects</th><th class='n'>Mean</th><th "
      "class='n'>SD</th>"
      "<th class='n'>Least</th><th class='n'>Median</th><th class='n'>Greatest</th><th "
      "class='n'>Outliers</th><th class='n'>Doubtful</th><th class='n'>Mean without doubtful</th></tr>";
  for (const GroupColumn& column : page.columns) {
    const auto& told = column.summary;
    rows += "<tr>" + cell(escaped(column.name)) + cell(escaped(column.unit)) +
            figure_cell(std::to_string(told["subjects"].get<std::size_t>())) + figure(told, "mean") +
            figure(told, "sd") + figure(told, "least") + figure(told, "median") + figure(told, "greatest") +
            figure_cell(std::to_string(column.outliers.size())) +
            figure_cell(std::to_string(told["doubtful"].size())) +
            (told.contains("without_doubtful") ? figure(told["without_doubtful"], "mean") : figure_cell("")) +
            "</tr>";
  }
  return "<table>" + rows + "</table>";
}

std::string picture(const GroupPage::Shown& subject) {
  if (!subject.has_picture) return "<span class='none'>no picture</span>";
  return "<img loading='lazy' width='160' height='160' src='../sub-" + subject.label +
         "/picture.png' alt='Subject " + escaped(subject.label) + "'>";
}

std::string captioned(const GroupPage::Shown& subject, const std::string& caption) {
  return picture(subject) + "<figcaption>" + caption + "</figcaption></figure>";
}

/// The numbers of each subject by which it is an outlier.
std::map<std::uint32_t, std::string> outlying_numbers(const GroupPage& page) {
  std::map<std::uint32_t, std::string> numbers;
  for (const GroupColumn& column : page.columns)
    for (const auto& [subject, value] : column.outliers)
      numbers[subject] +=
          "<br>" + escaped(column.name) + " " + three_figures(value) + " " + escaped(column.unit);
  return numbers;
}

std::string outliers_of(const GroupPage& page, const std::map<std::uint32_t, std::string>& numbers) {
  std::string text;
  for (const auto& [subject, told] : numbers) {
    const GroupPage::Shown& shown = page.subjects[subject];
    const std::string label = escaped(shown.label);
    text += "<figure>" + captioned(shown, "<a href='#" + label + "'>" + label + "</a>" + told);
  }
  return text.empty()
             ? "<p>None: no number lies more than 3.5 robust standard deviations from its median.</p>"
             : "<p>Numbers more than 3.5 robust standard deviations from their median. Each picture is drawn "
               "to its own "
               "scale.</p><div class='subjects'>" +
                   text + "</div>";
}

}  // namespace

std::string group_page(const GroupPage& page) {
  std::size_t answers = 0, doubtful = 0;
  std::string missing, doubts, pictures, plots;
  const std::map<std::uint32_t, std::string> outlying = outlying_numbers(page);
  for (std::uint32_t i = 0; i < page.subjects.size(); ++i) {
    const GroupPage::Shown& subject = page.subjects[i];
    const bool is_outlier = outlying.contains(i);
    const std::string label = escaped(subject.label);
    if (subject.is_doubtful) {
      ++doubtful;
      doubts += "<li><a href='#" + label + "'>" + label + "</a>: " + escaped(subject.audit) + "</li>";
    }
    if (subject.reason.empty())
      ++answers;
    else
      missing += "<li><a href='#" + label + "'>" + label + "</a>: " + escaped(subject.reason) + "</li>";
    pictures += "<figure id='" + label + (is_outlier ? "' class='outlier'>" : "'>") +
                captioned(subject, label + (is_outlier ? ": outlier" : "") +
                                       (subject.is_doubtful ? ": doubtful" : "") +
                                       (subject.reason.empty() ? "" : ": without an answer"));
  }
  for (const GroupColumn& column : page.columns)
    for (const auto& [kind, svg] : column.plots) plots += "<div class='plot'>" + svg + "</div>";
  std::string body =
      "<style>.plots,.subjects{display:flex;flex-wrap:wrap;gap:14px}.plot{flex:1 1 380px;max-width:520px}"
      "figure{margin:0;width:160px;overflow-wrap:anywhere}.none{display:inline-block;width:160px;height:"
      "160px;"
      "line-height:160px;text-align:center;outline:1px dashed}.outlier img{outline:2px solid "
      "#c2410c}</style>";
  body += element("h1", "Cohort of " + std::to_string(page.subjects.size()) + " subjects");
  body += element(
      "p", "With an answer: " + std::to_string(answers) + ", " + std::to_string(doubtful) +
               " of them doubtful. Without one: " + std::to_string(page.subjects.size() - answers) + ".");
  if (!doubts.empty())
    body += element("h2", "Doubtful") +
            element("p",
                    "The audit of a scan has a FAIL. The numbers below count these subjects; look at each "
                    "before you trust them.") +
            element("ul", doubts);
  if (!missing.empty()) body += element("h2", "Without an answer") + element("ul", missing);
  if (!page.findings.empty()) body += element("h2", "Findings") + list(page.findings);
  body += element("h2", "Numbers") + numbers_table(page);
  body += element("h2", "Outliers") + outliers_of(page, outlying);
  body += element("h2", "Plots") + "<div class='plots'>" + plots + "</div>";
  body += element("h2", "Subjects") + "<div class='subjects'>" + pictures + "</div>";
  return html_page("Cohort", body);
}

}  // namespace octotomy::planner

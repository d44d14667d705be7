// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/text_header.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

/// The largest length of a header. Segmentations have the longest headers: about ten lines per segment.
constexpr std::size_t most_header_bytes = std::size_t{4} << 20;

std::string header_bytes_of(const fs::path& path) {
  std::ifstream in = opened(path);
  if (!in) refuse(path, "cannot be opened; check that it is a file and that you may read it");
  std::string head(most_header_bytes, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  if (head.empty()) refuse(path, "the file is empty");
  return head;
}

class HeaderLines {
 public:
  HeaderLines(const fs::path& path, VolumeFormat format)
      : path_(path), format_(format), head_(header_bytes_of(path)) {
    // If a header is too long, its end is not in memory and its last line may be incomplete.
    is_whole_ = head_.size() < most_header_bytes;
    if (!is_whole_) head_.resize(head_.rfind('\n') + 1);
    const bool is_known = format == VolumeFormat::Nrrd
                              ? head_.starts_with("NRRD00")
                              : head_.find(is_whole_ ? "ElementDataFile" : "DimSize") != std::string::npos;
    if (!is_known)
      refuse(path, std::string("is not a ") + name_of(format) +
                       " file, though its extension says so; rename it to its real format");
  }

  TextHeader parsed() {
    if (format_ == VolumeFormat::Nrrd) next_line();  // skips the magic number
    while (at_ < head_.size()) {
      const std::string line = next_line();
      ends_ = line.empty() && format_ == VolumeFormat::Nrrd;
      if (ends_) break;
      if (line.empty() || line.front() == '#') continue;
      format_ == VolumeFormat::Nrrd ? take_nrrd(line) : take_meta(line);
      if (ends_ && !is_list_) break;
      if (!is_list_) continue;
      list_files();  // the list of data files extends to the end of the file
      ends_ = false;
    }
    if (!ends_ && !is_whole_)
      refuse(path_, std::string("its ") + name_of(format_) + " header is longer than " +
                        std::to_string(most_header_bytes >> 20) +
                        " MB: save the volume without its additional fields");
    header_.end = std::min(at_, head_.size());
    return std::move(header_);
  }

 private:
  std::string next_line() {
    const std::size_t end = std::min(head_.find('\n', at_), head_.size());
    const std::string line = trimmed(head_.substr(at_, end - at_));
    at_ = end + 1;
    return line;
  }

  /// Parses NRRD's "field: description" or "key:=value". The mark that comes first determines the form.
  void take_nrrd(const std::string& line) {
    const std::size_t mark = line.find(':');
    if (mark == std::string::npos) refuse(path_, "its NRRD header is damaged: a line has no colon");
    if (line.compare(mark, 2, ":=") == 0) {
      header_.keys[lower_case(trimmed(line.substr(0, mark)))] = trimmed(line.substr(mark + 2));
      return;
    }
    std::string name = lower_case(line.substr(0, mark));
    std::erase(name, ' ');
    const std::string value = trimmed(line.substr(mark + 1));
    is_list_ = name == "datafile" && is_list(value);
    put(name, value);
  }

  /// Parses "Key = Value" or "Key: Value". The mark that comes first separates the parts, as in MetaIO
  /// (MET_Read).
  void take_meta(const std::string& line) {
    const std::size_t mark = line.find_first_of("=:");
    if (mark == std::string::npos || mark == 0)
      refuse(path_, "its MetaImage header is damaged: a line is neither 'Key = Value' nor 'Key: Value'");
    const std::string name = lower_case(trimmed(line.substr(0, mark)));
    const std::string value = trimmed(line.substr(mark + 1));
    // Private keys may share their first part: "lab:dose = 5" and "lab:date = 6" do not contradict each
    // other.
    if (line[mark] == ':' && value.find('=') != std::string::npos)
      header_.fields.emplace(name, value);
    else
      put(name, value);
    ends_ = name == "elementdatafile";
    is_list_ = ends_ && is_list(value);
  }

  static bool is_list(const std::string& value) { return value == "LIST" || value.starts_with("LIST "); }

  void put(const std::string& name, const std::string& value) {
    const auto [place, is_new] = header_.fields.emplace(name, value);
    if (!is_new && place->second != value)
      refuse(path_, "its header states '" + name + "' twice, as '" + place->second + "' and as '" + value +
                        "': remove the wrong line");
  }

  void list_files() {
    while (at_ < head_.size())
      if (std::string line = next_line(); !line.empty()) header_.listed.push_back(std::move(line));
  }

  const fs::path& path_;
  VolumeFormat format_;
  std::string head_;
  std::size_t at_ = 0;
  bool is_whole_ = true, is_list_ = false, ends_ = false;
  TextHeader header_;
};

fs::path beside(const fs::path& header, const std::string& name) {
  const fs::path file = fs::absolute(header).parent_path() / name;  // an absolute name remains unchanged
  std::error_code error;
  if (!fs::is_regular_file(file, error))
    refuse(header, "its data file '" + name + "' is missing; keep header and data together");
  return file;
}

/// The file name for a number, by a pattern with one %d, %3d or %03d.
class NumberedName {
 public:
  explicit NumberedName(const std::string& pattern) {
    const std::size_t mark = pattern.find('%');
    std::size_t at = mark + 1;
    fill_ = at < pattern.size() && pattern[at] == '0' ? '0' : ' ';
    for (; at < pattern.size() && pattern[at] >= '0' && pattern[at] <= '9' && width_ < 100; ++at)
      width_ = width_ * 10 + static_cast<std::size_t>(pattern[at] - '0');
    is_sound_ = at < pattern.size() && (pattern[at] == 'd' || pattern[at] == 'i' || pattern[at] == 'u') &&
                pattern.find('%', at) == std::string::npos && width_ < 100;
    if (!is_sound_) return;
    before_ = pattern.substr(0, mark);
    after_ = pattern.substr(at + 1);
  }
  bool is_sound() const { return is_sound_; }
  std::string operator()(long number) const {
    std::string digits = std::to_string(std::abs(number));
    const std::size_t sign = number < 0 ? 1 : 0;
    const std::size_t missing = width_ - std::min(width_, digits.size() + sign);
    digits = fill_ == '0' ? std::string(sign, '-') + std::string(missing, '0') + digits
                          : std::string(missing, ' ') + std::string(sign, '-') + digits;
    return before_ + digits + after_;
  }

 private:
  std::string before_, after_;
  char fill_ = ' ';
  std::size_t width_ = 0;
  bool is_sound_ = false;
};

}  // namespace

std::optional<std::vector<double>> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t at = 0;;) {
    at = text.find_first_not_of(" \t,", at);
    if (at == std::string::npos) return numbers;
    std::size_t end = std::min(text.find_first_of(" \t,", at), text.size());
    if (text[at] == '+' && end - at > 1 && text[at + 1] != '-') ++at;
    double number = 0.0;
    const auto [rest, error] = std::from_chars(text.data() + at, text.data() + end, number);
    if (error != std::errc() || rest != text.data() + end) return std::nullopt;
    numbers.push_back(number);
    at = end;
  }
}

std::optional<std::string> TextHeader::field(const std::string& name) const {
  const auto found = fields.find(name);
  return found == fields.end() ? std::nullopt : std::optional<std::string>(found->second);
}

std::vector<double> TextHeader::numbers(const fs::path& path, const std::string& name,
                                        std::size_t count) const {
  const std::optional<std::string> text = field(name);
  if (!text) return {};
  const std::optional<std::vector<double>> numbers = numbers_in(*text);
  if (!numbers || numbers->size() != count)
    refuse(path, "its header is damaged: '" + name + "' must have " + std::to_string(count) +
                     (count == 1 ? " number, not '" : " numbers, not '") + text->substr(0, 100) + "'");
  return *numbers;
}

std::optional<double> TextHeader::number(const fs::path& path, const std::string& name) const {
  const std::vector<double> all = numbers(path, name, 1);
  return all.empty() ? std::nullopt : std::optional<double>(all.front());
}

TextHeader read_text_header(const fs::path& path, VolumeFormat format) {
  return HeaderLines(path, format).parsed();
}

std::vector<fs::path> data_files(const fs::path& header, const std::string& statement,
                                 const std::vector<std::string>& listed) {
  std::vector<fs::path> files;
  if (statement == "LIST" || statement.starts_with("LIST ")) {
    for (const std::string& name : listed) files.push_back(beside(header, name));
    if (files.empty()) refuse(header, "its header lists no data files behind LIST");
    return files;
  }
  // A pattern is followed by two or three numbers and, in NRRD, by the number of axes per file.
  std::istringstream words(statement);
  std::string name, rest;
  words >> name;
  std::getline(words, rest);
  const std::optional<std::vector<double>> numbers = numbers_in(rest);
  if (name.find('%') == std::string::npos || !numbers || numbers->size() < 2)
    return {beside(header, statement)};
  const NumberedName numbered(name);
  constexpr double most = 1e6;
  const double first = (*numbers)[0], last = (*numbers)[1];
  const double step = numbers->size() > 2 ? (*numbers)[2] : first <= last ? 1.0 : -1.0;
  const auto is_whole = [&](double number) {
    return std::abs(number) <= most && number == std::trunc(number);
  };
  if (!numbered.is_sound() || numbers->size() > 4 || !is_whole(first) || !is_whole(last) || !is_whole(step) ||
      step == 0.0 || (last - first) * step < 0.0)
    refuse(header, "its data files '" + statement +
                       "' cannot be read: use a pattern with one %d, the first and the last number and "
                       "the step, for example slice%03d.raw 1 10 1");
  for (long number = std::lround(first); step > 0.0 ? number <= last : number >= last;
       number += std::lround(step))
    files.push_back(beside(header, numbered(number)));
  return files;
}

}  // namespace octotomy::voxel

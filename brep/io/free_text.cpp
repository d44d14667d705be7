// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads each occurrence of a key in four steps: the word before it (a key of another quantity is skipped),
// the sign after it, the small words up to the unit or frame, and the text after that (m is not a unit of
// length in m/s, and two units joined by "to" are a conversion). If the steps fail but the sentence names a
// unit or frame, it is Unclear, so that readers do not silently assume a unit.
#include "brep/io/free_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "brep/io/mesh_audit.h"
#include "brep/io/mesh_scanner.h"

namespace octotomy::brep {
namespace {

/// Whether a byte belongs to a word: ASCII letters and digits, all bytes of other UTF-8 characters, hyphen
/// and underscore.
bool is_name_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ||
         (static_cast<unsigned char>(c) & 0x80) != 0;
}

/// Whether `words` contains the word.
template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Whether a word names a quantity that is no length, or a screen, whose lengths are not those of the mesh.
bool is_other_quantity(std::string_view word) {
  static constexpr auto known = std::to_array<std::string_view>(
      {"volume",   "volumes",   "area",      "areas",         "velocity",    "velocities",   "speed",
       "time",     "temporal",  "angle",     "angles",        "angular",     "curvature",    "curvatures",
       "density",  "densities", "mass",      "weight",        "force",       "forces",       "pressure",
       "stress",   "stresses",  "strain",    "modulus",       "temperature", "intensity",    "intensities",
       "value",    "values",    "scalar",    "scalars",       "hounsfield",  "hu",           "dose",
       "energy",   "power",     "frequency", "concentration", "stiffness",   "display",      "screen",
       "colour",   "color",     "texture",   "rotation",      "rotations",   "acceleration", "torque",
       "viscosity"});
  return is_one_of(word, known);
}

/// A word or one other character; blanks and quotation marks are skipped.
struct Token {
  std::string_view text;  ///< as written in the sentence
  std::size_t at = 0;     ///< where it starts in the sentence
  bool joined = false;    ///< follows the token before it without a blank
  bool is_word() const { return !text.empty() && is_name_letter(text.front()); }
};

/// One occurrence of a key, with the word before it and the text after it up to the end of the sentence: the
/// end of the line, a semicolon, or a full stop before a blank.
struct Sentence {
  std::string_view key;      ///< as written in the text
  std::string before;        ///< the word before the key, in lower case; empty if there is none
  bool is_name_end = false;  ///< an underscore joins the key to that word
  std::string_view behind;   ///< the text after the key
  std::vector<Token> tokens;

  std::size_t size() const { return tokens.size(); }
  std::string_view text(std::size_t i) const { return i < size() ? tokens[i].text : std::string_view{}; }
  std::string lower(std::size_t i) const { return lower_case(text(i)); }
  bool is_word(std::size_t i) const { return i < size() && tokens[i].is_word(); }
  bool is_joined(std::size_t i) const { return i < size() && tokens[i].joined; }
  bool is_sign(std::size_t i) const { return text(i) == "=" || text(i) == ":"; }
  bool is_open(std::size_t i) const {
    return text(i) == "(" || text(i) == "[" || text(i) == "<" || text(i) == "{";
  }
  /// The text from a token on, at most 40 characters.
  std::string excerpt(std::size_t i) const {
    return std::string(behind.substr(i < size() ? tokens[i].at : behind.size()).substr(0, 40));
  }
  std::string whole() const { return std::string(key) + std::string(behind.substr(0, 60)); }
};

std::vector<Token> tokens_of(std::string_view behind) {
  std::vector<Token> tokens;
  bool joined = true;
  for (std::size_t at = 0; at < behind.size();) {
    const char c = behind[at];
    if (c == ' ' || c == '\t' || c == '"' || c == '\'') {
      joined = joined && c != ' ' && c != '\t';
      ++at;
      continue;
    }
    std::size_t end = at + 1;
    if (is_name_letter(c))
      while (end < behind.size() && is_name_letter(behind[end])) ++end;
    tokens.push_back({behind.substr(at, end - at), at, joined});
    joined = true;
    at = end;
  }
  return tokens;
}

/// The end of a sentence, or of the last whole word in its first 200 characters. Statements are short, but a
/// text may be a file's whole first line.
std::size_t sentence_end(std::string_view text, std::size_t at) {
  constexpr std::size_t longest = 200;
  const std::size_t begin = at, most = std::min(text.size() - at, longest) + at;
  for (; at < most; ++at) {
    const char c = text[at];
    if (c == '\n' || c == '\r' || c == '\0' || c == ';') break;
    if (c == '.' && (at + 1 == text.size() || text[at + 1] == ' ')) break;
  }
  if (at == most && most < text.size())
    while (at > begin && is_name_letter(text[at - 1])) --at;
  return at;
}

/// The occurrences of a key that are whole words.
std::vector<Sentence> sentences_about(std::string_view text, std::string_view key) {
  std::vector<Sentence> found;
  const std::string folded = lower_case(text);
  for (std::size_t at = folded.find(key); at != std::string::npos; at = folded.find(key, at + 1)) {
    const std::size_t end = at + key.size();
    if ((at > 0 && is_name_letter(text[at - 1]) && text[at - 1] != '_') ||
        (end < text.size() && is_name_letter(text[end])))
      continue;
    Sentence made;
    made.key = text.substr(at, key.size());
    std::size_t word_end = at;
    while (word_end > 0 && (text[word_end - 1] == ' ' || text[word_end - 1] == '_')) --word_end;
    std::size_t begin = word_end;
    while (begin > 0 && is_name_letter(text[begin - 1]) && text[begin - 1] != '_') --begin;
    const bool is_digit = begin < word_end && std::isdigit(static_cast<unsigned char>(text[begin])) != 0;
    if (is_digit && begin > 0 && text[begin - 1] == '.') --begin;  // the number is 0.1, not 1
    made.before = folded.substr(begin, word_end - begin);
    made.is_name_end = at > 0 && text[at - 1] == '_';
    made.behind = text.substr(end, sentence_end(text, end) - end);
    made.tokens = tokens_of(made.behind);
    found.push_back(std::move(made));
  }
  return found;
}

/// Whether a unit is unambiguous: neither an English word nor a single letter.
bool is_plain_unit(std::string_view word) {
  const std::string folded = lower_case(word);
  return length_unit(word) && folded != "in" && folded != "m" && folded != "foot" && folded != "feet" &&
         folded != "mil";
}

/// Whether the token after a unit makes it part of another unit: m/s, mm^3, "mm squared", "m s-1".
bool is_compound(const Sentence& s, std::size_t unit) {
  const std::string_view next = s.text(unit + 1);
  if (next == "/" || next == "^" || next == "*") return true;
  if (next == "." && s.is_joined(unit + 1) && s.is_joined(unit + 2)) return true;
  static constexpr auto joining = std::to_array<std::string_view>({"per", "squared", "cubed", "times"});
  if (is_one_of(lower_case(next), joining)) return true;
  const std::size_t minus = next.rfind('-');
  return s.is_word(unit + 1) && minus != std::string_view::npos && minus + 2 == next.size() &&
         std::isdigit(static_cast<unsigned char>(next.back())) != 0;
}

/// Whether two different names are joined by words such as "to" or "or".
template <typename Meaning>
bool is_converted(const Sentence& s, std::size_t at, const Meaning& meaning) {
  const std::string joint = s.lower(at + 1);
  const bool is_arrow = s.text(at + 1) == ">" || (joint == "-" && s.text(at + 2) == ">");
  static constexpr auto joints = std::to_array<std::string_view>({"to", "or", "and", "into", "from", "not"});
  if (!is_arrow && !is_one_of(joint, joints)) return false;
  std::size_t next = at + 2;
  while (next < s.size() && !s.is_word(next)) ++next;
  const auto other = meaning(s.text(next));
  return other && *other != *meaning(s.text(at));
}

/// Whether the word is a number other than 1: "10 units = 1 mm" states a scale, not a unit.
bool is_number_but_one(std::string_view word) {
  return word != "1" && !word.empty() && word.find_first_not_of("0123456789.") == std::string_view::npos;
}

std::optional<std::string> unit_name(std::string_view word) {
  const std::optional<LengthUnit> unit = length_unit(word);
  return unit ? std::optional(unit->name) : std::nullopt;
}

/// Whether "in" after = or : means inch: after it, the sentence ends or another statement begins.
bool is_inch(const Sentence& s, std::size_t at) {
  std::size_t next = at + 1;
  while (next < s.size() && s.is_open(next)) ++next;
  if (const auto unit = unit_name(s.text(next)); unit && *unit != "inch") return false;
  if (!s.is_word(at + 1)) return true;
  return s.text(at + 2) == "=" || (s.lower(at + 1) == "space" && s.is_sign(at + 2));
}

/// Whether a single m without a sign means metre: only in lower case, after "units" (or after "unit" without
/// another word before it), and at the end of the sentence or of its part.
bool is_lone_metre(const Sentence& s, std::size_t at) {
  const bool in_capitals = s.key.front() == 'U' && s.key[1] == 'N';
  if (s.text(at) == "M" && !in_capitals) return false;
  if (s.is_word(at + 1) && !s.is_sign(at + 2)) return false;
  return s.key.size() == 5 || s.before.empty();
}

/// The first token at `from` or later that begins another statement with a known key.
std::size_t next_key(const Sentence& s, std::size_t from) {
  static constexpr auto keys =
      std::to_array<std::string_view>({"unit", "units", "space", "coordinate", "coordinatesystem"});
  while (from < s.size() && !is_one_of(s.lower(from), keys)) ++from;
  return from;
}

std::optional<TextStatement> unit_in(const Sentence& s) {
  static constexpr auto of_length = std::to_array<std::string_view>(
      {"length", "lengths", "distance", "distances", "coordinate", "coordinates", "linear"});
  static constexpr auto small = std::to_array<std::string_view>(
      {"is", "are", "the", "of", "for", "given", "measured", "stated", "expressed"});
  static constexpr auto owners =
      std::to_array<std::string_view>({"file", "mesh", "model", "scene", "world", "space", "system", "all"});
  if (is_other_quantity(s.before)) return std::nullopt;
  if (s.is_name_end && !is_one_of(s.before, of_length) && !is_one_of(s.before, owners)) return std::nullopt;
  if (s.text(0) == ",") {  // two cells of a table
    if (s.size() != 2 || !length_unit(s.text(1)) || s.lower(1) == "in") return std::nullopt;
    return TextStatement{TextStatement::Kind::Stated, std::string(s.text(1)), {}};
  }
  std::size_t at = 0;
  const bool is_equal = s.text(0) == "=";
  bool is_signed = s.is_sign(0) || s.is_open(0) || s.text(0) == ">";
  if (is_signed) ++at;
  bool is_verb = false, has_small = false;
  for (; at < s.size(); ++at) {
    const std::string word = s.lower(at);
    if (word == "in") {
      if (is_signed && !has_small && is_inch(s, at)) break;
    } else if (!is_one_of(word, small) && !is_one_of(word, of_length) && !(has_small && s.is_open(at))) {
      break;
    }
    is_verb = is_verb || word == "is" || word == "are";
    has_small = true;
    // "units in use: mm", "unit of length: mm"
    if (!is_signed && s.is_sign(at + 1) && is_one_of(word, of_length)) is_signed = true, ++at;
  }
  if (is_equal && s.text(at) == "1" && length_unit(s.text(at + 1))) ++at;  // 1 unit = 1 cm
  if (at >= s.size())
    return has_small ? std::optional(TextStatement{TextStatement::Kind::Unclear, s.whole(), {}})
                     : std::nullopt;
  if (is_other_quantity(s.lower(at))) return std::nullopt;
  if (length_unit(s.text(at))) {
    if (is_compound(s, at)) return TextStatement{TextStatement::Kind::Unknown, s.excerpt(at), {}};
    if ((is_signed && is_number_but_one(s.before)) || is_converted(s, at, unit_name))
      return TextStatement{TextStatement::Kind::Unclear, s.whole(), {}};
    if (is_signed || has_small || is_plain_unit(s.text(at)))
      return TextStatement{TextStatement::Kind::Stated, std::string(s.text(at)), {}};
    if (s.lower(at) != "m") return std::nullopt;
    if (is_lone_metre(s, at)) return TextStatement{TextStatement::Kind::Stated, std::string(s.text(at)), {}};
    return s.text(at) == "m" ? std::optional(TextStatement{TextStatement::Kind::Unclear, s.whole(), {}})
                             : std::nullopt;
  }
  if (is_signed || is_verb) return TextStatement{TextStatement::Kind::Unknown, s.excerpt(at), {}};
  for (std::size_t i = at, end = next_key(s, at); i < end; ++i)
    if (is_plain_unit(s.text(i))) return TextStatement{TextStatement::Kind::Unclear, s.whole(), {}};
  return std::nullopt;
}

/// Whether a word can only be a frame: capitals that are not an English word, the two usual frames, or words
/// joined by hyphens.
bool is_sure_frame(std::string_view word) {
  static constexpr auto english =
      std::to_array<std::string_view>({"AIR", "LIP", "LAP", "RIP", "SAP", "SPA", "RAP", "PAL", "AIL"});
  if (!frame_named(word)) return false;
  const std::string folded = lower_case(word);
  if (folded == "lps" || folded == "ras" || word.find('-') != std::string_view::npos) return true;
  return folded != word && std::none_of(word.begin(), word.end(), [](char c) { return c >= 'a'; }) &&
         !is_one_of(word, english);
}

std::optional<TextStatement> frame_in(const Sentence& s) {
  static constexpr auto small = std::to_array<std::string_view>({"is", "are", "in", "the", "used", "of"});
  if (s.is_name_end) return std::nullopt;  // "color_space"
  const bool is_equal = s.text(0) == "=";
  std::size_t at = s.is_sign(0) || s.is_open(0) ? 1 : 0;
  while (!is_equal && at < s.size() && is_one_of(s.lower(at), small)) ++at;
  const std::string_view word = s.text(at);
  if (is_equal) {
    if (word.empty()) return std::nullopt;
    return TextStatement{frame_named(word) ? TextStatement::Kind::Stated : TextStatement::Kind::Unknown,
                         std::string(word),
                         {}};
  }
  if (is_sure_frame(word))
    return is_converted(s, at, frame_named)
               ? TextStatement{TextStatement::Kind::Unclear, s.whole(), {}}
               : TextStatement{TextStatement::Kind::Stated, std::string(word), {}};
  if (s.is_sign(0) && frame_named(word)) return TextStatement{TextStatement::Kind::Unclear, s.whole(), {}};
  for (std::size_t i = at, end = next_key(s, at); i < end; ++i)
    if (is_sure_frame(s.text(i))) return TextStatement{TextStatement::Kind::Unclear, s.whole(), {}};
  return std::nullopt;
}

template <typename Read>
void read_all(std::string_view text, std::string_view key, const Read& read,
              std::vector<TextStatement>& found) {
  for (const Sentence& sentence : sentences_about(text, key))
    if (std::optional<TextStatement> statement = read(sentence)) {
      statement->key = key;
      found.push_back(std::move(*statement));
    }
}

}  // namespace

std::vector<TextStatement> stated_units(std::string_view text) {
  std::vector<TextStatement> found;
  for (const std::string_view key : {"unit", "units"}) read_all(text, key, unit_in, found);
  return found;
}

std::vector<TextStatement> stated_frames(std::string_view text) {
  std::vector<TextStatement> found;
  for (const std::string_view key : {"space", "coordinate system", "coordinatesystem"})
    read_all(text, key, frame_in, found);
  return found;
}

}  // namespace octotomy::brep

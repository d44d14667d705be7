// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 cut each name into numbers and the text between them; 2 for names with equal text, collect the signs and
// the digits after the dot at each number; 3 decide for each number the meaning of its minus and its dot; 4
// sort.
#include "voxel/picture/slice_names.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

bool is_digit_at(const std::string& text, std::size_t at) {
  return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0;
}

/// Whether a byte is a letter. Every byte beyond ASCII counts as one.
bool is_letter_or_digit(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return std::isalnum(byte) != 0 || byte >= 0x80;
}

struct NumberInName {
  char sign = '\0';             ///< the sign as written: '-', '+' or '\0' for none
  bool is_behind_word = false;  ///< whether the sign follows a letter
  std::string whole, fraction;  ///< digits before and after the dot; `whole` without leading zeros
  bool is_negative = false, is_decimal = true;
};

struct CutName {
  std::string text;  ///< the name with '\1' in place of each number and its sign
  std::vector<std::string> between;
  std::vector<NumberInName> numbers;
};

CutName cut(const std::string& name) {
  CutName made;
  std::string text;
  const auto end_text = [&] {
    made.text += text;
    made.between.push_back(std::exchange(text, {}));
  };
  for (std::size_t at = 0; at < name.size();) {
    const bool is_sign = (name[at] == '-' || name[at] == '+') && is_digit_at(name, at + 1) &&
                         !(at > 0 && is_digit_at(name, at - 1));
    if (!is_sign && !is_digit_at(name, at)) {
      text += name[at++];
      continue;
    }
    NumberInName number;
    if (is_sign) {
      number.sign = name[at];
      number.is_behind_word = at > 0 && is_letter_or_digit(name[at - 1]);
      ++at;
    }
    const bool is_chained = at > 1 && name[at - 1] == '.' && is_digit_at(name, at - 2);
    const auto digits = [&] {
      const std::size_t begin = at;
      while (is_digit_at(name, at)) ++at;
      return name.substr(begin, at - begin);
    };
    number.whole = digits();
    number.whole.erase(0, number.whole.find_first_not_of('0'));
    if (!is_chained && at < name.size() && name[at] == '.' && is_digit_at(name, at + 1)) {
      const std::size_t dot = at++;
      number.fraction = digits();
      // Two dots, as in 1.2.840, separate numbers: this text is read as three numbers.
      if (at < name.size() && name[at] == '.' && is_digit_at(name, at + 1)) {
        number.fraction.clear();
        at = dot;
      }
    }
    end_text();
    made.text += '\1';
    made.numbers.push_back(std::move(number));
  }
  end_text();
  return made;
}

/// Properties of the numbers at one position, over all names with equal text.
struct NumberProperties {
  bool has_minus = false, has_other = false, is_behind_word = false;
  /// Least and largest number of digits after a dot, among numbers with a dot.
  std::size_t least_digits = 0, most_digits = 0;
  /// Whether a number has several digits after a dot and ends with 0.
  bool ends_with_zero = false;

  void add(const NumberInName& number) {
    (number.sign == '-' ? has_minus : has_other) = true;
    is_behind_word = is_behind_word || (number.sign == '-' && number.is_behind_word);
    const std::size_t digits = number.fraction.size();
    if (digits == 0) return;
    least_digits = least_digits == 0 ? digits : std::min(least_digits, digits);
    most_digits = std::max(most_digits, digits);
    ends_with_zero = ends_with_zero || (digits > 1 && number.fraction.back() == '0');
  }
  bool is_sign() const { return has_minus && (!is_behind_word || has_other); }
  bool is_decimal() const { return least_digits == most_digits || !ends_with_zero; }
};

int order_of_digits(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

int order_of(const NumberInName& a, const NumberInName& b) {
  const auto is_zero = [](const NumberInName& n) {
    return n.whole.empty() && n.fraction.find_first_not_of('0') == std::string::npos;
  };
  const bool is_below = a.is_negative && !is_zero(a), is_other_below = b.is_negative && !is_zero(b);
  if (is_below != is_other_below) return is_below ? -1 : 1;
  const auto trimmed_zeros = [](const std::string& digits, bool at_end) {
    return at_end ? digits.substr(0, digits.find_last_not_of('0') + 1)
                  : digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
  };
  int order = order_of_digits(a.whole, b.whole);
  if (order == 0 && a.is_decimal)
    order = trimmed_zeros(a.fraction, true).compare(trimmed_zeros(b.fraction, true));
  else if (order == 0)
    order = order_of_digits(trimmed_zeros(a.fraction, false), trimmed_zeros(b.fraction, false));
  return is_below ? -order : order;
}

bool comes_before(const CutName& a, const CutName& b) {
  for (std::size_t i = 0; i < std::min(a.between.size(), b.between.size()); ++i) {
    if (const int order = a.between[i].compare(b.between[i]); order != 0) return order < 0;
    const bool has = i < a.numbers.size(), other_has = i < b.numbers.size();
    if (has != other_has) return other_has;
    if (!has) return false;
    if (const int order = order_of(a.numbers[i], b.numbers[i]); order != 0) return order < 0;
  }
  return false;
}

std::optional<double> last_number(const CutName& name) {
  if (name.numbers.empty()) return std::nullopt;
  const NumberInName& last = name.numbers.back();
  const std::string& digits = last.is_decimal || last.fraction.empty() ? last.whole : last.fraction;
  if (digits.size() > 9) return std::nullopt;
  const std::string text = last.is_decimal ? "0" + last.whole + "." + last.fraction + "0" : "0" + digits;
  const double number = std::strtod(text.c_str(), nullptr);
  return last.is_negative ? -number : number;
}

}  // namespace

SliceNames ordered_by_name(const std::vector<fs::path>& files) {
  std::vector<CutName> names;
  std::map<std::pair<std::string, std::size_t>, NumberProperties> places;
  for (const fs::path& file : files) {
    names.push_back(cut(file.stem().string()));
    for (std::size_t i = 0; i < names.back().numbers.size(); ++i)
      places[{names.back().text, i}].add(names.back().numbers[i]);
  }
  for (CutName& name : names)
    for (std::size_t i = 0; i < name.numbers.size(); ++i) {
      const NumberProperties& place = places[{name.text, i}];
      name.numbers[i].is_negative = name.numbers[i].sign == '-' && place.is_sign();
      name.numbers[i].is_decimal = place.is_decimal();
    }
  std::vector<std::size_t> order(files.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (comes_before(names[a], names[b])) return true;
    if (comes_before(names[b], names[a])) return false;
    return files[a].filename().string() < files[b].filename().string();
  });

  SliceNames made;
  for (const std::size_t i : order) {
    made.files.push_back(files[i]);
    made.number.push_back(last_number(names[i]));
  }
  if (files.size() < 2) return made;
  const auto doubt = [&](bool holds, const char* words) {
    if (holds) made.doubts.emplace_back(words);
  };
  const auto any = [&](const auto& is) {
    return std::any_of(places.begin(), places.end(), [&](const auto& entry) { return is(entry.second); });
  };
  doubt(any([](const NumberProperties& p) { return p.is_sign() && !p.has_other; }),
        "each name has a minus before its number, which is taken as the number's sign: if it is only a "
        "separator, the stack is upside down; rename the files");
  doubt(any([](const NumberProperties& p) { return p.is_sign() && p.has_other && p.is_behind_word; }),
        "a minus after a letter is taken as the number's sign, because other names lack it there: if it is "
        "only a separator, the slices are out of order; rename the files");
  doubt(any([](const NumberProperties& p) { return p.least_digits != p.most_digits && p.is_decimal(); }),
        "a dot in numbers is taken as the decimal point, so that 1.25 comes before 1.5: if it separates two "
        "numbers, the slices are out of order; rename the files");
  return made;
}

namespace {

/// A file's name with # in place of each number and its sign, and its numbers without leading zeros.
struct NumberedName {
  std::string pattern, numbers;
};
NumberedName numbered_name(const fs::path& file) {
  NumberedName made;
  const std::string name = file.filename().string();
  const fs::path stem = file.stem();
  for (std::size_t at = 0; at < name.size();) {
    if (at >= stem.string().size() || !is_digit_at(name, at)) {
      made.pattern += name[at++];
      continue;
    }
    std::size_t end = at;
    while (is_digit_at(name, end)) ++end;
    while (at + 1 < end && name[at] == '0') ++at;
    if (!made.pattern.empty() && (made.pattern.back() == '-' || made.pattern.back() == '+')) {
      made.numbers += made.pattern.back();
      made.pattern.pop_back();
    }
    made.pattern += '#';
    made.numbers += name.substr(at, end - at) + ' ';
    at = end;
  }
  return made;
}

}  // namespace

std::string stacks_named(const std::vector<fs::path>& files) {
  std::map<std::string, std::set<std::string>> patterns_of;  // by numbers
  std::map<std::string, std::size_t> count_of;               // by pattern
  for (const fs::path& file : files) {
    const NumberedName name = numbered_name(file);
    if (!name.numbers.empty()) patterns_of[name.numbers].insert(name.pattern);
    ++count_of[name.pattern];
  }
  std::set<std::string> doubled;
  for (const auto& [numbers, patterns] : patterns_of)
    if (patterns.size() > 1) doubled.insert(patterns.begin(), patterns.end());
  std::string text;
  std::size_t named = 0;
  constexpr std::size_t most_named = 3;
  for (const std::string& pattern : doubled) {
    if (++named > most_named) return text + " and " + std::to_string(doubled.size() - most_named) + " more";
    const std::size_t count = count_of[pattern];
    text += (named == 1                ? ""
             : named == doubled.size() ? " and "
                                       : ", ") +
            pattern + " (" + std::to_string(count) + (count == 1 ? " file)" : " files)");
  }
  return text;
}

std::string numbered_alike(const SliceNames& names) {
  // The names' numbers, by the text before the last number.
  std::map<std::string, std::set<double>> numbers_of;
  for (std::size_t i = 0; i < names.files.size(); ++i) {
    const std::string stem = names.files[i].stem().string();
    const std::size_t last = stem.find_last_of("0123456789");
    const std::size_t before = last == std::string::npos ? last : stem.find_last_not_of("0123456789", last);
    if (names.number[i] && before != std::string::npos)
      numbers_of[stem.substr(0, before + 1)].insert(*names.number[i]);
  }
  const std::set<double>* first = nullptr;
  std::string first_name;
  for (const auto& [name, numbers] : numbers_of) {
    const auto is_first_too = [&](double number) { return first->contains(number); };
    if (numbers.size() < 2) continue;
    if (first == nullptr) {
      first = &numbers;
      first_name = name;
    } else if (std::count_if(numbers.begin(), numbers.end(), is_first_too) > 1) {
      return "names that begin with '" + first_name + "' and with '" + name +
             "' have the same last numbers, and their pictures are read as slices of one stack: if they "
             "belong to several stacks, put each stack into its own folder";
    }
  }
  return {};
}

}  // namespace octotomy::voxel

// Order of names by the values of the numbers in them.
#include "common/natural_order.hpp"

#include <algorithm>
#include <cstddef>

namespace cartvo {
namespace {

bool isDigit(char character) {
  return character >= '0' && character <= '9';
}

/// Removes the digits at the beginning of `text`, and returns them without leading zeros.
std::string_view takeNumber(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string_view digits = text.substr(0, end);
  text.remove_prefix(end);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

/// Negative, zero or positive, as the first number is smaller, equal or larger. Both are without leading
/// zeros.
int compareNumbers(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

/// The digits after the point of a name that is one decimal number; nothing if it is not one.
std::string_view fractionOf(std::string_view name) {
  const std::size_t point = name.find('.');
  if (point == std::string_view::npos || point == 0) return {};
  const auto all_digits = [](std::string_view text) {
    return std::all_of(text.begin(), text.end(), isDigit);
  };
  const std::string_view fraction = name.substr(point + 1);
  return all_digits(name.substr(0, point)) && all_digits(fraction) ? fraction : std::string_view();
}

int compareNames(std::string_view a, std::string_view b) {
  const std::string_view fraction_a = fractionOf(a), fraction_b = fractionOf(b);
  if (!fraction_a.empty() && !fraction_b.empty()) {
    const int whole = compareNumbers(takeNumber(a), takeNumber(b));
    return whole != 0 ? whole : fraction_a.compare(fraction_b);
  }
  while (!a.empty() && !b.empty()) {
    if (isDigit(a.front()) && isDigit(b.front())) {
      const int order = compareNumbers(takeNumber(a), takeNumber(b));
      if (order != 0) return order;
    } else if (a.front() != b.front()) {
      return static_cast<unsigned char>(a.front()) < static_cast<unsigned char>(b.front()) ? -1 : 1;
    } else {
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return static_cast<int>(b.empty()) - static_cast<int>(a.empty());
}

}  // namespace

bool NaturalOrder::operator()(std::string_view a, std::string_view b) const {
  const int order = compareNames(a, b);
  return order != 0 ? order < 0 : a < b;
}

std::string withoutLeadingZeros(std::string_view name) {
  std::string result;
  while (!name.empty()) {
    if (isDigit(name.front())) {
      const std::string_view number = takeNumber(name);
      result += number.empty() ? "0" : number;
    } else {
      result += name.front();
      name.remove_prefix(1);
    }
  }
  return result;
}

}  // namespace cartvo

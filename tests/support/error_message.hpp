#pragma once

#include <exception>
#include <string>

namespace cartvo::test {

/// The message of the exception that a call throws; empty if it throws none.
template <typename Call>
std::string messageOf(Call call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

}  // namespace cartvo::test

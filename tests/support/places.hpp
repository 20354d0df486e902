#pragma once

#include <filesystem>

namespace cartvo::test {

/// The root of the checkout that the tests were built from.
std::filesystem::path sourceFolder();

/// The program `cartvo` of the same build.
std::filesystem::path cartvoProgram();

}  // namespace cartvo::test

#pragma once

#include <filesystem>

namespace cartvo::test {

/// The root folder of the checkout that the tests were built from.
std::filesystem::path sourceFolder();

/// The path of the program `cartvo` of the same build.
std::filesystem::path cartvoProgram();

}  // namespace cartvo::test

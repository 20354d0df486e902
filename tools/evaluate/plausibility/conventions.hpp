#pragma once

#include <string>

#include "tools/evaluate/evaluation.hpp"

namespace cartvo {

/// Says that a file's poses are of another convention than they were read in (quaternions with w first,
/// inverse poses), or that the axes of the two files are turned, if short segments then agree much better.
/// Empty otherwise.
std::string conventionProblem(const AssociatedTrajectories& associated, const Evaluation& evaluation);

}  // namespace cartvo

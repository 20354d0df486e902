#pragma once

// Classes of CLI11 for headers that only name them: CLI11 takes seconds to compile in each source.

namespace CLI {
class App;
class Error;
class Option;
}  // namespace CLI

#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace cartvo::world {

/// Calls work(i) for each i in [0, count) on `threads` threads and returns when all calls have ended.
template <typename Work>
void parallelFor(int count, int threads, const Work& work) {
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int i = next++; i < count; i = next++)
      work(i);
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < threads; ++i)
    helpers.emplace_back(run);
  run();
}

}  // namespace cartvo::world

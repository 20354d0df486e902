#pragma once

#include <cstddef>
#include <vector>

#include "capture/dataset/image_folder.hpp"

namespace cartvo::benchmark {

using Indices = std::vector<std::size_t>;

/// The items at these indices; indices beyond the end are left out.
template <typename Item>
std::vector<Item> chosen(const std::vector<Item>& items, const Indices& indices) {
  std::vector<Item> result;
  for (const std::size_t i : indices)
    if (i < items.size()) result.push_back(items[i]);
  return result;
}

/// The sequence with only the images at these indices.
inline capture::ImageSequence chosen(capture::ImageSequence sequence, const Indices& indices) {
  sequence.images = chosen(sequence.images, indices);
  sequence.instants_ns = chosen(sequence.instants_ns, indices);
  return sequence;
}

}  // namespace cartvo::benchmark

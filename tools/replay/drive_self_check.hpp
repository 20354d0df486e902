#pragma once

#include <string>
#include <vector>

namespace cartvo {

/// The self-check in the course of a drive: each fault with its last numbers and when it showed.
class DriveSelfCheck {
 public:
  /// Adds SelfCheck::message() after a pair, `seconds` after the first one.
  void add(const std::string& message, double seconds);
  /// The faults that lasted, the longest first, with their times unless they last to the end; empty if none.
  std::string sentence() const;

 private:
  struct Fault {
    std::string kind;  ///< the message without its numbers
    std::string message;
    double first, last;
    double lasted = 0.0;  ///< s
  };
  std::vector<Fault> faults_;
  double end_ = 0.0;
};

}  // namespace cartvo

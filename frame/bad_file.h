// The error for a file whose content is wrong.
#pragma once

#include <stdexcept>

namespace eigenlight {

/// A file that can be read but is not what it must be, so that a second try will not help. The
/// message names the file, what was wrong and what was expected.
class BadFile : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace eigenlight

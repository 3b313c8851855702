/// \file
/// Numbers as text for messages.
#pragma once

#include <sstream>
#include <string>

namespace floe {

/// Returns a number with six significant digits.
inline std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace floe

/// \file
/// Numbers in messages.
#pragma once

#include <sstream>
#include <string>

namespace floe {

/// A number as messages show it.
inline std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace floe

/// \file
/// Counts and sizes as text for messages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>

namespace floe::amounts {

/// Formats as printf does, at most 399 characters.
inline std::string text(const char* format, auto... values) {
  std::array<char, 400> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

/// Formats a count with all digits as far as these are useful.
inline std::string count(double value) { return text(value < 1e9 ? "%.0f" : "%.4g", value); }

/// Formats a size in kB to TB. \param value  [B]
inline std::string bytes(double value) {
  constexpr std::array units{"kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  for (value /= 1e3; value >= 1e3 && unit + 1 < units.size(); ++unit) value /= 1e3;
  return text("%.3g %s", value, units[unit]);
}

}  // namespace floe::amounts

/// \file
/// Numbers that are compared with a reference: expected by GoogleTest and, where FLOE_RECORD names
/// a folder, appended to the test's own file there as one JSON line each, from which
/// tools/verification_page makes docs/verification.md.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

namespace floe::test {

/// Whether the long form was asked for: every number, several meshes each.
inline bool full_form() {
  const char* full = std::getenv("FLOE_FULL");
  return full != nullptr && *full != '\0' && *full != '0';
}

/// Formatted as by printf.
std::string text(const char* format, auto... values) {
  char line[200];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

/// One number of the verification.
struct Checked {
  std::string section, quantity;
  double value = 0;
  std::optional<double> reference = {};
  std::optional<double> tolerance = {};  ///< without one the number is reported only
  std::string unit = {}, note = {};
};

/// Appends it to SUITE.TEST.jsonl in the folder that FLOE_RECORD names, if any.
void record(const Checked& c, bool pass);

/// Records a number and expects it to lie within its tolerance of the reference.
inline void verify(const Checked& c) {
  const bool pass = std::abs(c.value - c.reference.value()) <= c.tolerance.value();
  record(c, pass);
  EXPECT_TRUE(pass) << c.section << ": " << c.quantity << ": " << c.value << ", expected "
                    << *c.reference << " +- " << *c.tolerance << " " << c.unit << " " << c.note;
}

/// Records a number that nothing is compared with.
inline void report(const Checked& c) { record(c, true); }

}  // namespace floe::test

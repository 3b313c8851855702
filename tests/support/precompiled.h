/// \file
/// What nearly every test includes, compiled once for all of them.
#pragma once

#include <gtest/gtest.h>
#include <petsc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <Eigen/Dense>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <ostream>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "floe/base/rotation.h"

namespace floe {

/// What a failed comparison of vectors shows.
inline void PrintTo(const Vec3<double>& v, std::ostream* out) {
  *out << "(" << v.x << ", " << v.y << ", " << v.z << ")";
}

}  // namespace floe

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
#include <random>
#include <span>
#include <string>
#include <vector>

/// \file
/// Numbers of many bodies or beams, number by number: neighbouring threads read what lies side by
/// side.
#pragma once

#include <cstdint>

#include "floe/base/rotation.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

template <class T>
struct SoaOf {
  T* numbers;         ///< null: none
  std::int64_t size;  ///< of bodies or beams

  constexpr T& at(int number, std::int64_t of) const { return numbers[number * size + of]; }
  constexpr Vec3<T> vector(int number, std::int64_t of) const {
    return {at(number, of), at(number + 1, of), at(number + 2, of)};
  }
  constexpr Quat<T> quaternion(int number, std::int64_t of) const {
    return {at(number, of), at(number + 1, of), at(number + 2, of), at(number + 3, of)};
  }
};
using Soa = SoaOf<double>;

}  // namespace
}  // namespace floe::device

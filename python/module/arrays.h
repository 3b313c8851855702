/// \file
/// Vectors of the library as numpy arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "floe/base/rotation.h"

namespace floe::python {

namespace py = pybind11;

/// The numbers in an entry of a vector.
template <class T>
struct Entry {
  using Number = T;
  static constexpr py::ssize_t width = 1;
};
template <>
struct Entry<Vec3<double>> {
  using Number = double;
  static constexpr py::ssize_t width = 3;
};
template <>
struct Entry<Quat<double>> {
  using Number = double;
  static constexpr py::ssize_t width = 4;
};
template <class T, std::size_t n>
struct Entry<std::array<T, n>> {
  using Number = T;
  static constexpr py::ssize_t width = n;
};

/// An array on the memory of a vector, (n,) or (n, width). \param owner  keeps that memory
template <class T>
py::array view(const std::vector<T>& values, const py::handle& owner, bool writable = false) {
  using Number = typename Entry<T>::Number;
  constexpr py::ssize_t width = Entry<T>::width, bytes = sizeof(Number);
  static_assert(sizeof(T) == width * sizeof(Number));
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(values.size())}, strides{width * bytes};
  if (width > 1) shape.push_back(width), strides.push_back(bytes);
  py::array array(py::dtype::of<Number>(), std::move(shape), std::move(strides),
                  reinterpret_cast<const Number*>(values.data()), owner);
  if (!writable)
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// An array that takes a vector over, without a copy.
template <class T>
py::array array_of(std::vector<T>&& values) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  const std::vector<T>& vector = *kept;
  const py::capsule owner(kept.release(),
                          [](void* memory) { delete static_cast<std::vector<T>*>(memory); });
  return view(vector, owner, true);
}

inline py::array array_of(const Vec3<double>& v) {
  return array_of(std::vector<double>{v.x, v.y, v.z});
}
inline py::array array_of(const Quat<double>& q) {
  return array_of(std::vector<double>{q.w, q.x, q.y, q.z});
}

}  // namespace floe::python

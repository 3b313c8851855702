/// \file
/// What engines take and give, as bytes for another process of this machine.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "device/engine.h"

namespace floe::device {

template <class T, class U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

// visit_fields(of, visit) calls visit for each field. One that is added to a struct must be added
// here: until then the number of names below is an error of the compiler.
void visit_fields(Is<Water> auto& of, auto&& visit) {
  auto& [weight_density, linear, coefficient, drags, level_moves, by_points, pace, prisms, wholes,
         extents, most2, area_per_volume, first_vertex, first_face, first_corner, corners,
         vertices] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(weight_density, linear, coefficient, drags, level_moves, by_points, pace, prisms, wholes,
       extents, most2, area_per_volume, first_vertex, first_face, first_corner, corners, vertices);
}
void visit_fields(Is<Breaking> auto& of, auto&& visit) {
  auto& [general, crushes, beams, limits] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(general, crushes, beams, limits);
}
void visit_fields(Is<Damage> auto& of, auto&& visit) {
  auto& [cracks, viscous] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(cracks, viscous);
}
void visit_fields(Is<Listing> auto& of, auto&& visit) {
  auto& [reach, young, young_broken, friction, friction_wet, sizes, widths, frictions, ranks,
         beams] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(reach, young, young_broken, friction, friction_wet, sizes, widths, frictions, ranks, beams);
}
void visit_fields(Is<Eligible> auto& of, auto&& visit) {
  auto& [pieces, states, broken] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(pieces, states, broken);
}
void visit_fields(Is<Contacts> auto& of, auto&& visit) {
  auto& [potential, with_patch, wears, damping_ratio, plastic_limit, periods, slack, obstacles,
         first_vertex, first_plane, vertices, planes, graph, graphs, radius, carriers, inverse,
         rest, listing] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(potential, with_patch, wears, damping_ratio, plastic_limit, periods, slack, obstacles,
       first_vertex, first_plane, vertices, planes, graph, graphs, radius, carriers, inverse, rest,
       listing);
}
void visit_fields(Is<Pairs> auto& of, auto&& visit) {
  auto& [solids, numbers, histories, states, crushes, eligible] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(solids, numbers, histories, states, crushes, eligible);
}
void visit_fields(Is<Lattice> auto& of, auto&& visit) {
  auto& [bodies, constants, weights, ends, beams, damped, flat, eccentric, held, motions, loaded,
         loads, supports, water, breaking, halts_at_breaks, contacts] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(bodies, constants, weights, ends, beams, damped, flat, eccentric, held, motions, loaded,
       loads, supports, water, breaking, halts_at_breaks, contacts);
}
void visit_fields(Is<Steps> auto& of, auto&& visit) {
  auto& [count, dt, before, motions, wrenches, water, times, accelerations, obstacles, since] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(count, dt, before, motions, wrenches, water, times, accelerations, obstacles, since);
}
void visit_fields(Is<Works> auto& of, auto&& visit) {
  auto& [beams, held, loaded, supports, drag, buoyancy, contacts, obstacles] = of;
  const auto each = [&](auto&... fields) { (visit(fields), ...); };
  each(beams, held, loaded, supports, drag, buoyancy, contacts, obstacles);
}

/// What is copied byte by byte: numbers, arrays of them, structs of numbers alone.
template <class T>
concept Plain = std::is_trivially_copyable_v<T> && !requires(const T& of) {
  of.subspan(0);
};

using Bytes = std::vector<std::byte>;

/// Appends values to bytes.
class Writer {
 public:
  template <class T>
  void operator()(std::span<const T> values) {
    list(values);
  }
  template <class T>
  void operator()(const std::vector<T>& values) {
    list(std::span<const T>(values));
  }
  template <class T>
  void operator()(const std::optional<T>& value) {
    (*this)(value.has_value());
    if (value) (*this)(*value);
  }
  template <class T>
  void operator()(const T& value) {
    if constexpr (Plain<T>) {
      append(&value, sizeof(T));
    } else {
      visit_fields(value, *this);
    }
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  template <class T>
  void list(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    (*this)(static_cast<std::uint64_t>(values.size()));
    append(values.data(), values.size_bytes());
  }
  void append(const void* from, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(from);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  Bytes bytes_;
};

/// Reads them again, in the same order. \throws Failed where there are too few
class Reader {
 public:
  explicit Reader(Bytes bytes) : bytes_(std::move(bytes)) {}

  template <class T>
  void operator()(std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto size = get<std::uint64_t>();
    if (size > (bytes_.size() - at_) / sizeof(T)) refuse();
    values.resize(size);
    take(values.data(), size * sizeof(T));
  }
  template <class T>
  void operator()(std::optional<T>& value) {
    value.reset();
    if (get<bool>()) (*this)(value.emplace());
  }
  template <class T>
  void operator()(T& value) {
    if constexpr (Plain<T>) {
      take(&value, sizeof(T));
    } else {
      visit_fields(value, *this);
    }
  }
  template <class T>
  T get() {
    T value{};
    (*this)(value);
    return value;
  }

 private:
  [[noreturn]] static void refuse() { throw Failed("a message between processes is cut short"); }
  void take(void* to, std::size_t size) {
    if (size > bytes_.size() - at_) refuse();
    if (size > 0) std::memcpy(to, &bytes_[at_], size);
    at_ += size;
  }
  Bytes bytes_;
  std::size_t at_ = 0;
};

/// Returns a text that two lattices share only if an engine makes their steps by the same
/// operations: the same flags, and numbers for the same things.
class Kind {
 public:
  static std::string of(const Lattice& lattice) {
    Kind kind;
    visit_fields(lattice, kind);
    return kind.text_;
  }

  template <class T>
  void operator()(const std::vector<T>& values) {
    add(!values.empty());
  }
  template <class T>
  void operator()(const std::optional<T>& value) {
    add(value.has_value());
    if (value) visit_fields(*value, *this);
  }
  void operator()(bool value) { add(value); }
  void operator()(double /*number*/) {}
  void operator()(std::int32_t /*number*/) {}
  template <std::size_t size>
  void operator()(const std::array<double, size>& /*numbers*/) {}

 private:
  void add(bool yes) { text_ += yes ? '1' : '0'; }
  std::string text_;
};

}  // namespace floe::device

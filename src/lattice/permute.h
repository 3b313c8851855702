/// \file
/// Selection and renumbering of the entries of a lattice's arrays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "floe/base/item.h"
#include "floe/lattice/lattice.h"

namespace floe {

/// Return values[order[0]], values[order[1]], ...; an empty optional array stays empty.
template <class T>
std::vector<T> pick(const std::vector<T>& values, std::span<const std::int32_t> order) {
  std::vector<T> picked;
  if (values.empty()) return picked;
  picked.reserve(order.size());
  for (const std::int32_t k : order) picked.push_back(item(values, k));
  return picked;
}

inline Bodies pick(const Bodies& b, std::span<const std::int32_t> order) {
  return {pick(b.position, order), pick(b.orientation, order), pick(b.mass, order),
          pick(b.inertia, order),  pick(b.velocity, order),    pick(b.angular_velocity, order),
          pick(b.dry, order)};
}

inline Beams pick(const Beams& b, std::span<const std::int32_t> order) {
  return {pick(b.bodies, order),         pick(b.area, order),          pick(b.inertia_y, order),
          pick(b.inertia_z, order),      pick(b.torsion, order),       pick(b.length, order),
          pick(b.young, order),          pick(b.shear_modulus, order), pick(b.shear_factor, order),
          pick(b.shear_factor_y, order), pick(b.axis_y, order),        pick(b.width, order),
          pick(b.height, order),         pick(b.offsets, order),       pick(b.image, order),
          pick(b.strength, order),       pick(b.energy, order)};
}

/// Reorder in place, array by array: each old array is freed before the next is copied. The
/// structured bindings name every member, so that none is forgotten.
inline void permute(Bodies& b, std::span<const std::int32_t> order) {
  const auto each = [&](auto&... arrays) { ((arrays = pick(arrays, order)), ...); };
  auto& [position, orientation, mass, inertia, velocity, spin, dry] = b;
  each(position, orientation, mass, inertia, velocity, spin, dry);
}
inline void permute(Beams& b, std::span<const std::int32_t> order) {
  const auto each = [&](auto&... arrays) { ((arrays = pick(arrays, order)), ...); };
  auto& [bodies, area, iy, iz, torsion, length, young, shear, factor, factor_y, axis, width, height,
         offsets, image, strength, energy] = b;
  each(bodies, area, iy, iz, torsion, length, young, shear, factor, factor_y, axis, width, height,
       offsets, image, strength, energy);
}

inline Shapes pick(const Shapes& s, std::span<const std::int32_t> order) {
  Shapes out;
  if (s.empty()) return out;
  if (order.size() + 1 == s.vertex_of.size()) {  // all bodies: the sizes stay
    out.vertices.reserve(s.vertices.size());
    out.corners.reserve(s.corners.size());
    out.corner_of.reserve(s.corner_of.size());
  }
  for (const std::int32_t body : order) {
    const auto b = static_cast<std::size_t>(body);
    const std::int32_t shift = static_cast<std::int32_t>(out.vertices.size()) - s.vertex_of[b];
    out.vertices.insert(out.vertices.end(), s.vertices.begin() + s.vertex_of[b],
                        s.vertices.begin() + s.vertex_of[b + 1]);
    out.vertex_of.push_back(static_cast<std::int32_t>(out.vertices.size()));
    for (std::int32_t f = s.face_of[b]; f < s.face_of[b + 1]; ++f) {
      const auto face = static_cast<std::size_t>(f);
      for (std::int32_t c = s.corner_of[face]; c < s.corner_of[face + 1]; ++c)
        out.corners.push_back(item(s.corners, c) + shift);
      out.corner_of.push_back(static_cast<std::int32_t>(out.corners.size()));
    }
    out.face_of.push_back(static_cast<std::int32_t>(out.corner_of.size()) - 1);
  }
  return out;
}

}  // namespace floe

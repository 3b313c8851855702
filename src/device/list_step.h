/// \file
/// The list of the pairs of a run that may touch, made on an engine (model.md, "Contact"). It has
/// the pairs of src/contact/pair_list.h, and those that only an axis between edges separates: no
/// result depends on such pairs. Who may touch (Eligibility) is the processor's, since it changes
/// only where beams break.
#pragma once

#include <cmath>
#include <cstdint>

#include "contact_laws/response.h"
#include "device/contact_step.h"
#include "device/engine.h"
#include "device/launch.h"
#include "device/soa.h"
#include "forces/device_contacts.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// Calls work(k) for the first `number` numbers, a thread for each.
template <class Work>
struct Each {
  Work work;
  std::int32_t number;

  FLOE_KERNEL std::int32_t beams(std::int32_t) const { return 0; }
  FLOE_KERNEL void beam(std::int32_t, std::int32_t, double*) const {}
  FLOE_KERNEL std::int32_t bodies(std::int32_t block) const {
    const std::int32_t left = number - block * of_block;
    return left < of_block ? left : of_block;
  }
  FLOE_KERNEL void body(std::int32_t block, std::int32_t k, const double*) const {
    work(block * of_block + k);
  }
};

/// What does not change of the bodies of all runs and of their obstacles.
struct ListedSolids {
  const double *sizes, *widths;            ///< per body; per obstacle after them [m]
  const double* frictions;                 ///< per obstacle: mu, and mu below still water
  const std::int32_t *rank, *by_rank;      ///< of a body in its run's model; the body of a rank
  const std::int32_t* piece;               ///< per body, within its run
  const std::uint8_t* states;              ///< Eligible::State
  const std::int32_t *first_beam, *beams;  ///< per body, and one more; the other end of each beam
  const std::uint8_t* broken;              ///< per such end: 1 if the beam has broken, else 0
};

/// A list that is made of one run.
struct ListedRun {
  std::int32_t run, first_body, bodies, first_obstacle, obstacles;
  std::int32_t buckets;  ///< of the grid, a power of 2
  std::int32_t large;    ///< number of bodies that are too large for it
  double cell;           ///< length of its cells [m]
  double reach;          ///< largest gap of a listed pair [m]
  Periods periods;
  std::int32_t columns_x, columns_y;  ///< cells of a period; 0: there is none
  double young, young_broken, friction, friction_wet;
};

/// Memory in which a list is made.
struct ListMemory {
  ListedSolids solids;
  ListedRun of;
  ContactMemory contacts;
  Soa records;                ///< of now
  Soa bodies;                 ///< their constants, as Lattice has them
  const double* obstacles;    ///< of the run: origin and axes of each [12 numbers]
  const std::int32_t* large;  ///< bodies
  // The grid.
  std::int32_t* cells;  ///< per body of the run: x, y, z
  std::int32_t *bucket, *in_bucket, *first_in_bucket, *entries;
  // Per rank: number of pairs, where they begin; per block of these the same.
  std::int32_t *count, *first, *of_blocks;
  // The pairs that are made, in memory for the room of the run.
  std::int32_t *a, *b, *face;
  std::uint8_t* states;
  Soa constants, history, crushes;
  // What changes of the contacts: ContactMemory has the same to be read.
  std::int32_t *of_a, *of_b, *first_end, *end_count, *ends, *first_of_obstacle, *count_of_obstacle,
      *pairs_of_obstacle;
};

/// Sums before each of some numbers, in a fixed order: blocks, then their sums, then within blocks.
struct SumBlocks {
  const std::int32_t* count;
  std::int32_t* of_blocks;
  std::int32_t number;

  FLOE_KERNEL void operator()(std::int32_t block) const {
    std::int32_t sum = 0;
    for (std::int32_t k = block * of_block; k < (block + 1) * of_block && k < number; ++k)
      sum += count[k];
    of_blocks[block] = sum;
  }
};
struct SumBefore {
  std::int32_t* of_blocks;  ///< and one more: the sum of all
  std::int32_t blocks;

  FLOE_KERNEL void operator()(std::int32_t) const {
    std::int32_t sum = 0;
    for (std::int32_t k = 0; k < blocks; ++k) {
      const std::int32_t of = of_blocks[k];
      of_blocks[k] = sum;
      sum += of;
    }
    of_blocks[blocks] = sum;
  }
};
struct SumWithin {
  const std::int32_t *count, *of_blocks;
  std::int32_t* first;
  std::int32_t number;
  std::int32_t begin = 0;  ///< before all

  FLOE_KERNEL void operator()(std::int32_t block) const {
    std::int32_t sum = begin + of_blocks[block];
    for (std::int32_t k = block * of_block; k < (block + 1) * of_block && k < number; ++k) {
      first[k] = sum;
      sum += count[k];
    }
  }
};

struct SetZero {
  std::int32_t* numbers;
  FLOE_KERNEL void operator()(std::int32_t k) const { numbers[k] = 0; }
};

/// What kernels of a list share.
struct OfList {
  ListMemory m;

 protected:
  FLOE_KERNEL bool is_in_grid(std::int64_t body) const {
    return (m.solids.states[body] & (Eligible::left_out | Eligible::large)) == 0;
  }
  FLOE_KERNEL Placed placed(std::int32_t solid) const {
    const std::int64_t body = m.contacts.body_of(solid);
    if (body < 0) {
      const std::int64_t k = solid - m.contacts.bodies - m.of.first_obstacle;
      const double* o = m.obstacles + 12 * k;
      const auto at = [&](int n) { return Vec3<double>{o[n], o[n + 1], o[n + 2]}; };
      return {at(0), {at(3), at(6), at(9)}, {}, {}, 0};
    }
    return {m.contacts.rest.vector(0, body) + m.records.vector(0, body),
            triad(product(m.records.quaternion(3, body), m.bodies.quaternion(4, body))),
            {},
            {},
            0};
  }
  FLOE_KERNEL Vec3<double> centre(std::int64_t body) const {
    return m.contacts.rest.vector(0, body) + m.records.vector(0, body);
  }
  FLOE_KERNEL std::int32_t bucket_of(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const std::uint32_t hash = static_cast<std::uint32_t>(x) * 73856093U ^
                               static_cast<std::uint32_t>(y) * 19349663U ^
                               static_cast<std::uint32_t>(z) * 83492791U;
    return static_cast<std::int32_t>(hash & static_cast<std::uint32_t>(m.of.buckets - 1));
  }
  FLOE_KERNEL static std::int32_t wrapped(std::int32_t place, std::int32_t columns) {
    if (columns == 0) return place;
    const std::int32_t rest = place % columns;
    return rest < 0 ? rest + columns : rest;
  }
  FLOE_KERNEL bool has_beam(std::int32_t a, std::int32_t b, bool broken) const {
    const ListedSolids& s = m.solids;
    for (std::int32_t k = s.first_beam[a]; k < s.first_beam[a + 1]; ++k)
      if (s.beams[k] == b && (s.broken[k] != 0) == broken) return true;
    return false;
  }
  /// Eligibility::may_touch().
  FLOE_KERNEL bool may_touch(std::int32_t a, std::int32_t b) const {
    const ListedSolids& s = m.solids;
    if (s.piece[a] != s.piece[b]) return true;
    return (s.states[a] & s.states[b] & Eligible::on_surface) != 0 && !has_beam(a, b, false);
  }
  /// Whether no plane of a face leaves a gap wider than the reach.
  FLOE_KERNEL bool is_near(std::int32_t a, std::int32_t b) const {
    const Placed of_a = placed(a);
    Placed of_b = placed(b);
    if (m.of.periods.any()) of_b.x = of_a.x - m.of.periods.nearest(of_a.x - of_b.x);
    return !has_gap(a, b, of_a, of_b) &&
           (m.contacts.first_vertex[b] == m.contacts.first_vertex[b + 1] ||
            !has_gap(b, a, of_b, of_a));
  }
  /// Whether a plane of B leaves such a gap to the vertices of A.
  FLOE_KERNEL bool has_gap(std::int32_t a, std::int32_t b, const Placed& of_a,
                           const Placed& of_b) const {
    const ContactMemory& c = m.contacts;
    const Relative place(of_a, of_b);
    for (std::int32_t p = c.first_plane[b]; p < c.first_plane[b + 1]; ++p) {
      const HalfSpace& plane = c.planes[p];
      const double height = dot(plane.normal, place.x) - plane.offset;
      if (!(height > m.of.reach)) continue;  // no gap is wider if the origin is inside
      const Vec3<double> along = place.turn.to_local(plane.normal);
      bool beyond = true;
      for (std::int32_t v = c.first_vertex[a]; v < c.first_vertex[a + 1] && beyond; ++v) {
        const double* r = c.vertices + 3 * static_cast<std::int64_t>(v);
        beyond = height + dot(along, Vec3<double>{r[0], r[1], r[2]}) > m.of.reach;
      }
      if (beyond) return true;
    }
    return false;
  }
  /// Calls use(body) for bodies that may touch a body and come after it in the model, in any order.
  template <class Use>
  FLOE_KERNEL void for_later_bodies(std::int32_t a, const Use& use) const {
    const ListedSolids& s = m.solids;
    const Vec3<double> at = centre(a);
    const auto look = [&](std::int32_t b) {
      if (s.rank[b] <= s.rank[a]) return;
      const double most = m.contacts.radius[a] + m.contacts.radius[b] + m.of.reach;
      const Vec3<double> apart = m.of.periods.nearest(at - centre(b));
      if (dot(apart, apart) <= most * most && may_touch(a, b) && is_near(a, b)) use(b);
    };
    if ((s.states[a] & Eligible::large) != 0) {  // few are
      for (std::int32_t k = 0; k < m.of.bodies; ++k) {
        const std::int32_t b = m.of.first_body + k;
        if ((s.states[b] & Eligible::left_out) == 0) look(b);
      }
      return;
    }
    for (std::int32_t k = 0; k < m.of.large; ++k) look(m.large[k]);
    const std::int32_t* cell = m.cells + 3 * static_cast<std::int64_t>(a - m.of.first_body);
    // Of periods with one or two cells there are not three different ones side by side.
    const auto cells = [](std::int32_t columns) {
      return columns == 1 || columns == 2 ? columns : 3;
    };
    const std::int32_t nx = cells(m.of.columns_x), ny = cells(m.of.columns_y);
    for (std::int32_t i = 0; i < nx; ++i) {
      for (std::int32_t j = 0; j < ny; ++j) {
        for (std::int32_t k = -1; k <= 1; ++k)
          for_cell(wrapped(cell[0] + i - 1, m.of.columns_x),
                   wrapped(cell[1] + j - 1, m.of.columns_y), cell[2] + k, look);
      }
    }
  }
  /// Calls use(obstacle) for obstacles that a body may touch, from the last to the first: so they
  /// are sorted in the list.
  template <class Use>
  FLOE_KERNEL void for_obstacles(std::int32_t a, const Use& use) const {
    for (std::int32_t k = m.of.obstacles; k-- > 0;) {
      const std::int32_t b = m.contacts.bodies + m.of.first_obstacle + k;
      if (is_near(a, b)) use(b);
    }
  }

 private:
  template <class Look>
  FLOE_KERNEL void for_cell(std::int32_t x, std::int32_t y, std::int32_t z,
                            const Look& look) const {
    const std::int32_t bucket = bucket_of(x, y, z);
    const std::int32_t begin = m.first_in_bucket[bucket];
    for (std::int32_t e = begin; e < begin + m.in_bucket[bucket]; ++e) {
      const std::int32_t b = m.entries[e];
      const std::int32_t* cell = m.cells + 3 * static_cast<std::int64_t>(b - m.of.first_body);
      if (cell[0] == x && cell[1] == y && cell[2] == z) look(b);
    }
  }
};

/// Finds the cell of each body, and counts the bodies of a bucket.
struct FindCells : OfList {
  FLOE_KERNEL void operator()(std::int32_t k) const {
    const std::int32_t body = m.of.first_body + k;
    if (!is_in_grid(body)) return;
    const Vec3<double> x = centre(body);
    std::int32_t* cell = m.cells + 3 * static_cast<std::int64_t>(k);
    cell[0] = cell_along(x.x, m.of.periods.length.x, m.of.columns_x);
    cell[1] = cell_along(x.y, m.of.periods.length.y, m.of.columns_y);
    cell[2] = cell_along(x.z, 0, 0);
    m.bucket[k] = bucket_of(cell[0], cell[1], cell[2]);
    (void)add_one(&m.in_bucket[m.bucket[k]]);
  }

 private:
  FLOE_KERNEL std::int32_t cell_along(double x, double period, std::int32_t columns) const {
    constexpr double farthest = 1e9;  // bodies that fly off share the last cell
    if (columns == 0) {
      const double place = std::floor(x / m.of.cell);
      return static_cast<std::int32_t>(place < -farthest  ? -farthest
                                       : place < farthest ? place
                                                          : farthest);
    }
    const double rest = x / period - std::floor(x / period);
    const auto place = static_cast<std::int32_t>(rest * columns);
    return place < columns ? place : columns - 1;
  }
};
/// Writes the bodies of each bucket, in any order. \param in_bucket  zeros, which count again
struct FillBuckets : OfList {
  FLOE_KERNEL void operator()(std::int32_t k) const {
    const std::int32_t body = m.of.first_body + k;
    if (!is_in_grid(body)) return;
    const std::int32_t bucket = m.bucket[k];
    m.entries[m.first_in_bucket[bucket] + add_one(&m.in_bucket[bucket])] = body;
  }
};

/// Counts the pairs of which a body is A.
struct CountPairs : OfList {
  FLOE_KERNEL void operator()(std::int32_t rank) const {
    const std::int32_t a = m.solids.by_rank[m.of.first_body + rank];
    std::int32_t number = 0;
    if ((m.solids.states[a] & Eligible::left_out) == 0) {
      const auto count = [&](std::int32_t) { ++number; };
      for_obstacles(a, count);
      for_later_bodies(a, count);
    }
    m.count[rank] = number;
  }
};

/// Writes these pairs, sorted, each with its constants and with what the last list knew of it.
struct WritePairs : OfList {
  FLOE_KERNEL void operator()(std::int32_t rank) const {
    const std::int32_t a = m.solids.by_rank[m.of.first_body + rank];
    if (m.count[rank] == 0) return;
    const std::int32_t begin = m.first[rank];
    std::int32_t end = begin;
    for_obstacles(a, [&](std::int32_t b) { m.b[end++] = b; });
    const std::int32_t bodies = end;
    for_later_bodies(a, [&](std::int32_t b) {
      std::int32_t at = end++;
      for (; at > bodies && m.solids.rank[m.b[at - 1]] > m.solids.rank[b]; --at)
        m.b[at] = m.b[at - 1];
      m.b[at] = b;
    });
    const ContactMemory& c = m.contacts;
    const ContactsOfRun& run = c.runs[m.of.run];
    std::int64_t old = first_of(rank);
    const std::int64_t last = run.first_pair + run.pairs;
    for (std::int32_t p = begin; p < end; ++p) {
      const std::int32_t b = m.b[p];
      m.a[p] = a;
      write_constants(p, a, b);
      while (old < last && c.a[old] == a && is_before(c.b[old], b)) ++old;
      const bool known = old < last && c.a[old] == a && c.b[old] == b;
      m.face[p] = known ? c.face[old] : -1;
      m.states[p] = known ? c.states[old] : 0;
      if (!known || c.states[old] == 0) continue;
      for (int n = 0; n < of_history; ++n) m.history.at(n, p) = c.history.at(n, old);
      if (run.wears == 0) continue;
      for (int n = 0; n < static_cast<int>(DevicePairs::crush); ++n)
        m.crushes.at(n, p) = c.crushes.at(n, old);
    }
  }

 private:
  /// Whether one B comes before another in the pairs of a body.
  FLOE_KERNEL bool is_before(std::int32_t b, std::int32_t other) const {
    const bool on_body = b < m.contacts.bodies, on_other = other < m.contacts.bodies;
    if (on_body && on_other) return m.solids.rank[b] < m.solids.rank[other];
    return on_body == on_other ? b > other : on_other;
  }
  /// Returns the first pair of the last list of which A has a rank that is not below this.
  FLOE_KERNEL std::int64_t first_of(std::int32_t rank) const {
    const ContactMemory& c = m.contacts;
    std::int64_t low = c.runs[m.of.run].first_pair, high = low + c.runs[m.of.run].pairs;
    while (low < high) {
      const std::int64_t middle = low + (high - low) / 2;
      if (m.solids.rank[c.a[middle]] < rank) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }
  FLOE_KERNEL void write_constants(std::int32_t p, std::int32_t a, std::int32_t b) const {
    const ListedSolids& s = m.solids;
    double friction = m.of.friction, wet = m.of.friction_wet, half_space = 0;
    PairConstants of;
    if (b < m.contacts.bodies) {
      of =
          ice_on_ice(has_beam(a, b, true) ? m.of.young_broken : m.of.young, s.sizes[a], s.sizes[b]);
    } else {
      of = ice_on_obstacle(m.of.young, s.sizes[a]);
      const double* rubs = s.frictions + 2 * static_cast<std::int64_t>(b - m.contacts.bodies);
      friction = rubs[0], wet = rubs[1];
      half_space = m.contacts.first_vertex[b] == m.contacts.first_vertex[b + 1] ? 1 : 0;
    }
    const double thinner = s.widths[a] < s.widths[b] ? s.widths[a] : s.widths[b];
    const double numbers[6] = {of.stiffness, of.area,    friction,  // NOLINT: registers
                               wet,          half_space, thinner};
    for (int n = 0; n < 6; ++n) m.constants.at(n, p) = numbers[n];
  }
};

/// Takes the pairs that have been made into the run's place. \param pair  counted from 0
struct TakePairs : OfList {
  FLOE_KERNEL void operator()(std::int32_t p) const {
    const ContactMemory& c = m.contacts;
    const ContactsOfRun& run = c.runs[m.of.run];
    const std::int64_t at = run.first_pair + p;
    m.of_a[at] = m.a[p];
    m.of_b[at] = m.b[p];
    c.face[at] = m.face[p];
    c.states[at] = m.states[p];
    c.touch[at] = 0;
    for (int n = 0; n < 6; ++n) c.constants.at(n, at) = m.constants.at(n, p);
    if (m.states[p] == 0) return;
    for (int n = 0; n < of_history; ++n) c.history.at(n, at) = m.history.at(n, p);
    if (run.wears == 0) return;
    for (int n = 0; n < static_cast<int>(DevicePairs::crush); ++n)
      c.crushes.at(n, at) = m.crushes.at(n, p);
  }
};

/// Counts the ends of pairs on each body; writes them, in any order; sorts them as pairs are.
/// \param end_count  zeros, for both of the first
struct CountEnds : OfList {
  FLOE_KERNEL void operator()(std::int32_t p) const {
    (void)add_one(&m.end_count[m.a[p]]);
    const std::int32_t b = m.contacts.body_of(m.b[p]);
    if (b >= 0) (void)add_one(&m.end_count[b]);
  }
};
struct WriteEnds : OfList {
  FLOE_KERNEL void operator()(std::int32_t p) const {
    const auto pair = static_cast<std::int32_t>(m.contacts.runs[m.of.run].first_pair) + p;
    const auto add = [&](std::int32_t body, std::int32_t end) {
      m.ends[m.first_end[body] + add_one(&m.end_count[body])] = end;
    };
    add(m.a[p], 2 * pair);
    const std::int32_t b = m.contacts.body_of(m.b[p]);
    if (b >= 0) add(b, 2 * pair + 1);
  }
};
struct SortEnds : OfList {
  FLOE_KERNEL void operator()(std::int32_t k) const {
    const std::int32_t body = m.of.first_body + k, begin = m.first_end[body],
                       end = begin + m.end_count[body];
    for (std::int32_t e = begin + 1; e < end; ++e) {
      const std::int32_t moved = m.ends[e];
      std::int32_t at = e;
      for (; at > begin && m.ends[at - 1] > moved; --at) m.ends[at] = m.ends[at - 1];
      m.ends[at] = moved;
    }
  }
};

/// Lists the pairs of each obstacle of the run, in order; one warp does all.
struct ListObstacles : OfList {
  struct Room {
    double none;
  };
  std::int32_t pairs;

  FLOE_KERNEL void warp(std::int32_t, const Warp& warp, Room&) const {
    const auto first = static_cast<std::int32_t>(m.contacts.runs[m.of.run].first_pair);
    std::int32_t at = first;
    for (std::int32_t k = m.of.first_obstacle; k < m.of.first_obstacle + m.of.obstacles; ++k) {
      const std::int32_t begin = at, solid = m.contacts.bodies + k;
      for (std::int32_t p = 0; p < pairs; p += Warp::lanes) {
        const std::uint32_t mask =
            warp.ballot([&](int lane) { return p + lane < pairs && m.b[p + lane] == solid; });
        warp.each([&](int lane) {
          const std::uint32_t before = mask & ((1U << lane) - 1U);
          if ((mask >> lane & 1U) != 0)
            m.pairs_of_obstacle[at + count_bits(before)] = first + p + lane;
        });
        at += count_bits(mask);
      }
      warp.each([&](int lane) {
        if (lane != 0) return;
        m.first_of_obstacle[k] = begin;
        m.count_of_obstacle[k] = at - begin;
      });
    }
  }
};

}  // namespace
}  // namespace floe::device

#include "leapfrog/leapfrog_stepper.h"

#include <algorithm>

#include "floe/base/item.h"
#include "leapfrog/held_body.h"

namespace floe {
namespace {

BodyMotion<double> read(const double* r) {
  return {{r[0], r[1], r[2]},
          {r[3], r[4], r[5], r[6]},
          {r[7], r[8], r[9]},
          {r[10], r[11], r[12]},
          {r[13], r[14], r[15]}};
}

void write(const BodyMotion<double>& m, double* r) {
  const std::array<double, 16> all{m.u.x, m.u.y,        m.u.z,        m.q.w,       m.q.x, m.q.y,
                                   m.q.z, m.v.x,        m.v.y,        m.v.z,       m.w.x, m.w.y,
                                   m.w.z, m.momentum.x, m.momentum.y, m.momentum.z};
  std::copy(all.begin(), all.end(), r);
}

/// Force and moment, with the prescribed components set to zero.
std::array<Vec3<double>, 2> on_free(const double* w, std::uint8_t prescribed) {
  std::array<double, 6> f{};
  for (std::size_t k = 0; k < 6; ++k) f[k] = (prescribed >> k & 1U) != 0 ? 0.0 : w[k];
  return {Vec3<double>{f[0], f[1], f[2]}, Vec3<double>{f[3], f[4], f[5]}};
}

Vec3<double> inverse_of(const Vec3<double>& v) { return {1.0 / v.x, 1.0 / v.y, 1.0 / v.z}; }

}  // namespace

BodyConstants<Lanes> LeapfrogStepper::Block::get() const {
  const auto at = [&](std::size_t k) { return load(values[k].data()); };
  return {at(0), {at(1), at(2), at(3)}, {at(4), at(5), at(6), at(7)}};
}

BodyConstants<double> LeapfrogStepper::constants(std::int32_t body) const {
  const auto b = static_cast<std::size_t>(body);
  const auto at = [&](std::size_t k) { return blocks_[b / lanes].values[k][b % lanes]; };
  return {at(0), {at(1), at(2), at(3)}, {at(4), at(5), at(6), at(7)}};
}

Vec3<Lanes> LeapfrogStepper::MassBlock::get() const {
  return {load(values[0].data()), load(values[1].data()), load(values[2].data())};
}

/// Masses along the principal axes.
Vec3<double> LeapfrogStepper::masses(std::int32_t body) const {
  const auto b = static_cast<std::size_t>(body);
  const auto at = [&](std::size_t k) { return masses_[b / lanes].values[k][b % lanes]; };
  return {at(0), at(1), at(2)};
}

/// Linear momentum by the velocity, and the other way round.
Vec3<double> LeapfrogStepper::momentum_of(std::int32_t body, const Triad<double>& axes,
                                          const Vec3<double>& velocity) const {
  if (masses_.empty()) return (1.0 / constants(body).inverse_mass) * velocity;
  const Vec3<double> mass = masses(body), v = axes.to_local(velocity);
  return axes.to_world({mass.x * v.x, mass.y * v.y, mass.z * v.z});
}
Vec3<double> LeapfrogStepper::velocity_of(std::int32_t body, const Triad<double>& axes,
                                          const Vec3<double>& momentum) const {
  if (masses_.empty()) return constants(body).inverse_mass * momentum;
  const Vec3<double> mass = masses(body), p = axes.to_local(momentum);
  return axes.to_world({p.x / mass.x, p.y / mass.y, p.z / mass.z});
}

LeapfrogStepper::LeapfrogStepper(const Model<Spatial>& model) : model_(model), part_(model.part()) {
  const auto owned = static_cast<std::size_t>(part_.owned);
  blocks_.resize((owned + lanes - 1) / lanes, Block{});
  for (std::size_t slot = 0; slot < blocks_.size() * lanes; ++slot) {
    const std::size_t b = std::min(slot, owned - 1);  // lanes without a body compute the last one
    Point3 inertia = part_.bodies.inertia[b];
    // Bodies with prescribed components move without added inertia.
    if (!model.added_inertia().empty()) {
      const double own = model.inertial_mass()[b];
      Vec3<double> mass{own, own, own};
      if (model.prescribed()[b] == 0) {
        mass = mass + model.added_inertia()[b].mass;
        inertia = inertia + model.added_inertia()[b].moment;
      }
      if (slot == 0) masses_.resize(blocks_.size()), kicked_.resize(3 * lanes * blocks_.size());
      for (std::size_t k = 0; k < 3; ++k) masses_[slot / lanes].values[k][slot % lanes] = mass[k];
    }
    const auto [w, x, y, z] = part_.bodies.orientation[b];
    const std::array<double, 8> all{
        1 / model.inertial_mass()[b], 1 / inertia.x, 1 / inertia.y, 1 / inertia.z, w, x, y, z};
    for (std::size_t k = 0; k < all.size(); ++k)
      blocks_[slot / lanes].values[k][slot % lanes] = all[k];
    if (slot >= owned || model.prescribed()[b] == 0) continue;
    if (rows_.empty()) rows_.assign(static_cast<std::size_t>(part_.local), -1);
    rows_[b] = static_cast<std::int32_t>(held_.size());
    held_.push_back(static_cast<std::int32_t>(b));
  }
  if (!held_.empty()) free_.assign(blocks_.size() * lanes, 1.0);
  for (const std::int32_t b : held_) item(free_, b) = 0;
  for (std::size_t slot = owned; slot < free_.size(); ++slot) free_[slot] = free_[owned - 1];
  saved_.resize(held_.size() * Spatial::record);
  now_.resize(held_.size() * Spatial::unknowns);
  next_ = now_;
}

void LeapfrogStepper::start(State<Spatial>& state, const std::vector<Point3>& velocity,
                            const std::vector<Point3>& spin) const {
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    const auto b = static_cast<std::size_t>(body);
    BodyMotion<double> m = read(state.record(b));
    if (!velocity.empty()) m.v = velocity[b];
    if (!spin.empty()) m.w = spin[b];
    const BodyConstants<double> c = constants(body);
    const Triad<double> axes = triad(product(m.q, c.axes));
    const Vec3<double> w = axes.to_local(m.w), inertia = inverse_of(c.inverse_inertia);
    m.momentum = axes.to_world({inertia.x * w.x, inertia.y * w.y, inertia.z * w.z});
    write(m, state.record(b));
  }
}

void LeapfrogStepper::stagger(State<Spatial>& state, const Wrenches<Spatial>& wrenches,
                              double dt) const {
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    const auto b = static_cast<std::size_t>(body);
    BodyMotion<double> m = read(state.record(b));
    const BodyConstants<double> c = constants(body);
    const auto [force, moment] = on_free(wrenches.of(b), model_.prescribed()[b]);
    const Triad<double> axes = triad(product(m.q, c.axes));
    m.v = masses_.empty() ? m.v - (0.5 * dt * c.inverse_mass) * force
                          : m.v - (0.5 * dt) * velocity_of(body, axes, force);
    m.momentum = m.momentum - (0.5 * dt) * moment;
    const Vec3<double> l = axes.to_local(m.momentum);
    m.w = axes.to_world(
        {c.inverse_inertia.x * l.x, c.inverse_inertia.y * l.y, c.inverse_inertia.z * l.z});
    write(m, state.record(b));
  }
}

/// Whole blocks one after the other. In one copy, for all ranks: contraction to fused operations
/// may differ between two copies of a loop, and a body must not depend on whether its block is
/// whole. \param records, wrenches  of the first block's bodies
template <bool added>
[[FLOE_ONE_COPY, gnu::flatten]] LeapfrogStepper::Extremes LeapfrogStepper::step_blocks(
    std::span<const Block> blocks, [[maybe_unused]] const MassBlock* masses, const double* free,
    double* records, const double* wrenches, [[maybe_unused]] double* kicked, double dt) {
  Extremes largest;
  for (const Block& block : blocks) {
    const auto four = [](const double* first, std::size_t width) {
      return gather_four([&](std::size_t lane) { return first + lane * width; });
    };
    constexpr std::size_t n = Spatial::record, w = Spatial::wrench;
    const auto a = four(records, n), b = four(records + 4, n), c = four(records + 8, n),
               d = four(records + 12, n), f = four(wrenches, w), g = four(wrenches + 4, w);
    BodyMotion<Lanes> m{{a[0], a[1], a[2]},
                        {a[3], b[0], b[1], b[2]},
                        {b[3], c[0], c[1]},
                        {c[2], c[3], d[0]},
                        {d[1], d[2], d[3]}};
    if constexpr (added) {
      const Vec3<Lanes> v = leap_with_added_mass<Lanes>(block.get(), (masses++)->get(), m,
                                                        {f[0], f[1], f[2]}, {f[3], g[0], g[1]}, dt);
      for (std::size_t lane = 0; lane < lanes; ++lane, kicked += 3)
        kicked[0] = v.x[lane], kicked[1] = v.y[lane], kicked[2] = v.z[lane];
    } else {
      leap<Lanes>(block.get(), m, {f[0], f[1], f[2]}, {f[3], g[0], g[1]}, dt);
    }

    const auto put = [&](std::size_t offset, const std::array<Lanes, 4>& values) {
      scatter_four(values, [&](auto lane, const Row& row) {
        store_row(records + lane() * n + offset, row);
      });
    };
    put(0, {m.u.x, m.u.y, m.u.z, m.q.w});
    put(4, {m.q.x, m.q.y, m.q.z, m.v.x});
    put(8, {m.v.y, m.v.z, m.w.x, m.w.y});
    put(12, {m.w.z, m.momentum.x, m.momentum.y, m.momentum.z});
    Lanes speed2 = dot(m.v, m.v), spin2 = dot(m.w, m.w);
    if (free != nullptr) {  // held bodies move otherwise
      const auto held = Lanes(free, std::experimental::element_aligned) == 0.0;
      where(held, speed2) = 0.0;
      where(held, spin2) = 0.0;
      free += lanes;
    }
    largest.speed2 = max(largest.speed2, speed2);
    largest.spin2 = max(largest.spin2, spin2);
    largest.sum += speed2;
    records += lanes * n;
    wrenches += lanes * w;
  }
  return largest;
}

/// The bodies of the last block, if they do not fill it, are stepped in a block of their own that
/// is filled up with the last of them.
std::array<double, 2> LeapfrogStepper::step_all(State<Spatial>& state,
                                                const Wrenches<Spatial>& wrenches, double dt) {
  constexpr std::size_t n = Spatial::record, w = Spatial::wrench;
  const auto owned = static_cast<std::size_t>(part_.owned);
  const std::size_t whole = owned / lanes, left = owned % lanes;
  const std::span<const Block> blocks(blocks_);
  const auto step = [&](std::span<const Block> some, std::size_t first, double* records,
                        const double* forces) {
    const double* free = free_.empty() ? nullptr : free_.data() + first * lanes;
    return masses_.empty() ? step_blocks<false>(some, nullptr, free, records, forces, nullptr, dt)
                           : step_blocks<true>(some, masses_.data() + first, free, records, forces,
                                               kicked_.data() + 3 * first * lanes, dt);
  };
  Extremes largest = step(blocks.first(whole), 0, state.records.data(), wrenches.values.data());
  if (left > 0) {
    alignas(64) std::array<double, lanes * n> records;
    alignas(64) std::array<double, lanes * w> forces;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t body = whole * lanes + std::min(lane, left - 1);
      std::copy_n(state.record(body), n, &records[lane * n]);
      std::copy_n(wrenches.of(body), w, &forces[lane * w]);
    }
    const Extremes last = step(blocks.last(1), whole, records.data(), forces.data());
    std::copy_n(records.data(), left * n, state.record(whole * lanes));
    largest.speed2 = max(largest.speed2, last.speed2);
    largest.spin2 = max(largest.spin2, last.spin2);
    largest.sum += last.sum;
  }
  // A maximum would lose what is not a number, a sum keeps it.
  return {std::isfinite(reduce(largest.sum)) ? hmax(largest.speed2)
                                             : std::numeric_limits<double>::quiet_NaN(),
          hmax(largest.spin2)};
}

void LeapfrogStepper::swap_kicked(State<Spatial>& state) {
  if (masses_.empty()) return;
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b) {
    if (model_.prescribed()[b] == 0)
      std::swap_ranges(&kicked_[3 * b], &kicked_[3 * b] + 3, state.record(b) + Spatial::velocity);
  }
}

double LeapfrogStepper::step(State<Spatial>& state, const Wrenches<Spatial>& wrenches, double dt) {
  for (std::size_t k = 0; k < held_.size(); ++k) {
    const double* record = state.record(static_cast<std::size_t>(held_[k]));
    std::copy_n(record, Spatial::record,
                saved_.begin() + static_cast<std::ptrdiff_t>(k * Spatial::record));
  }
  auto [speed2, spin2] = step_all(state, wrenches, dt);
  if (!held_.empty()) {
    model_.prescribe(state.time, now_, rows_);
    model_.prescribe(state.time + dt, next_, rows_);
    for (std::size_t k = 0; k < held_.size(); ++k) {
      const auto first = k * Spatial::unknowns;
      step_held(held_[k], &saved_[k * Spatial::record], state, wrenches,
                std::span(now_).subspan(first, Spatial::unknowns),
                std::span(next_).subspan(first, Spatial::unknowns), dt);
      const auto b = static_cast<std::size_t>(held_[k]);
      const Vec3<double> v = velocity(state, b), w = angular_velocity(state, b);
      // Keeps what is not a number, of free bodies and of held ones.
      if (!std::isnan(speed2) && !(dot(v, v) <= speed2)) speed2 = dot(v, v);
      spin2 = std::max(spin2, dot(w, w));
    }
  }
  state.time += dt;
  state.fastest = std::sqrt(speed2);
  state.fastest_spin = std::sqrt(spin2);
  return speed2;
}

/// Corrects a body that was stepped as if it were free: prescribed components get the velocity that
/// takes them to their prescribed places, by an impulse of the boundary; the others stay free. The
/// boundary's work is that impulse times the mean velocity.
void LeapfrogStepper::step_held(std::int32_t body, const double* before, State<Spatial>& state,
                                const Wrenches<Spatial>& wrenches, std::span<const double> now,
                                std::span<const double> next, double dt) {
  const auto b = static_cast<std::size_t>(body);
  const HeldBody<double> held{model_.prescribed()[b], now.data(), next.data(), dt};
  const BodyConstants<double> c = constants(body);
  const BodyMotion<double> from = read(before);
  BodyMotion<double> to = read(state.record(b));
  boundary_work_ += hold_displacements(held, c.inverse_mass, from, to);
  if (held.bits >> 3 != 0) {
    const double* f = wrenches.of(b);
    boundary_work_ += hold_rotations(held, c, from, Vec3<double>{f[3], f[4], f[5]}, to);
  }
  write(to, state.record(b));
}

/// Velocity and angular momentum half a step later: by the forces where a body is free, prescribed
/// elsewhere.
std::pair<Vec3<double>, Vec3<double>> LeapfrogStepper::half_step_on(
    std::int32_t body, const State<Spatial>& state, const Wrenches<Spatial>& wrenches,
    double dt) const {
  const auto b = static_cast<std::size_t>(body);
  const std::uint8_t bits = model_.prescribed()[b];
  const BodyConstants<double> c = constants(body);
  const BodyMotion<double> m = read(state.record(b));
  const auto [force, moment] = on_free(wrenches.of(b), bits);
  const Vec3<double> v = masses_.empty()
                             ? m.v + (dt * c.inverse_mass) * force
                             : m.v + dt * velocity_of(body, triad(product(m.q, c.axes)), force);
  const Vec3<double> momentum = m.momentum + dt * moment;
  if (bits == 0) return {v, momentum};
  const auto given = [&](std::size_t k) {
    const std::size_t at = static_cast<std::size_t>(rows_[b]) * Spatial::unknowns + k;
    return (next_[at] - now_[at]) / dt;
  };
  const auto fixed = [&](std::size_t k) { return (bits >> k & 1U) != 0; };
  const Vec3<double> held{fixed(0) ? given(0) : v.x, fixed(1) ? given(1) : v.y,
                          fixed(2) ? given(2) : v.z};
  if (!fixed(3) || !fixed(4) || !fixed(5)) return {held, momentum};
  const Triad<double> axes = triad(product(m.q, c.axes));
  const Vec3<double> w = axes.to_local({given(3), given(4), given(5)});
  const Vec3<double> inertia = inverse_of(c.inverse_inertia);
  return {held, axes.to_world({inertia.x * w.x, inertia.y * w.y, inertia.z * w.z})};
}

LeapfrogStepper::Energies LeapfrogStepper::energies(const State<Spatial>& state,
                                                    const Wrenches<Spatial>& wrenches,
                                                    double dt) const {
  if (!held_.empty()) {
    model_.prescribe(state.time, now_, rows_);
    model_.prescribe(state.time + dt, next_, rows_);
  }
  Energies sum{0, boundary_work_};
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    const auto b = static_cast<std::size_t>(body);
    const BodyConstants<double> c = constants(body);
    const BodyMotion<double> m = read(state.record(b));
    const auto [v, momentum] = half_step_on(body, state, wrenches, dt);
    const Triad<double> axes = triad(product(m.q, c.axes));
    const Vec3<double> before = axes.to_local(m.momentum), after = axes.to_local(momentum);
    const double moving =
        masses_.empty() ? dot(m.v, v) / c.inverse_mass : dot(m.v, momentum_of(body, axes, v));
    sum.kinetic +=
        0.5 * (moving + c.inverse_inertia.x * before.x * after.x +
               c.inverse_inertia.y * before.y * after.y + c.inverse_inertia.z * before.z * after.z);
    if (model_.prescribed()[b] == 0) continue;
    // Half the impulse that the boundary gives at t_n belongs to the step before.
    const double* w = wrenches.of(b);
    const Vec3<double> impulse =
        (1.0 / c.inverse_mass) * (v - m.v) - dt * Vec3<double>{w[0], w[1], w[2]};
    const Vec3<double> turn = momentum - m.momentum - dt * Vec3<double>{w[3], w[4], w[5]};
    sum.boundary += 0.5 * (dot(m.v, impulse) + dot(m.w, turn));
  }
  return sum;
}

std::array<double, 6> LeapfrogStepper::momentum(const State<Spatial>& state,
                                                const Wrenches<Spatial>& wrenches,
                                                double dt) const {
  std::array<double, 6> total{};
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    const auto b = static_cast<std::size_t>(body);
    const BodyConstants<double> c = constants(body);
    const BodyMotion<double> m = read(state.record(b));
    const double* f = wrenches.of(b);
    const Vec3<double> p = momentum_of(body, triad(product(m.q, c.axes)), m.v) +
                           (0.5 * dt) * Vec3<double>{f[0], f[1], f[2]};
    const Vec3<double> at = part_.bodies.position[b] + m.u;
    const Vec3<double> l = m.momentum + (0.5 * dt) * Vec3<double>{f[3], f[4], f[5]} + cross(at, p);
    const std::array<double, 6> mine{p.x, p.y, p.z, l.x, l.y, l.z};
    for (std::size_t k = 0; k < 6; ++k) total[k] += mine[k];
  }
  return total;
}

}  // namespace floe
